//! VTK XML files with appended binary data.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::arrays::{Array, Grid, Kind, fields, node_fields, whole};
use super::{BLOCK, VtkOptions};
use crate::{OutputError, Snapshot, write_whole};

/// Write one snapshot as a `.vtp` file at `path`, or as a `.vtu` file if it has cells, atomically. Besides its fields it contains `body`
/// (Int32), a field `particle` in 64 bits, `size` (m, if particles differ) and the field data `TimeValue` (s), `Step`, `ParticleSize` (m)
/// if uniform, and `body_names`, the name of body n as entry n, if bodies have names.
///
/// # Errors
/// A path that is no regular file, or a file that cannot be written; the old file is then unchanged.
pub fn write_vtp(
    path: impl AsRef<Path>,
    snapshot: &Snapshot,
    options: VtkOptions,
) -> Result<(), OutputError> {
    let path = path.as_ref();
    let bytes = vtp_bytes(snapshot, options).map_err(OutputError::file("compress", path))?;
    write_whole(path, bytes)
}

/// Format a `.pvd` file of frames and their times.
pub(super) fn listed(frames: &[(f64, String)]) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n",
    );
    for (time, file) in frames {
        // Writing to a String cannot fail.
        let _ = writeln!(
            xml,
            "    <DataSet timestep=\"{time:e}\" group=\"\" part=\"0\" file=\"{}\"/>",
            escaped(file)
        );
    }
    xml.push_str("  </Collection>\n</VTKFile>\n");
    xml
}

/// Build the bytes of a file.
fn vtp_bytes(snapshot: &Snapshot, options: VtkOptions) -> std::io::Result<Vec<u8>> {
    let n = snapshot.len();
    let mut file = Appended { xml: String::new(), data: Vec::new(), options };
    let compressor = if options.compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let kind = if snapshot.cells().is_some() { "UnstructuredGrid" } else { "PolyData" };
    let _ = write!(
        file.xml,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}>\n  <{kind}>\n    <FieldData>\n"
    );
    for array in whole(snapshot) {
        file.array(&array, " NumberOfTuples=\"1\"")?;
    }
    file.names(snapshot.body_names());
    file.xml.push_str("    </FieldData>\n");
    match snapshot.cells() {
        Some(cells) => {
            let grid = Grid::of(snapshot, cells);
            let count = grid.points.len();
            let _ = write!(
                file.xml,
                "    <Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{n}\">\n      <PointData>\n"
            );
            node_fields(snapshot, options).try_for_each(|array| file.array(&array, ""))?;
            file.xml.push_str("      </PointData>\n      <CellData>\n");
            file.fields(snapshot)?;
            file.xml.push_str("      </CellData>\n      <Points>\n");
            file.array(&Array::points(grid.points.iter()), "")?;
            file.xml.push_str("      </Points>\n      <Cells>\n");
            file.integers("connectivity", grid.connectivity.into_iter())?;
            file.integers("offsets", grid.ends.into_iter())?;
            file.array(&Array::bytes("types", grid.kinds), "")?;
            file.xml.push_str("      </Cells>\n");
        }
        None => {
            let _ = write!(
                file.xml,
                "    <Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n"
            );
            file.fields(snapshot)?;
            file.xml.push_str("      </PointData>\n      <Points>\n");
            file.array(&Array::points(snapshot.positions().iter()), "")?;
            file.xml.push_str("      </Points>\n      <Verts>\n");
            file.integers("connectivity", 0..n)?;
            file.integers("offsets", 1..n + 1)?;
            file.xml.push_str("      </Verts>\n");
        }
    }
    let _ = write!(file.xml, "    </Piece>\n  </{kind}>\n  <AppendedData encoding=\"raw\">\n   _");
    let mut bytes = file.xml.into_bytes();
    bytes.append(&mut file.data);
    bytes.extend_from_slice(b"\n  </AppendedData>\n</VTKFile>\n");
    Ok(bytes)
}

/// Parts of a file under construction: the XML header and the appended binary data.
struct Appended {
    xml: String,
    data: Vec<u8>,
    options: VtkOptions,
}

impl Appended {
    /// Append increasing integers, in 32 bits if they fit.
    fn integers(&mut self, name: &str, numbers: impl Iterator<Item = usize> + Clone) -> std::io::Result<()> {
        let array = if numbers.clone().all(|x| i32::try_from(x).is_ok()) {
            Array::short(name, numbers.map(|x| x as i32))
        } else {
            Array::long(name, numbers.map(|x| x as i64))
        };
        self.array(&array, "")
    }

    /// Write the names of the bodies as a string array: bytes as signed numbers, each string terminated by zero.
    fn names(&mut self, names: &[String]) {
        if names.is_empty() {
            return;
        }
        let _ = write!(
            self.xml,
            "        <Array type=\"String\" Name=\"body_names\" NumberOfTuples=\"{}\" format=\"ascii\">\n         ",
            names.len()
        );
        for name in names {
            for byte in name.bytes().filter(|byte| *byte != 0).chain([0]) {
                let _ = write!(self.xml, " {}", byte.cast_signed());
            }
        }
        self.xml.push_str("\n        </Array>\n");
    }

    /// Write body, size and fields of the particles.
    fn fields(&mut self, snapshot: &Snapshot) -> std::io::Result<()> {
        fields(snapshot, self.options).try_for_each(|array| self.array(&array, ""))
    }

    /// Describe an array and append its bytes. Uncompressed: `[bytes] data`. Compressed: `[blocks] [size of a block]
    /// [size of the last block, 0 if full] [compressed sizes ...] data`, all headers UInt64.
    fn array(&mut self, array: &Array, attributes: &str) -> std::io::Result<()> {
        let kind = match array.kind {
            Kind::UInt8 => "UInt8",
            Kind::Int32 => "Int32",
            Kind::Int64 => "Int64",
            Kind::Float32 => "Float32",
            Kind::Float64 => "Float64",
        };
        let components = match array.components {
            3 => " NumberOfComponents=\"3\"",
            6 => {
                " NumberOfComponents=\"6\" ComponentName0=\"XX\" ComponentName1=\"YY\" ComponentName2=\"ZZ\" ComponentName3=\"XY\" ComponentName4=\"YZ\" ComponentName5=\"XZ\""
            }
            _ => "",
        };
        let _ = writeln!(
            self.xml,
            "        <DataArray type=\"{kind}\" Name=\"{}\"{attributes}{components} format=\"appended\" offset=\"{}\"/>",
            escaped(array.name),
            self.data.len()
        );
        let bytes = &array.bytes;
        if !self.options.compressed {
            self.data.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
            self.data.extend_from_slice(bytes);
            return Ok(());
        }
        let blocks = bytes.len().div_ceil(BLOCK);
        for word in [blocks, BLOCK, bytes.len() % BLOCK] {
            self.data.extend_from_slice(&(word as u64).to_le_bytes());
        }
        let mut size_at = self.data.len();
        self.data.resize(size_at + 8 * blocks, 0);
        for block in bytes.chunks(BLOCK) {
            let start = self.data.len();
            let mut encoder = ZlibEncoder::new(&mut self.data, Compression::fast());
            encoder.write_all(block)?;
            encoder.finish()?;
            let size = (self.data.len() - start) as u64;
            self.data[size_at..size_at + 8].copy_from_slice(&size.to_le_bytes());
            size_at += 8;
        }
        Ok(())
    }
}

/// Escape text for a double-quoted XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
