//! Bodies of finite elements and bodies of particles in one scene.
//!
//! At small strain elements are cheaper and more accurate than particles; at large strain particles do not tangle. So bodies of small
//! strain are elements, those of large strain particles, and contact joins them \[Zhang2017\]:
//!
//! | way | contact | sizes |
//! |---|---|---|
//! | [`Elements::on_the_grid`] (CFEMP, \[Lian2011\]) | nodes of the mesh act on the grid of the scene as particles do, and meet others by its contact algorithm | elements about as large as cells: through wider meshes particles slip |
//! | [`Elements::by_surface`] (ICFEMP, \[Chen2015\]) | particles meet the facets of the mesh one by one ([`mpm_contact::mesh`]) | any |
//! | [`Elements::within`] (HFEMP, \[Lian2011b\]) | none: elements are a part of a body of particles, bars in concrete; nodes move with its matter | any |
//! | [`Elements::converting`] (MPFEM \[Zhang2006\], AFEMP \[Lian2012\]) | none within a body: elements become particles, by the rules of a [`Conversion`]; on the grid with others | any |
//!
//! Bodies of elements of one client touch each other, and themselves, where their [`Fem`](fem::Fem) was told ([`fem::Fem::touch`]): at the end
//! of its step, after particles pushed them.
//!
//! The review that describes both prints no numbers of cases; what is built is the principle, held to gates of our own (book,
//! "Elements, particles, or both").
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
mod particles;
mod surface;
mod tied;

pub use bond::{BondLaw, BondState, LinearBond, ModelCodeBond};
pub use conversion::{Conversion, ConversionBook, ConversionLog, Particles, Share};
pub use elements::Elements;
