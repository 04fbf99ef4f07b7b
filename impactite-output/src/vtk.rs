//! ParaView files: one `.vtp` (XML PolyData) an instant and a `.pvd` that lists them with their times.
//!
//! The data follow the XML as one raw binary block ("appended raw", little endian), by default compressed by
//! zlib in blocks of 1 MiB, the layout that VTK's `vtkZLibDataCompressor` writes itself. Each particle is a
//! vertex, so files open in ParaView with nothing to set; choose "Point Gaussian" to see spheres and scale
//! them by the array `size`. A snapshot with [cells](super::Cells) becomes a `.vtu` (XML UnstructuredGrid) instead: elements are cells,
//! particles beside them vertices, and the fields those of the cells.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::{Cells, FieldValues, OutputError, ParticleSize, Snapshot, check_name, write_whole};

/// How many bits a field keeps in a file. Positions and the time always keep all 64.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Seven digits (Float32): enough to look at, half the size.
    #[default]
    Single,
    /// All digits (Float64): to compute with.
    Double,
}

/// How a `.vtp` file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VtkOptions {
    /// Whether the data are compressed by zlib; `false` writes faster and larger files.
    pub compressed: bool,
    /// The precision of the fields.
    pub fields: Precision,
}

impl Default for VtkOptions {
    fn default() -> Self {
        Self { compressed: true, fields: Precision::Single }
    }
}

/// The uncompressed size of a compressed block, bytes.
const BLOCK: usize = 1 << 20;

/// A time series for ParaView: frame files `NAME_000012.vtp` in a folder and `NAME.pvd`, which lists them with
/// their times and is complete and valid after every frame.
///
/// ```
/// use impactite_output::{ParticleSize, Snapshot, VtkSeries};
/// # let folder = std::env::temp_dir().join("impactite-doc-vtk");
/// let mut series = VtkSeries::create(&folder, "two_disks")?;
/// for frame in 0..3u32 {
///     let x = 1.0e-3 * f64::from(frame);
///     let time = 1.0e-6 * f64::from(frame);
///     let size = ParticleSize::Uniform(1.0e-3);
///     series.write(&Snapshot::new(3, time, u64::from(frame), vec![[x, 0.0, 0.0]], size)?)?;
/// }
/// assert!(folder.join("two_disks_000002.vtp").is_file());
/// assert!(folder.join("two_disks.pvd").is_file());
/// # Ok::<(), impactite_output::OutputError>(())
/// ```
#[derive(Debug, Clone)]
pub struct VtkSeries {
    folder: PathBuf,
    name: String,
    options: VtkOptions,
    frames: Vec<(f64, String)>,
}

impl VtkSeries {
    /// A series called `name` in `folder`, which is created if it does not exist. Frames of an older series of
    /// that name are overwritten as the new ones arrive.
    ///
    /// # Errors
    /// A name that is empty or holds a path separator, or a folder that cannot be created.
    pub fn create(folder: impl AsRef<Path>, name: impl Into<String>) -> Result<Self, OutputError> {
        let (folder, name) = (folder.as_ref().to_path_buf(), name.into());
        check_name("a series", &name)?;
        if name.contains(['/', '\\']) {
            let why = "it must hold no path separator; the folder is given apart";
            return Err(OutputError::Name { what: "a series", name, why });
        }
        std::fs::create_dir_all(&folder).map_err(OutputError::file("create", &folder))?;
        Ok(Self { folder, name, options: VtkOptions::default(), frames: Vec::new() })
    }

    /// Write frames so.
    #[must_use]
    pub fn with_options(mut self, options: VtkOptions) -> Self {
        self.options = options;
        self
    }

    /// Write the next frame and bring the `.pvd` up to date. Returns the path of the frame.
    ///
    /// # Errors
    /// A file that cannot be written; the series as it was before stays valid.
    pub fn write(&mut self, snapshot: &Snapshot) -> Result<PathBuf, OutputError> {
        let kind = if snapshot.cells().is_some() { "vtu" } else { "vtp" };
        let file = self.frame(self.frames.len(), kind);
        let path = self.folder.join(&file);
        write_vtp(&path, snapshot, self.options)?;
        self.frames.push((snapshot.time(), file));
        write_whole(self.pvd(), self.index())?;
        Ok(path)
    }

