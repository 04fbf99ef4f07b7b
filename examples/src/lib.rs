//! Shared code of the cases of this crate: command-line options, table of checks and JSON result.
//!
//! | binary | case |
//! |---|---|
//! | `taylor_bar` | impact of a copper cylinder on a wall: final shape against finite elements and experiment |
//! | `expanding_ring` | radially expanding rings: final radius and time at rest against exact values; fragments of breaking rings |
//! | `ring_collision` | collision of two elastic rings: closest approach of the surfaces, energy error over the time step |
//! | `bouncing_blocks` | bars, discs, balls and a block on an incline in contact, against exact values |
//! | `ball_on_plate` | impact of a steel ball on a steel plate, one of elements, the other of particles: force and duration against Hertz |
//! | `pressed_balls` | loaded plate on a thousand balls: stress waves through contacts, cost of contact |
//! | `rolling_cylinder` | cylinder rolling or sliding down an incline: distance and spin against a rigid one |
//! | `shaken_discs` | three large and 207 small discs in a shaken container: rise of the large ones, rest of the pile |
//! | `oblique_penetration` | ogive rod through an aluminium plate: residual speed against experiment |
//! | `concrete_perforation` | ogive rod through a slab of concrete: residual speeds of seven shots, cracks |
//! | `reinforced_slab` | slab of concrete with steel bars under rod impact and blast: effect of the bars, as lines and as particles |
//! | `granular_column` | collapse of a column of aluminium bars: run-out and deposit against published fits |
//! | `slope_failure` | failure of a soil slope: strength at failure and slip surface against Bishop's slip circles |
//! | `plate_impact` | impact of two plates: Hugoniot lines of the library's metals, spall |
//! | `tnt_slab` | slab of TNT burning from a wall: front, pressure and Taylor wave against exact flow |
//! | `debris_cloud_2d` | disc through a plate at 5 km/s, by the particle-contact meshfree method |
//! | `elastic_bar` | elastic bar hitting a wall, by the particle-contact meshfree method, against the exact solution |
//! | `taylor_copper` | long copper bar hitting a wall: particle contacts (original and consistent), MPM, finite elements, fragile points |
//! | `taylor_4340` | steel bars hitting a wall at three speeds, by SPH: original form, updated and total Lagrangian |
//! | `tungsten_bullet` | tungsten bullet through an aluminium plate, by particle contacts and by MPM, against theory |
//! | `plug_weldox` | blunt projectile punching a plug out of a steel plate, by SPH: size of the plug, residual velocity |
//! | `kalthoff` | edge impact on a plate with notches, by fragile points: crack at 70 degrees, or shear band |
//! | `glass_branching` | crack branching in glass under tension, by fragile points |
//! | `pcmm_distortion` | scenes that the original rules of the particle-contact method fail, and those of the library do not |
//! | `debris_cloud` | lead sphere through a lead plate: debris cloud with and without particle splitting |
//! | `debris_cloud_3d` | aluminium sphere through a plate of particles, and through one of elements that become particles |
//! | `tnt_cased` | TNT in copper, cylinder and cube: speed of the case |
//! | `exploding_cylinder` | copper cylinders burst by TNT: speed over the mass ratio against Gurney, fragments |
//! | `gate_flow` | water behind an elastic gate that opens: tip displacement, statics against beams, dam break against experiment |
//! | `dam_break` | incompressible dam break: first pressure, shallow flow, front and pressure against experiments |
//! | `sloshing` | incompressible liquid in a tank: natural periods, forced sway, viscous decay, 20 s of free sloshing |
//! | `floating_box` | rigid box floating in incompressible liquid: depth, period of heave, light box, box that rolls over, free fall |
//! | `drop` | free drops: elliptic drop, oscillation by surface tension, square and cube to circle and sphere, drop at rest |
//! | `taylor_green` | viscous flow: Taylor-Green vortices, start of Poiseuille and Couette flow, with observed orders |
//! | `wedge_entry` | wedge entering water, elements of one to eight cells, and incompressible flow: leakage, forces against theory |
//! | `wave_plate` | waves along a plate pulled at its end, by fragile points, against exact ones: peaks, convergence orders |
//! | `cantilever_pulse` | cantilever under a shear pulse, by fragile points, against finite elements: tip, modes, stress |
//! | `validation` | all cases: writes docs/validation.md |
//! | `throughput` | particle updates per second on fixed scenes |
//!
//! Exit code: 0 if the run ends and every failed check is a known miss ([`Check::known_miss`]); known misses still count as
//! missed. Otherwise 1. Rules of judgement: [`check`].

pub mod blocks;
pub mod case;
mod cased;
pub mod check;
pub mod cost;
pub mod cracks;
mod detection;
pub mod fragile;
mod fragments;
mod heap;
mod immersed;
mod law;
mod liquid;
pub mod machine;
pub mod martin_moyce;
mod meeting;
pub mod methods;
mod ogive;
mod outline;
pub mod peers;
pub mod plug;
mod restart;
pub mod series;
pub mod throughput;
mod water;

pub use case::{CaseError, Common, Report, Resolution, Totals, largest, within, worst};
pub use cased::Cased;
pub use check::{Check, NotJudged};
pub use detection::Detection;
pub use fragments::{Fragments, mott_strains};
pub use heap::Heap;
pub use immersed::{WATER_PRESSURE, immersed};
pub use law::Law;
pub use liquid::{FlowRun, FlowRuns, FlowScheme, liquid};
pub use meeting::Coupling;
pub use ogive::Ogive;
pub use outline::{Inside, Outline};
pub use restart::{Restart, Simulation};
pub use water::{Transfer, Water, WaterState};
