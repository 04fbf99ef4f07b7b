//! Displacements in frames for ParaView: moving points, points created later, and resumed runs.

use std::path::{Path, PathBuf};

use impactite_output::{Precision, VtkOptions};
use impactite_scene::observe::{Pace, VtkSeries};
use impactite_scene::{
    Archive, Body, CheckpointError, Clock, Exchange, PointView, Run, RunError, Solver, StepError, Totals,
    snapshot_fields,
};
use impactite_simd::Team;

/// Time step, s. Like positions and velocities below it has so few digits that all sums are exact.
const STEP: f64 = 1.0 / 1024.0;
const END: f64 = 16.0 * STEP;
/// Step in which a point is created.
const SPLITS: u64 = 6;
/// Number of the new point.
const NEW: usize = 100;

/// Two bodies of points with constant velocities, whose order in memory changes.
struct Flight {
    clock: Clock,
    bodies: [Flock; 2],
}

struct Flock {
    name: &'static str,
    /// Number, position (m), velocity (m/s).
    points: Vec<(usize, [f64; 3], [f64; 3])>,
}

fn velocity(body: usize, number: usize) -> [f64; 3] {
    let (b, n) = (body as f64, number as f64);
    [1.0 + 8.0 * b, 0.25 * n, -0.5 * n + b]
}

impl Flight {
    fn new() -> Self {
        let flock = |body: usize, name| {
            let place = |n: usize| [n as f64 / 64.0, (n * n) as f64 / 64.0, body as f64];
            Flock { name, points: (0..7).map(|n| (n, place(n), velocity(body, n))).collect() }
        };
        Flight { clock: Clock::default(), bodies: [flock(0, "geese"), flock(1, "cranes")] }
    }
}

impl Body for Flock {
    fn name(&self) -> &str {
        self.name
    }
    fn law(&self) -> &'static str {
        ""
    }
    fn len(&self) -> usize {
        self.points.len()
    }
    fn state_names(&self) -> Vec<String> {
        // A law may have a state variable of this name: it is not the displacement of a frame.
        vec!["displacement".into()]
    }
    fn totals(&self) -> Totals {
        let mut sum = Totals::default();
        self.points.iter().for_each(|(_, x, v)| sum.add_point(1.0, x, v));
        sum
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        for &(number, position, velocity) in &self.points {
            let state = vec![1.0];
            visit(&PointView {
                number,
                position,
                velocity,
                mass: 1.0,
                // The new point has failed, and its volume grows without bound.
                volume: if number == NEW { 1e15 } else { 1.0 },
                failed: number == NEW,
                state,
                ..Default::default()
            });
        }
    }
    fn bytes(&self) -> usize {
        0
    }
}

