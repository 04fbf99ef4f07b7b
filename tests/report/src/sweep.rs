//! Sweeps: runs of the charts.

use examples::Detection;
use verification::problems::gas::tube_schemes;
use verification::problems::gates::Gate;
use verification::smoothed::Smoothed;
use verification::{Case, Kernel, Problem, Scheme, Velocity};

use crate::contact::{DETECTIONS, Meeting, Strike, Touch};
use crate::gates;
use crate::job::Job;
use crate::long::{Bar, Long};
use crate::soil::Footing;
use crate::study::{Scene, Study};

/// Chart kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Error against work.
    Work,
    /// Error against the particle-steps of one long run.
    Time,
}

/// Error chart and its sweep.
pub struct Chart {
    /// Number in the list of charts.
    pub number: &'static str,
    /// Anchor, and name of the data.
    pub id: &'static str,
    /// Headline of the chart.
    pub title: &'static str,
    /// Description of the problem.
    pub about: &'static str,
    /// Problem name in files.
    pub problem: &'static str,
    /// Error measure of the chart.
    pub error: &'static str,
    /// Axis label of the error.
    pub label: &'static str,
    /// Error targets of the table of recommendations.
    pub targets: &'static [f64],
    /// Theoretical order in words, and minimum order that counts as convergence; none without theory.
    pub wanted: Option<(&'static str, f64)>,
    /// Chart kind.
    pub kind: Kind,
    /// True if runs that are worse than on a coarser grid are marked, for charts with one run per grid and scheme.
    pub marks_growth: bool,
}

impl Chart {
    /// Smallest error target.
    pub fn finest_target(&self) -> f64 {
        self.targets.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// List the charts of the page.
pub fn charts() -> Vec<Chart> {
    vec![
        Chart {
            number: "C1",
            id: "c1-displacement",
            title: "Large smooth strain: displacement",
            about: "V3, a unit square pulsates with strains of 31 % along the axes (manufactured, exact). Particles cross cells.",
            problem: "V3 axes",
            error: "u",
            label: "RMS error of displacement / amplitude",
            targets: &[0.05, 0.01, 0.001],
            wanted: Some(("1.8 in displacement for cpGIMP and total Lagrangian", 1.8)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C1",
            id: "c1-stress",
            title: "Large smooth strain: stress",
            about: "V3 again, by its stress.",
            problem: "V3 axes",
            error: "stress",
            label: "RMS error of stress / (A k E)",
            targets: &[0.1, 0.05, 0.01],
            wanted: Some((
                "1 with linear shape functions, 2 with splines, in the reference configuration",
                0.9,
            )),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C2",
            id: "c2-vortex",
            title: "Shear and rotation",
            about: "V4, an annulus turns by up to 57 degrees within a block that stands still, shears reach 7 (manufactured, exact).",
            problem: "V4 vortex",
            error: "u",
            label: "RMS error of displacement / largest",
            targets: &[0.1, 0.05, 0.02, 0.01],
            wanted: Some(("1.5 for total Lagrangian", 1.5)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C3",
            id: "c3-ring",
            title: "Curved free surfaces",
            about: "V5, a ring pulsates between radii of 0.4 and 0.6 m with free surfaces (manufactured, exact), cut out of a lattice. Largest error of any particle.",
            problem: "V5 ring",
            error: "u largest",
            label: "largest error of displacement / amplitude",
            targets: &[0.1, 0.05, 0.02],
            wanted: Some(("1", 0.9)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C4",
            id: "c4-sod",
            title: "Shock tube, with bulk viscosity",
            about: "V13, Sod's tube with q1 = 0.5 and q2 = 2, against the exact solution of the Riemann problem.",
            problem: "V13 Sod",
            error: "density",
            label: "L1 error of density, kg/m³ · m",
            targets: &[0.02, 0.01, 0.005],
            wanted: Some(("0.7 (a shock allows 1)", 0.7)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C4",
            id: "c4-overshoot",
            title: "Shock tube, with bulk viscosity: overshoot",
            about: "The same runs by their largest speed over that of the plateau, less one.",
            problem: "V13 Sod",
            error: "overshoot",
            label: "overshoot of speed / plateau",
            targets: &[0.1, 0.05, 0.03],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C4",
            id: "c4-sod-bare",
            title: "Shock tube, without bulk viscosity",
            about: "Sod's tube without: what the transfer itself dissipates is all there is.",
            problem: "V13 Sod bare",
            error: "density",
            label: "L1 error of density, kg/m³ · m",
            targets: &[0.02, 0.01, 0.005],
            wanted: Some(("0.7 (a shock allows 1)", 0.7)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C4",
            id: "c4-bars",
            title: "Impact of bars, with bulk viscosity",
            about: "V8, two equal elastic bars hit each other end to end, q1 = 0.1; velocity in both bars when the waves have run 0.8 of them, against the exact \
                    two fronts. Frictionless contact by several tests; of smoothed particles by their surfaces.",
            problem: "V8 bars",
            error: "velocity",
            label: "L1 error of velocity / closing speed",
            targets: &[0.05, 0.02, 0.01],
            wanted: Some(("0.7 (a jump allows 1)", 0.7)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C4",
            id: "c4-bars-bare",
            title: "Impact of bars, without bulk viscosity",
            about: "V8, two equal elastic bars hit each other end to end, q1 = 0; velocity in both bars when the waves have run 0.8 of them, against the exact \
                    two fronts. Frictionless contact by several tests; of smoothed particles by their surfaces.",
            problem: "V8 bars bare",
            error: "velocity",
            label: "L1 error of velocity / closing speed",
            targets: &[0.05, 0.02, 0.01],
            wanted: Some(("0.7 (a jump allows 1)", 0.7)),
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C5",
            id: "c5-pulse",
            title: "Contact: a pulse through a joint",
            about: "V9, a bar of two pieces under pressure, and a pulse of half of that: its peak behind the joint against that in a bar of one piece. Frictionless.",
            problem: "V9 pulse",
            error: "transmitted",
            label: "error of the transmitted peak",
            targets: &[0.1, 0.01, 0.001],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C5",
            id: "c5-onset",
            title: "Contact: when discs touch",
            about: "V10, the discs of Sulsky 1994: the step of the first contact against the moment at which the circles touch (0.586 s); of the step's ends the one farther off.",
            problem: "V10 discs",
            error: "onset",
            label: "error of the time of first contact",
            targets: &[0.1, 0.01, 0.001],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C5",
            id: "c5-energy",
            title: "Contact: energy of discs",
            about: "V10 again: kinetic and elastic energy after the collision against what there was before; 3 % is what V10 allows.",
            problem: "V10 discs",
            error: "energy",
            label: "change of energy / energy before",
            targets: &[0.03, 0.01],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C5",
            id: "c5-hertz",
            title: "Contact: force of balls",
            about: "V11, two balls pressed together by their inertia, to a contact of a sixth of the radius: force against that of Hertz for this approach of the \
                    centres of mass, near the largest approach.",
            problem: "V11 balls",
            error: "force",
            label: "error of the force",
            targets: &[0.1, 0.05, 0.03],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C6",
            id: "c6-footing",
            title: "Locking: a strip footing",
            about: "V18, a footing on soil that keeps its volume: load at a settlement of 1 % of the half width, against the limit load (2 + π) c. \
                    Linear shape functions, FLIP, MUSL; laws see every particle's own dilatation or the mean of a cell.",
            problem: Footing::PROBLEM,
            error: "load",
            label: "error of the limit load",
            targets: &[0.1, 0.05, 0.01],
            wanted: None,
            kind: Kind::Work,
            marks_growth: false,
        },
        Chart {
            number: "C7",
            id: "c7-long",
            title: "Long time",
            about: "T17, a free bar of ten cells swings in its first mode with 1e-3 c, steps of 0.3 h/c: change of the energy since the first period.",
            problem: Long::PROBLEM,
            error: "energy",
            label: "|change of energy| / energy",
            targets: &[0.05, 0.01],
            wanted: None,
            kind: Kind::Time,
            marks_growth: false,
        },
        Chart {
            number: "C13",
            id: "c13-copper",
            title: "Methods for impact: a copper bar",
            about: "A Taylor bar of copper, 3.2 x 32.4 mm, 227 m/s, Y = 400 + 100 eps MPa, axisymmetric, by default settings: length after 80 us against 21.42 mm \
                    (several codes, fine meshes). Cells are those of the radius.",
            problem: Scene::Copper.name(),
            error: "length",
            label: "error of the length",
            targets: &[0.01, 0.005, 0.002],
            wanted: Some(("1", 0.9)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C13",
            id: "c13-steel",
            title: "Methods for impact: a steel bar",
            about: "A Taylor bar of 4340 steel, 7.595 x 37.97 mm, 270 m/s, adiabatic Johnson-Cook: length after 70 us against 31.185 mm (two axisymmetric finite \
                    element codes, 31.19 and 31.18).",
            problem: Scene::Steel.name(),
            error: "length",
            label: "error of the length",
            targets: &[0.01, 0.005, 0.002],
            wanted: Some(("1", 0.9)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C13",
            id: "c13-spin",
            title: "Methods for impact: a disc that spins",
            about: "A steel disc of 0.1 m radius that spins without load, rim at 200 m/s, two turns: energy that nothing explains. Cells are those of the radius.",
            problem: Scene::Spin.name(),
            error: "energy",
            label: "|unexplained energy| / energy",
            targets: &[0.01, 0.001],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C13",
            id: "c13-slide",
            title: "Methods for contact: a block that slides",
            about: "A block of 0.4 x 0.2 m slides on a rigid floor at 23 degrees to the grid, friction 0.2, default contact: speed after 0.3 s against 1.4 m/s. \
                    Cells are those of 0.1 m.",
            problem: Scene::Slide.name(),
            error: "speed",
            label: "error of the speed",
            targets: &[0.02, 0.01, 0.005],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C13",
            id: "c13-plate",
            title: "Methods for penetration: energy of a bullet through a plate",
            about: "A steel bullet, radius 5 mm, length 30 mm, at 400 m/s through 6 mm of aluminium with Johnson-Cook damage, axisymmetric, default contact: energy that \
                    nothing explains after 80 us. Cells are those of the radius.",
            problem: Scene::Plate.name(),
            error: "energy",
            label: "|unexplained energy| / energy",
            targets: &[0.1, 0.05, 0.02],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C13",
            id: "c13-shot",
            title: "Methods for hypervelocity: energy of a shot",
            about: "A quarter of an aluminium ball of 2 mm radius on 2 mm of the same at 5 km/s, in space, with bulk viscosity: energy that nothing explains after 2.4 us. \
                    Cells are those of the radius.",
            problem: Scene::Shot.name(),
            error: "energy",
            label: "|unexplained energy| / energy",
            targets: &[0.1, 0.05, 0.02],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-bar",
            title: "Gates of all methods: a bar on a wall",
            about: "Gate A, an elastic bar of 0.2 m without Poisson's ratio hits a rigid wall at 10 m/s, without bulk viscosity, by material points, particle \
                    contacts, smoothed particles, finite elements and fragile points with one law value: velocity along the bar at seven moments until it has left, against d'Alembert's \
                    fronts. Cells are those along the bar; work counts points of integration and their nodes.",
            problem: Gate::Bar.name(),
            error: "velocity",
            label: "mean error of velocity / impact speed",
            targets: &[0.05, 0.02],
            wanted: Some(("0.6 (jumps without viscosity allow 2/3)", 0.6)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-cantilever",
            title: "Gates of all methods: a cantilever under a pulse",
            about: "Gate B, a cantilever of 48 x 12 m in plane stress under 100 Pa of shear on its end for 0.5 s, by material points, finite elements and fragile points, which have \
                    tractions: displacement of the end at nine moments until 0.6 s against 96 x 24 elements of eight nodes, over that at rest. Cells are those through the beam.",
            problem: Gate::Cantilever.name(),
            error: "path",
            label: "RMS error of displacement / that at rest",
            targets: &[0.1, 0.05, 0.02],
            wanted: Some(("1.6", 1.6)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-beam",
            title: "Gates of all methods: a beam that swings",
            about: "Gate C, a cantilever of 0.2 x 0.02 m in plane strain, by the same methods: lowest frequency against 3.9210 Hz (CalculiX). Cells are those through \
                    the beam.",
            problem: Gate::Beam.name(),
            error: "frequency",
            label: "error of the frequency",
            targets: &[0.05, 0.02, 0.01],
            wanted: Some(("2", 1.6)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-pull",
            title: "Gates of all methods: a plate that is pulled",
            about: "A plate of 4 m without Poisson's ratio, clamped, whose end is pulled by a sine squared, for eight and a half times what a wave takes along it, by methods that have \
                    tractions: displacement against the exact images. Work is that of this run and one of half a sine, whose errors are in the data. Cells are those along the plate.",
            problem: Gate::Pull.name(),
            error: "smooth",
            label: "RMS error of displacement / RMS displacement",
            targets: &[0.02, 0.005, 0.001],
            wanted: Some(("2", 1.9)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-plate",
            title: "Gates of all methods: a shock in copper",
            about: "Gate D, half of a symmetric impact of plates at 500 m/s: 0.1 m of copper without strength at 250 m/s on a rigid wall, q1 = 0.3 and q2 = 1.5, by the same \
                    methods: pressure along it when the shock has passed 0.7 of it, against Rankine's and Hugoniot's 9.628 GPa. Cells are those along it.",
            problem: Gate::Plate.name(),
            error: "profile",
            label: "mean error of pressure / that of the shock",
            targets: &[0.02, 0.01, 0.005],
            wanted: Some(("0.9 (a shock with viscosity allows 1)", 0.9)),
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-shock",
            title: "Gates of all methods: density behind a shock",
            about: "The same runs by the mean density behind the shock, without what the wall heats too much, against 9479.5 kg/m³.",
            problem: Gate::Plate.name(),
            error: "density",
            label: "error of the density",
            targets: &[0.005, 0.001],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-steel",
            title: "Gates of all methods: bars of steel",
            about: "Gate G, Taylor bars of 4340 steel, 7.595 x 37.97 mm, at 181, 224 and 270 m/s, axisymmetric, adiabatic Johnson-Cook, by the same methods and by elements that become particles (MPFEM: within two radii of the wall \
                    from the start; AFEMP: where they are deformed too far): the largest error \
                    of the three lengths after 70 us against two axisymmetric finite element codes, which differ by 0.1 %. Work is that of the three. Cells are those \
                    of the radius. A copper bar at 190 and 400 m/s over cost, which no other code has run, is in the book (taylor_copper --convergence).",
            problem: Gate::Taylor.name(),
            error: "length",
            label: "largest error of the lengths",
            targets: &[0.01, 0.005, 0.002],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C14",
            id: "c14-faces",
            title: "Gates of all methods: faces of bars of steel",
            about: "The same runs by the largest error of the radii of the three faces; the two codes differ by 1 % in them.",
            problem: Gate::Taylor.name(),
            error: "face",
            label: "largest error of the radii of the faces",
            targets: &[0.05, 0.02],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C15",
            id: "c15-angle",
            title: "Cracks: Kalthoff's plate, the angle",
            about: "Gate H, half of Kalthoff's plate of steel, struck at 16.5 m/s beside a notch, in plane stress, by fragile points of two random sets of cells of 2, 1.4 and 1 mm, whose \
                    faces open at 1773 MPa, at once or over 22.13 kJ/m²: angle of the chord of the first 60 mm of the crack against 67 degrees, the middle of what is accepted (64 to 70: \
                    4.5 % off). Start, speed and energy are in the data. Cells are those along the plate.",
            problem: Gate::Kalthoff.name(),
            error: "angle",
            label: "error of the angle",
            targets: &[0.1, 0.045],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
        Chart {
            number: "C15",
            id: "c15-work",
            title: "Cracks: Kalthoff's plate, what they take",
            about: "The same runs by the energy that cracks took over their area, against 22.13 kJ/m². Faces that open at once know no such number: what they take follows from the size of \
                    cells and goes to nothing with it.",
            problem: Gate::Kalthoff.name(),
            error: "work of the crack",
            label: "error of the work per area",
            targets: &[0.2, 0.1],
            wanted: None,
            kind: Kind::Work,
            marks_growth: true,
        },
    ]
}

/// List all runs of a problem, cheap first.
pub fn jobs(problem: &str, quick: bool) -> Vec<Job> {
    if let Some(found) = Problem::ALL.into_iter().find(|p| p.name() == problem) {
        let smoothed = smoothed(found, quick).into_iter().map(Job::Smoothed);
        return cases(found, quick).into_iter().map(Job::Case).chain(smoothed).collect();
    }
    let grid = |list: &[usize]| list.to_vec();
    if let Some(meeting) = Meeting::ALL.into_iter().find(|m| m.name() == problem) {
        let cells = match (meeting, quick) {
            (Meeting::Pulse, true) => grid(&[25, 50, 100]),
            (Meeting::Pulse, false) => grid(&[25, 50, 100, 200, 400]),
            (Meeting::Discs, true) => grid(&[10, 20, 40]),
            (Meeting::Discs, false) => grid(&[10, 20, 40, 80, 160]),
            (Meeting::Bars | Meeting::BareBars, true) => grid(&[50, 100, 200]),
            (Meeting::Bars | Meeting::BareBars, false) => grid(&[50, 100, 200, 400, 800]),
            (Meeting::Balls, true) => grid(&[10, 20, 40]),
            (Meeting::Balls, false) => grid(&[10, 20, 40, 80]),
        };
        // Flat contact of bars: contact detections differ little.
        let bars = matches!(meeting, Meeting::Bars | Meeting::BareBars);
        let tests = if bars { vec![Detection::Distance, Detection::Approach] } else { DETECTIONS.to_vec() };
        let of = |cells: usize| {
            tests.clone().into_iter().flat_map(move |detection| {
                [false, true].map(|quadratic| Job::Touch(Touch { meeting, quadratic, detection, cells }))
            })
        };
        let touches: Vec<Job> = cells.iter().copied().flat_map(of).collect();
        // Smoothed particles run bars only: contact detections are those of grids.
        let finer: Vec<usize> = cells.iter().map(|cells| 2 * cells).collect();
        let strikes = if bars { Strike::all(meeting == Meeting::Bars, &finer) } else { Vec::new() };
        return touches.into_iter().chain(strikes.into_iter().map(Job::Strike)).collect();
    }
    if problem == Footing::PROBLEM {
        let cells = if quick { grid(&[2, 4, 8]) } else { grid(&[2, 4, 8, 16, 32]) };
        return cells.into_iter().flat_map(Footing::all).map(Job::Footing).collect();
    }
    if let Some(scene) = Scene::ALL.into_iter().find(|s| s.name() == problem) {
        return Study::all(scene).into_iter().map(Job::Study).collect();
    }
    if let Some(gate) = Gate::ALL.into_iter().find(|gate| gate.name() == problem) {
        return gates::all(gate, quick).into_iter().map(Job::Passage).collect();
    }
    let steps = if quick { 100_000 } else { 1_000_000 };
    Bar::all().into_iter().map(|bar| Job::Long(Long { bar, steps })).collect()
}

fn cases(problem: Problem, quick: bool) -> Vec<Case> {
    /// Grids, and the Courant numbers on each.
    type Grids = &'static [(usize, &'static [f64])];
    const ALL: &[f64] = &[0.1, 0.2, 0.4, 0.6];
    const SMALL: &[f64] = &[0.025, 0.05, 0.1, 0.2];
    let (schemes, grids, per_axis): (Vec<Scheme>, Grids, &[usize]) = match (problem, quick) {
        (Problem::Axes, true) => {
            const TWO: &[f64] = &[0.1, 0.3];
            (Scheme::all(), &[(8, TWO), (16, TWO), (32, TWO), (64, &[0.3])], &[2])
        }
        (Problem::Axes, false) => {
            (Scheme::all(), &[(8, ALL), (16, ALL), (32, ALL), (64, ALL), (128, ALL)], &[2, 3, 4])
        }
        (Problem::Vortex, true) => {
            const TWO: &[f64] = &[0.05, 0.1];
            (without_musl(), &[(32, TWO), (64, &[0.1]), (96, &[0.1])], &[2])
        }
        (Problem::Vortex, false) => {
            (Scheme::all(), &[(32, SMALL), (64, SMALL), (128, SMALL), (256, SMALL)], &[2, 3, 4])
        }
        (Problem::Ring, true) => (Scheme::all(), &[(4, &[0.3]), (8, &[0.3]), (16, &[0.3])], &[2]),
        (Problem::Ring, false) => {
            (Scheme::all(), &[(4, ALL), (8, ALL), (16, ALL), (32, ALL), (64, ALL)], &[2, 3, 4])
        }
        (_, true) => {
            const TWO: &[f64] = &[0.2, 0.4];
            (tube_schemes(), &[(50, TWO), (100, TWO), (200, TWO), (400, TWO)], &[2])
        }
        (_, false) => (
            tube_schemes(),
            &[(50, ALL), (100, ALL), (200, ALL), (400, ALL), (800, ALL), (1600, ALL)],
            &[2, 3, 4],
        ),
    };
    let mut list = Vec::new();
    for &(cells, courants) in grids {
        for &per_axis in per_axis {
            for &courant in courants {
                for &scheme in &schemes {
                    list.push(Case { problem, scheme, per_axis, cells, courant });
                }
            }
        }
    }
    if problem == Problem::Vortex && quick {
        // With two particles per axis, domains sheared by 7 exceed their stencils.
        let convects = |s: &Scheme| matches!(s.kernel, Kernel::Cpdi | Kernel::Cpdi2);
        for scheme in schemes.into_iter().filter(convects) {
            for cells in [32, 64] {
                list.push(Case { problem, scheme, per_axis: 4, cells, courant: 0.05 });
            }
        }
    }
    list
}

/// List the cases by smoothed particles, with one particle where material points have about one; their steps may be larger.
fn smoothed(problem: Problem, quick: bool) -> Vec<Case<Smoothed>> {
    let (cells, courants): (&[usize], &[f64]) = match (problem, quick) {
        (Problem::Axes, true) => (&[16, 32, 64, 128], &[0.4, 0.8]),
        (Problem::Axes, false) => (&[16, 32, 64, 128, 256], &[0.2, 0.4, 0.8, 1.2]),
        (Problem::Vortex, true) => (&[64, 128, 192], &[0.1, 0.2]),
        (Problem::Vortex, false) => (&[64, 128, 256, 512], &[0.05, 0.1, 0.2]),
        (Problem::Ring, true) => (&[8, 16, 32], &[0.6]),
        (Problem::Ring, false) => (&[8, 16, 32, 64, 128], &[0.2, 0.4, 0.8, 1.2]),
        (_, true) => (&[100, 200, 400, 800], &[0.4, 0.8]),
        (_, false) => (&[100, 200, 400, 800, 1600, 3200], &[0.2, 0.4, 0.8, 1.2]),
    };
    let mut list = Vec::new();
    for &cells in cells {
        for &courant in courants {
            let of = |scheme| Case { problem, scheme, per_axis: 1, cells, courant };
            list.extend(Smoothed::ALL.map(of));
        }
    }
    list
}

fn without_musl() -> Vec<Scheme> {
    Scheme::all().into_iter().filter(|s| s.velocity != Velocity::FlipMusl).collect()
}

/// Particle numbers of the throughput measurement.
pub fn sizes(quick: bool) -> &'static [u64] {
    if quick {
        &[1_000, 10_000, 100_000, 1_000_000]
    } else {
        &[1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 10_000_000]
    }
}

/// Case that measures the timing noise.
pub fn control() -> Case {
    let scheme = Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl);
    Case { problem: Problem::Axes, scheme, per_axis: 2, cells: 32, courant: 0.2 }
}
