//! ParaView files, histories and snapshots: files read back bit for bit; invalid input causes errors.
//!
//! `IMPACTITE_VTK=folder cargo test -p mpm-core --test output_files` keeps a series for inspection with VTK.

use std::collections::HashMap;
use std::io::Read;
use std::io::Write;
use std::path::PathBuf;

use impactite_output::vtk::write_vtp;
use impactite_output::{
    Cells, FieldValues, History, ParticleSize, Precision, Progress, Snapshot, VtkOptions, VtkSeries,
    WholeFile,
};

/// Temporary folder of a test, removed on drop.
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

/// Special values: all bits count.
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

/// Parse VTP files as written by this crate: name to (type, bytes).
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
    // 60 000 points: two full blocks of positions and a partial one; 0 points and 1 point: edge cases.
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
            // VTK's order is XX YY ZZ XY YZ XZ, the field's xx yy zz yz xz xy.
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

/// Point data: a vector of each node, then of each free particle.
#[test]
fn fields_of_nodes_are_point_data() {
    let folder = Folder::new("nodes");
    let cells = Cells {
        nodes: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        corners: vec![0, 1, 2],
        ends: vec![3, 3],
    };
    let both = Snapshot::new(2, 0.0, 0, vec![[0.3, 0.3, 0.0], [4.0, 0.0, 0.0]], ParticleSize::Uniform(1.0))
        .and_then(|s| s.with_cells(cells))
        .and_then(|s| s.with_vector("displacement", vec![[9.0; 3], [7.0; 3]]))
        .expect("a snapshot");
    assert!(both.clone().with_node_vector("displacement", vec![[0.0; 3]]).is_err());
    let both = both.with_node_vector("displacement", vec![[1.0; 3], [2.0; 3], [3.0; 3]]).expect("a field");
    let path = folder.0.join("a.vtu");
    write_vtp(&path, &both, VtkOptions { compressed: false, fields: Precision::Double }).expect("written");
    let bytes = std::fs::read(&path).expect("read");
    let head = String::from_utf8_lossy(&bytes);
    let (points, _) = head.split_once("</PointData>").expect("point data");
    let line = points.lines().rfind(|line| line.contains("\"displacement\"")).expect("the field");
    let offset: usize =
        line.split("offset=\"").nth(1).and_then(|o| o.split('"').next()?.parse().ok()).expect("a number");
    let marker = b"<AppendedData encoding=\"raw\">\n   _";
    let at = bytes.windows(marker.len()).position(|w| w == marker).expect("data") + marker.len() + offset;
    let expected = [1.0, 2.0, 3.0, 7.0].into_iter().flat_map(|x| [x; 3]);
    assert_eq!(&bytes[at + 8..at + 8 + 96], doubles(expected));
}