    /// Go on with a series whose frames of these times (s) were written before.
    pub fn go_on(&mut self, times: &[f64]) {
        let frame = |(k, &time): (usize, &f64)| {
            let cells = self.frame(k, "vtu");
            (time, if self.folder.join(&cells).is_file() { cells } else { self.frame(k, "vtp") })
        };
        self.frames = times.iter().enumerate().map(frame).collect();
    }

    /// The path of the `.pvd` file.
    #[must_use]
    pub fn pvd(&self) -> PathBuf {
        self.folder.join(format!("{}.pvd", self.name))
    }

    /// How many frames were written.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    fn frame(&self, number: usize, kind: &str) -> String {
        format!("{}_{number:06}.{kind}", self.name)
    }

    fn index(&self) -> String {
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n",
        );
        for (time, file) in &self.frames {
            // `{:e}` is the shortest text that reads back to the same bits. Writing to a String cannot fail.
            let _ = writeln!(
                xml,
                "    <DataSet timestep=\"{time:e}\" group=\"\" part=\"0\" file=\"{}\"/>",
                escaped(file)
            );
        }
        xml.push_str("  </Collection>\n</VTKFile>\n");
        xml
    }
}

/// Write one snapshot as a `.vtp` file at `path`, or as a `.vtu` file if it has cells, whole or not at all. Beside its fields it holds `body`
/// (Int32), a field `particle` in 64 bits, `size` (m, if particles differ) and the field data `TimeValue` (s), `Step` and, if all particles are
/// alike, `ParticleSize` (m).
///
/// # Errors
/// A path that is no regular file, or a file that cannot be written; what was there before stays.
pub fn write_vtp(
    path: impl AsRef<Path>,
    snapshot: &Snapshot,
    options: VtkOptions,
) -> Result<(), OutputError> {
    let path = path.as_ref();
    let bytes = vtp_bytes(snapshot, options).map_err(OutputError::file("compress", path))?;
    write_whole(path, bytes)
}

