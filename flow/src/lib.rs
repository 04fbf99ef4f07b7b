//! Incompressible free-surface flow: particles on a staggered (MAC) grid, in the plane and in space.
//!
//! A [`Flow`] is a [`Solver`](impactite_scene::Solver) of bodies of one liquid among [`Wall`]s of any shape.
//!
//! # Equations
//! ```text
//! rho dv/dt = -grad p + div(mu (grad v + grad v^T)) + rho b,    div v = 0,    p = p_ambient + sigma kappa at the surface
//! ```
//! with the density rho, the viscosity mu, the body force b (gravity, frame of a moving tank), the surface tension sigma and the curvature
//! kappa. The normal viscous stress at the surface is left out.
//!
//! # Bodies that the liquid moves
//! The velocities of a [`RigidBody`] that the liquid moves are unknowns of the pressure equation, which gets the term rho h^D G M^-1 G^T
//! with the net outflow G V of the cells beside the body and its mass matrix M. Prescribed walls move and turn.
//! [`Deformable`] bodies are another solver, as finite elements; liquid and bodies are iterated in each step until their velocities agree.
//!
//! # Step
//! Velocities belong to the middles between positions (leap-frog); forces act over the mean of two successive steps.
//!
//! 1. Sort the particles into blocks of 4^D cells; cut the cells by the walls: open fractions of faces by the signed distance at nodes.
//! 2. Transfer volume and momentum to the faces, by multilinear weights and an affine matrix for each particle (\[Jiang2017\]).
//! 3. Find the liquid fraction c of each cell, over the open share of its kernel. The inverse of its profile at a flat surface makes the
//!    level set of it: no union of balls, which would be half a cell too thick. A cell with less than half of its kernel in liquid is air;
//!    particles far from liquid cells move freely.
//! 4. Apply half of the body force, the viscous stress, and the other half.
//! 5. Solve the Poisson equation of the pressure with (2D+1) points, ghost-fluid theta at the surface (\[Gibou2002\]), at least 0.01, and open
//!    fractions (\[Batty2007\], \[Ng2009\]), by conjugate gradients with a multigrid preconditioner (`impactite-solve`). Periodic scenes have
//!    the Jacobi preconditioner.
//! 6. Extrapolate the changes of velocity to the faces beyond the liquid; apply the walls.
//! 7. Interpolate velocities and affine matrices to the particles, and move them.
//! 8. Displace them by -grad q with div grad q = -(c - 1), relaxed, so that volume is kept.
//!
//! **Reflection.** The projected velocity is that at the positions. Twice its change makes the velocity in the middle of the next step, so that
//! neither rotation nor translation loses energy to the splitting (\[Zehnder2018\], here with one solve a step). Divergence above 2 % of a
//! cell in a step comes from impacts and is projected once, without reflection, since liquid does not bounce.
//! A tenth of the divergence is not reflected, which damps pressures that alternate from step to step.
//! [`FlowOptions::without_reflection`] is the first-order scheme of most codes, with a Runge-Kutta step for positions.
//!
//! **Step size.** The Courant factor limits the displacement to a share of a cell, gravity to sqrt(h / g), and surface tension to
//! sqrt(rho h^3 / (4 pi sigma)) (\[Brackbill1992\]).
//!
//! # Semi-staggered scheme
//! [`FlowOptions::semi_staggered`] is the scheme of \[Zhang2017b\], as printed, for comparison: velocities at nodes, pressure at the centres of
//! cells, a 7-point Laplacian that is not the divergence of the gradient at the nodes, a filter of hourglass modes, FLIP with a share of PIC, and
//! the surface of balls around the particles. `cargo run --release -p impactite-flow --example schemes` prints both beside each other.
//! The level set that is advected, of its drops, is not there.
//!
//! # Balances
//! The work of the body force is that of all displacements, those of the density correction included. Impulses of walls are those of the
//! pressure on their areas and of the mass at closed faces. What the transfer loses of momentum is booked as dropped: below 0.1 % of the
//! momentum in the collision of two drops, 0 in free fall. The energy of the surface is in no balance, so that energy is not judged with
//! surface tension. Heat of viscosity is internal energy.
//!
//! # Measured
//! By the tests of the crate, 4 particles a cell in the plane and 8 in space.
//!
//! | case | measured |
//! |---|---|
//! | hydrostatic pressure, theta 0.01 to 0.99, plane and space | exact to 2e-11 |
//! | pressure of a column at its release, a/H 0.5, 1, 2 | order 1.84 to 1.89 (mean square), 2.0 to 2.1 (wall force) |
//! | elastic layer under water, 0.2 to 2 of its density, four periods | within 2 to 7 % of the amplitude |
//! | free fall, plane and space, a drop of a cell included | exact to 1e-12 m |
//! | standing wave, 32 and 64 cells | period -0.05, -0.09 %; amplitude +0.8, 0.0 % after 4 periods |
//! | forced sway, 48 cells | centroid within 1 % |
//! | elliptic drop, stretched 3.7 times, 16 cells a radius | axes within 0.2 %, energy +0.6 % |
//! | Taylor-Green, Re 100, 16 and 32 cells | amplitude -1.6, +1.1 %; without reflection -16, -8 % |
//! | start of channel flow, 8 and 16 cells | 0.0022, 0.0006 of the final speed: second order |
//! | round full tank in rotation, 8, 16, 32 cells a radius | spin -4.2, -1.7, -0.7 % after a revolution |
//! | drop in a central force, 12 and 24 cells a radius, ten periods | period +0.31, +0.07 %; amplitude -0.1, -0.3 % |
//! | drop at rest, 8 and 16 cells a radius; 6 in space | pressure within 0.3 %; 1 % |
//! | oscillating drop, 6 and 12 cells a radius | period +11, +2.5 % |
//! | sloshing of 20 s, 24 cells | volume -0.28 to 0.0 %, energy +0.3 J (1226 J of potential energy, 36 J of kinetic) |
//! | forced for 100 000 steps (3258, 2369 s), gently and strongly | mean volume +0.2, -0.2 %, without a trend; single steps within 1 % |
//! | capillary wave, 12 and 24 cells on half of it, three periods | amplitude within 0.30, 0.03 of that at the start |
//! | dam on a wet bed, 20 cells | depth behind the bore -2.3 %, speed of the bore +3.9 %, after 18 sqrt(H / g) |
//!
//! # Cost
//! `cargo run --release -p impactite-flow --example speed`: a column of 1 M particles in space, AMD EPYC: 4.1 M particle-steps/s on
//! one thread, 7.3 M on two. Pressure and density correction are 26 % of it, with 10 and 2 iterations; transfers 36 %, sort 12 %.
//! Memory: 295 bytes a particle, 785 a liquid cell with what is around it. `benchmarks/RESULTS.md` has it beside another program.
//!
//! # Limits
//! - Speeds of a drop at rest, 0.01 m/s for water and 5 mm, do not fall with the cells: noise of the particles in the curvature, whose filters
//!   are a fixed number of cells wide.
//! - The decay of vortices does not converge below 1 %: the noise of the particles again.
//! - Energy grows by up to 1 % where the reflection meets a surface (elliptic drop), and with the centroid that the density correction lifts.
//! - Liquid does not separate from a wall by tension, but from deformable bodies within three cells of air; a closed full tank may have negative pressures, known but for a constant.
//! - Deformable bodies are at least a cell thick, do not erode, and are not beside rigid bodies that the liquid moves. Layers under water are
//!   stable down to a fifth of its density; at a twentieth they turned inside out after some periods. Steps are shortened for the vibration of
//!   bodies while liquid is slower than five times their surfaces; else they follow the liquid, and stiff vibrations are averaged.
//! - The liquid of a scene has one density. It slips along rigid bodies that it moves; what is narrower than a cell between them is not
//!   resolved.

mod afloat;
mod blocks;
mod booking;
mod contact;
mod couple;
mod coupled;
mod cuts;
mod deformable;
mod error;
mod extrapolate;
mod field;
#[cfg(test)]
mod gates;
mod gather;
mod grid;
mod nodal;
mod options;
mod particles;
mod pressure;
mod rigid;
mod solver;
mod step;
mod surface;
mod tension;
mod transfer;
mod turn;
mod view;
mod viscosity;
mod wall;

pub use deformable::{Deformable, NodeImpulse, SurfaceElement};
pub use error::FluidError;
pub use options::{FlowOptions, Fluid, SemiStaggered};
pub use rigid::RigidBody;
pub use solver::{Flow, StepTimes};
pub use wall::{Wall, WallMotion};
