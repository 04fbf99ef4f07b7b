//! Tests of the parts of the report page.

use std::path::Path;

use examples::peers::{Peer, object};
use report::chart::{draw, legend};
use report::front::Cost;
use report::job::Job;
use report::limits::{self, Asked};
use report::peers;
use report::pool::each;
use report::price::{Need, needed};
use report::record::Record;
use report::speed::{self, Speed};
use report::study::{Scene, Study, Way};
use report::sweep::{charts, jobs};
use verification::{Kernel, Scheme, Velocity};

#[test]
fn every_item_is_done_once_and_an_error_stops() {
    let items: Vec<usize> = (0..100).collect();
    let mut seen = Vec::new();
    let made: Result<(), ()> = each(
        3,
        &items,
        |n| n * n,
        |count, n, square| {
            seen.push((count, *n, square));
            Ok(())
        },
    );
    assert!(made.is_ok());
    assert!(seen.iter().enumerate().all(|(at, s)| s.0 == at + 1 && s.2 == s.1 * s.1));
    seen.sort_by_key(|s| s.1);
    assert_eq!(seen.iter().map(|s| s.1).collect::<Vec<_>>(), items);
    let made = each(2, &items, |n| *n, |count, _, _| if count == 5 { Err("five") } else { Ok(()) });
    assert_eq!(made, Err("five"));
}

#[test]
fn a_power_law_is_met_exactly() {
    // Series with error 1 / cost.
    let series: Vec<_> = [10.0, 40.0, 160.0].map(|c: f64| (Some(c), Some(1.0 / c))).into();
    let Need::Is(found) = needed(&series, 0.01) else { panic!("{:?}", needed(&series, 0.01)) };
    assert!((found - 100.0).abs() < 1e-9, "{found}");
    assert_eq!(needed(&series, 0.5), Need::AtMost(10.0));
    assert_eq!(needed(&series, 1e-3), Need::Unreachable);
    // Small error by chance on the coarse grid.
    assert_eq!(needed(&[(Some(1.0), Some(0.001)), (Some(4.0), Some(0.1))], 0.01), Need::Unreachable);
    // Stopped runs do not bracket the target.
    assert_eq!(needed(&[(Some(1.0), None), (Some(4.0), Some(0.001))], 0.01), Need::AtMost(4.0));
    assert_eq!(needed(&[(None, Some(0.1)), (None, Some(0.001))], 0.01), Need::Unknown);
}

/// Round trip of keys: every stored key leads back to its job, otherwise a sweep would never complete.
#[test]
fn names_lead_back_to_jobs() {
    for chart in charts() {
        for quick in [true, false] {
            let list = jobs(chart.problem, quick);
            assert!(!list.is_empty(), "{}: nothing to run", chart.id);
            for job in list {
                let key = job.key();
                assert_eq!(key.problem, chart.problem);
                let found = Job::of(&key).unwrap_or_else(|| panic!("{key:?} leads nowhere"));
                assert_eq!(found.key(), key);
                let scaled = job.scaled().key();
                assert_eq!((scaled.scheme, scaled.per_axis), (key.scheme, key.per_axis));
            }
        }
    }
}

/// Round trip of limits: every limit of the chart is found by its request; measured limits equal theory.
#[test]
fn limits_are_found_and_drawn() {
    let asked = Asked::all(true);
    let of = |kernel, velocity| {
        let scheme = Scheme::moving(kernel, velocity);
        asked.iter().filter(move |a| a.scheme == scheme && a.per_cell == 2)
    };
    let mut list = Vec::new();
    for asked in
        of(Kernel::Quadratic, Velocity::FlipMusl).chain(of(Kernel::Quadratic, Velocity::ApicUsl)).step_by(8)
    {
        let found = asked.make("none").unwrap();
        assert!(found.is_of(asked));
        assert!((found.measured / found.predicted - 1.0).abs() < 0.1, "{found:?}");
        list.push(found);
    }
    assert_eq!(list.len(), 4);
    let mut page = String::new();
    limits::section(&mut page, &list);
    assert_eq!(page.matches("<figure>").count(), 1);
    // Two lines each of two transfers in the drawing; markers there and in the legend.
    assert_eq!(page.matches("class=\"disc").count(), 4 + 3);
    assert!(page.contains("Of 4 arrangements"), "{page}");
}

