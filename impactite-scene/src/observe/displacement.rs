//! Displacements: current positions minus those at the first observation.

use impactite_output::{OutputError, Snapshot};

use crate::archive::{Archive, CheckpointError};

/// Position of each point at its first observation, sorted by body and number: points are found by bisection, and a checkpoint does not
/// depend on the order of points in memory.
#[derive(Default)]
pub(super) struct FirstSeen(Vec<Seen>);

#[derive(Clone, Default)]
struct Seen {
    body: u32,
    number: u64,
    /// Position, m.
    position: [f64; 3],
    /// Corners of an element, m; empty for a particle.
    corners: Vec<[f64; 3]>,
}

/// Displacements of points and of the nodes of their cells, m.
pub(super) struct Displacements {
    pub points: Vec<[f64; 3]>,
    /// Empty without cells.
    pub nodes: Vec<[f64; 3]>,
}

impl Seen {
    fn key(&self) -> (u32, u64) {
        (self.body, self.number)
    }
}

impl FirstSeen {
    /// Return the displacements of the points of a snapshot, m: 0 for new points, whose reference is this snapshot.
    ///
    /// # Errors
    /// A snapshot without the field `particle`.
    pub fn displacements(&mut self, now: &Snapshot) -> Result<Displacements, OutputError> {
        let numbers = now.scalar("particle")?.iter().map(|&number| number as u64);
        let keys = now.bodies().iter().copied().zip(numbers);
        let mut new = Vec::new();
        let mut points = Vec::with_capacity(now.len());
        let mut nodes = vec![[0.0; 3]; now.cells().map_or(0, |cells| cells.nodes.len())];
        for (i, ((body, number), &position)) in keys.zip(now.positions()).enumerate() {
            let corners = now.cells().into_iter().flat_map(|cells| {
                cells.of(i).iter().map(|&node| (node as usize, cells.nodes[node as usize]))
            });
            points.push(match self.0.binary_search_by_key(&(body, number), Seen::key) {
                Ok(place) => {
                    let first = &self.0[place];
                    for ((node, x), first) in corners.zip(&first.corners) {
                        nodes[node] = [0, 1, 2].map(|d| x[d] - first[d]);
                    }
                    [0, 1, 2].map(|d| position[d] - first.position[d])
                }
                Err(_) => {
                    let corners = corners.map(|(_, x)| x).collect();
                    new.push(Seen { body, number, position, corners });
                    [0.0; 3]
                }
            });
        }
        if !new.is_empty() {
            self.0.append(&mut new);
            self.0.sort_by_key(Seen::key);
            // Duplicate numbers would be an error of the body; the first point stays.
            self.0.dedup_by_key(|seen| seen.key());
        }
        Ok(Displacements { points, nodes })
    }

    /// Write or read the reference positions.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.0, &Seen::default(), |file, seen| {
            file.index(&mut seen.body, usize::MAX)?;
            file.word(&mut seen.number)?;
            file.reals(&mut seen.position)?;
            file.list(&mut seen.corners, &[0.0; 3], |file, x| file.reals(x))
        })?;
        match self.0.is_sorted_by(|a, b| a.key() < b.key()) {
            true => Ok(()),
            false => Err(file.damaged("points of frames that are not in order")),
        }
    }
}

#[cfg(test)]
mod tests {
    use impactite_output::{Cells, ParticleSize};

    use super::*;

    /// Two triangles with a common edge, numbered by `order`, sheared by `shear`.
    fn triangles(order: [f64; 2], shear: f64) -> Snapshot {
        let place = |x: f64, y: f64| [x + shear * y, y, 0.0];
        let nodes = vec![place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0)];
        let cells: [[u32; 3]; 2] =
            if order[0] == 0.0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 3], [0, 1, 2]] };
        let middle =
            |cell: [u32; 3]| [0, 1, 2].map(|d| cell.iter().map(|&n| nodes[n as usize][d]).sum::<f64>() / 3.0);
        let positions = cells.map(middle).to_vec();
        let cells = Cells { nodes, corners: cells.into_iter().flatten().collect(), ends: vec![3, 6] };
        Snapshot::new(2, 0.0, 0, positions, ParticleSize::Uniform(1.0))
            .and_then(|s| s.with_scalar("particle", order.to_vec()))
            .and_then(|s| s.with_cells(cells))
            .unwrap()
    }

    #[test]
    fn nodes_are_displaced_with_their_elements() {
        let mut first = FirstSeen::default();
        assert_eq!(first.displacements(&triangles([0.0, 1.0], 0.0)).unwrap().nodes, vec![[0.0; 3]; 4]);
        // The order of elements in memory may change.
        let now = first.displacements(&triangles([1.0, 0.0], 0.5)).unwrap();
        assert_eq!(now.nodes, [[0.0; 3], [0.0; 3], [0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    }
}
