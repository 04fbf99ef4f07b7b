//! Meshes of elements from files.

mod abaqus;
mod builder;
mod cursor;
mod gmsh;

use std::path::Path;

use super::change::reverse;
use super::reference::Reference;
use super::{ElementMesh, MeshError};
use crate::error::{Check, GeometryError};
use crate::file::{Kind, read};
use builder::Builder;
use cursor::ReadError;

impl<const D: usize> ElementMesh<D> {
    /// Numbers those elements the other way round that are inverted at every corner, and leaves the others.
    fn oriented(mut self) -> Result<Self, MeshError> {
        self.check_numbers()?;
        let mut blocks = std::mem::take(&mut self.blocks);
        for block in blocks.iter_mut().filter(|b| b.kind.dimensions() == D) {
            let kind = block.kind;
            let reference = Reference::new(kind);
            for nodes in block.nodes.chunks_exact_mut(kind.nodes()) {
                if reference.element(&self, nodes).corners().all(|j| j.value < 0.0) {
                    reverse(kind, nodes);
                }
            }
        }
        self.blocks = blocks;
        Ok(self)
    }

    /// Reads a Gmsh file of version 2.0 to 2.2, 4.0 or 4.1, ASCII or binary. Coordinates are multiplied by `unit` (m): 1e-3 for a file in mm.
    ///
    /// - The elements of the highest dimension there is become blocks, one for each kind and physical group (the first one of their entity),
    ///   whose name they take; without a name `physical 7`, without a group none.
    /// - Every physical group, of points, curves and surfaces too, becomes a set of its nodes.
    /// - Elements that are inverted at every corner are numbered the other way round (a surface that faces down); nodes without an
    ///   element are dropped.
    /// - Bars, triangles, quadrilaterals, tetrahedra and bricks are allowed, those of second order as what their corners make; prisms and
    ///   pyramids are refused by name.
    /// - In fewer than three dimensions the remaining coordinates must be zero to rounding.
    /// - Of the sections, `$PhysicalNames`, `$Entities`, `$Nodes` and `$Elements` are read, `$PartitionedEntities` is refused, others are
    ///   skipped (as data of post-processing).
    ///
    /// # Errors
    /// [`GeometryError::File`] with the line (or the byte of a binary file), what was expected and what was found; else as
    /// [`check`](Self::check).
    pub fn read_gmsh(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Gmsh)?;
        Self::from_gmsh(&name, &bytes, unit)
    }

    /// The mesh of the bytes of a Gmsh file; `name` stands for the file in errors.
    ///
    /// ```
    /// use impactite_geometry::{ElementMesh, Metric};
    /// let file = b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n\
    /// $Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n2 0 0\n0 1 0\n$EndNodes\n\
    /// $Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n";
    /// let mesh = ElementMesh::<2>::from_gmsh("one.msh", file, 1e-3)?;
    /// assert_eq!(mesh.measure(Metric::Cartesian)?, 1e-6);
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// As [`read_gmsh`](Self::read_gmsh).
    pub fn from_gmsh(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Self::from_file(name, unit, gmsh::read(bytes))
    }

    /// Reads the mesh of an Abaqus input file. Coordinates are multiplied by `unit` (m): 1e-3 for a file in mm.
    ///
    /// - `*NODE` (NSET), `*ELEMENT` (TYPE, ELSET), `*NSET` and `*ELSET` (GENERATE) are read. Elements: C3D8, C3D8R, C3D4, CPE4, CPE4R,
    ///   CAX4, CAX4R, CPE3, CAX3, and T2D2, T3D2, B31 as bars; all others are refused by name (also the CPS3 and CPS4 that Gmsh writes for
    ///   faces: read its own files).
    /// - A block holds the elements of a kind and a set: that of their `*ELEMENT` line, else the first `*ELSET` that has them.
    /// - Every NSET becomes a node set, and every ELSET the set of its nodes unless an NSET has its name. Names are compared without regard
    ///   to case.
    /// - Elements that are inverted at every corner are numbered the other way round; nodes without an element are dropped.
    /// - One `*PART` and one `*INSTANCE` that is not moved are allowed; what makes or moves nodes and elements (`*NGEN`, `*NFILL`, `*NCOPY`,
    ///   `*NMAP`, `*ELGEN`, `*ELCOPY`, `*SYSTEM`, `*INCLUDE`) is refused. Other keywords describe no mesh and are skipped.
    ///
    /// # Errors
    /// [`GeometryError::File`] with the line, the keyword or parameter, and what is allowed; else as [`check`](Self::check).
    pub fn read_abaqus(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Abaqus)?;
        Self::from_abaqus(&name, &bytes, unit)
    }

    /// The mesh of the bytes of an Abaqus input file; `name` stands for the file in errors.
    ///
    /// ```
    /// use impactite_geometry::{ElementMesh, Metric};
    /// let file = b"*NODE, NSET=ALL\n1, 0., 0.\n2, 2., 0.\n3, 2., 1.\n4, 0., 1.\n\
    /// *ELEMENT, TYPE=CAX4R, ELSET=ROD\n1, 1, 2, 3, 4\n";
    /// let mesh = ElementMesh::<2>::from_abaqus("one.inp", file, 1e-3)?;
    /// assert_eq!(mesh.blocks[0].name, "ROD");
    /// assert_eq!(mesh.node_sets["ALL"], [0, 1, 2, 3]);
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// As [`read_abaqus`](Self::read_abaqus).
    pub fn from_abaqus(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Self::from_file(name, unit, abaqus::read(bytes))
    }

    fn from_file(name: &str, unit: f64, builder: Result<Builder, ReadError>) -> Result<Self, GeometryError> {
        Check("element mesh").positive("unit", unit)?;
        let refuse = |reason: String| GeometryError::File { path: name.into(), reason };
        let mesh = builder.and_then(|builder| builder.build(unit)).map_err(|e| refuse(e.to_string()))?;
        let checked = || -> Result<Self, GeometryError> {
            let mesh = mesh.oriented()?.without_unused_nodes();
            mesh.check()?;
            Ok(mesh)
        };
        checked().map_err(|e| refuse(e.to_string()))
    }
}

fn load(path: &Path, kind: Kind) -> Result<(String, Vec<u8>), GeometryError> {
    let name = path.display().to_string();
    match read(path, kind) {
        Ok(bytes) => Ok((name, bytes)),
        Err(reason) => Err(GeometryError::File { path: name, reason }),
    }
}
