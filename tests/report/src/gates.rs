//! Gates, the benchmarks of all methods: elements, particle contacts, smoothed particles, fragile points and material points.

use verification::problems::gates::{Gate, Passage};

use crate::job::Key;

/// Grids of a gate: cells along its length.
pub fn grids(gate: Gate, quick: bool) -> &'static [usize] {
    match (gate, quick) {
        (Gate::Bar | Gate::Plate, true) => &[25, 50, 100, 200],
        (Gate::Cantilever, true) => &[3, 6, 12],
        (Gate::Cantilever, false) => &[3, 6, 12, 24],
        (Gate::Pull, true) => &[40, 80, 160],
        (Gate::Pull, false) => &[40, 80, 160, 320],
        (Gate::Kalthoff, true) => &[50, 71, 100],
        (Gate::Kalthoff, false) => &[50, 71, 100, 141, 200],
        (Gate::Bar | Gate::Plate, false) => &[25, 50, 100, 200, 400, 800],
        (Gate::Beam, true) => &[2, 4, 8],
        (Gate::Beam, false) => &[2, 4, 8, 16],
        (Gate::Taylor, true) => &[4, 6, 8, 12],
        (Gate::Taylor, false) => &[4, 6, 8, 12, 16, 24],
    }
}

/// List all runs of a gate, coarse first.
pub fn all(gate: Gate, quick: bool) -> Vec<Passage> {
    let of = |&cells| gate.ways().into_iter().map(move |way| Passage { gate, way, cells });
    grids(gate, quick).iter().flat_map(of).collect()
}

/// Key of a run.
pub fn key(Passage { gate, way, cells }: Passage) -> Key {
    let (problem, scheme) = (gate.name().into(), way.name().into());
    Key { problem, scheme, per_axis: way.per_axis(), cells, courant: way.courant() }
}

/// Find the run of a key.
pub fn of(key: &Key) -> Option<Passage> {
    let gate = Gate::ALL.into_iter().find(|gate| gate.name() == key.problem)?;
    let mut ways = gate.ways().into_iter().map(|way| Passage { gate, way, cells: key.cells });
    ways.find(|passage| self::key(*passage) == *key)
}

/// Scale the run down to the coarsest grid.
pub fn scaled(passage: Passage) -> Passage {
    Passage { cells: grids(passage.gate, true)[0], ..passage }
}