/// The bytes of a file.
fn vtp_bytes(snapshot: &Snapshot, options: VtkOptions) -> std::io::Result<Vec<u8>> {
    let n = snapshot.len();
    let mut file = Appended { xml: String::new(), data: Vec::new(), options };
    let compressor = if options.compressed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let kind = if snapshot.cells().is_some() { "UnstructuredGrid" } else { "PolyData" };
    let _ = write!(
        file.xml,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}>\n  <{kind}>\n    <FieldData>\n"
    );
    let one = " NumberOfTuples=\"1\"";
    file.array("Float64", "TimeValue", one, &snapshot.time().to_le_bytes())?;
    file.array("Int64", "Step", one, &i64::try_from(snapshot.step()).unwrap_or(i64::MAX).to_le_bytes())?;
    if let ParticleSize::Uniform(size) = snapshot.size() {
        file.array("Float64", "ParticleSize", one, &size.to_le_bytes())?;
    }
    file.xml.push_str("    </FieldData>\n");
    match snapshot.cells() {
        Some(cells) => file.grid(snapshot, cells)?,
        None => {
            let _ = write!(
                file.xml,
                "    <Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n"
            );
            file.fields(snapshot)?;
            file.xml.push_str("      </PointData>\n      <Points>\n");
            file.points(snapshot.positions().iter())?;
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

/// The two halves of a file in the making: the XML that describes and the binary data that follow it.
struct Appended {
    xml: String,
    data: Vec<u8>,
    options: VtkOptions,
}

impl Appended {
    /// Nodes of the cells, with the particles that are none behind them, and the cells.
    fn grid(&mut self, snapshot: &Snapshot, cells: &Cells) -> std::io::Result<()> {
        let n = snapshot.len();
        let mut points = cells.nodes.clone();
        let (mut connectivity, mut offsets, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
        for (i, position) in snapshot.positions().iter().enumerate() {
            let corners = cells.of(i);
            kinds.push(Cells::kind(corners.len(), snapshot.dimension()).unwrap_or(1));
            connectivity.extend(corners.iter().map(|&corner| corner as usize));
            if corners.is_empty() {
                connectivity.push(points.len());
                points.push(*position);
            }
            offsets.push(connectivity.len());
        }
        let count = points.len();
        let _ = write!(
            self.xml,
            "    <Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{n}\">\n      <CellData>\n"
        );
        self.fields(snapshot)?;
        self.xml.push_str("      </CellData>\n      <Points>\n");
        self.points(points.iter())?;
        self.xml.push_str("      </Points>\n      <Cells>\n");
        self.integers("connectivity", connectivity.into_iter())?;
        self.integers("offsets", offsets.into_iter())?;
        self.array("UInt8", "types", "", &kinds)?;
        self.xml.push_str("      </Cells>\n");
        Ok(())
    }

    /// Places, m.
    fn points<'a>(&mut self, points: impl Iterator<Item = &'a [f64; 3]>) -> std::io::Result<()> {
        let bytes: Vec<u8> = points.flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.array("Float64", "Points", " NumberOfComponents=\"3\"", &bytes)
    }

    /// Numbers that count up to the last one, in 32 bits if that fits.
    fn integers(&mut self, name: &str, numbers: impl Iterator<Item = usize> + Clone) -> std::io::Result<()> {
        if numbers.clone().all(|x| i32::try_from(x).is_ok()) {
            let bytes: Vec<u8> = numbers.flat_map(|x| (x as i32).to_le_bytes()).collect();
            self.array("Int32", name, "", &bytes)
        } else {
            let bytes: Vec<u8> = numbers.flat_map(|x| (x as i64).to_le_bytes()).collect();
            self.array("Int64", name, "", &bytes)
        }
    }

    /// Body, size and fields of the particles.
    fn fields(&mut self, snapshot: &Snapshot) -> std::io::Result<()> {
        let number = |b: &u32| i32::try_from(*b).unwrap_or(i32::MAX).to_le_bytes();
        let bodies: Vec<u8> = snapshot.bodies().iter().flat_map(number).collect();
        self.array("Int32", "body", "", &bodies)?;
        if let ParticleSize::Each(sizes) = snapshot.size() {
            self.floats("size", "", sizes.iter().copied())?;
        }
        for (name, values) in snapshot.fields() {
            match values {
                // Numbers of particles, which single precision would round from 16 million on.
                FieldValues::Scalar(v) if name == "particle" => {
                    let bytes: Vec<u8> = v.iter().flat_map(|&x| (x as i64).to_le_bytes()).collect();
                    self.array("Int64", name, "", &bytes)?;
                }
                FieldValues::Scalar(v) => self.floats(name, "", v.iter().copied())?,
                FieldValues::Vector(v) => {
                    self.floats(name, " NumberOfComponents=\"3\"", v.iter().flatten().copied())?;
                }
                FieldValues::Tensor(v) => {
                    // VTK's order is XX YY ZZ XY YZ XZ, ours xx yy zz yz xz xy.
                    let names = " NumberOfComponents=\"6\" ComponentName0=\"XX\" ComponentName1=\"YY\" ComponentName2=\"ZZ\" ComponentName3=\"XY\" ComponentName4=\"YZ\" ComponentName5=\"XZ\"";
                    self.floats(name, names, v.iter().flat_map(|t| [t[0], t[1], t[2], t[5], t[3], t[4]]))?;
                }
            }
        }
        Ok(())
    }

    /// A field of floating-point numbers in the precision asked for.
    fn floats(
        &mut self,
        name: &str,
        attributes: &str,
        values: impl Iterator<Item = f64>,
    ) -> std::io::Result<()> {
        match self.options.fields {
            Precision::Single => {
                let bytes: Vec<u8> = values.flat_map(|x| (x as f32).to_le_bytes()).collect();
                self.array("Float32", name, attributes, &bytes)
            }
            Precision::Double => {
                let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
                self.array("Float64", name, attributes, &bytes)
            }
        }
    }

    /// Describe an array and append its bytes. Plain: `[bytes] data`. Compressed: `[blocks] [size of a block]
    /// [size of the last block, 0 if full] [compressed sizes ...] data`, all headers UInt64.
    fn array(&mut self, kind: &str, name: &str, attributes: &str, bytes: &[u8]) -> std::io::Result<()> {
        let _ = writeln!(
            self.xml,
            "        <DataArray type=\"{kind}\" Name=\"{}\"{attributes} format=\"appended\" offset=\"{}\"/>",
            escaped(name),
            self.data.len()
        );
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

/// Text inside a double-quoted XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
