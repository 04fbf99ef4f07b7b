//! Legend of bodies: rows of colours and names below the title.

use super::super::Snapshot;
use super::axis::INK;
use super::canvas::{Pen, Picture};
use super::colour::{NO_VALUE, Rgb, palette};
use super::quantity::Coloured;

/// Maximum number of rows.
const ROWS: usize = 3;
/// Maximum length of a name, letters.
const LONGEST: usize = 40;
/// Maximum number of bodies of one base name that are listed individually.
const APART: usize = 4;
/// Number of colours before the name of a group of bodies.
const SWATCHES: usize = 3;
/// Height of a row over the font size.
const ROW: f32 = 1.5;

/// Entries of a legend, wrapped into rows.
pub(super) struct Legend {
    rows: Vec<Vec<Entry>>,
    size: f32,
}

#[derive(Clone, Debug, PartialEq)]
struct Entry {
    colours: Vec<Rgb>,
    name: String,
}

impl Entry {
    fn width(&self, pen: &Pen, size: f32) -> f32 {
        (1.0 + 0.9 * self.colours.len() as f32) * size + pen.width(&self.name)
    }
}

impl Legend {
    /// Create the legend of a picture: bodies if colour shows the body, else bodies without a value in grey. Empty for a single body, and
    /// for bodies without names.
    pub(super) fn of(snapshot: &Snapshot, coloured: &Coloured, width: f32, size: f32) -> Self {
        let entries = match &coloured.bar {
            None => of_bodies(snapshot),
            Some(_) => without_value(snapshot, &coloured.valued),
        };
        let pen = Pen::new(size, INK);
        let count = entries.len();
        let mut rows: Vec<Vec<Entry>> = Vec::new();
        let mut free = 0.0;
        let (mut listed, mut bodies) = (0, 0);
        for (entry, of) in entries {
            let needs = entry.width(&pen, size) + 0.6 * size;
            if rows.is_empty() || needs > free {
                if rows.len() == ROWS {
                    break;
                }
                rows.push(Vec::new());
                free = width;
            }
            free -= needs;
            (listed, bodies) = (listed + 1, bodies + of);
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        }
        if listed < count {
            let all = snapshot_bodies(snapshot).len();
            let more =
                |bodies: usize| Entry { colours: Vec::new(), name: format!("and {} more", all - bodies) };
            // Remove the last entries to make room for the remainder.
            if let Some(row) = rows.last_mut() {
                let used = |row: &[Entry]| row.iter().map(|e| e.width(&pen, size) + 0.6 * size).sum::<f32>();
                while row.len() > 1 && used(row) + more(bodies).width(&pen, size) > width {
                    if let Some(last) = row.pop() {
                        bodies -= last.bodies();
                    }
                }
                row.push(more(bodies));
            }
        }
        Legend { rows, size }
    }

    /// Height, pixels.
    pub(super) fn height(&self) -> f32 {
        self.rows.len() as f32 * ROW * self.size
    }

    /// Draw the legend centred on column `middle` below row `top`.
    pub(super) fn draw(&self, picture: &mut Picture, middle: f32, top: f32) {
        let (size, pen) = (self.size, Pen::new(self.size, INK));
        for (n, row) in self.rows.iter().enumerate() {
            let width: f32 = row.iter().map(|e| e.width(&pen, size) + 0.6 * size).sum::<f32>() - 0.6 * size;
            let mut x = (middle - 0.5 * width).max(0.3 * size).round();
            let y = top + (n as f32 + 0.5) * ROW * size;
            for Entry { colours, name } in row {
                for colour in colours {
                    picture.fill([x, y - 0.38 * size], [x + 0.8 * size, y + 0.38 * size], *colour);
                    x += 0.9 * size;
                }
                x += 0.4 * size;
                picture.text(name, [x, y + 0.36 * size], &pen);
                x += 1.2 * size + pen.width(name);
            }
        }
    }
}

impl Entry {
    /// Number of bodies of the entry.
    fn bodies(&self) -> usize {
        let count = self.name.rsplit_once(" (").and_then(|(_, n)| n.strip_suffix(" bodies)")?.parse().ok());
        count.unwrap_or(1)
    }
}

/// Indices of the bodies in the snapshot, ascending.
fn snapshot_bodies(snapshot: &Snapshot) -> Vec<usize> {
    let mut there = vec![false; snapshot.body_names().len()];
    for body in snapshot.bodies() {
        if let Some(there) = there.get_mut(*body as usize) {
            *there = true;
        }
    }
    there.iter().enumerate().filter(|(_, there)| **there).map(|(n, _)| n).collect()
}

