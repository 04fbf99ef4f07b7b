//! ParaView files: one `.vtp` (XML PolyData) per frame and a `.pvd` that lists the frames with their times; with the feature `hdf5` also
//! one `.vtkhdf` per frame and a `.vtkhdf.series` ([`Format`]).
//!
//! The data follow the XML as one raw binary block ("appended raw", little endian), by default compressed by
//! zlib in blocks of 1 MiB, the layout of VTK's `vtkZLibDataCompressor`. Each particle is a
//! vertex, so that files open in ParaView without settings; choose "Point Gaussian" to see spheres and scale
//! them by the array `size`. A snapshot with [cells](super::Cells) becomes a `.vtu` (XML UnstructuredGrid): elements are cells,
//! free particles are vertices, and fields are cell data; fields of nodes are point data.
//!
//! VTKHDF stores the same arrays in HDF5: chunks of 1 MiB, by default shuffled by bytes and compressed by deflate.

mod arrays;
#[cfg(feature = "hdf5")]
mod hdf;
mod xml;

use std::path::{Path, PathBuf};

use super::{OutputError, Snapshot, check_name, remove_parts, write_whole};

#[cfg(feature = "hdf5")]
pub use hdf::write_vtkhdf;
pub use xml::write_vtp;

/// Precision of fields in a file. Positions and the time are always in double precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Single precision, seven digits (Float32): sufficient for visualization, half the size.
    #[default]
    Single,
    /// Double precision (Float64): for further computation.
    Double,
}

/// Options of frame files, in any [`Format`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VtkOptions {
    /// True for compressed data (zlib's deflate); `false` gives larger files that are written faster.
    pub compressed: bool,
    /// Precision of the fields.
    pub fields: Precision,
}

impl Default for VtkOptions {
    fn default() -> Self {
        Self { compressed: true, fields: Precision::Single }
    }
}

/// File format of the frames of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Format {
    /// XML with binary data: `NAME_000012.vtp` ([`write_vtp`]), with cells `.vtu`, listed in `NAME.pvd`.
    #[default]
    Xml,
    /// VTKHDF: `NAME_000012.vtkhdf` ([`write_vtkhdf`]), listed in `NAME.vtkhdf.series`. Compressed files are smaller
    /// where values change little from a point to the next.
    #[cfg(feature = "hdf5")]
    Hdf,
}

/// Uncompressed size of a compressed block, bytes.
const BLOCK: usize = 1 << 20;

/// Time series for ParaView: frame files `NAME_000012.vtp` in a folder and `NAME.pvd`, which lists them with
/// their times and is complete and valid after every frame; or files of another [`Format`].
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
    format: Format,
    frames: Vec<(f64, String)>,
}

impl VtkSeries {
    /// Create a series called `name` in `folder`, which is created if it does not exist. Frames of an older series of
    /// that name are overwritten one by one; temporary files of killed processes are removed.
    ///
    /// # Errors
    /// A name that is empty or contains a path separator, or a folder that cannot be created.
    pub fn create(folder: impl AsRef<Path>, name: impl Into<String>) -> Result<Self, OutputError> {
        let (folder, name) = (folder.as_ref().to_path_buf(), name.into());
        check_name("a series", &name)?;
        if name.contains(['/', '\\']) {
            let why = "it must hold no path separator; the folder is given apart";
            return Err(OutputError::Name { what: "a series", name, why });
        }
        std::fs::create_dir_all(&folder).map_err(OutputError::file("create", &folder))?;
        remove_parts(&folder, &name)?;
        Ok(Self {
            folder,
            name,
            options: VtkOptions::default(),
            format: Format::default(),
            frames: Vec::new(),
        })
    }

    /// Set the options of frame files.
    #[must_use]
    pub fn with_options(mut self, options: VtkOptions) -> Self {
        self.options = options;
        self
    }

    /// Set the file format of frames.
    #[must_use]
    pub fn with_format(mut self, format: Format) -> Self {
        self.format = format;
        self
    }

    /// Write the next frame and update the list of frames. Returns the path of the frame.
    ///
    /// # Errors
    /// A file that cannot be written, or a field name that the format does not allow; the previous series stays valid.
    pub fn write(&mut self, snapshot: &Snapshot) -> Result<PathBuf, OutputError> {
        let file = match self.format {
            Format::Xml if snapshot.cells().is_some() => self.frame(self.frames.len(), "vtu"),
            Format::Xml => self.frame(self.frames.len(), "vtp"),
            #[cfg(feature = "hdf5")]
            Format::Hdf => self.frame(self.frames.len(), "vtkhdf"),
        };
        let path = self.folder.join(&file);
        match self.format {
            Format::Xml => write_vtp(&path, snapshot, self.options)?,
            #[cfg(feature = "hdf5")]
            Format::Hdf => write_vtkhdf(&path, snapshot, self.options)?,
        }
        self.frames.push((snapshot.time(), file));
        write_whole(self.index(), self.listed())?;
        Ok(path)
    }

    /// Continue a series whose frames at these times (s) exist.
    pub fn go_on(&mut self, times: &[f64]) {
        let written = |number: usize| match self.format {
            Format::Xml => {
                let cells = self.frame(number, "vtu");
                if self.folder.join(&cells).is_file() { cells } else { self.frame(number, "vtp") }
            }
            #[cfg(feature = "hdf5")]
            Format::Hdf => self.frame(number, "vtkhdf"),
        };
        self.frames = times.iter().enumerate().map(|(number, &time)| (time, written(number))).collect();
    }

    /// Path of the file that lists the frames, to be opened: `NAME.pvd`, or `NAME.vtkhdf.series`.
    #[must_use]
    pub fn index(&self) -> PathBuf {
        let kind = match self.format {
            Format::Xml => "pvd",
            #[cfg(feature = "hdf5")]
            Format::Hdf => "vtkhdf.series",
        };
        self.folder.join(format!("{}.{kind}", self.name))
    }

    /// Number of frames written.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    fn frame(&self, number: usize, kind: &str) -> String {
        format!("{}_{number:06}.{kind}", self.name)
    }

    /// Format the list of frames with their times. `{:e}` is the shortest text that reads back to the same bits.
    fn listed(&self) -> String {
        match self.format {
            Format::Xml => xml::listed(&self.frames),
            #[cfg(feature = "hdf5")]
            Format::Hdf => hdf::listed(&self.frames),
        }
    }
}
