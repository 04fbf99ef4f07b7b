//! Invalid input is refused by name; a run that fails names element, particles, position and cause.

use crate::common::{block, copper, steel};
use impactite_scene::{Axisymmetric, Boundary, PlaneStrain, Side, TimeControl};
use impactite_scene::{Cause, PointKind, SceneError, Solver as _, StepError, Stopped};
use mpm_materials::Constitutive;
use pcmm::{AzimuthFan, Composition, Limits, LocalDelaunay, Masses, Method, Packing, Pcmm};

const H: f64 = 1.0e-3;

fn delaunay() -> LocalDelaunay {
    LocalDelaunay::new(0.45 * H, 2.0).unwrap()
}

fn refused(packing: &Packing<2>, speed: f64, masses: Masses) -> String {
    let method = Method::consistent(PlaneStrain, delaunay());
    match Pcmm::new(method, steel().compiled(), packing, |_| [speed, 0.0], masses) {
        Ok(_) => "accepted".into(),
        Err(e) => e.to_string(),
    }
}

#[test]
fn packings_are_refused_by_name() {
    let good = block([0.0; 2], 3, 3, H);
    let with = |change: fn(&mut Packing<2>)| {
        let mut packing = good.clone();
        change(&mut packing);
        refused(&packing, 0.0, Masses::FromElements)
    };
    let none = with(|p| {
        p.positions.clear();
        p.radii.clear();
    });
    assert!(none.contains("has no particles"), "{none}");
    let short = with(|p| p.radii.truncate(15));
    assert!(short.contains("radii: 15 values") && short.contains("16"), "{short}");
    let nan = with(|p| p.positions[5][1] = f64::NAN);
    assert!(nan.contains("particle 5: position = NaN"), "{nan}");
    let flat = with(|p| p.radii[2] = 0.0);
    assert!(flat.contains("particle 2: radius = 0"), "{flat}");
    let away = with(|p| p.positions[15] = [1.0, 1.0]);
    assert!(away.contains("particle 15 of body `body` at [1.0, 1.0] m has no mass"), "{away}");
    let fast = refused(&good, f64::INFINITY, Masses::FromElements);
    assert!(fast.contains("velocity = inf"), "{fast}");
    let volumes = refused(&good, 0.0, Masses::FromVolumes);
    assert!(volumes.contains("number of volumes = 0") && volumes.contains("one a particle"), "{volumes}");
    let method = Method::consistent(Axisymmetric, delaunay());
    let left =
        Pcmm::new(method, steel().compiled(), &block([-H, 0.0], 3, 3, H), |_| [0.0; 2], Masses::FromElements);
    let left = left.err().map_or("accepted".into(), |e| e.to_string());
    assert!(left.contains("distance from the axis = -0.001"), "{left}");
}

#[test]
fn parameters_are_refused_by_name() {
    let said = |r: Result<String, SceneError>| r.unwrap_or_else(|e| e.to_string());
    let fan = said(AzimuthFan::new(-1.0).map(|_| "accepted".into()));
    assert!(fan.contains("tolerance delta = -1"), "{fan}");
    let stretch = said(LocalDelaunay::new(1.0, 0.5).map(|_| "accepted".into()));
    assert!(stretch.contains("stretch = 0.5") && stretch.contains("at least 1"), "{stretch}");
    let angles = said(Limits::new(0.0, [40.0, 30.0], 0.5).map(|_| "accepted".into()));
    assert!(angles.contains("largest angle = 30"), "{angles}");
    let flip = said(delaunay().with_exchange_below(90.0).map(|_| "accepted".into()));
    assert!(flip.contains("angle of exchange = 90"), "{flip}");
    let mut bar = Pcmm::new(
        Method::consistent(PlaneStrain, delaunay()),
        steel().compiled(),
        &block([0.0; 2], 3, 3, H),
        |_| [0.0; 2],
        Masses::FromElements,
    )
    .unwrap();
    let axis = Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 };
    assert!(bar.bound(axis).unwrap_err().to_string().contains("axis = 2"));
    let place = Boundary::Fixed { axis: 0, at: f64::NAN, side: Side::Above };
    assert!(bar.bound(place).unwrap_err().to_string().contains("at = NaN"));
    assert!(bar.set_revision_interval(0).unwrap_err().to_string().contains("interval in steps = 0"));
    assert!(bar.set_time_control(TimeControl::Fixed(0.0)).is_err());
    assert!(matches!(bar.run_until(-1.0), Err(StepError { what: Stopped::Clock { field: "end", .. }, .. })));
    assert!(matches!(
        bar.run_until(f64::NAN),
        Err(StepError { what: Stopped::Clock { field: "end", .. }, .. })
    ));
}