/// The method recommended for impact is accurate on the coarse grids of the study with default settings.
#[test]
fn the_method_for_impact_holds_on_scenes_where_methods_fail() {
    let run = |scene, way, cells| {
        let outcome = Study { scene, way, cells }.run();
        assert_eq!(outcome.failure, None, "{scene:?}, {way:?}");
        move |name: &str| outcome.measures.iter().find(|m| m.0 == name).expect("measure").1
    };
    // Length errors below 0.5 %, foot errors decreasing with refinement; two codes differ by 1 % in the foot of
    // steel.
    for (scene, feet) in [(Scene::Copper, 0.01), (Scene::Steel, 0.02)] {
        let [coarse, fine] = [8, 16].map(|cells| run(scene, Way::Impact, cells));
        for bar in [&coarse, &fine] {
            assert!(
                bar("length").abs() < 0.005 && bar("energy").abs() < 0.01,
                "{scene:?}: {}",
                bar("length")
            );
        }
        let foot = [coarse("foot"), fine("foot")].map(f64::abs);
        assert!(foot[1] < feet && foot[1] < foot[0], "{scene:?}: {foot:?}");
    }
    // Linear FLIP diverges from the answer under refinement and is therefore not recommended.
    let [coarse, fine] = [8, 16].map(|cells| run(Scene::Copper, Way::Linear, cells)("length").abs());
    assert!(fine > 0.01 && fine > 3.0 * coarse, "{coarse}, {fine}");

    let disc = run(Scene::Spin, Way::Impact, 10);
    assert!(
        disc("energy").abs() < 0.01 && disc("angular momentum").abs() < 1e-3,
        "{}",
        disc("angular momentum")
    );
    for (way, cells) in [(Way::Impact, 2), (Way::AtRest, 2), (Way::Impact, 4), (Way::AtRest, 4)] {
        let block = run(Scene::Slide, way, cells);
        assert!(block("speed").abs() < 0.01 && block("lift").abs() < 0.005, "{way:?}: {}", block("speed"));
    }
    let bullet = run(Scene::Plate, Way::Impact, 8);
    assert!(bullet("energy") < 0.002 && bullet("energy") > -0.03, "{}", bullet("energy"));
}

/// Format an output line of a peer's program: linear shape functions, 2 particles per cell and axis, 16 cells, with this
/// displacement error.
fn line(u: &str) -> String {
    format!(
        "{{\"program\": \"Taichi 1.7.4\", \"scheme\": \"linear FLIP-MUSL\", \"per_axis\": 2, \"cells\": 16, \"courant\": 0.3, \
         \"particles\": 1024, \"steps\": 54, \"core_seconds\": 0.004, \
         \"errors\": {{\"u\": {u}, \"u largest\": 0.4, \"v\": 0.7, \"stress\": 0.8}}}}"
    )
}

fn of_line(peer: Peer, text: &str) -> Record {
    peers::record(peer, object(text).unwrap(), "none").unwrap()
}

#[test]
fn lines_of_peers_become_runs() {
    let run = of_line(Peer::Taichi, &line("0.24"));
    let of_hats = |c: &&verification::Case| (c.scheme, c.cells, c.courant) == (peers::SCHEMES[0], 16, 0.3);
    let case = peers::cases(true).into_iter().find(|c| of_hats(&c)).unwrap();
    assert_eq!(run.key, peers::key(Peer::Taichi, &case));
    assert_eq!((run.particles, run.steps, run.units), (1024, 54, 1024.0 * 54.0 * 4.0));
    assert_eq!((run.error("u"), run.error("stress")), (Some(0.24), Some(0.8)));
    // Serialisation round trip; the run belongs to a peer.
    let again: Record = serde_json::from_str(&serde_json::to_string(&run).unwrap()).unwrap();
    assert_eq!(again, run);
    assert!(peers::is_known(&run.key) && Job::of(&run.key).is_none());
    assert_eq!(peers::split(run.scheme()), (Some(Peer::Taichi), "linear FLIP-MUSL"));
    assert!(!peers::is_known(&Job::Case(case).key()));

    // A NaN is a failed run; lines that are not JSON objects are skipped.
    assert!(of_line(Peer::Warp, &line("null")).failure.is_some());
    let stopped = line("0.1").replace("0.004", "0.004, \"failure\": \"a particle left the nodes\"");
    let stopped = of_line(Peer::Warp, &stopped);
    assert_eq!((stopped.failure.as_deref(), stopped.error("u")), (Some("a particle left the nodes"), None));
    assert_eq!(object("[Taichi] version 1.7.4, llvm 15.0.4, linux"), None);
    assert_eq!(object("17"), None);
    for wrong in [line("\"small\""), line("0.1").replace("linear", "linnear"), "{}".into()] {
        assert!(peers::record(Peer::Taichi, object(&wrong).unwrap(), "none").is_err(), "{wrong}");
    }
}

