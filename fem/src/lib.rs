//! Explicit finite elements on the shared house: bars, quadrilaterals, bricks, triangles and tetrahedra with the laws of
//! [`mpm_materials`], and the conditions, run loop, observers and checkpoints of [`impactite_scene`]. At small strain one-point elements
//! are cheaper and more accurate than particles; at large strain they turn inside out, which stops a run with the remedy.
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
//! | of triangles and tetrahedra | [`AveragedVolumes`](Technology::AveragedVolumes), [`Full`](Technology::Full) |
//! | bars | stress along them alone; laws are asked for the strain across at which there is none |
//! | mass | row sums |
//! | bulk viscosity | that of the laws (`with_bulk_viscosity`), with the edge of a square (cube) of the element at rest for its length |
//! | [`Erosion`] | by a number of the state, failure, volume, stable step, all of several |
//! | contact of bodies | [`Fem::touch`] with the laws of [`mpm_contact`] that need no memory; with itself, [`Fem::touch_itself`] |
//! | space | `FullSpace`, `PlaneStrain`, `Axisymmetric`; `Line` of bars |
//! | conditions | those of [`Boundary`](impactite_scene::Boundary) but periodic ones ([`Boundary::hold`](impactite_scene::Boundary::hold)); sets of nodes ([`Fem::prescribe`]) |
//!
//! # The step
//! Central differences: velocities belong to the middle of steps. Laws get the gradient of the displacement with respect to the
//! configuration half way through the step, in which a rotation has no strain. A step is in public parts, so that a coupling can act:
//!
//! | part | |
//! |---|---|
//! | [`Fem::trial`] | forces of the elements and the body force make trial velocities |
//! | [`Trial::bodies`], [`ElementBody::add_impulse`] | others look at nodes and surface facets, and give impulses |
//! | [`Trial::finish`] | contact, conditions, positions, strains, laws, forces, erosion, books |
//!
//! Stable steps come from a bound of the highest frequency of each element, exact for boxes of isotropic laws; hourglass springs and
//! bulk viscosity are in it. Bodies with longer steps may make one for several of the others ([`Fem::set_subcycling`]).
//!
//! # Contact
//! Bodies pass through each other, unless [`Fem::touch`] names a law; then nodes of each meet facets of all others, and of their own
//! where [`Fem::touch_itself`] asks, by impulses of a step that are found together ([`mpm_contact::mesh`]):
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
//! - It acts where a step ends ([`Trial::finish`]), on the velocities that elements, body forces and impulses of others left, as
//!   conditions would hold them; nodes that conditions alone move (in all directions) do not yield. Others hold after it. So it also acts
//!   in a scene that is a client of another one.
//! - It needs no shorter steps: what closes is stopped in the step in which it would overlap. Springs ([`mpm_contact::Penalty`]) limit
//!   themselves.
//! - Bodies with steps of several lengths meet in each step of the scene, which is the shortest.
//! - Impulses work on the mean of velocities before and after the step: what rests under load takes and gives nothing. Heat of friction
//!   ([`Exchange::friction`](impactite_scene::Exchange)) and what nodes lose that stop each other
//!   ([`Exchange::impacts`](impactite_scene::Exchange)) are in the books; the latter is of the mass of the nodes that meet, and goes with
//!   the size of elements.
//! - Momentum is kept to rounding; angular momentum too but for friction in the step in which a gap closes
//!   ([`MeshStep::couple`](mpm_contact::mesh::MeshStep)).
//! - Where elements leave, what is behind them touches from the next step on; their nodes fly on and touch nobody.
//!
//! # Books
//! Internal energy is that of the laws and of hourglass forces ([`ElementBody::hourglass_energy`]), of which a run warns above 5 %.
//! Mass and momentum are kept to rounding; energy to the square of the step, but for laws in rate form, whose own energies are exact to
//! their elastic strain. What leaves by erosion is booked as negative [`Exchange::conversion`](impactite_scene::Exchange).
//!
//! # Limits
//! `f64` only. One law a body. Elements of a body that share no node know each other only where it touches itself. Contact does not
//! test edges against edges, nor bars against bars; a node that a condition holds in some directions yields to contact in all, until the
//! condition acts.

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
pub use load::{SurfaceFacet, TractionHistory};
pub use solver::{Fem, Trial};
pub use technology::{Hourglass, Technology};
