//! Pictures of elements in water.

use mpm_core::output::{OutputError, ParticleSize, Snapshot};

/// The snapshot in the plane with this field alone, and each quadrilateral filled with points about `size` wide, m, without a value: they are
/// drawn grey, in the shape of their element.
///
/// # Errors
/// A field that is not there.
pub fn immersed(snapshot: &Snapshot, size: f64, field: &str) -> Result<Snapshot, OutputError> {
    let (mut places, mut values, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    for (n, (&place, &value)) in snapshot.positions().iter().zip(snapshot.scalar(field)?).enumerate() {
        let cells = snapshot.cells().filter(|cells| cells.of(n).len() == 4);
        let Some(cells) = cells else {
            places.push(place);
            values.push(value);
            sizes.push(snapshot.size_of(n));
            continue;
        };
        let corners: Vec<[f64; 3]> = cells.of(n).iter().map(|&c| cells.nodes[c as usize]).collect();
        let edge = |a: usize, b: usize| (corners[b][0] - corners[a][0]).hypot(corners[b][1] - corners[a][1]);
        let count = |a: f64, b: f64| (a.max(b) / size).ceil().max(1.0) as u32;
        let counts = [count(edge(0, 1), edge(3, 2)), count(edge(0, 3), edge(1, 2))];
        let middle = |k: u32, n: u32| (f64::from(k) + 0.5) / f64::from(n);
        for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
            let (s, t) = (middle(i, counts[0]), middle(j, counts[1]));
            let shares = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
            places.push([0, 1, 2].map(|d| (0..4).map(|c| shares[c] * corners[c][d]).sum()));
            values.push(f64::NAN);
            sizes.push(size);
        }
    }
    Snapshot::new(2, snapshot.time(), snapshot.step(), places, ParticleSize::Each(sizes))?
        .with_scalar(field, values)
}
