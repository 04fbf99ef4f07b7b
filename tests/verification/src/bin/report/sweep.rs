//! Which runs the charts are made of.

use verification::problems::gas::tube_schemes;
use verification::{Case, Kernel, Problem, Scheme, Velocity};

/// A chart and its sweep.
pub struct Chart {
    /// Anchor.
    pub id: &'static str,
    /// Headline.
    pub title: &'static str,
    /// The problem, in words.
    pub about: &'static str,
    /// Problem.
    pub problem: Problem,
    /// Which error.
    pub error: &'static str,
    /// The same on the axis.
    pub label: &'static str,
    /// Errors that the table of choices is made for.
    pub targets: [f64; 3],
    /// The order that the problem's theory has, in words, and what counts as converging.
    pub wanted: (&'static str, f64),
}

/// The charts of the page.
pub fn charts() -> Vec<Chart> {
    vec![
        Chart {
            id: "c1-displacement",
            title: "Large smooth strain: displacement",
            about: "V3, a unit square pulsates with strains of 31 % along the axes (manufactured, exact). Particles cross cells.",
            problem: Problem::Axes,
            error: "u",
            label: "error of displacement over amplitude",
            targets: [0.05, 0.01, 0.001],
            wanted: ("1.8 in displacement for cpGIMP and total Lagrangian", 1.8),
        },
        Chart {
            id: "c1-stress",
            title: "Large smooth strain: stress",
            about: "V3 again, by its stress.",
            problem: Problem::Axes,
            error: "stress",
            label: "error of stress over A k E",
            targets: [0.1, 0.05, 0.01],
            wanted: ("1 with hats, 2 with splines, in the reference configuration", 0.9),
        },
        Chart {
            id: "c2-vortex",
            title: "Shear and rotation",
            about: "V4, an annulus turns by up to 57 degrees within a block that stands still, shears reach 7 (manufactured, exact).",
            problem: Problem::Vortex,
            error: "u",
            label: "error of displacement over largest",
            targets: [0.1, 0.05, 0.02],
            wanted: ("1.5 for total Lagrangian", 1.5),
        },
        Chart {
            id: "c3-ring",
            title: "Curved free surfaces",
            about: "V5, a ring pulsates between radii of 0.4 and 0.6 m with free surfaces (manufactured, exact), cut out of a lattice. Largest error of any particle.",
            problem: Problem::Ring,
            error: "u largest",
            label: "largest error of displacement over A",
            targets: [0.1, 0.05, 0.02],
            wanted: ("1", 0.9),
        },
        Chart {
            id: "c4-sod",
            title: "Shock tube, with bulk viscosity",
            about: "V13, Sod's tube with q1 = 0.5 and q2 = 2, against the exact solution of the Riemann problem.",
            problem: Problem::Sod,
            error: "density",
            label: "L1 error of density",
            targets: [0.02, 0.01, 0.005],
            wanted: ("0.7 (a shock allows 1)", 0.7),
        },
        Chart {
            id: "c4-sod-bare",
            title: "Shock tube, without bulk viscosity",
            about: "The same without: what the transfer itself dissipates is all there is.",
            problem: Problem::SodBare,
            error: "density",
            label: "L1 error of density",
            targets: [0.02, 0.01, 0.005],
            wanted: ("0.7 (a shock allows 1)", 0.7),
        },
    ]
}

/// All runs of a problem, cheap ones first.
pub fn cases(problem: Problem, quick: bool) -> Vec<Case> {
    let (schemes, cells, per_axis, courant): (Vec<Scheme>, &[usize], &[usize], &[f64]) =
        match (problem, quick) {
            (Problem::Axes, true) => (Scheme::all(), &[8, 16, 32, 64], &[2], &[0.1, 0.3]),
            (Problem::Axes, false) => {
                (Scheme::all(), &[8, 16, 32, 64, 128], &[2, 3, 4], &[0.1, 0.2, 0.4, 0.6])
            }
            (Problem::Vortex, true) => (without_musl(), &[32, 64, 96], &[2], &[0.05, 0.1]),
            (Problem::Vortex, false) => {
                (Scheme::all(), &[32, 64, 128, 256], &[2, 3, 4], &[0.025, 0.05, 0.1, 0.2])
            }
            (Problem::Ring, true) => (Scheme::all(), &[4, 8, 16], &[2], &[0.3]),
            (Problem::Ring, false) => (Scheme::all(), &[4, 8, 16, 32, 64], &[2, 3, 4], &[0.1, 0.2, 0.4, 0.6]),
            (_, true) => (tube_schemes(), &[50, 100, 200, 400], &[2], &[0.2, 0.4]),
            (_, false) => {
                (tube_schemes(), &[50, 100, 200, 400, 800, 1600], &[2, 3, 4], &[0.1, 0.2, 0.4, 0.6])
            }
        };
    let mut list = Vec::new();
    for &cells in cells {
        for &per_axis in per_axis {
            for &courant in courant {
                for &scheme in &schemes {
                    list.push(Case { problem, scheme, per_axis, cells, courant });
                }
            }
        }
    }
    list
}

fn without_musl() -> Vec<Scheme> {
    Scheme::all().into_iter().filter(|s| s.velocity != Velocity::FlipMusl).collect()
}

/// The case that the clock is judged by.
pub fn control() -> Case {
    let scheme = Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl);
    Case { problem: Problem::Axes, scheme, per_axis: 2, cells: 32, courant: 0.2 }
}
