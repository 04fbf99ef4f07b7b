//! VTKHDF 2.0 files: VTK data in HDF5, one partition per file.

use std::path::Path;

use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, GroupBuilder};

use super::arrays::{Array, Grid, Kind, fields, node_fields, whole};
use super::{BLOCK, VtkOptions};
use crate::{OutputError, Snapshot, WholeFile};

/// Maximum size of an unchunked array, bytes: each chunk needs an index entry.
const SMALL: usize = 1 << 10;

/// Compression level of deflate, equal to [`flate2::Compression::fast`].
const LEVEL: u32 = 1;

/// Write one snapshot as a VTKHDF file at `path`, atomically: a `PolyData` whose vertices are the particles, or an
/// `UnstructuredGrid` if it has cells. It contains the arrays of [`write_vtp`](super::write_vtp) with the same names and types; point
/// indices are Int64. Needs the feature `hdf5`.
///
/// # Errors
/// A field name that HDF5 does not allow (`.`, or with a `/`); a path that is no regular file, or a file that cannot be written. The old
/// file is then unchanged.
pub fn write_vtkhdf(
    path: impl AsRef<Path>,
    snapshot: &Snapshot,
    options: VtkOptions,
) -> Result<(), OutputError> {
    let path = path.as_ref();
    if let Some((name, _)) = snapshot.fields().find(|(name, _)| *name == "." || name.contains('/')) {
        let why = "HDF5 has `/` between names, and `.` for where it is";
        return Err(OutputError::Name { what: "a field of VTKHDF", name: name.to_string(), why });
    }
    let mut file = WholeFile::create(path)?;
    frame(snapshot, options).finish_to(&mut file).map_err(|error| match error {
        hdf5_pure::Error::Io(source) => OutputError::file("write", path)(source),
        source => OutputError::Hdf { path: path.to_path_buf(), source: Box::new(source) },
    })?;
    file.finish()
}

/// Format a `.series` file (JSON) of frames and their times.
pub(super) fn listed(frames: &[(f64, String)]) -> String {
    let frame = |(time, file): &(f64, String)| {
        let name = file.replace('\\', "\\\\").replace('"', "\\\"");
        format!("    {{ \"name\": \"{name}\", \"time\": {time:e} }}")
    };
    let list: Vec<String> = frames.iter().map(frame).collect();
    format!("{{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n{}\n  ]\n}}\n", list.join(",\n"))
}

/// Build the content of a file.
fn frame(snapshot: &Snapshot, options: VtkOptions) -> FileBuilder {
    let mut file = FileBuilder::new();
    let mut root = file.create_group("VTKHDF");
    root.set_attr("Version", AttrValue::I64Array(vec![2, 0]));
    let mut about = root.create_group("FieldData");
    whole(snapshot).into_iter().for_each(|array| put(&mut about, array, options));
    root.add_group(about.finish());
    let n = snapshot.len();
    let of_fields = match snapshot.cells() {
        Some(cells) => {
            root.set_attr("Type", AttrValue::AsciiString("UnstructuredGrid".into()));
            let Grid { points, connectivity, ends, kinds } = Grid::of(snapshot, cells);
            put(&mut root, count("NumberOfPoints", points.len()), options);
            put(&mut root, Array::points(points.iter()), options);
            topology(&mut root, connectivity.into_iter(), ends.into_iter(), options);
            put(&mut root, Array::bytes("Types", kinds), options);
            if snapshot.node_vectors().next().is_some() {
                let mut data = root.create_group("PointData");
                node_fields(snapshot, options).for_each(|array| put(&mut data, array, options));
                root.add_group(data.finish());
            }
            "CellData"
        }
        None => {
            root.set_attr("Type", AttrValue::AsciiString("PolyData".into()));
            put(&mut root, count("NumberOfPoints", n), options);
            put(&mut root, Array::points(snapshot.positions().iter()), options);
            for (kind, cells) in [("Vertices", n), ("Lines", 0), ("Polygons", 0), ("Strips", 0)] {
                let mut group = root.create_group(kind);
                topology(&mut group, 0..cells, 1..cells + 1, options);
                root.add_group(group.finish());
            }
            "PointData"
        }
    };
    let mut data = root.create_group(of_fields);
    fields(snapshot, options).for_each(|array| put(&mut data, array, options));
    root.add_group(data.finish());
    file.add_group(root.finish());
    file
}

/// Write cells by their connectivity and the end of each cell.
fn topology(
    group: &mut GroupBuilder,
    connectivity: impl ExactSizeIterator<Item = usize>,
    ends: impl ExactSizeIterator<Item = usize>,
    options: VtkOptions,
) {
    put(group, count("NumberOfCells", ends.len()), options);
    put(group, count("NumberOfConnectivityIds", connectivity.len()), options);
    put(group, Array::long("Connectivity", connectivity.map(|x| x as i64)), options);
    put(group, Array::long("Offsets", std::iter::once(0).chain(ends.map(|x| x as i64))), options);
}

/// Array of the number of entities in the single partition of the file.
fn count(name: &'static str, count: usize) -> Array<'static> {
    Array::long(name, std::iter::once(count as i64))
}

/// Write an array to a group, in chunks if it is compressed.
fn put(group: &mut GroupBuilder, array: Array, options: VtkOptions) {
    let Array { name, kind, components, bytes } = array;
    let (datatype, width) = match kind {
        Kind::UInt8 => (hdf5_pure::make_u8_type(), 1),
        Kind::Int32 => (hdf5_pure::make_i32_type(), 4),
        Kind::Int64 => (hdf5_pure::make_i64_type(), 8),
        Kind::Float32 => (hdf5_pure::make_f32_type(), 4),
        Kind::Float64 => (hdf5_pure::make_f64_type(), 8),
    };
    let (total, row) = (bytes.len(), width * components);
    // Arrays of one component have one dimension.
    let shape = |rows: usize| [rows as u64, components as u64][..1 + usize::from(components > 1)].to_vec();
    let data: &mut DatasetBuilder = group.create_dataset(name);
    data.with_raw_data(datatype, bytes, (total / width) as u64).with_shape(&shape(total / row));
    if options.compressed && total > SMALL {
        let rows = (BLOCK / row).min(total / row);
        data.with_chunks(&shape(rows)).with_shuffle().with_deflate(LEVEL);
    }
}
