//! Coupling of finite elements and particles in one scene.
//!
//! At small strain elements are cheaper and more accurate than particles; at large strain particles avoid mesh tangling. Bodies of small
//! strain are therefore elements, those of large strain particles, coupled by contact \[Zhang2017\]:
//!
//! | coupling | contact | element size |
//! |---|---|---|
//! | [`Elements::on_the_grid`] (CFEMP, \[Lian2011\]) | grid contact of the scene | about a cell: particles slip through wider meshes |
//! | [`Elements::by_surface`] (ICFEMP, \[Chen2015\]) | point to surface, particles against facets ([`mpm_contact::mesh`]) | any |
//! | [`Elements::within`] (HFEMP, \[Lian2011b\]) | none: elements are embedded in a body of particles (bars in concrete) | any |
//! | [`Elements::converting`] (MPFEM \[Zhang2006\], AFEMP \[Lian2012\]) | none within a body; grid contact with others | any |
//!
//! On the grid, mesh nodes contribute to the grid like particles; embedded nodes move with the matter of the body. Elements are converted
//! to particles by the rules of a [`Conversion`]. Contact between bodies of elements of one client, and self-contact, is defined in their
//! [`Fem`](fem::Fem) ([`fem::Fem::touch`]): it acts at the end of its step, after the impulses of particles.
//!
//! The review \[Zhang2017\] prints no numbers of cases; the principles are implemented, with acceptance tests of our own (book, "Elements,
//! particles, or both").
//!
//! ```
//! use coupling::Elements;
//! use fem::{Fem, MeshBody};
//! use impactite_geometry::{Cuboid, Filling, Lattice, fill, structured::box_mesh};
//! use mpm_contact::Coulomb;
//! use mpm_core::{BlockGrid, Method, Mpm, PlaneStrain};
//! use mpm_materials::{LinearElastic, Moduli, NeoHookean};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A steel block of elements falls on rubber of particles.
//! let steel = LinearElastic::new(7850.0, Moduli::young_poisson(200e9, 0.3)?)?;
//! let mesh = box_mesh(&Cuboid::new([0.3, 0.501], [0.6, 0.7])?, [6, 4])?;
//! let mut elements = Fem::new(PlaneStrain);
//! elements.add(MeshBody::new("block", mesh, steel).moving(|_| [0.0, -2.0]))?;
//!
//! let lattice = Lattice::new([0.0; 2], 0.05)?;
//! let seeds = fill(&Cuboid::new([0.1, 0.2], [0.8, 0.5])?, &lattice, 2, &Filling::new())?;
//! let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
//! mpm.add("rubber", NeoHookean::new(1100.0, Moduli::young_poisson(2e6, 0.4)?)?, &seeds, |_| [0.0; 2])?;
//! mpm.add_client(Elements::by_surface(elements, Coulomb::new(0.3)?)?)?;
//! let start = mpm.totals().momentum;
//! mpm.run_until(2.0e-3)?;
//! assert!((mpm.totals().momentum[1] - start[1]).abs() < 1e-9 * start[1].abs());
//! assert!(mpm.bodies()[0].totals().momentum[1] < 0.0);
//! # Ok(())
//! # }
//! ```

mod bond;
mod cells;
mod conversion;
mod element;
mod elements;
mod elements_in_liquid;
mod leapfrog;
mod particles;
mod particles_in_liquid;
mod surface;
mod tied;

pub use bond::{BondLaw, BondState, LinearBond, ModelCodeBond};
pub use conversion::{Conversion, ConversionBook, ConversionLog, Particles, Share};
pub use elements::Elements;
pub use elements_in_liquid::ElementsInLiquid;
pub use particles_in_liquid::ParticlesInLiquid;