impl Solver for Flight {
    fn method(&self) -> String {
        "flight".into()
    }
    fn dimensions(&self) -> usize {
        3
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        Ok(STEP)
    }
    fn step_at_most(&mut self, _: f64) -> Result<f64, StepError> {
        for flock in &mut self.bodies {
            for (_, x, v) in &mut flock.points {
                [0, 1, 2].iter().for_each(|&d| x[d] += v[d] * STEP);
            }
            flock.points.rotate_left(3);
        }
        self.clock.advance(STEP);
        if self.clock.steps == SPLITS {
            let (_, x, _) = self.bodies[0].points[0];
            self.bodies[0].points.insert(2, (NEW, x, velocity(0, NEW)));
        }
        Ok(STEP)
    }
    fn set_team(&mut self, _: Team) {}
    fn bodies(&self) -> Vec<&dyn Body> {
        self.bodies.iter().map(|flock| flock as &dyn Body).collect()
    }
    fn exchange(&self) -> Exchange {
        Exchange::default()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.clock.archive(file)?;
        self.bodies.iter_mut().try_for_each(|flock| {
            file.list(&mut flock.points, &Default::default(), |file, (number, x, v)| {
                file.count(number)?;
                file.reals(x.iter_mut().chain(v))
            })
        })
    }
}

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("impactite-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Write a frame every four steps, with all digits.
fn frames(folder: &Path) -> VtkSeries {
    let options = VtkOptions { compressed: false, fields: Precision::Double };
    let pace = Pace::interval(4.0 * STEP).expect("a pace");
    VtkSeries::create(folder, "flight", pace).expect("a series").with_options(options)
}

fn frame(folder: &Path, number: usize) -> Vec<u8> {
    std::fs::read(folder.join(format!("flight_{number:06}.vtp"))).expect("a frame")
}

/// Return the words of an array of an uncompressed frame; none if it does not exist.
fn words(frame: &[u8], name: &str) -> Option<Vec<[u8; 8]>> {
    let marker = b"<AppendedData encoding=\"raw\">\n   _";
    let at = frame.windows(marker.len()).position(|w| w == marker).expect("appended data");
    let xml = std::str::from_utf8(&frame[..at]).expect("the head is text");
    let line = xml.lines().find(|l| l.contains(&format!("Name=\"{name}\"")))?;
    let offset = line.split("offset=\"").nth(1).and_then(|l| l.split('"').next());
    let data = &frame[at + marker.len() + offset.expect("an offset").parse::<usize>().expect("a number")..];
    let (size, data) = data.split_at(8);
    let size = u64::from_le_bytes(size.try_into().expect("8 bytes")) as usize;
    Some(data[..size].as_chunks().0.to_vec())
}

fn displacements(frame: &[u8]) -> Vec<[f64; 3]> {
    let numbers: Vec<f64> =
        words(frame, "displacement").expect("the field").into_iter().map(f64::from_le_bytes).collect();
    numbers.as_chunks().0.to_vec()
}

/// Check the displacements of a frame: v t, with the time since its first frame for a point created after the start.
fn check(frame: &[u8], number: usize) {
    let numbers: Vec<usize> = words(frame, "particle")
        .expect("the field")
        .into_iter()
        .map(|w| i64::from_le_bytes(w) as usize)
        .collect();
    let displacements = displacements(frame);
    let time = (4 * number) as f64 * STEP;
    let first = if 4 * number as u64 >= SPLITS { 8 } else { 7 };
    assert_eq!((numbers.len(), displacements.len()), (first + 7, first + 7));
    for (place, (&n, displacement)) in numbers.iter().zip(&displacements).enumerate() {
        // The new point is first observed in frame 2, two steps after its creation.
        let flown = if n == NEW { time - 8.0 * STEP } else { time };
        let v = velocity(usize::from(place >= first), n);
        assert_eq!(*displacement, v.map(|v| v * flown), "point {n} of frame {number}");
    }
}

#[test]
fn fields_are_known_without_their_values() {
    let flight = Flight::new();
    let snapshot = flight.snapshot().expect("a snapshot");
    let fields: Vec<_> = snapshot.fields().map(|(name, values)| (name.to_string(), values.kind())).collect();
    assert_eq!(snapshot_fields(&flight.bodies()), fields);
    assert!(fields.iter().any(|(name, _)| name == "state_displacement"));
    assert_eq!(snapshot.body_names(), ["geese", "cranes"]);
}

#[test]
fn displacements_are_velocities_times_time() {
    let folder = Folder::new("displacement");
    // Options in any order, with the field named or not.
    let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| folder.0.join(name));
    let mut series = [
        frames(&a).with_displacement(),
        frames(&b).with_displacement().with_fields(["particle"]),
        frames(&c).with_fields(["displacement", "particle"]).with_displacement(),
        frames(&d),
    ];
    let mut flight = Flight::new();
    Run::new(&mut flight)
        .observe_all(series.iter_mut().map(|s| s as &mut dyn impactite_scene::observe::Observer))
        .until(END)
        .expect("a run");
    for folder in [&a, &b, &c] {
        (0..5).for_each(|number| check(&frame(folder, number), number));
    }
    let with = |folder, name| words(&frame(folder, 4), name).is_some();
    assert!(with(&a, "velocity") && with(&a, "state_displacement"));
    assert!(!with(&b, "velocity") && !with(&c, "velocity"));
    assert!(with(&d, "velocity") && !with(&d, "displacement"));
    // A field that was not requested does not exist.
    let mut series = frames(&d).with_fields(["displacement"]);
    let said = Run::new(&mut Flight::new()).observe(&mut series).until(END).unwrap_err().to_string();
    assert!(said.contains("field \"displacement\""), "{said}");
}

#[test]
fn a_run_that_is_resumed_goes_on_with_the_same_displacements() {
    let folder = Folder::new("displacement-resumed");
    let (whole, halves) = (folder.0.join("whole"), folder.0.join("halves"));
    let mut series = frames(&whole).with_displacement();
    Run::new(&mut Flight::new()).observe(&mut series).until(END).expect("a run");

    // The last checkpoint is after nine steps: the new point was observed once.
    let file = folder.0.join("checkpoint");
    let mut series = frames(&halves).with_displacement();
    let mut flight = Flight::new();
    let every = Pace::steps(9).expect("a pace");
    Run::new(&mut flight).observe(&mut series).checkpoint(&file, every).until(12.0 * STEP).expect("a run");
    let mut series = frames(&halves).with_displacement();
    let mut again = Flight::new();
    let run = Run::new(&mut again).observe(&mut series).resume(&file);
    run.and_then(|mut run| run.until(END)).expect("a run");
    assert_eq!(series.frames(), 5);
    for number in 0..5 {
        assert!(frame(&halves, number) == frame(&whole, number), "frame {number}");
        check(&frame(&halves, number), number);
    }

    let mut other = frames(&folder.0.join("other"));
    let refused = Run::new(&mut Flight::new()).observe(&mut other).resume(&file).map(|_| ());
    let Err(RunError::Checkpoint { source: CheckpointError::OtherScene { what, .. }, .. }) = &refused else {
        panic!("{refused:?}");
    };
    assert_eq!(what, "`displacement` of the frames");
}

/// A failed point of a huge volume is drawn as wide as intact ones.
#[test]
fn failed_points_are_drawn_no_wider_than_sound_ones() {
    let mut flight = Flight::new();
    for _ in 0..SPLITS {
        flight.step_at_most(STEP).expect("a step");
    }
    let snapshot = flight.snapshot().expect("points");
    assert_eq!(snapshot.len(), 15);
    assert!((0..snapshot.len()).all(|n| snapshot.size_of(n) == 1.0), "{:?}", snapshot.size());
}