/// Name without the number at its end: `ball` for `ball 12`.
fn base(name: &str) -> &str {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    if base.len() < name.len() { base.trim_end_matches([' ', '_', '-', '.', '#']) } else { name }
}

/// Entries of bodies and the number of bodies of each; more than [`APART`] of one base name form one entry.
fn of_bodies(snapshot: &Snapshot) -> Vec<(Entry, usize)> {
    let (bodies, names) = (snapshot_bodies(snapshot), snapshot.body_names());
    if bodies.len() < 2 {
        return Vec::new();
    }
    let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
    for body in bodies {
        let base = base(&names[body]);
        match groups.iter_mut().find(|(name, _)| *name == base && !base.is_empty()) {
            Some((_, group)) => group.push(body),
            None => groups.push((base, vec![body])),
        }
    }
    let mut entries = Vec::new();
    for (base, group) in groups {
        if group.len() > APART {
            let colours = group.iter().take(SWATCHES).map(|&body| palette(body)).collect();
            let name = format!("{} ({} bodies)", short(base), group.len());
            entries.push((Entry { colours, name }, group.len()));
        } else {
            let each = |&body: &usize| (Entry { colours: vec![palette(body)], name: short(&names[body]) }, 1);
            entries.extend(group.iter().map(each));
        }
    }
    entries
}

/// One entry for all bodies of which no particle has a value.
fn without_value(snapshot: &Snapshot, valued: &[bool]) -> Vec<(Entry, usize)> {
    let bodies = snapshot_bodies(snapshot);
    let mut with = vec![false; snapshot.body_names().len()];
    for (body, valued) in snapshot.bodies().iter().zip(valued) {
        if let Some(with) = with.get_mut(*body as usize) {
            *with |= *valued;
        }
    }
    let without: Vec<usize> = bodies.into_iter().filter(|&body| !with[body]).collect();
    match without.len() {
        0 => Vec::new(),
        1 => {
            let name = format!("no value: {}", short(&snapshot.body_names()[without[0]]));
            vec![(Entry { colours: vec![NO_VALUE], name }, 1)]
        }
        n => vec![(Entry { colours: vec![NO_VALUE], name: format!("no value: {n} bodies") }, n)],
    }
}

/// Shorten a name to [`LONGEST`] letters.
fn short(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_string();
    }
    name.chars().take(LONGEST - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::ParticleSize;
    use super::super::quantity::colours_of;
    use super::*;

    fn entries(names: Vec<String>, width: f32) -> Vec<String> {
        let count = names.len();
        let positions = (0..count).map(|i| [i as f64, 0.0, 0.0]).collect();
        let snapshot = Snapshot::new(2, 0.0, 0, positions, ParticleSize::Uniform(1.0))
            .and_then(|s| s.with_bodies((0..count as u32).collect()))
            .expect("a snapshot")
            .with_body_names(names);
        let coloured = colours_of(None, &snapshot).expect("colours");
        let legend = Legend::of(&snapshot, &coloured, width, 18.0);
        assert!(legend.rows.len() <= ROWS);
        legend.rows.into_iter().flatten().map(|entry| entry.name).collect()
    }

    #[test]
    fn bodies_are_named_or_counted() {
        let few = ["plate", "rod"].map(String::from).to_vec();
        assert_eq!(entries(few.clone(), 900.0), few);
        assert!(entries(vec!["plate".into()], 900.0).is_empty());
        let mut many: Vec<String> = (1..=400).map(|n| format!("ball {n}")).collect();
        many.push("floor".into());
        assert_eq!(entries(many, 900.0), ["ball (400 bodies)", "floor"]);
        // Letters: numbers would merge the names into one group.
        let other: Vec<String> = (0..400)
            .map(|n| {
                format!(
                    "{}{}",
                    ('a'..='z').nth(n / 26).unwrap_or('a'),
                    ('a'..='z').nth(n % 26).unwrap_or('a')
                )
            })
            .collect();
        let listed = entries(other, 900.0);
        let more: usize = listed
            .last()
            .and_then(|l| l.strip_prefix("and ")?.strip_suffix(" more")?.parse().ok())
            .expect("more");
        assert_eq!(more + listed.len() - 1, 400);
    }
}
