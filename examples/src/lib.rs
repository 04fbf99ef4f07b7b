//! What the cases of this crate share: the options every binary understands, the table of checks it prints,
//! and the JSON object it ends with.
//!
//! | binary | case |
//! |---|---|
//! | `taylor_bar` | a copper cylinder hits a wall: final shape against finite elements and experiment |
//! | `expanding_ring` | rings thrown outwards: radius and time at rest against exact ones; pieces of those that break |
//! | `ring_collision` | two elastic rings collide: where their surfaces meet, energy over the time step |
//! | `bouncing_blocks` | bars, discs, balls and a block on an incline in contact, against exact values |
//! | `ball_on_plate` | a steel ball strikes a steel plate, one of elements, the other of particles: force and duration against Hertz |
//! | `pressed_balls` | a loaded plate on a thousand balls: stress waves through contacts, and what contact costs |
//! | `rolling_cylinder` | a cylinder rolls or slides down an incline: way and spin against a rigid one |
//! | `shaken_discs` | three large and 207 small discs in a shaken container: the large ones rise, the pile rests |
//! | `oblique_penetration` | an ogive rod through an aluminium plate: residual speed against experiment |
//! | `concrete_perforation` | an ogive rod through a slab of concrete: residual speeds of seven shots, cracks |
//! | `reinforced_slab` | a slab of concrete with bars of steel, hit by a rod and by a blast: what bars hold back, as lines and as particles |
//! | `granular_column` | a column of aluminium bars collapses: run-out and deposit against published fits |
//! | `slope_failure` | a slope of soil fails: strength at failure and slip surface against circles of Bishop |
//! | `plate_impact` | a plate hits a plate: shock lines of the library's metals, spall |
//! | `tnt_slab` | a slab of TNT burns from a wall: the front, the pressure and the wave behind it against exact flow |
//! | `debris_cloud_2d` | a disc goes through a plate at 5 km/s, by the particle-contact meshfree method |
//! | `elastic_bar` | an elastic bar hits a wall, by the particle-contact meshfree method, against the exact solution |
//! | `taylor_copper` | a long copper bar hits a wall, by particle contacts, as printed and ours, by MPM, finite elements and fragile points |
//! | `taylor_4340` | steel bars hit a wall at three speeds, by smoothed particles as printed, updated and total Lagrangian |
//! | `tungsten_bullet` | a tungsten bullet goes through an aluminium plate, by particle contacts and by MPM, against theory |
//! | `plug_weldox` | a blunt projectile punches a plug out of a steel plate, by smoothed particles: size of the plug, residual velocity |
//! | `kalthoff` | a plate with notches is struck at its edge, by fragile points: a crack at 70 degrees, or a shear band |
//! | `glass_branching` | a crack in glass under tension branches, by fragile points |
//! | `pcmm_distortion` | what fails with the printed rules of the particle-contact method, and what does not with ours |
//! | `debris_cloud` | a lead sphere through a lead plate: the cloud, seeded and split |
//! | `debris_cloud_3d` | an aluminium sphere through a plate of particles, and one of elements that become particles |
//! | `tnt_cased` | TNT in copper, cylinder and cube: speed of the case |
//! | `exploding_cylinder` | cylinders of copper burst by TNT: speed over the mass ratio against Gurney with the energy of the products, pieces |
//! | `gate_flow` | water behind an elastic gate that opens: its tip, statics against beams, a dam break against experiment |
//! | `wedge_entry` | a wedge enters water, elements of one to eight cells: what comes through, forces against theory |
//! | `wave_plate` | waves along a plate that is drawn at its end, by fragile points, against exact ones: peaks, orders |
//! | `cantilever_pulse` | a cantilever under a shear pulse, by fragile points, against finite elements: tip, modes, stress |
//! | `validation` | runs all cases and writes docs/validation.md |
//! | `throughput` | particle updates a second on fixed scenes |
//!
//! The exit code is 0 if the run came to its end and missed no row of its table but those that are declared as missed
//! ([`Check::known_miss`]), which count as missed all the same; it is 1 otherwise. Which rows are judged: [`check`].

pub mod blocks;
pub mod case;
mod cased;
pub mod check;
pub mod cracks;
mod detection;
pub mod fragile;
mod fragments;
mod heap;
mod immersed;
mod law;
pub mod machine;
mod meeting;
pub mod methods;
mod ogive;
mod outline;
pub mod peers;
pub mod plug;
mod restart;
pub mod throughput;
mod water;

pub use case::{CaseError, Common, Report, Resolution, Totals, largest, within, worst};
pub use cased::Cased;
pub use check::{Check, NotJudged};
pub use detection::{Detection, Detector, Normals};
pub use fragments::{Fragments, mott_strains};
pub use heap::Heap;
pub use immersed::{WATER_PRESSURE, immersed};
pub use law::Law;
pub use meeting::Coupling;
pub use ogive::Ogive;
pub use outline::{Inside, Outline};
pub use restart::{Restart, Simulation};
pub use water::{Transfer, Water, WaterState};
