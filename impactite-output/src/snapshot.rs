//! Snapshot of a particle simulation at one time, independent of the solver.

use super::{Cells, OutputError, check_length, check_name};

/// Maximum distance of a drawn particle from the origin, m. Larger than the universe, and small enough that volumes and squared areas do
/// not overflow.
pub(crate) const FARTHEST: f64 = 1e30;

/// True if a position is finite and close enough to be drawn.
pub(crate) fn is_place(x: &[f64; 3]) -> bool {
    x.iter().all(|c| c.abs() <= FARTHEST)
}

/// Edge length of the cube (square in 2D) of matter that a particle represents, m.
#[derive(Debug, Clone, PartialEq)]
pub enum ParticleSize {
    /// Uniform size, m.
    Uniform(f64),
    /// Size of each particle, m.
    Each(Vec<f64>),
}

/// Values of one field, one entry per particle, SI units.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldValues {
    /// Scalar per particle.
    Scalar(Vec<f64>),
    /// Vector `[x, y, z]` per particle; z is 0 in two dimensions.
    Vector(Vec<[f64; 3]>),
    /// Symmetric tensor `[xx, yy, zz, yz, xz, xy]` per particle (the order of
    /// `Sym3` of mpm-materials, tensor components, shear not doubled).
    Tensor(Vec<[f64; 6]>),
}

impl FieldValues {
    /// Number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Scalar(v) => v.len(),
            Self::Vector(v) => v.len(),
            Self::Tensor(v) => v.len(),
        }
    }

    /// True if there are no entries.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Kind of the values.
    #[must_use]
    pub fn kind(&self) -> FieldKind {
        match self {
            Self::Scalar(_) => FieldKind::Scalar,
            Self::Vector(_) => FieldKind::Vector,
            Self::Tensor(_) => FieldKind::Tensor,
        }
    }
}

/// Kind of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldKind {
    /// Scalar per particle.
    Scalar,
    /// Vector per particle.
    Vector,
    /// Symmetric tensor per particle.
    Tensor,
}

impl FieldKind {
    fn word(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Vector => "vector",
            Self::Tensor => "tensor",
        }
    }
}

/// State at one time: positions and fields of the particles. Lengths and names are checked at construction, so
/// that writers need no further checks.
///
/// ```
/// use impactite_output::{ParticleSize, Snapshot};
/// let snapshot = Snapshot::new(3, 1.0e-6, 42, vec![[0.0; 3], [1.0e-3, 0.0, 0.0]], ParticleSize::Uniform(1.0e-3))?
///     .with_bodies(vec![0, 1])?
///     .with_scalar("pressure", vec![1.0e9, 2.0e9])?
///     .with_vector("velocity", vec![[0.0, 0.0, -227.0]; 2])?;
/// assert_eq!(snapshot.scalar("pressure")?[1], 2.0e9);
/// assert!(snapshot.scalar("temperature").is_err());
/// # Ok::<(), impactite_output::OutputError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    dimension: usize,
    time: f64,
    step: u64,
    positions: Vec<[f64; 3]>,
    size: ParticleSize,
    bodies: Vec<u32>,
    names: Vec<String>,
    fields: Vec<(String, FieldValues)>,
    cells: Option<Cells>,
    node_fields: Vec<(String, Vec<[f64; 3]>)>,
}

impl Snapshot {
    /// Create a snapshot of particles at `positions` (m; z is 0 when `dimension` is 2) at `time` (s) after `step` steps. All belong
    /// to body 0 unless [`with_bodies`](Self::with_bodies) assigns them.
    ///
    /// # Errors
    /// A dimension other than 2 or 3, a time that is not finite, a size outside 1e-30 to 1e30 m, z that is
    /// not 0 in two dimensions, or a list of sizes of the wrong length. Positions that are not finite, or farther than 1e30 m
    /// from the origin, are accepted (for inspection of a failed run) and omitted from pictures.
    pub fn new(
        dimension: usize,
        time: f64,
        step: u64,
        positions: Vec<[f64; 3]>,
        size: ParticleSize,
    ) -> Result<Self, OutputError> {
        if dimension != 2 && dimension != 3 {
            return Err(OutputError::value("dimension", dimension, "2 or 3"));
        }
        if !time.is_finite() {
            return Err(OutputError::value("time", time, "a finite number of seconds"));
        }
        if dimension == 2
            && let Some((i, x)) = positions.iter().enumerate().find(|(_, x)| x[2] != 0.0)
        {
            let what = format!("z of particle {i}");
            return Err(OutputError::value(what, x[2], "0 in two dimensions"));
        }
        let good = |h: &f64| (1.0 / FARTHEST..=FARTHEST).contains(h);
        let allowed = "a length from 1e-30 to 1e30 m";
        match &size {
            ParticleSize::Uniform(h) if !good(h) => {
                return Err(OutputError::value("particle size", h, allowed));
            }
            ParticleSize::Each(list) => {
                check_length("particle size", list.len(), positions.len())?;
                if let Some((i, h)) = list.iter().enumerate().find(|(_, h)| !good(h)) {
                    return Err(OutputError::value(format!("size of particle {i}"), h, allowed));
                }
            }
            ParticleSize::Uniform(_) => {}
        }
        let (bodies, names) = (vec![0; positions.len()], Vec::new());
        Ok(Self {
            dimension,
            time,
            step,
            positions,
            size,
            bodies,
            names,
            fields: Vec::new(),
            cells: None,
            node_fields: Vec::new(),
        })
    }

