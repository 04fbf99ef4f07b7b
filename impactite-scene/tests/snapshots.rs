//! Snapshots are unchanged by writing to a file and reading back.

use impactite_output::{Cells, ParticleSize, Snapshot};
use impactite_scene::Archive;

fn snapshot(points: usize, size: ParticleSize) -> Snapshot {
    let of = |n: usize| [n as f64, 0.1 * n as f64, 0.0];
    Snapshot::new(2, 1.5e-6, 42, (0..points).map(of).collect(), size)
        .and_then(|s| s.with_bodies((0..points).map(|n| n as u32 % 2).collect()))
        .and_then(|s| s.with_scalar("strain", (0..points).map(|n| 1.0 / (1.0 + n as f64)).collect()))
        .and_then(|s| s.with_vector("velocity", (0..points).map(of).collect()))
        .and_then(|s| s.with_tensor("stress", vec![[1.0, -2.0, 0.5, 0.0, f64::MAX, 1e-300]; points]))
        .expect("a snapshot")
        .with_body_names(["rod", "plate"])
}

#[test]
fn they_come_back_as_they_were() {
    let path = std::env::temp_dir().join(format!("impactite-snapshots-{}", std::process::id()));
    let each = ParticleSize::Each((0..5).map(|n| 0.1 + n as f64).collect());
    let nodes = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let cells = Cells { nodes: nodes.clone(), corners: vec![0, 1, 2], ends: vec![3] };
    let element = snapshot(1, ParticleSize::Uniform(1.0)).with_cells(cells);
    let element = element.and_then(|s| s.with_node_vector("displacement", nodes)).expect("an element");
    let list = vec![
        snapshot(5, each),
        snapshot(3, ParticleSize::Uniform(0.25)),
        snapshot(0, ParticleSize::Uniform(1.0)),
        element,
    ];
    let mut file = Archive::create(&path).expect("a file");
    file.snapshots(&mut list.clone()).expect("written");
    file.close().expect("closed");
    let mut read = vec![snapshot(1, ParticleSize::Uniform(2.0))];
    let mut file = Archive::open(&path).expect("the file");
    file.snapshots(&mut read).expect("read");
    file.close().expect("whole");
    assert_eq!(read, list);
    // A file that is cut short is an error.
    let bytes = std::fs::read(&path).expect("bytes");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("written");
    let error = Archive::open(&path).expect("the file").snapshots(&mut read).expect_err("half of it");
    assert!(error.to_string().contains("it ends too early"), "{error}");
    std::fs::remove_file(&path).expect("removed");
}
