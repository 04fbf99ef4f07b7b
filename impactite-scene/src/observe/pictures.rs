//! Frames: ParaView files and pictures.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use crate::archive::{Archive, CheckpointError};

use super::background::{Background, locked};
use super::displacement::FirstSeen;
use super::{ObserveError, Observer, Pace, RunView};
use impactite_output::picture::Picture;
use impactite_output::{self as output, Format, OutputError, Snapshot, VtkOptions};

/// Name of the vector field that [`VtkSeries::with_displacement`] adds.
const DISPLACEMENT: &str = "displacement";

/// Observer that writes a ParaView series, all bodies in one frame, with the fields of [`RunView::snapshot`].
pub struct VtkSeries {
    pace: Pace,
    series: Arc<Mutex<output::VtkSeries>>,
    background: Background,
    times: Vec<f64>,
    fields: Option<Vec<String>>,
    first: Option<FirstSeen>,
}

impl VtkSeries {
    /// Create the series: frames `NAME_000000.vtp`, ... and `NAME.pvd` (or the files of [`VtkSeries::with_format`]) in `folder`, which is
    /// created if it does not exist.
    ///
    /// # Errors
    /// A name that cannot be a file name, or a folder that cannot be created.
    pub fn create(
        folder: impl AsRef<Path>,
        name: impl Into<String>,
        pace: Pace,
    ) -> Result<Self, ObserveError> {
        Ok(VtkSeries {
            pace,
            series: Arc::new(Mutex::new(output::VtkSeries::create(folder, name)?)),
            background: Background::none(),
            times: Vec::new(),
            fields: None,
            first: None,
        })
    }

    /// Set the options of frames.
    #[must_use]
    pub fn with_options(self, options: VtkOptions) -> Self {
        let series = locked(&self.series).clone().with_options(options);
        VtkSeries { series: Arc::new(Mutex::new(series)), ..self }
    }

    /// Set the file format of frames.
    #[must_use]
    pub fn with_format(self, format: Format) -> Self {
        let series = locked(&self.series).clone().with_format(format);
        VtkSeries { series: Arc::new(Mutex::new(series)), ..self }
    }

    /// Write frames in this background thread.
    #[must_use]
    pub fn in_background(self, background: &Background) -> Self {
        VtkSeries { background: background.clone(), ..self }
    }

    /// Write only these fields, and `displacement` if [`VtkSeries::with_displacement`] is set.
    #[must_use]
    pub fn with_fields<S: Into<String>>(self, names: impl IntoIterator<Item = S>) -> Self {
        VtkSeries { fields: Some(names.into_iter().map(Into::into).collect()), ..self }
    }

    /// Also write the vector field `displacement`, m: current position minus the position at the first observation, the start of the run.
    /// The reference of a point created later, for example by splitting, is its position in its first frame. A point that crosses a
    /// periodic plane is displaced by the period.
    ///
    /// Nodes of elements have the same field, as point data: "Warp By Vector" moves them. Points are identified by body and number (the
    /// field `particle`). The reference positions need 64 bytes per point, and 24 per corner of an element, in checkpoints, too: a resumed
    /// run continues with the same displacements.
    #[must_use]
    pub fn with_displacement(self) -> Self {
        VtkSeries { first: Some(FirstSeen::default()), ..self }
    }

    /// Path of the index file of the frames, to be opened: `NAME.pvd`, or that of another format.
    #[must_use]
    pub fn index(&self) -> PathBuf {
        locked(&self.series).index()
    }

    /// Number of frames written, without those that wait in the background.
    #[must_use]
    pub fn frames(&self) -> usize {
        locked(&self.series).frames()
    }
}

impl Observer for VtkSeries {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let mut snapshot = now.snapshot()?;
        let displacements = self.first.as_mut().map(|first| first.displacements(&snapshot)).transpose()?;
        if let Some(names) = &self.fields {
            let added = |name: &&String| displacements.is_some() && *name == DISPLACEMENT;
            let names: Vec<&String> = names.iter().filter(|name| !added(name)).collect();
            snapshot = snapshot.with_fields_only(&names)?;
        }
        if let Some(displacements) = displacements {
            snapshot = snapshot.with_vector(DISPLACEMENT, displacements.points)?;
            if snapshot.cells().is_some() {
                snapshot = snapshot.with_node_vector(DISPLACEMENT, displacements.nodes)?;
            }
        }
        let series = self.series.clone();
        self.background.run(move || locked(&series).write(&snapshot).map(drop))?;
        self.times.push(now.time());
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.background.wait()?;
        file.list(&mut self.times, &0.0, Archive::real)?;
        if file.reads() {
            locked(&self.series).go_on(&self.times);
        }
        let here = if self.first.is_some() { "written" } else { "not written" };
        file.same("`displacement` of the frames", here)?;
        if let Some(first) = &mut self.first {
            first.archive(file)?;
        }
        Ok(())
    }
    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.background.wait()?)
    }
}