    /// Assign a body index to each particle.
    ///
    /// # Errors
    /// A list of a length other than the number of particles.
    pub fn with_bodies(mut self, bodies: Vec<u32>) -> Result<Self, OutputError> {
        check_length("body", bodies.len(), self.len())?;
        self.bodies = bodies;
        Ok(self)
    }

    /// Set the names of the bodies by index, for legends and ParaView. Bodies beyond the end of the list are unnamed.
    #[must_use]
    pub fn with_body_names<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.names = names.into_iter().map(Into::into).collect();
        self
    }

    /// Set the cells of the particles.
    ///
    /// # Errors
    /// Lists that are not valid cells, one per particle.
    pub fn with_cells(mut self, cells: Cells) -> Result<Self, OutputError> {
        cells.check(self.len(), self.dimension)?;
        self.cells = Some(cells);
        Ok(self)
    }

    /// Add a field of any kind.
    ///
    /// # Errors
    /// A list of a length other than the number of particles; a name that is empty, taken, reserved (`body`,
    /// `size`), or contains control characters.
    pub fn with_field(mut self, name: impl Into<String>, values: FieldValues) -> Result<Self, OutputError> {
        let name = name.into();
        check_name("a field", &name)?;
        if name == "body" || name == "size" {
            let why = "`body` and `size` are written by the snapshot itself";
            return Err(OutputError::Name { what: "a field", name, why });
        }
        if self.fields.iter().any(|(taken, _)| *taken == name) {
            return Err(OutputError::Name { what: "a field", name, why: "each name may be used once" });
        }
        check_length(&format!("field {name:?}"), values.len(), self.len())?;
        self.fields.push((name, values));
        Ok(self)
    }

    /// Add a scalar field, SI units.
    ///
    /// # Errors
    /// Errors of [`with_field`](Self::with_field).
    pub fn with_scalar(self, name: impl Into<String>, values: Vec<f64>) -> Result<Self, OutputError> {
        self.with_field(name, FieldValues::Scalar(values))
    }

    /// Add a vector field, SI units.
    ///
    /// # Errors
    /// Errors of [`with_field`](Self::with_field).
    pub fn with_vector(self, name: impl Into<String>, values: Vec<[f64; 3]>) -> Result<Self, OutputError> {
        self.with_field(name, FieldValues::Vector(values))
    }

    /// Add a symmetric tensor field `[xx, yy, zz, yz, xz, xy]`, SI units.
    ///
    /// # Errors
    /// Errors of [`with_field`](Self::with_field).
    pub fn with_tensor(self, name: impl Into<String>, values: Vec<[f64; 6]>) -> Result<Self, OutputError> {
        self.with_field(name, FieldValues::Tensor(values))
    }

    /// Add a vector field of the nodes of the cells, SI units: point data in ParaView, whereas fields of cells are cell data. Free
    /// particles have the value of the particle field of that name, or 0.
    ///
    /// # Errors
    /// A snapshot without cells; a list of a length other than the number of nodes; a name that is empty, taken by another field of nodes,
    /// or contains control characters.
    pub fn with_node_vector(
        mut self,
        name: impl Into<String>,
        values: Vec<[f64; 3]>,
    ) -> Result<Self, OutputError> {
        let name = name.into();
        check_name("a field of nodes", &name)?;
        if self.node_fields.iter().any(|(taken, _)| *taken == name) {
            return Err(OutputError::Name {
                what: "a field of nodes",
                name,
                why: "each name may be used once",
            });
        }
        let nodes = self.cells.as_ref().map_or(0, |cells| cells.nodes.len());
        check_length(&format!("field {name:?} of nodes"), values.len(), nodes)?;
        self.node_fields.push((name, values));
        Ok(self)
    }

    /// All vector fields of nodes in the order of addition.
    pub fn node_vectors(&self) -> impl Iterator<Item = (&str, &[[f64; 3]])> {
        self.node_fields.iter().map(|(name, values)| (name.as_str(), values.as_slice()))
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True if there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number of dimensions, 2 or 3.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of steps.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Particle positions, m.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Edge length of particle `i`, m; beyond the end of a list, that of the last particle.
    #[must_use]
    pub fn size_of(&self, i: usize) -> f64 {
        match &self.size {
            ParticleSize::Uniform(h) => *h,
            ParticleSize::Each(list) => list.get(i).or(list.last()).copied().unwrap_or(0.0),
        }
    }

    /// Particle sizes, m.
    #[must_use]
    pub fn size(&self) -> &ParticleSize {
        &self.size
    }

    /// Body index of each particle.
    #[must_use]
    pub fn bodies(&self) -> &[u32] {
        &self.bodies
    }

    /// Names of the bodies by index; empty if unnamed.
    #[must_use]
    pub fn body_names(&self) -> &[String] {
        &self.names
    }

    /// Cells of the particles, if some are elements.
    #[must_use]
    pub fn cells(&self) -> Option<&Cells> {
        self.cells.as_ref()
    }

    /// All fields in the order of addition.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &FieldValues)> {
        self.fields.iter().map(|(name, values)| (name.as_str(), values))
    }

    /// Keep only the fields of these names.
    ///
    /// # Errors
    /// A name without a field; the error lists the available names.
    pub fn with_fields_only<S: AsRef<str>>(mut self, names: &[S]) -> Result<Self, OutputError> {
        let missing = names.iter().map(AsRef::as_ref).find(|name| self.fields.iter().all(|(n, _)| n != name));
        if let Some(name) = missing {
            let names: Vec<String> = self.fields.iter().map(|(n, _)| format!("{n:?}")).collect();
            let (kind, name, available) = ("such", name.to_string(), names.join(", "));
            return Err(OutputError::NoSuchField { kind, name, available });
        }
        self.fields.retain(|(name, _)| names.iter().any(|n| n.as_ref() == name));
        Ok(self)
    }

    /// Return a scalar field by name.
    ///
    /// # Errors
    /// No scalar field of that name; the error lists the available names.
    pub fn scalar(&self, name: &str) -> Result<&[f64], OutputError> {
        match self.fields.iter().find(|(n, _)| n == name) {
            Some((_, FieldValues::Scalar(values))) => Ok(values),
            _ => Err(self.no_such(FieldKind::Scalar, name)),
        }
    }

    /// Return a vector field by name.
    ///
    /// # Errors
    /// No vector field of that name; the error lists the available names.
    pub fn vector(&self, name: &str) -> Result<&[[f64; 3]], OutputError> {
        match self.fields.iter().find(|(n, _)| n == name) {
            Some((_, FieldValues::Vector(values))) => Ok(values),
            _ => Err(self.no_such(FieldKind::Vector, name)),
        }
    }

    /// Return a tensor field by name.
    ///
    /// # Errors
    /// No tensor field of that name; the error lists the available names.
    pub fn tensor(&self, name: &str) -> Result<&[[f64; 6]], OutputError> {
        match self.fields.iter().find(|(n, _)| n == name) {
            Some((_, FieldValues::Tensor(values))) => Ok(values),
            _ => Err(self.no_such(FieldKind::Tensor, name)),
        }
    }

    /// Bounding box of the particles at finite positions within 1e30 m of the origin, particle sizes
    /// included, m; `None` if there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let mut lo = [f64::INFINITY; 3];
        let mut hi = [f64::NEG_INFINITY; 3];
        for (i, x) in self.positions.iter().enumerate() {
            if is_place(x) {
                let half = 0.5 * self.size_of(i);
                for d in 0..self.dimension {
                    lo[d] = lo[d].min(x[d] - half);
                    hi[d] = hi[d].max(x[d] + half);
                }
            }
        }
        for d in self.dimension..3 {
            lo[d] = 0.0;
            hi[d] = 0.0;
        }
        (lo[0] <= hi[0]).then_some((lo, hi))
    }

    fn no_such(&self, kind: FieldKind, name: &str) -> OutputError {
        let names: Vec<String> =
            self.fields.iter().filter(|(_, v)| v.kind() == kind).map(|(n, _)| format!("{n:?}")).collect();
        let available = if names.is_empty() { "none".to_string() } else { names.join(", ") };
        OutputError::NoSuchField { kind: kind.word(), name: name.to_string(), available }
    }
}
