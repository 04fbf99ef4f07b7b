//! Outer faces of three-dimensional elements.

use super::super::{Cells, Snapshot, is_place};
use super::camera::{Cut, Mirror};
use super::colour::Rgb;

/// Face to draw, with three or four corners.
pub(super) struct Face {
    pub(super) corners: [[f64; 3]; 4],
    pub(super) count: usize,
    pub(super) colour: Rgb,
}

/// Corners of the faces of a tetrahedron and of a brick, in the order of the VTK file format.
const TETRAHEDRON: [&[usize]; 4] = [&[0, 1, 2], &[0, 1, 3], &[1, 2, 3], &[0, 2, 3]];
const BRICK: [&[usize]; 6] =
    [&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
const TRIANGLE: [&[usize]; 1] = [&[0, 1, 2]];

/// Faces of a cell with this number of corners in space; empty for a point or a line.
fn faces_of(corners: usize) -> &'static [&'static [usize]] {
    match corners {
        3 => &TRIANGLE,
        4 => &TETRAHEDRON,
        8 => &BRICK,
        _ => &[],
    }
}

/// True if particle `i` is drawn by the faces of its cell.
pub(super) fn has_faces(snapshot: &Snapshot, i: usize) -> bool {
    let cells = snapshot.cells().filter(|_| snapshot.dimension() == 3);
    cells.is_some_and(|cells| !faces_of(cells.of(i).len()).is_empty() && is_drawn(cells, i))
}

fn is_drawn(cells: &Cells, i: usize) -> bool {
    cells.of(i).iter().all(|&n| is_place(&cells.nodes[n as usize]))
}

/// Ends of the line element of particle `i`.
pub(super) fn line(snapshot: &Snapshot, i: usize) -> Option<[[f64; 3]; 2]> {
    let cells = snapshot.cells()?;
    let &[a, b] = cells.of(i) else { return None };
    let ends = [a, b].map(|n| cells.nodes[n as usize]);
    ends.iter().all(is_place).then_some(ends)
}

/// Collect the outer faces of each body, those of one cell only, after cuts, with mirror copies.
pub(super) fn outer(snapshot: &Snapshot, colours: &[Rgb], mirrors: &[Mirror], cuts: &[Cut]) -> Vec<Face> {
    let Some(cells) = snapshot.cells().filter(|_| snapshot.dimension() == 3) else { return Vec::new() };
    let mut list = Vec::new();
    let mut copies = Vec::new();
    // Without cuts all copies have the same faces.
    let passes = if cuts.is_empty() { 1 } else { 1_usize << mirrors.len() };
    for pass in 0..passes {
        let mut is_kept = |i: usize| {
            if !has_faces(snapshot, i) || cuts.is_empty() {
                return has_faces(snapshot, i);
            }
            Mirror::copies(mirrors, snapshot.positions()[i], &mut copies);
            !cuts.iter().all(|cut| cut.removes(copies[pass]))
        };
        let kept: Vec<u32> = (0..snapshot.len()).filter(|&i| is_kept(i)).map(|i| i as u32).collect();
        let mut corners = Vec::new();
        for (i, face) in alone(snapshot, cells, &kept) {
            let of = cells.of(i);
            corners.clear();
            for &corner in face {
                Mirror::copies(mirrors, cells.nodes[of[corner] as usize], &mut copies);
                corners.push(copies.clone());
            }
            let chosen = if cuts.is_empty() { 0..copies.len() } else { pass..pass + 1 };
            for copy in chosen {
                let at = |c: usize| corners.get(c).map_or([0.0; 3], |copies| copies[copy]);
                list.push(Face {
                    corners: [at(0), at(1), at(2), at(3)],
                    count: face.len(),
                    colour: colours[i],
                });
            }
        }
    }
    list
}

/// Return the faces of these cells that no other cell of the same body shares, in the order of the cells.
fn alone(snapshot: &Snapshot, cells: &Cells, kept: &[u32]) -> Vec<(usize, &'static [usize])> {
    // Bucket faces by their smallest node: few faces share one.
    let each = |visit: &mut dyn FnMut(u32, &'static [usize], [u32; 4])| {
        for &i in kept {
            let of = cells.of(i as usize);
            for &face in faces_of(of.len()) {
                let mut nodes = [u32::MAX; 4];
                for (node, &corner) in nodes.iter_mut().zip(face) {
                    *node = of[corner];
                }
                nodes.sort_unstable();
                visit(i, face, nodes);
            }
        }
    };
    let mut start = vec![0_u32; cells.nodes.len() + 1];
    each(&mut |_, _, nodes| start[nodes[0] as usize + 1] += 1);
    for n in 0..cells.nodes.len() {
        start[n + 1] += start[n];
    }
    let total = start.last().map_or(0, |&end| end as usize);
    let mut keys = vec![([0_u32; 3], 0_u32); total];
    let mut next = start.clone();
    each(&mut |i, _, nodes| {
        let at = &mut next[nodes[0] as usize];
        keys[*at as usize] = ([nodes[1], nodes[2], nodes[3]], snapshot.bodies()[i as usize]);
        *at += 1;
    });
    let mut faces = Vec::new();
    each(&mut |i, face, nodes| {
        let near = &keys[start[nodes[0] as usize] as usize..start[nodes[0] as usize + 1] as usize];
        let key = ([nodes[1], nodes[2], nodes[3]], snapshot.bodies()[i as usize]);
        if near.iter().filter(|other| **other == key).count() == 1 {
            faces.push((i as usize, face));
        }
    });
    faces
}

#[cfg(test)]
mod tests {
    use super::super::super::ParticleSize;
    use super::*;

    /// Row of unit cubes along x; `body` assigns the bodies.
    fn row(count: u32, body: impl Fn(u32) -> u32) -> Snapshot {
        let nodes = (0..=count)
            .flat_map(|x| [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[y, z]| [f64::from(x), y.into(), z.into()]));
        let corners = (0..count).flat_map(|i| (4 * i..4 * i + 8).collect::<Vec<_>>()).collect();
        let cells = Cells { nodes: nodes.collect(), corners, ends: (1..=count).map(|n| 8 * n).collect() };
        let positions = (0..count).map(|i| [f64::from(i) + 0.5, 0.5, 0.5]).collect();
        Snapshot::new(3, 0.0, 0, positions, ParticleSize::Uniform(1.0))
            .and_then(|s| s.with_bodies((0..count).map(body).collect()))
            .and_then(|s| s.with_cells(cells))
            .expect("a snapshot")
    }

    #[test]
    fn only_outer_faces_are_drawn() {
        let count = |snapshot: &Snapshot, mirrors: &[Mirror], cuts: &[Cut]| {
            outer(snapshot, &vec![[0; 3]; snapshot.len()], mirrors, cuts).len()
        };
        let rod = row(5, |_| 0);
        assert_eq!(count(&rod, &[], &[]), 22);
        // Two bodies in contact: each has its own face there.
        assert_eq!(count(&row(5, |i| i / 3), &[], &[]), 24);
        assert_eq!(count(&rod, &[Mirror::y(0.0)], &[]), 44);
        // The cut opens the rod after two cells, and shows the face behind them.
        let cut = Cut { normal: [1.0, 0.0, 0.0], through: [2.0, 0.0, 0.0] };
        assert_eq!(count(&rod, &[], &[cut]), 10);
        // The copy on the other side is not cut.
        assert_eq!(count(&rod, &[Mirror::x(0.0)], &[cut]), 32);
    }
}
