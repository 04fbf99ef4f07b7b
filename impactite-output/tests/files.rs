//! ParaView files, histories and snapshots: what was written reads back, bit for bit; what is wrong is refused.
//!
//! `IMPACTITE_VTK=folder cargo test -p mpm-core --test output_files` keeps a series for a look with VTK itself.

use std::collections::HashMap;
use std::io::Read;
use std::path::PathBuf;

use impactite_output::vtk::write_vtp;
use impactite_output::{
    Cells, FieldValues, History, ParticleSize, Precision, Progress, Snapshot, VtkOptions, VtkSeries,
};

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("impactite-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Awkward numbers: all bits count.
fn number(i: usize) -> f64 {
    match i % 7 {
        0 => f64::NAN,
        1 => f64::NEG_INFINITY,
        2 => -0.0,
        3 => f64::MIN_POSITIVE / 3.0,
        k => (i as f64 + 0.1).sqrt() * 10.0_f64.powi(3 * k as i32 - 15),
    }
}

fn awkward(n: usize, time: f64, each: bool) -> Snapshot {
    let size = if each {
        ParticleSize::Each((0..n).map(|i| 1.0e-3 + 1.0e-9 * i as f64).collect())
    } else {
        ParticleSize::Uniform(1.0e-3)
    };
    Snapshot::new(
        3,
        time,
        77,
        (0..n).map(|i| [number(i), number(3 * i + 1), 1.0e-3 * i as f64]).collect(),
        size,
    )
    .and_then(|s| s.with_bodies((0..n).map(|i| (i % 3) as u32).collect()))
    .and_then(|s| s.with_scalar("a \"<&>\" scalar", (0..n).map(number).collect()))
    .and_then(|s| s.with_vector("velocity", (0..n).map(|i| [1.0, number(i), 3.0 + i as f64]).collect()))
    .and_then(|s| {
        s.with_tensor(
            "stress",
            (0..n).map(|i| [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|c| c + 10.0 * i as f64)).collect(),
        )
    })
    .expect("a good snapshot")
}

/// Read our own dialect of VTP: name to (type, bytes).
fn read(path: &std::path::Path) -> HashMap<String, (String, Vec<u8>)> {
    let bytes = std::fs::read(path).expect("the file");
    let marker = b"<AppendedData encoding=\"raw\">\n   _";
    let at = bytes.windows(marker.len()).position(|w| w == marker).expect("appended data");
    let xml = std::str::from_utf8(&bytes[..at]).expect("the head is text");
    let data = &bytes[at + marker.len()..];
    let compressed = xml.contains("vtkZLibDataCompressor");
    let word = |at: usize| u64::from_le_bytes(data[at..at + 8].try_into().expect("8 bytes")) as usize;
    let attribute = |line: &str, name: &str| {
        let start = line.find(&format!(" {name}=\"")).expect(name) + name.len() + 3;
        line[start..].split('"').next().expect("closed").to_string()
    };
    let mut arrays = HashMap::new();
    let mut end = 0;
    for line in xml.lines().filter(|l| l.contains("<DataArray ")) {
        let offset: usize = attribute(line, "offset").parse().expect("a number");
        assert_eq!(offset, end, "arrays follow each other without gaps");
        let mut content = Vec::new();
        if compressed {
            let (blocks, block, last) = (word(offset), word(offset + 8), word(offset + 16));
            let mut from = offset + 24 + 8 * blocks;
            for b in 0..blocks {
                let size = word(offset + 24 + 8 * b);
                let before = content.len();
                flate2::read::ZlibDecoder::new(&data[from..from + size])
                    .read_to_end(&mut content)
                    .expect("zlib");
                let expected = if b + 1 == blocks && last > 0 { last } else { block };
                assert_eq!(content.len() - before, expected);
                from += size;
            }
            end = from;
        } else {
            let size = word(offset);
            content.extend_from_slice(&data[offset + 8..offset + 8 + size]);
            end = offset + 8 + size;
        }
        arrays.insert(attribute(line, "Name"), (attribute(line, "type"), content));
    }
    assert_eq!(&data[end..], b"\n  </AppendedData>\n</VTKFile>\n");
    arrays
}

fn doubles(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

#[test]
fn a_vtp_file_reads_back_bit_for_bit() {
    let folder = Folder::new("vtp");
    // 60 000 points are two blocks of positions and a bit; 0 points and 1 point are their own kind of awkward.
    for n in [0, 1, 13, 60_000] {
        for compressed in [true, false] {
            let snapshot = awkward(n, 1.0e-6 / 3.0, n == 13);
            let path = folder.0.join("a.vtp");
            let options = VtkOptions { compressed, fields: Precision::Double };
            write_vtp(&path, &snapshot, options).expect("written");
            let arrays = read(&path);
            let get = |name: &str| arrays[name].1.as_slice();
            assert_eq!(get("TimeValue"), doubles([1.0e-6 / 3.0]));
            assert_eq!(get("Step"), 77_i64.to_le_bytes());
            assert_eq!(get("Points"), doubles(snapshot.positions().iter().flatten().copied()));
            let bodies: Vec<u8> = (0..n).flat_map(|i| ((i % 3) as i32).to_le_bytes()).collect();
            assert_eq!(get("body"), bodies);
            assert_eq!(get("a &quot;&lt;&amp;&gt;&quot; scalar"), doubles((0..n).map(number)));
            assert_eq!(
                get("velocity"),
                doubles(snapshot.vector("velocity").unwrap().iter().flatten().copied())
            );
            // VTK wants XX YY ZZ XY YZ XZ of our xx yy zz yz xz xy.
            let stress = [1.0, 2.0, 3.0, 6.0, 4.0, 5.0];
            let all = (0..n).flat_map(|i| stress.map(|c| c + 10.0 * i as f64));
            assert_eq!(get("stress"), doubles(all));
            let ids: Vec<u8> = (1..=n as i32).flat_map(i32::to_le_bytes).collect();
            assert_eq!(get("offsets"), ids);
            assert_eq!(arrays.contains_key("size"), n == 13);
            assert_eq!(arrays.contains_key("ParticleSize"), n != 13);
        }
    }
}

#[test]
fn cells_read_back_with_particles_beside_them() {
    let folder = Folder::new("cells");
    let path = folder.0.join("a.vtu");
    // Two quadrilaterals that share an edge, a particle, a triangle.
    let nodes: Vec<[f64; 3]> =
        [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]].map(|[x, y]| [x.into(), y.into(), 0.0]).to_vec();
    let cells = Cells {
        nodes: nodes.clone(),
        corners: vec![0, 1, 2, 3, 1, 4, 5, 2, 2, 5, 3],
        ends: vec![4, 8, 8, 11],
    };
    let positions = vec![[0.5, 0.5, 0.0], [1.5, 0.5, 0.0], [9.0, 9.0, 0.0], [1.0, 1.0, 0.0]];
    let made = || Snapshot::new(2, 0.0, 1, positions.clone(), ParticleSize::Uniform(1.0)).unwrap();
    let snapshot =
        made().with_cells(cells.clone()).unwrap().with_scalar("a", vec![1.0, 2.0, 3.0, 4.0]).unwrap();
    write_vtp(&path, &snapshot, VtkOptions { compressed: true, fields: Precision::Double }).expect("written");
    let arrays = read(&path);
    let get = |name: &str| arrays[name].1.as_slice();
    let integers = |list: &[i32]| list.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>();
    let all = nodes.iter().chain([&[9.0, 9.0, 0.0]]).flatten().copied();
    assert_eq!(get("Points"), doubles(all));
    assert_eq!(get("connectivity"), integers(&[0, 1, 2, 3, 1, 4, 5, 2, 6, 2, 5, 3]));
    assert_eq!(get("offsets"), integers(&[4, 8, 9, 12]));
    assert_eq!(get("types"), [9, 9, 1, 5]);
    assert_eq!(get("a"), doubles([1.0, 2.0, 3.0, 4.0]));
    let wrong = |change: &dyn Fn(&mut Cells)| {
        let mut cells = cells.clone();
        change(&mut cells);
        made().with_cells(cells).expect_err("refused").to_string()
    };
    assert!(wrong(&|c| c.ends[3] = 10).contains("corners of cells"));
    assert!(wrong(&|c| c.corners[0] = 6).contains("corner of a cell = 6"));
    assert!(wrong(&|c| c.ends = vec![4, 5, 8, 11]).contains("corners of a cell = 1"));
    assert!(wrong(&|c| c.ends = vec![4, 8, 11]).contains("ends of cells"));
}

#[test]
fn single_precision_rounds_fields_but_not_positions() {
    let folder = Folder::new("single");
    let path = folder.0.join("a.vtp");
    let snapshot = awkward(100, 0.0, false);
    write_vtp(&path, &snapshot, VtkOptions::default()).expect("written");
    let arrays = read(&path);
    let (kind, bytes) = &arrays["velocity"];
    assert_eq!(kind, "Float32");
    let vectors = snapshot.vector("velocity").unwrap().iter().flatten();
    assert_eq!(*bytes, vectors.flat_map(|x| (*x as f32).to_le_bytes()).collect::<Vec<u8>>());
    assert_eq!(arrays["Points"].0, "Float64");
}

#[test]
fn a_series_is_valid_after_every_frame() {
    let folder = Folder::new("series");
    let kept = std::env::var_os("IMPACTITE_VTK").map(PathBuf::from);
    let place = kept.unwrap_or_else(|| folder.0.join("new").join("folder"));
    let mut series = VtkSeries::create(&place, "two & two").expect("created");
    for frame in 0..13_usize {
        let options = VtkOptions { compressed: frame % 2 == 0, fields: Precision::Double };
        series = series.with_options(options);
        let path =
            series.write(&awkward(5 + frame, frame as f64 * 1.0e-7 / 3.0, frame == 2)).expect("written");
        assert_eq!(path, place.join(format!("two & two_{frame:06}.vtp")));
        let index = std::fs::read_to_string(series.pvd()).expect("there");
        assert!(
            index.starts_with("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"")
                && index.ends_with("</VTKFile>\n")
        );
        let times: Vec<f64> = index
            .lines()
            .filter_map(|l| l.split("timestep=\"").nth(1))
            .map(|l| l.split('"').next().expect("closed").parse().expect("a number"))
            .collect();
        assert_eq!(times, (0..=frame).map(|f| f as f64 * 1.0e-7 / 3.0).collect::<Vec<_>>());
        assert!(index.contains(&format!("file=\"two &amp; two_{frame:06}.vtp\"")));
    }
    assert_eq!(series.frames(), 13);
    write_vtp(place.join("none.vtp"), &awkward(0, 0.0, false), VtkOptions::default()).expect("written");
    let left: Vec<_> = std::fs::read_dir(&place).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(left.iter().all(|p| p.extension().is_some_and(|e| e == "vtp" || e == "pvd")), "{left:?}");
}

#[test]
fn a_series_refuses_bad_names_and_says_which_file_failed() {
    for name in ["", "a/b", "a\nb", " a"] {
        let said = VtkSeries::create(std::env::temp_dir(), name).expect_err("refused").to_string();
        assert!(said.starts_with(&format!("name {name:?} of a series is not allowed")), "{said}");
    }
    let missing = std::env::temp_dir().join("impactite-no-such-folder").join("a.vtp");
    let said =
        write_vtp(&missing, &awkward(1, 0.0, false), VtkOptions::default()).expect_err("refused").to_string();
    assert!(said.starts_with("cannot create `") && said.contains("impactite-no-such-folder"), "{said}");
}

#[test]
fn a_history_reads_back_bit_for_bit_and_refuses_wrong_rows() {
    let folder = Folder::new("history");
    let path = folder.0.join("history.csv");
    let mut history =
        History::create(&path, [("time", "s"), ("length, foot", "m"), ("ratio", "")]).expect("created");
    let rows: Vec<[f64; 3]> =
        (0..50).map(|i| [i as f64 * 1.0e-7 / 3.0, number(i), f64::MAX / (i as f64 + 0.7)]).collect();
    for row in &rows {
        history.push(row).expect("written");
    }
    let said = history.push(&[1.0]).expect_err("refused").to_string();
    assert!(said.starts_with("row 50 of `") && said.ends_with("has 1 values, expected 3"), "{said}");
    assert_eq!(history.rows(), 50);
    let text = std::fs::read_to_string(&path).expect("flushed");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("time [s],\"length, foot [m]\",ratio [-]"));
    for (line, row) in lines.zip(&rows) {
        let back: Vec<f64> = line.split(',').map(|x| x.parse().expect("a number")).collect();
        assert!(back.iter().zip(row).all(|(a, b)| a.to_bits() == b.to_bits()), "{line}");
    }
    assert_eq!(text.lines().count(), 51);
    let none: [(&str, &str); 0] = [];
    assert!(History::create(&path, none).is_err());
    assert!(History::create(&path, [("a", "m"), ("a", "m")]).is_err());
    assert!(History::create(folder.0.join("no").join("a.csv"), [("a", "m")]).is_err());
}

#[test]
fn a_snapshot_refuses_what_does_not_fit() {
    let points = || vec![[0.0; 3], [1.0, 0.0, 0.0]];
    let one = || ParticleSize::Uniform(1.0);
    let said =
        |result: Result<Snapshot, impactite_output::OutputError>| result.expect_err("refused").to_string();
    assert_eq!(said(Snapshot::new(4, 0.0, 0, points(), one())), "dimension = 4 is not allowed: 2 or 3");
    assert!(said(Snapshot::new(3, f64::NAN, 0, points(), one())).starts_with("time = NaN"));
    assert!(
        said(Snapshot::new(3, 0.0, 0, points(), ParticleSize::Uniform(0.0))).starts_with("particle size = 0")
    );
    assert!(
        said(Snapshot::new(3, 0.0, 0, points(), ParticleSize::Each(vec![1.0])))
            .contains("has 1 values, expected 2")
    );
    let wrong = ParticleSize::Each(vec![1.0, -1.0]);
    assert!(said(Snapshot::new(3, 0.0, 0, points(), wrong)).starts_with("size of particle 1 = -1"));
    assert!(said(Snapshot::new(2, 0.0, 0, vec![[0.0, 0.0, 1.0]], one())).starts_with("z of particle 0 = 1"));
    let good = || Snapshot::new(3, 0.0, 0, points(), one()).expect("good");
    assert!(said(good().with_bodies(vec![0])).starts_with("body has 1 values"));
    assert!(said(good().with_scalar("p", vec![0.0])).starts_with("field \"p\" has 1 values, expected 2"));
    for name in ["", " p", "p\u{7}", "body", "size"] {
        assert!(good().with_scalar(name, vec![0.0; 2]).is_err(), "{name:?}");
    }
    assert!(
        good().with_scalar("p", vec![0.0; 2]).and_then(|s| s.with_vector("p", vec![[0.0; 3]; 2])).is_err()
    );
    let held = good().with_field("t", FieldValues::Tensor(vec![[0.0; 6]; 2])).expect("good");
    assert_eq!(
        held.scalar("t").expect_err("a tensor").to_string(),
        "no scalar field \"t\" in the snapshot; it has none"
    );
    assert_eq!(held.bounds(), Some(([-0.5; 3], [1.5, 0.5, 0.5])));
}

#[test]
fn a_hidden_progress_bar_is_silent() {
    let mut progress = Progress::hidden();
    assert!(progress.is_hidden());
    for step in 0..10_u64 {
        progress.update(step as f64, 10.0, step, 1.0e7);
    }
    progress.finish();
}

/// Numbers of particles beyond what single precision holds.
#[test]
fn numbers_of_particles_are_whole() {
    let number = f64::from(1u32 << 24) + 1.0;
    let snapshot = Snapshot::new(3, 0.0, 0, vec![[0.0; 3]], ParticleSize::Uniform(1.0)).expect("a snapshot");
    let snapshot = snapshot.with_scalar("particle", vec![number]).expect("a field");
    let path = std::env::temp_dir().join(format!("impactite-numbers-{}.vtp", std::process::id()));
    let options = VtkOptions { compressed: false, ..VtkOptions::default() };
    write_vtp(&path, &snapshot, options).expect("a file");
    let bytes = std::fs::read(&path).expect("the file");
    std::fs::remove_file(path).expect("the file");
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("type=\"Int64\" Name=\"particle\""));
    assert!(bytes.windows(8).any(|w| w == (number as i64).to_le_bytes()));
}
