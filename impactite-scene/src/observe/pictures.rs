//! Frames: ParaView files and pictures.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use crate::archive::{Archive, CheckpointError};

use super::background::{Background, locked};
use super::displacement::FirstSeen;
use super::{ObserveError, Observer, Pace, RunView};
use impactite_output::picture::Picture;
use impactite_output::{self as output, Format, OutputError, Snapshot, VtkOptions};

/// The vector field that [`VtkSeries::with_displacement`] adds.
const DISPLACEMENT: &str = "displacement";

/// Writes a ParaView series, all bodies in one frame, with the fields of [`RunView::snapshot`].
pub struct VtkSeries {
    pace: Pace,
    series: Arc<Mutex<output::VtkSeries>>,
    background: Background,
    times: Vec<f64>,
    fields: Option<Vec<String>>,
    first: Option<FirstSeen>,
}

impl VtkSeries {
    /// Frames `NAME_000000.vtp`, ... and `NAME.pvd` (or as [`VtkSeries::with_format`] says) in `folder`, which is created if it
    /// does not exist.
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

    /// Write frames so.
    #[must_use]
    pub fn with_options(self, options: VtkOptions) -> Self {
        let series = locked(&self.series).clone().with_options(options);
        VtkSeries { series: Arc::new(Mutex::new(series)), ..self }
    }

    /// Write frames as such files.
    #[must_use]
    pub fn with_format(self, format: Format) -> Self {
        let series = locked(&self.series).clone().with_format(format);
        VtkSeries { series: Arc::new(Mutex::new(series)), ..self }
    }

    /// Write frames there, beside the run.
    #[must_use]
    pub fn in_background(self, background: &Background) -> Self {
        VtkSeries { background: background.clone(), ..self }
    }

    /// Write these fields alone, and `displacement` if [`VtkSeries::with_displacement`] asks for it.
    #[must_use]
    pub fn with_fields<S: Into<String>>(self, names: impl IntoIterator<Item = S>) -> Self {
        VtkSeries { fields: Some(names.into_iter().map(Into::into).collect()), ..self }
    }

    /// Write the vector field `displacement`, too (m): where a point is, less where this observer first saw it, at the start of the run.
    /// A point that comes later, as those that others were split into, counts from where it is in its first frame. Through a
    /// periodic plane a point is displaced by the period.
    ///
    /// Nodes of elements have the same field, as point data: "Warp By Vector" moves them. Points are known by body and number (the field
    /// `particle`). Takes 64 bytes a point, and 24 for each corner of an element, in checkpoints, too: a run that is
    /// resumed goes on with the same displacements.
    #[must_use]
    pub fn with_displacement(self) -> Self {
        VtkSeries { first: Some(FirstSeen::default()), ..self }
    }

    /// The path of the file that lists the frames and is to be opened: `NAME.pvd`, or that of another format.
    #[must_use]
    pub fn index(&self) -> PathBuf {
        locked(&self.series).index()
    }

    /// How many frames were written; those that wait in the background are not.
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

/// Draws the pictures of a run, with what stays from one to the next, as a [`SeriesView`](output::picture::SeriesView). Functions draw, too.
pub trait Draw {
    /// Draw a snapshot.
    ///
    /// # Errors
    /// A snapshot that cannot be drawn so; the run stops there.
    fn draw(&mut self, now: &Snapshot) -> Result<Picture, OutputError>;

    /// State between pictures, to a checkpoint or from one; none of a function.
    ///
    /// # Errors
    /// The file.
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

/// Draws a picture at each look and saves it as `NAME_000000.png`, ...
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
    /// Pictures in `folder`, which is created if it does not exist, drawn by a function. Parts of files that a killed process left
    /// there are removed.
    ///
    /// # Errors
    /// A name that is empty or holds a path separator, or a folder that cannot be created.
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
    /// Pictures as of [`Pictures::create`], drawn by something that keeps a state between them.
    ///
    /// # Errors
    /// As for [`Pictures::create`].
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

    /// Draw and save there, beside the run.
    #[must_use]
    pub fn in_background(self, background: &Background) -> Self {
        Pictures { background: background.clone(), ..self }
    }

    /// How many pictures were taken, of which some may still wait in the background.
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

/// Keeps snapshots, with the fields of [`RunView::snapshot`].
pub struct Snapshots {
    pace: Pace,
    list: Vec<Snapshot>,
}

impl Snapshots {
    /// At this pace.
    #[must_use]
    pub fn new(pace: Pace) -> Self {
        Snapshots { pace, list: Vec::new() }
    }

    /// Those taken so far, in order of time.
    #[must_use]
    pub fn list(&self) -> &[Snapshot] {
        &self.list
    }

    /// All, to be kept after the run.
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