/// Renderer of the pictures of a run with state between them, such as a [`SeriesView`](output::picture::SeriesView). Functions implement
/// it, too.
pub trait Draw {
    /// Draw a snapshot.
    ///
    /// # Errors
    /// A snapshot that cannot be drawn; the run stops there.
    fn draw(&mut self, now: &Snapshot) -> Result<Picture, OutputError>;

    /// Write or read the state between pictures; none for a function.
    ///
    /// # Errors
    /// I/O error; damaged file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let _ = file;
        Ok(())
    }
}

impl<F> Draw for F
where
    F: FnMut(&Snapshot) -> Result<Picture, OutputError>,
{
    fn draw(&mut self, now: &Snapshot) -> Result<Picture, OutputError> {
        self(now)
    }
}

/// Observer that draws a picture at each observation and saves it as `NAME_000000.png`, ...
///
/// ```
/// use impactite_scene::observe::{Pace, Pictures};
/// use impactite_output::picture::{ParticlePicture, Quantity};
/// # let folder = std::env::temp_dir().join("impactite-doc-pictures");
/// let pictures = Pictures::create(&folder, "bar", Pace::interval(5.0e-6)?, |snapshot| {
///     ParticlePicture::new(800, 600).colour_by(Quantity::scalar("plastic_strain")).draw(snapshot)
/// })?;
/// # Ok::<(), impactite_scene::observe::ObserveError>(())
/// ```
pub struct Pictures<D> {
    pace: Pace,
    folder: PathBuf,
    name: String,
    draw: Arc<Mutex<D>>,
    background: Background,
    frames: usize,
}

impl<F> Pictures<F>
where
    F: FnMut(&Snapshot) -> Result<Picture, OutputError> + Send + 'static,
{
    /// Create pictures in `folder`, which is created if it does not exist, drawn by a function. Partial files of a killed process are
    /// removed there.
    ///
    /// # Errors
    /// A name that is empty or contains a path separator, or a folder that cannot be created.
    pub fn create(
        folder: impl AsRef<Path>,
        name: impl Into<String>,
        pace: Pace,
        draw: F,
    ) -> Result<Self, ObserveError> {
        Pictures::drawn_by(folder, name, pace, draw)
    }
}

impl<D: Draw + Send + 'static> Pictures<D> {
    /// Create pictures as by [`Pictures::create`], drawn by a renderer with state.
    ///
    /// # Errors
    /// Those of [`Pictures::create`].
    pub fn drawn_by(
        folder: impl AsRef<Path>,
        name: impl Into<String>,
        pace: Pace,
        draw: D,
    ) -> Result<Self, ObserveError> {
        let (folder, name) = (folder.as_ref().to_path_buf(), name.into());
        output::check_name("a series", &name)?;
        if name.contains(['/', '\\']) {
            let why = "it must hold no path separator; the folder is given apart";
            return Err(OutputError::Name { what: "a series", name, why }.into());
        }
        std::fs::create_dir_all(&folder).map_err(OutputError::file("create", &folder))?;
        output::remove_parts(&folder, &name)?;
        let draw = Arc::new(Mutex::new(draw));
        Ok(Pictures { pace, folder, name, draw, background: Background::none(), frames: 0 })
    }

    /// Draw and save in this background thread.
    #[must_use]
    pub fn in_background(self, background: &Background) -> Self {
        Pictures { background: background.clone(), ..self }
    }

    /// Number of pictures taken, some of which may wait in the background.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }
}

impl<D: Draw + Send + 'static> Observer for Pictures<D> {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let (snapshot, draw) = (now.snapshot()?, self.draw.clone());
        let path = self.folder.join(format!("{}_{:06}.png", self.name, self.frames));
        self.background.run(move || locked(&draw).draw(&snapshot)?.save(path))?;
        self.frames += 1;
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.background.wait()?;
        file.count(&mut self.frames)?;
        locked(&self.draw).archive(file)
    }
    fn finish(&mut self) -> Result<(), ObserveError> {
        Ok(self.background.wait()?)
    }
}

/// Observer that stores snapshots, with the fields of [`RunView::snapshot`].
pub struct Snapshots {
    pace: Pace,
    list: Vec<Snapshot>,
}

impl Snapshots {
    /// Create the observer with this pace.
    #[must_use]
    pub fn new(pace: Pace) -> Self {
        Snapshots { pace, list: Vec::new() }
    }

    /// Snapshots so far, in order of time.
    #[must_use]
    pub fn list(&self) -> &[Snapshot] {
        &self.list
    }

    /// Return all snapshots, to keep them after the run.
    #[must_use]
    pub fn into_list(self) -> Vec<Snapshot> {
        self.list
    }
}

impl Observer for Snapshots {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        self.list.push(now.snapshot()?);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.snapshots(&mut self.list)
    }
}