#[test]
fn names_of_bodies_are_written() {
    let folder = Folder::new("names");
    let path = folder.0.join("a.vtp");
    let snapshot = awkward(3, 0.0, false).with_body_names(["rod", "é"]);
    write_vtp(&path, &snapshot, VtkOptions::default()).expect("written");
    let bytes = std::fs::read(&path).expect("read");
    let text = String::from_utf8_lossy(&bytes);
    let array = "<Array type=\"String\" Name=\"body_names\" NumberOfTuples=\"2\" format=\"ascii\">";
    let (_, rest) = text.split_once(array).expect("the array");
    let numbers = rest.split("</Array>").next().expect("its end").split_whitespace();
    // Types of VTK's own writer.
    assert_eq!(numbers.collect::<Vec<_>>(), ["114", "111", "100", "0", "-61", "-87", "0"]);
    // All other arrays stay readable.
    assert!(read(&path).contains_key("velocity"));
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
        let index = std::fs::read_to_string(series.index()).expect("there");
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
fn parts_of_killed_processes_are_removed() {
    let folder = Folder::new("parts");
    let left = ["s_000007.vtp.4000000001-3.part", "s.pvd.4000000001-12.part"];
    let stay = ["s.pvd", "other.vtp.4000000001-3.part", "s_notes.part", "s.4000000001-x.part"];
    for name in left.iter().chain(&stay) {
        std::fs::write(folder.0.join(name), "half").expect("written");
    }
    VtkSeries::create(&folder.0, "s").expect("a series");
    assert!(left.iter().all(|name| !folder.0.join(name).exists()));
    assert!(stay.iter().all(|name| folder.0.join(name).exists()));
    // A temporary file of this process is kept.
    let mut file = WholeFile::create(folder.0.join("s_000001.vtp")).expect("a file");
    file.write_all(b"whole").expect("written");
    VtkSeries::create(&folder.0, "s").expect("a series");
    file.finish().expect("whole");
    assert_eq!(std::fs::read(folder.0.join("s_000001.vtp")).expect("read"), b"whole");
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

/// Particle numbers beyond the integers of single precision.
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

/// VTKHDF files contain the arrays of the XML files: names, types and bits.
#[cfg(feature = "hdf5")]
mod hdf {
    use super::*;
    use hdf5_pure::{AttrValue, File};
    use impactite_output::vtk::{Format, write_vtkhdf};

    fn open(path: &std::path::Path) -> File {
        File::from_bytes(std::fs::read(path).expect("the file")).expect("HDF5")
    }

    /// Bytes of an array, whose type must match its type in XML.
    fn bytes(file: &File, path: &str, kind: &str) -> Vec<u8> {
        let array = file.dataset(path).unwrap_or_else(|e| panic!("{path}: {e}"));
        assert_eq!(
            format!("{:?}", array.dtype().expect("a type")),
            kind.replace("Float", "F").replace("Int", "I")
        );
        let numbers = "numbers";
        match kind {
            "Float32" => array.read::<f32>().expect(numbers).into_iter().flat_map(f32::to_le_bytes).collect(),
            "Float64" => array.read::<f64>().expect(numbers).into_iter().flat_map(f64::to_le_bytes).collect(),
            "Int32" => array.read::<i32>().expect(numbers).into_iter().flat_map(i32::to_le_bytes).collect(),
            _ => array.read::<i64>().expect(numbers).into_iter().flat_map(i64::to_le_bytes).collect(),
        }
    }

    fn integers(file: &File, path: &str) -> Vec<i64> {
        file.dataset(path).and_then(|d| d.read::<i64>()).unwrap_or_else(|e| panic!("{path}: {e}"))
    }

    #[test]
    fn particles_are_those_of_the_xml_file() {
        let folder = Folder::new("vtkhdf");
        let (there, here) = (folder.0.join("a.vtp"), folder.0.join("a.vtkhdf"));
        // 60 000 points: two chunks of positions; scalars of 100 points are not chunked.
        for n in [0, 1, 100, 60_000] {
            for (compressed, fields) in
                [(true, Precision::Double), (true, Precision::Single), (false, Precision::Double)]
            {
                let snapshot = awkward(n, 1.0e-6 / 3.0, n == 100);
                let snapshot =
                    snapshot.with_scalar("particle", (0..n).map(|i| 3.0e9 + i as f64).collect()).unwrap();
                let options = VtkOptions { compressed, fields };
                write_vtp(&there, &snapshot, options).expect("written");
                write_vtkhdf(&here, &snapshot, options).expect("written");
                let file = open(&here);
                let about = file.group("VTKHDF").and_then(|g| g.attrs()).expect("the group");
                assert_eq!(about["Version"].to_i64s(), Some(vec![2, 0]));
                assert_eq!(about["Type"], AttrValue::AsciiString("PolyData".into()));
                let mut fields = 0;
                for (name, (kind, expected)) in read(&there) {
                    let path = match name.as_str() {
                        "Points" => "VTKHDF/Points".into(),
                        "connectivity" | "offsets" => continue,
                        "TimeValue" | "Step" | "ParticleSize" => format!("VTKHDF/FieldData/{name}"),
                        "a &quot;&lt;&amp;&gt;&quot; scalar" => "VTKHDF/PointData/a \"<&>\" scalar".into(),
                        _ => format!("VTKHDF/PointData/{name}"),
                    };
                    assert_eq!(bytes(&file, &path, &kind), expected, "{path} of {n}");
                    fields += u32::from(path.contains("PointData"));
                }
                assert_eq!(fields, if n == 100 { 6 } else { 5 });
                assert_eq!(file.dataset("VTKHDF/PointData/stress").unwrap().shape().unwrap(), [n as u64, 6]);
                assert_eq!(integers(&file, "VTKHDF/NumberOfPoints"), [n as i64]);
                assert_eq!(
                    integers(&file, "VTKHDF/Vertices/Connectivity"),
                    (0..n as i64).collect::<Vec<_>>()
                );
                assert_eq!(integers(&file, "VTKHDF/Vertices/Offsets"), (0..=n as i64).collect::<Vec<_>>());
                for none in ["Lines", "Polygons", "Strips"] {
                    assert_eq!(integers(&file, &format!("VTKHDF/{none}/NumberOfCells")), [0]);
                    assert_eq!(integers(&file, &format!("VTKHDF/{none}/Offsets")), [0]);
                }
                let filters = file.dataset("VTKHDF/PointData/velocity").unwrap().filters();
                // HDF5 filter numbers of shuffle and deflate.
                let expected: &[u16] = if compressed && n > 1 { &[2, 1] } else { &[] };
                assert_eq!(filters, expected, "{n} points");
            }
        }
    }

    #[test]
    fn cells_are_those_of_the_xml_file() {
        let folder = Folder::new("vtkhdf-cells");
        let path = folder.0.join("a.vtkhdf");
        // A brick, a particle, a tetrahedron.
        let cells = Cells {
            nodes: (0..9).map(|i| [i as f64, (i * i) as f64, (i % 3) as f64]).collect(),
            corners: vec![0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 8],
            ends: vec![8, 8, 12],
        };
        let positions = vec![[0.5; 3], [9.0; 3], [1.5; 3]];
        let snapshot = Snapshot::new(3, 2.5e-6, 1, positions, ParticleSize::Uniform(1.0))
            .and_then(|s| s.with_cells(cells.clone()))
            .and_then(|s| s.with_vector("velocity", vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]))
            .expect("a snapshot");
        write_vtkhdf(&path, &snapshot, VtkOptions { compressed: true, fields: Precision::Double })
            .expect("written");
        let file = open(&path);
        let about = file.group("VTKHDF").and_then(|g| g.attrs()).expect("the group");
        assert_eq!(about["Type"], AttrValue::AsciiString("UnstructuredGrid".into()));
        let all = cells.nodes.iter().chain([&[9.0; 3]]).flatten().copied();
        assert_eq!(bytes(&file, "VTKHDF/Points", "Float64"), doubles(all));
        assert_eq!(integers(&file, "VTKHDF/Connectivity"), [0, 1, 2, 3, 4, 5, 6, 7, 9, 4, 5, 6, 8]);
        assert_eq!(integers(&file, "VTKHDF/Offsets"), [0, 8, 9, 13]);
        for (name, count) in [("NumberOfPoints", 10), ("NumberOfCells", 3), ("NumberOfConnectivityIds", 13)] {
            assert_eq!(integers(&file, &format!("VTKHDF/{name}")), [count]);
        }
        assert_eq!(file.dataset("VTKHDF/Types").unwrap().read::<u8>().unwrap(), [12, 1, 10]);
        let velocity = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        assert_eq!(bytes(&file, "VTKHDF/CellData/velocity", "Float64"), doubles(velocity));
    }

    #[test]
    fn a_series_lists_its_frames_and_goes_on() {
        let folder = Folder::new("vtkhdf-series");
        let made =
            || VtkSeries::create(&folder.0, "two \"&\" two").map(|s| s.with_format(Format::Hdf)).unwrap();
        let mut series = made();
        let times = [0.0, 1.0e-7 / 3.0, 2.5];
        for (frame, &time) in times.iter().enumerate() {
            // Continue after the first frame, as after a restart.
            if frame == 1 {
                series = made();
                series.go_on(&times[..1]);
            }
            let path = series.write(&awkward(5, time, false)).expect("written");
            assert_eq!(path, folder.0.join(format!("two \"&\" two_{frame:06}.vtkhdf")));
        }
        assert_eq!(series.index(), folder.0.join("two \"&\" two.vtkhdf.series"));
        let text = std::fs::read_to_string(series.index()).expect("there");
        let expected = r#"{
  "file-series-version": "1.0",
  "files": [
    { "name": "two \"&\" two_000000.vtkhdf", "time": 0e0 },
    { "name": "two \"&\" two_000001.vtkhdf", "time": 3.3333333333333334e-8 },
    { "name": "two \"&\" two_000002.vtkhdf", "time": 2.5e0 }
  ]
}
"#;
        assert_eq!(text, expected);
        assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 4);
    }

    #[test]
    fn what_no_link_can_be_called_is_refused_and_the_old_file_stays() {
        let folder = Folder::new("vtkhdf-names");
        let path = folder.0.join("a.vtkhdf");
        std::fs::write(&path, "old").expect("written");
        for name in ["p/q", "."] {
            let snapshot = awkward(1, 0.0, false).with_scalar(name, vec![0.0]).expect("a field");
            let said =
                write_vtkhdf(&path, &snapshot, VtkOptions::default()).expect_err("refused").to_string();
            assert!(
                said.starts_with(&format!("name {name:?} of a field of VTKHDF is not allowed")),
                "{said}"
            );
            assert_eq!(std::fs::read(&path).expect("there"), b"old");
        }
    }

    /// Benchmark: size and time in comparison with the XML file, for a million particles that move and are stressed.
    #[test]
    #[ignore = "a measurement, printed with --nocapture"]
    fn a_million_particles() {
        let folder = Folder::new("vtkhdf-million");
        let side = 100usize;
        let places = || {
            (0..side * side * side).map(|i| [i % side, i / side % side, i / side / side].map(|k| k as f64))
        };
        // A wave through a block in spatial order: no two numbers are equal, and neighbours are as similar as possible.
        let wave = |x: [f64; 3], k: f64| (0.07 * (x[0] + 0.3 * x[1] + 0.1 * x[2]) + k).sin();
        let snapshot = Snapshot::new(
            3,
            1.0e-6,
            100,
            places().map(|x| [0, 1, 2].map(|d| 1.0e-3 * x[d] + 1.0e-4 * wave(x, d as f64))).collect(),
            ParticleSize::Uniform(1.0e-3),
        )
        .and_then(|s| {
            s.with_vector("velocity", places().map(|x| [0.1, 0.2, 0.3].map(|k| 100.0 * wave(x, k))).collect())
        })
        .and_then(|s| {
            s.with_tensor(
                "stress",
                places().map(|x| [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|k| 1.0e8 * wave(x, k))).collect(),
            )
        })
        .and_then(|s| s.with_scalar("pressure", places().map(|x| 1.0e8 * wave(x, 7.0)).collect()))
        .and_then(|s| s.with_scalar("particle", (0..side * side * side).map(|i| i as f64).collect()))
        .expect("a snapshot");
        for compressed in [true, false] {
            for fields in [Precision::Single, Precision::Double] {
                let options = VtkOptions { compressed, fields };
                for kind in ["vtp", "vtkhdf"] {
                    let path = folder.0.join(format!("a.{kind}"));
                    let start = std::time::Instant::now();
                    match kind {
                        "vtp" => write_vtp(&path, &snapshot, options).expect("written"),
                        _ => write_vtkhdf(&path, &snapshot, options).expect("written"),
                    }
                    let (time, size) =
                        (start.elapsed().as_secs_f64(), std::fs::metadata(&path).expect("there").len());
                    println!(
                        "{kind}, compressed {compressed}, {fields:?}: {:.1} MB in {time:.2} s",
                        size as f64 / 1e6
                    );
                }
            }
        }
    }
}
