//! VTK arrays of a frame, independent of the file format: names, types, component order.

use super::{Precision, VtkOptions};
use crate::{Cells, FieldValues, ParticleSize, Snapshot};

/// Number type of an array.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    UInt8,
    Int32,
    Int64,
    Float32,
    Float64,
}

/// Array of tuples with a fixed number of components, little-endian.
pub(super) struct Array<'a> {
    pub name: &'a str,
    pub kind: Kind,
    pub components: usize,
    pub bytes: Vec<u8>,
}

impl<'a> Array<'a> {
    /// Array of bytes, one per tuple.
    pub fn bytes(name: &'a str, bytes: Vec<u8>) -> Self {
        Array { name, kind: Kind::UInt8, components: 1, bytes }
    }

    /// Array of 32-bit integers, one per tuple.
    pub fn short(name: &'a str, numbers: impl Iterator<Item = i32>) -> Self {
        Array { name, kind: Kind::Int32, components: 1, bytes: numbers.flat_map(i32::to_le_bytes).collect() }
    }

    /// Array of 64-bit integers, one per tuple.
    pub fn long(name: &'a str, numbers: impl Iterator<Item = i64>) -> Self {
        Array { name, kind: Kind::Int64, components: 1, bytes: numbers.flat_map(i64::to_le_bytes).collect() }
    }

    /// Array in double precision.
    pub fn doubles(name: &'a str, components: usize, numbers: impl Iterator<Item = f64>) -> Self {
        let bytes = numbers.flat_map(f64::to_le_bytes).collect();
        Array { name, kind: Kind::Float64, components, bytes }
    }

    /// Array in the precision of fields.
    fn floats(
        name: &'a str,
        components: usize,
        numbers: impl Iterator<Item = f64>,
        options: VtkOptions,
    ) -> Self {
        match options.fields {
            Precision::Double => Array::doubles(name, components, numbers),
            Precision::Single => {
                let bytes = numbers.flat_map(|x| (x as f32).to_le_bytes()).collect();
                Array { name, kind: Kind::Float32, components, bytes }
            }
        }
    }

    /// Array of positions, m.
    pub fn points<'p>(points: impl Iterator<Item = &'p [f64; 3]>) -> Self {
        Array::doubles("Points", 3, points.flatten().copied())
    }
}

/// Field data of the frame: time (s), step and, if uniform, particle size (m).
pub(super) fn whole(snapshot: &Snapshot) -> Vec<Array<'static>> {
    let step = i64::try_from(snapshot.step()).unwrap_or(i64::MAX);
    let mut arrays = vec![
        Array::doubles("TimeValue", 1, std::iter::once(snapshot.time())),
        Array::long("Step", std::iter::once(step)),
    ];
    if let ParticleSize::Uniform(size) = snapshot.size() {
        arrays.push(Array::doubles("ParticleSize", 1, std::iter::once(*size)));
    }
    arrays
}

/// Body, size and fields of the particles, created lazily, so that only one array is in memory at a time.
pub(super) fn fields(snapshot: &Snapshot, options: VtkOptions) -> impl Iterator<Item = Array<'_>> {
    let bodies = snapshot.bodies().iter().map(|&b| i32::try_from(b).unwrap_or(i32::MAX));
    let sizes = match snapshot.size() {
        ParticleSize::Each(sizes) => Some(Array::floats("size", 1, sizes.iter().copied(), options)),
        ParticleSize::Uniform(_) => None,
    };
    let fields = snapshot.fields().map(move |(name, values)| match values {
        // Particle numbers: single precision would round them above 16 million.
        FieldValues::Scalar(v) if name == "particle" => Array::long(name, v.iter().map(|&x| x as i64)),
        FieldValues::Scalar(v) => Array::floats(name, 1, v.iter().copied(), options),
        FieldValues::Vector(v) => Array::floats(name, 3, v.iter().flatten().copied(), options),
        // VTK's order is XX YY ZZ XY YZ XZ, the field's xx yy zz yz xz xy.
        FieldValues::Tensor(v) => {
            let ordered = v.iter().flat_map(|t| [t[0], t[1], t[2], t[5], t[3], t[4]]);
            Array::floats(name, 6, ordered, options)
        }
    });
    std::iter::once(Array::short("body", bodies)).chain(sizes).chain(fields)
}

/// Vector fields of the points of [`Grid`]: values of the nodes, then of the free particles.
pub(super) fn node_fields(snapshot: &Snapshot, options: VtkOptions) -> impl Iterator<Item = Array<'_>> {
    let is_particle = |i: usize| snapshot.cells().is_some_and(|cells| cells.of(i).is_empty());
    snapshot.node_vectors().map(move |(name, nodes)| {
        let own = snapshot.vector(name).ok();
        let particles = (0..snapshot.len()).filter(|&i| is_particle(i));
        let values = particles.map(|i| own.map_or([0.0; 3], |values| values[i]));
        Array::floats(name, 3, nodes.iter().copied().chain(values).flatten(), options)
    })
}

/// VTK grid: points are the nodes of cells followed by the free particles.
pub(super) struct Grid {
    pub points: Vec<[f64; 3]>,
    /// Point indices of the corners, one cell after the other.
    pub connectivity: Vec<usize>,
    /// End of the corners of each cell in `connectivity`.
    pub ends: Vec<usize>,
    /// VTK types of the cells.
    pub kinds: Vec<u8>,
}

impl Grid {
    pub fn of(snapshot: &Snapshot, cells: &Cells) -> Self {
        let mut grid = Grid {
            points: cells.nodes.clone(),
            connectivity: Vec::with_capacity(cells.corners.len()),
            ends: Vec::with_capacity(snapshot.len()),
            kinds: Vec::with_capacity(snapshot.len()),
        };
        for (i, position) in snapshot.positions().iter().enumerate() {
            let corners = cells.of(i);
            grid.kinds.push(Cells::kind(corners.len(), snapshot.dimension()).unwrap_or(1));
            grid.connectivity.extend(corners.iter().map(|&corner| corner as usize));
            if corners.is_empty() {
                grid.connectivity.push(grid.points.len());
                grid.points.push(*position);
            }
            grid.ends.push(grid.connectivity.len());
        }
        grid
    }
}
