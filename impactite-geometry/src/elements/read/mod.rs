//! Meshes of elements from files.

mod abaqus;
mod builder;
mod gmsh;

use std::path::Path;

use super::change::reverse;
use super::reference::Reference;
use super::{ElementMesh, MeshError};
use crate::cursor::ReadError;
use crate::error::{Check, GeometryError};
use crate::file::{Kind, read};
use builder::Builder;

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
    /// - Every physical group becomes a set of its nodes, of points, curves and surfaces too, and one of the highest dimension an element set
    ///   of all its elements, those of other groups among them ([`only_groups`](Self::only_groups)).
    /// - Elements that are inverted at every corner are numbered the other way round (a surface that faces down); nodes without an
    ///   element are dropped.
    /// - Bars, triangles, quadrilaterals, tetrahedra, bricks, prisms and pyramids are read, those of second order by their corners. Prisms
    ///   and pyramids become tetrahedra that conform to each other; a brick that shares a quadrilateral with one of them is refused.
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
    /// - Elements: C3D4 to C3D20 with C3D5 and C3D6; CPS, CPE and CAX of 3 to 8 nodes; shells (S, STRI), membranes (M3D, SFM3D) and
    ///   rigid faces (R3D) as the triangles and quadrilaterals that they are; T2D2, T3D2, B21 and B31 as bars; letters after the number (R,
    ///   I, M, H, T, ...) change nothing. All others are refused by name. Elements of second order are read by their corners. Wedges and
    ///   pyramids become tetrahedra that conform to each other; a brick that shares a quadrilateral with one of them is refused.
    /// - In a file with elements of three dimensions, those of two are sets of nodes alone; bars remain (edges that Gmsh
    ///   writes as T3D2 are left out by [`only_groups`](Self::only_groups)).
    /// - Parts (`*PART`) are read as their instances (`*INSTANCE`) place them, translated and then rotated; one part alone needs no
    ///   instance. Nodes, elements and sets may be in the part, in the instance or in the assembly.
    /// - A block holds the elements of a kind and a set: that of their `*ELEMENT` line, else the first `*ELSET` that has them.
    /// - Every NSET becomes a node set; every ELSET an element set, which may share elements with others, and the set of its nodes unless an
    ///   NSET has its name; every instance an element set of its name. Sets of several instances with one name are `INSTANCE.SET`. Names are
    ///   compared without regard to case.
    /// - `*INCLUDE`, and INPUT of `*NODE` and `*ELEMENT`, name files in the folder of the file that names them, or in that of the main file.
    /// - Coordinates are rectangular, or cylindrical with an angle in degrees (`SYSTEM=C` of `*NODE`).
    /// - Elements that are inverted at every corner are numbered the other way round; nodes without an element are dropped.
    /// - What makes or moves nodes and elements (`*NGEN`, `*NFILL`, `*NCOPY`, `*NMAP`, `*ELGEN`, `*ELCOPY`, `*SYSTEM`) is refused. Other
    ///   keywords describe no mesh and are skipped. Keywords and parameters may be abbreviated to four and three letters.
    ///
    /// # Errors
    /// [`GeometryError::File`] with file and line, the keyword or parameter, and what is allowed; files that include themselves, more than 16 in
    /// a row or 10 000 in all, or that have more than 4 GiB together; else as [`check`](Self::check).
    pub fn read_abaqus(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let path = path.as_ref();
        let (name, bytes) = load(path, Kind::Abaqus)?;
        Self::from_file(&name, unit, abaqus::read(&bytes, Some(path)))
    }

    /// The mesh of the bytes of an Abaqus input file, which may include no others; `name` stands for the file in errors.
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
        Self::from_file(name, unit, abaqus::read(bytes, None))
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
