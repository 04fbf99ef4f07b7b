//! Mesh readers: Gmsh and Abaqus files.

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
    /// Reverse the node order of elements that are inverted at every corner; leave the others.
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

    /// Read a Gmsh file of version 2.0 to 2.2, 4.0 or 4.1, ASCII or binary. Coordinates are multiplied by `unit` (m): 1e-3 for mm.
    ///
    /// - Elements of the highest dimension in the file become blocks, one for each kind and physical group (the first one of their entity).
    ///   A block is named after its group: `physical 7` if the group has no name, empty if there is no group.
    /// - Every physical group becomes a node set, groups of points, curves and surfaces too. One of the highest dimension also becomes an
    ///   element set of all its elements, including those that are in other groups ([`only_groups`](Self::only_groups)).
    /// - The node order of elements that are inverted at every corner is reversed (a surface that faces down); nodes without an
    ///   element are removed.
    /// - Bars, triangles, quadrilaterals, tetrahedra, bricks, prisms and pyramids are read; of second-order elements the corners only.
    ///   Prisms and pyramids are split into conforming tetrahedra; a brick that shares a quadrilateral with one of them is an error.
    /// - In fewer than three dimensions the remaining coordinates must be zero to rounding.
    /// - The sections `$PhysicalNames`, `$Entities`, `$Nodes` and `$Elements` are read, `$PartitionedEntities` is an error, others are
    ///   skipped (such as post-processing data).
    ///
    /// # Errors
    /// [`GeometryError::File`] with the line (or the byte of a binary file), the expected and the found value; errors of
    /// [`check`](Self::check).
    pub fn read_gmsh(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let (name, bytes) = load(path.as_ref(), Kind::Gmsh)?;
        Self::from_gmsh(&name, &bytes, unit)
    }

    /// Read the mesh from the bytes of a Gmsh file; `name` is the file name in errors.
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
    /// Errors of [`read_gmsh`](Self::read_gmsh).
    pub fn from_gmsh(name: &str, bytes: &[u8], unit: f64) -> Result<Self, GeometryError> {
        Self::from_file(name, unit, gmsh::read(bytes))
    }

    /// Read the mesh of an Abaqus input file. Coordinates are multiplied by `unit` (m): 1e-3 for a file in mm.
    ///
    /// - Elements: C3D4 to C3D20 with C3D5 and C3D6; CPS, CPE and CAX of 3 to 8 nodes; shells (S, STRI), membranes (M3D, SFM3D) and
    ///   rigid faces (R3D) as triangles and quadrilaterals; T2D2, T3D2, B21 and B31 as bars; letters after the number (R,
    ///   I, M, H, T, ...) are ignored. All other types are an error. Of second-order elements the corners only are read. Wedges and
    ///   pyramids are split into conforming tetrahedra; a brick that shares a quadrilateral with one of them is an error.
    /// - In a file with three-dimensional elements, two-dimensional elements become node sets only; bars remain (edges that Gmsh
    ///   writes as T3D2 are excluded by [`only_groups`](Self::only_groups)).
    /// - Parts (`*PART`) are read at the position of their instances (`*INSTANCE`), translated and then rotated; a single part needs no
    ///   instance. Nodes, elements and sets may be in the part, in the instance or in the assembly.
    /// - A block contains the elements of a kind and a set: the set of their `*ELEMENT` line, else the first `*ELSET` that contains them.
    /// - Every NSET becomes a node set. Every ELSET becomes an element set, which may share elements with others, and a set of its nodes
    ///   unless an NSET has its name. Every `*SURFACE` of faces of elements (`set, S1`) or of node sets becomes a set of its nodes unless
    ///   an NSET has its name. Every instance becomes an element set of its name. Sets of equal name in several instances become
    ///   `INSTANCE.SET`. Names are compared without regard to case.
    /// - `*INCLUDE`, and INPUT of `*NODE` and `*ELEMENT`, refer to files in the folder of the including file, or in that of the main file.
    /// - Coordinates are rectangular, or cylindrical with an angle in degrees (`SYSTEM=C` of `*NODE`).
    /// - The node order of elements that are inverted at every corner is reversed; nodes without an element are removed.
    /// - Keywords that generate or move nodes and elements (`*NGEN`, `*NFILL`, `*NCOPY`, `*NMAP`, `*ELGEN`, `*ELCOPY`, `*SYSTEM`) are an
    ///   error. Keywords that do not describe a mesh are skipped. Keywords and parameters may be abbreviated to four and three letters.
    ///
    /// # Errors
    /// [`GeometryError::File`] with file and line, the keyword or parameter, and the allowed values; recursive includes, an include depth
    /// above 16, more than 10 000 files or 4 GiB in all; errors of [`check`](Self::check).
    pub fn read_abaqus(path: impl AsRef<Path>, unit: f64) -> Result<Self, GeometryError> {
        let path = path.as_ref();
        let (name, bytes) = load(path, Kind::Abaqus)?;
        Self::from_file(&name, unit, abaqus::read(&bytes, Some(path)))
    }

    /// Read the mesh from the bytes of an Abaqus input file without included files; `name` is the file name in errors.
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
    /// Errors of [`read_abaqus`](Self::read_abaqus).
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
