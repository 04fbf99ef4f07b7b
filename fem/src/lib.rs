//! Explicit finite elements: bars, quadrilaterals, bricks, triangles and tetrahedra with the laws of [`mpm_materials`], and the boundary
//! conditions, run loop, observers and checkpoints of [`impactite_scene`]. At small strain one-point elements are cheaper and more accurate
//! than particles; at large strain they turn inside out, which stops a run with the remedy.
//!
//! ```
//! use fem::{Fem, MeshBody};
//! use impactite_geometry::{ElementBlock, ElementKind, ElementMesh};
//! use impactite_scene::{Axisymmetric, Boundary, Side, Solver};
//! use mpm_materials::library;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A copper bar of 3.2 mm radius and 10 mm length, around its axis: 8 x 25 quadrilaterals.
//! let (across, along, h) = (8, 25, 0.4e-3);
//! let node = |i: u32, j: u32| j * (across + 1) + i;
//! let mut mesh = ElementMesh::default();
//! let mut quads = Vec::new();
//! for (j, i) in (0..=along).flat_map(|j| (0..=across).map(move |i| (j, i))) {
//!     mesh.nodes.push([f64::from(i) * h, f64::from(j) * h]);
//!     if i < across && j < along {
//!         quads.extend([node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
//!     }
//! }
//! mesh.blocks.push(ElementBlock { name: "bar".into(), kind: ElementKind::Quad4, nodes: quads });
//!
//! // It hits a rigid wall at 190 m/s.
//! let mut fem = Fem::new(Axisymmetric);
//! fem.add(MeshBody::new("bar", mesh, library::copper_taylor()).moving(|_| [0.0, -190.0]))?;
//! fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above })?;
//! fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
//! fem.run_until(2.0e-6)?;
//! assert!(fem.exchange().impulse[1] > 0.0);
//! assert!(fem.account().energy_error().abs() < 0.01);
//! # Ok(())
//! # }
//! ```
//!
//! | part | choices |
//! |---|---|
//! | [`Technology`] of quadrilaterals and bricks | [`OnePoint`](Technology::OnePoint) with [`Hourglass`] springs or dashpots, [`MeanDilatation`](Technology::MeanDilatation), [`Full`](Technology::Full) |
//! | [`Technology`] of triangles and tetrahedra | [`AveragedVolumes`](Technology::AveragedVolumes), [`Full`](Technology::Full) |
//! | bars | uniaxial stress; iteration of the law for the lateral strain at zero lateral stress |
//! | mass | lumped by row sums |
//! | bulk viscosity | by the law (`with_bulk_viscosity`); length: edge of a square (cube) of the element at rest |
//! | [`Erosion`] | by a state variable, failure, volume ratio, stable time step, or several of these at once |
//! | contact of bodies | [`Fem::touch`] with the laws of [`mpm_contact`] without memory; self-contact: [`Fem::touch_itself`] |
//! | space | `FullSpace`, `PlaneStrain`, `Axisymmetric`; `Line` for bars |
//! | conditions | [`Boundary`](impactite_scene::Boundary) except periodic ([`hold`](impactite_scene::Boundary::hold)); [`Fem::prescribe`] |
//!
//! # The step
//! Central difference time integration: velocities are those of half steps. Laws receive the displacement gradient with respect to the
//! midpoint configuration, in which a rotation has no strain. The parts of a step are public, so that a coupling can act between them:
//!
//! | part | |
//! |---|---|
//! | [`Fem::trial`] | trial velocities by internal forces and the body force |
//! | [`Trial::bodies`], [`ElementBody::add_impulse`] | a coupling reads nodes and surface facets, and adds impulses |
//! | [`Trial::finish`] | contact, conditions, positions, strains, stresses, internal forces, erosion, energy balance |
//!
//! The stable time step follows from an upper bound of the highest frequency of each element, exact for boxes of isotropic laws; it
//! includes hourglass stiffness and bulk viscosity. Bodies with a longer stable step may subcycle: one step for several of the scene
//! ([`Fem::set_subcycling`]).
//!
//! # Contact
//! Bodies pass through each other unless [`Fem::touch`] sets a contact law. Then node-to-facet contact acts between all bodies, and within
//! a body after [`Fem::touch_itself`]; the impulses of a step are solved for together ([`mpm_contact::mesh`]):
//!
//! ```
//! use fem::{Fem, MeshBody};
//! use impactite_geometry::{Cuboid, structured::box_mesh};
//! use impactite_scene::{PlaneStrain, Solver};
//! use mpm_contact::Coulomb;
//! use mpm_materials::{LinearElastic, Moduli};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Two equal steel bars of 0.1 m, of which one runs into the other.
//! let steel = || LinearElastic::new(7850.0, Moduli::young_poisson(200e9, 0.0)?);
//! let bar = |left: f64| box_mesh(&Cuboid::new([left, 0.0], [left + 0.1, 0.01])?, [50, 5]);
//! let mut fem = Fem::new(PlaneStrain);
//! fem.add(MeshBody::new("one", bar(0.0)?, steel()?).moving(|_| [10.0, 0.0]))?;
//! fem.add(MeshBody::new("other", bar(0.1)?, steel()?))?;
//! fem.touch(Coulomb::new(0.3)?)?;
//! fem.run_until(60e-6)?;
//! // The other one has all of it: waves ran to the free ends and back, and they let go after 40 us.
//! let other = fem.body(1).totals();
//! assert!((other.momentum[0] / other.mass - 10.0).abs() < 0.2);
//! assert!(fem.account().energy_error().abs() < 2e-3);
//! # Ok(())
//! # }
//! ```
//!
//! - Contact acts at the end of a step ([`Trial::finish`]) on the velocities after internal forces, body forces and impulses of couplings,
//!   with boundary conditions applied; nodes that conditions prescribe in all directions do not yield. Other conditions act after contact.
//!   Contact therefore also acts in a scene that is a client of another one.
//! - Contact does not limit the time step: a closing gap is stopped in the step in which it would become a penetration. Penalty springs
//!   ([`mpm_contact::Penalty`]) limit their own stiffness.
//! - Contact of subcycled bodies is enforced in each step of the scene, which is the shortest.
//! - Impulses do work on the mean of the velocities before and after the step: bodies at rest under load exchange no energy. The energy
//!   balance includes the heat of friction ([`Exchange::friction`](impactite_scene::Exchange)) and the plastic impact loss of nodes
//!   ([`Exchange::impacts`](impactite_scene::Exchange)); the latter is proportional to the mass of the nodes in contact, and decreases with
//!   the element size.
//! - Momentum is conserved to rounding; angular momentum too, except for friction in the step in which a gap closes
//!   ([`MeshStep::couple`](mpm_contact::mesh::MeshStep)).
//! - Facets uncovered by removed elements are in contact from the next step on; free nodes fly on without contact.
//!
//! # Energy balance
//! Internal energy is that of the laws plus the hourglass energy ([`ElementBody::hourglass_energy`]); a run warns if the latter exceeds 5 %
//! of the largest energy of a body. Mass and momentum are conserved to rounding, energy to second order in the time step; the energies of
//! laws in rate form are exact only to their elastic strain. Energy lost by erosion is booked as negative
//! [`Exchange::conversion`](impactite_scene::Exchange).
//!
//! # Limits
//! `f64` only. One law per body. Elements of a body that share no node interact by self-contact only. There is no edge-to-edge contact, and
//! no contact between bars; a node that a condition fixes in some directions yields to contact in all, until the condition acts.

mod body;
mod contact;
mod conversion;
mod erosion;
mod law;
mod leaving;
mod load;
mod motion;
mod pace;
mod push;
mod set;
mod shape;
mod solver;
mod states;
mod strain;
mod surface;
mod sweep;
mod technology;
mod view;

pub use body::{ElementBody, Eroded, MeshBody, Node};
pub use contact::ContactSurface;
pub use erosion::{Criterion, Erosion};
pub use leaving::ConvertedElement;
pub use load::{PressureHistory, SurfaceFacet, TractionHistory};
pub use solver::{Fem, Trial};
pub use technology::{Hourglass, Technology};