#[test]
fn states_of_another_law_are_refused() {
    fn of<C: Constitutive<f64>>(_: C, bar: &mut Pcmm<2, impl Composition<2>>) -> Result<(), SceneError> {
        bar.set_states::<C>(|_, state| state)
    }
    let method = Method::consistent(PlaneStrain, delaunay());
    let packing = block([0.0; 2], 3, 3, H);
    let mut bar =
        Pcmm::new(method, steel().compiled(), &packing, |_| [0.0; 2], Masses::FromElements).unwrap();
    assert!(of(steel(), &mut bar).is_ok());
    let refused = of(copper(), &mut bar).unwrap_err().to_string();
    assert!(refused.contains("plastic_strain") && refused.contains("not those of the law"), "{refused}");
}

#[test]
fn a_run_that_breaks_says_where_and_why() {
    // Two halves penetrate each other in one step far beyond the stable one.
    let method = Method::consistent(PlaneStrain, delaunay());
    let speed = |[x, _]: [f64; 2]| [if x < 2.5 * H { 4.0e3 } else { -4.0e3 }, 0.0];
    let packing = block([0.0; 2], 5, 5, H);
    let mut bar = Pcmm::new(method, copper(), &packing, speed, Masses::FromElements).unwrap();
    bar.set_time_control(TimeControl::Fixed(0.4e-6)).unwrap();
    let error = bar.run_until(1.0e-5).unwrap_err();
    let text = error.to_string();
    let StepError { step: 1, what: Stopped::Point { kind: PointKind::Element, position, cause, .. }, .. } =
        &error
    else {
        panic!("{text}")
    };
    assert!(matches!(cause, Cause::Law(_)), "{text}");
    assert!(position[0] > 0.0 && position[0] < 5.0 * H, "{position:?}");
    assert!(
        text.contains("(law: Johnson-Cook)") && text.contains("the volume became zero or negative"),
        "{text}"
    );
}

#[test]
fn particles_without_elements_fly_on_and_walls_stop_them() {
    let packing = Packing {
        positions: vec![[0.0, 1.0], [5.0, 1.0]],
        radii: vec![0.1; 2],
        volumes: vec![1.0, 2.0],
        surface: 0.0,
    };
    let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.1, 2.0).unwrap());
    let mut two =
        Pcmm::new(method, steel().compiled(), &packing, |_| [1.0, -2.0], Masses::FromVolumes).unwrap();
    two.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.5 }).unwrap();
    two.run_until(2.0).unwrap();
    assert_eq!(two.elements(), 0);
    for (n, p) in two.particles().iter().enumerate() {
        assert!((p.position[0] - (2.0 + 5.0 * n as f64)).abs() < 1e-12);
        // The wall rises at 0.5 m/s and carries them.
        assert!((p.position[1] - 1.0).abs() < 1e-12 && (p.velocity[1] - 0.5).abs() < 1e-9, "{p:?}");
    }
    let given = two.exchange();
    assert!((given.impulse[1] - 2.5 * two.totals().mass).abs() < 1e-9 * two.totals().mass);
    // Kinetic energy: the initial one plus the work of the wall; the impact loss is booked separately.
    let change = 0.5 * two.totals().mass * (0.25 - 4.0);
    assert!((given.work - given.impacts - change).abs() < 1e-9 * change.abs(), "{} {change}", given.work);
    assert!((given.impacts - 0.5 * two.totals().mass * 2.5 * 2.5).abs() < 1e-9 * given.impacts);
}