#[test]
fn peers_are_drawn_beside_ours_and_compared() {
    let charts = charts();
    let chart = charts.iter().find(|c| c.id == "c1-displacement").unwrap();
    let theirs = [of_line(Peer::Taichi, &line("0.24")), of_line(Peer::Warp, &line("0.3"))];
    let mut own = theirs[0].clone();
    own.key.scheme = "linear FLIP-MUSL".into();
    own.errors[0].1 = 0.25;
    own.core_seconds = 0.008;
    let (ours, theirs): (Vec<&Record>, Vec<&Record>) = (vec![&own], theirs.iter().collect());

    let plain = draw(chart, &ours, &[], Cost::Seconds, None).unwrap();
    let both = draw(chart, &ours, &theirs, Cost::Seconds, None).unwrap();
    assert_eq!(plain.matches("class=\"peer c1\"").count(), 0);
    assert_eq!(both.matches("class=\"peer c1\"").count(), 2);
    assert_eq!(both.matches("class=\"disc c1\"").count(), 1);
    // The broad line excludes peers: one point of this library.
    let broad = both.split("class=\"front\" d=\"").nth(1).and_then(|d| d.split('"').next()).unwrap();
    assert_eq!((broad.matches('M').count(), broad.matches('L').count()), (1, 0), "{broad}");
    let all: Vec<&Record> = theirs.iter().chain(&ours).copied().collect();
    let legend = legend(&all);
    let places =
        ["</svg>linear FLIP-MUSL", "</svg>Taichi: linear", "</svg>Warp: linear"].map(|n| legend.find(n));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{legend}");

    let found = peers::agreement(theirs[0].scheme(), &theirs, &ours, "u").unwrap();
    assert_eq!(found.runs, 1);
    assert!((found.difference - 0.04).abs() < 1e-12, "{found:?}");
    assert_eq!((found.time, found.longest), ([0.5; 2], 0.5));
    assert_eq!(peers::agreement(theirs[0].scheme(), &theirs, &[], "u"), None);
    let mut text = String::new();
    peers::reading(&mut text, chart, &theirs, &ours);
    assert!(text.contains("ours within 20 % of them, which is more than rounding"), "{text}");
    assert!(text.contains("<td>Taichi: linear FLIP-MUSL</td><td>1</td><td>4 %</td>"), "{text}");
}

#[test]
fn speeds_of_peers_are_told_from_ours() {
    let asked = speed::Asked::of_peer(Peer::Warp, &[1000]);
    assert!(!asked.is_empty() && asked.iter().all(|a| (a.threads, a.bits) == (1, 64)));
    assert_eq!(speed::Asked::of_peer(Peer::Taichi, &[1000]).len(), 2 * asked.len());
    let speed = |asked: &speed::Asked, rate| Speed {
        asked: asked.clone(),
        count: 1000,
        steps: 1000,
        rates: vec![rate],
        bytes: 200.0,
        commit: "none".into(),
    };
    let theirs = speed(&asked[0], 1e7);
    let again: Speed = serde_json::from_str(&serde_json::to_string(&theirs).unwrap()).unwrap();
    assert_eq!(again, theirs);
    // Lines without a peer field belong to this library.
    let before = r#"{"kernel":"linear-musl-elastic","particles":1000,"threads":1,"bits":64,"count":1000,"steps":1000,"rates":[2.5e7],"bytes":200.0,"commit":"none"}"#;
    let ours: Speed = serde_json::from_str(before).unwrap();
    assert_eq!(ours, speed(&speed::Asked { peer: None, ..asked[0].clone() }, 2.5e7));
    let mut page = String::new();
    report::rates::section(&mut page, &[ours, theirs]);
    // Marks in the drawing and in the legend.
    assert_eq!(page.matches("class=\"peer c1\"").count(), 2);
    assert!(page.contains("Warp: linear-musl-elastic, f64: ours is 2.5 to 2.5 times as fast"), "{page}");
}

/// Independent programs have the same errors as the library up to the order of summation, over 80 steps in which round-off
/// grows by some powers of ten. Skipped if a package is missing.
#[test]
fn peers_make_the_errors_that_we_make() {
    let python = std::env::var_os("IMPACTITE_PYTHON").unwrap_or_else(|| "python3".into());
    let python = Path::new(&python);
    let mut cases = peers::cases(true);
    cases.retain(|c| c.cells == 8);
    for peer in Peer::ALL.into_iter().filter(|p| p.version(python).is_some()) {
        let mut count = 0;
        peers::run(peer, python, &cases, (1, 0.0), "none", &mut |theirs| {
            let case = cases[count];
            assert_eq!(theirs.key, peers::key(peer, &case));
            let ours = Record::new(theirs.key.clone(), case.run(), "none");
            for (name, error) in &ours.errors {
                let found = theirs.error(name).unwrap_or(f64::NAN);
                assert!((found / error - 1.0).abs() < 1e-9, "{}: {name} {found} for {error}", case.name());
            }
            count += 1;
            Ok(())
        })
        .unwrap();
        assert_eq!(count, cases.len());
    }
}
