//! Laws other than friction, refused input, and checkpoints.

use impactite_scene::{Archive, CheckpointError};
use impactite_simd::Team;
use mpm_contact::mesh::{ContactBody, MeshContact};
use mpm_contact::{Adhesion, Coulomb, Frictionless, Penalty, SlipWeakening, Stick};

use crate::scene::{Body, advance, collide, outline};

fn fixed() -> Body<2> {
    let mut square = outline([0.0; 2], [1.0; 2], [4, 4]);
    square.m.fill(f64::INFINITY);
    square
}

#[test]
fn glue_holds_what_touches_and_nothing_else() {
    let points = Body::points(vec![[0.3, 1.05], [0.7, 1.08]], 1.0, 0.05).moving([1.0, 2.0]);
    let mut bodies = [points, fixed()];
    let mut contact = MeshContact::new(Frictionless).with(0, 1, Stick).between(0, 1);
    collide(&mut contact, &mut bodies, 1e-3, &Team::one());
    assert!(bodies[0].v[0].iter().all(|v| v.abs() < 1e-12));
    assert_eq!(bodies[0].v[1], [1.0, 2.0]);
    // Adhesion up to a strength: traction m v / (dt spacing) = 1 * 2 / (1e-3 * 0.1) = 2e4 Pa.
    for (strength, holds) in [(3e4, true), (1e4, false)] {
        let mut bodies = [Body::points(vec![[0.3, 1.05]], 1.0, 0.05).moving([0.0, 2.0]), fixed()];
        let law = Adhesion::new(strength, strength, 0.0).unwrap();
        collide(&mut MeshContact::new(law).between(0, 1), &mut bodies, 1e-3, &Team::one());
        assert_eq!(bodies[0].v[0][1].abs() < 1e-12, holds);
    }
}

#[test]
fn springs_give_back() {
    let law = Penalty::new(300.0, 1.0, 0.0).unwrap();
    let mut bodies = [Body::points(vec![[0.3, 1.06]], 1.0, 0.05).moving([0.0, -1.0]), fixed()];
    let mut contact = MeshContact::new(law).between(0, 1);
    for _ in 0..4000 {
        advance(&mut contact, &mut bodies, 1e-5);
    }
    assert!((bodies[0].v[0][1] - 1.0).abs() < 0.01, "{:?}", bodies[0].v);
}

#[test]
fn what_cannot_be_is_refused() {
    let team = Team::one();
    let (square, point) = (fixed(), Body::points(vec![[0.3, 1.05]], 1.0, 0.05));
    let said = |contact: &mut MeshContact<2>, bodies: &[ContactBody<'_, 2>], dt| {
        contact.step(bodies, 0.0, dt, &team).expect_err("refused").to_string()
    };
    let slip = SlipWeakening::new(0.5, 0.3, 1e-3).unwrap();
    let forgets = said(&mut MeshContact::new(slip).between(0, 1), &[point.view(), square.view()], 1e-3);
    assert!(forgets.contains("remembers") && forgets.contains("Coulomb"), "{forgets}");
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    let no_facets = said(&mut contact, &[point.view(), point.view()], 1e-3);
    assert!(no_facets.contains("no facets"), "{no_facets}");
    assert!(said(&mut contact, &[point.view()], 1e-3).contains("number of a body in contact = 1"));
    assert!(said(&mut contact, &[point.view(), square.view()], 0.0).contains("time step = 0"));
    let mut bad = point.clone();
    bad.v[0][1] = f64::NAN;
    assert!(said(&mut contact, &[bad.view(), square.view()], 1e-3).contains("trial velocity = NaN"));
    let mut bad = point.clone();
    bad.m[0] = 0.0;
    assert!(said(&mut contact, &[bad.view(), square.view()], 1e-3).contains("mass = 0"));
    let mut bad = point.clone();
    bad.half[0] = 0.0;
    assert!(said(&mut contact, &[bad.view(), square.view()], 1e-3).contains("half size = 0"));
    let mut bad = square.clone();
    bad.facets[2].nodes[1] = 99;
    assert!(said(&mut contact, &[point.view(), bad.view()], 1e-3).contains("node of a facet = 99"));
    let mut bad = square.clone();
    bad.facets[2].nodes[2] = 3;
    assert!(said(&mut contact, &[point.view(), bad.view()], 1e-3).contains("number of nodes of a facet = 3"));
    let mut bad = square.clone();
    bad.m.pop();
    assert!(said(&mut contact, &[point.view(), bad.view()], 1e-3).contains("masses"));
}

#[test]
fn a_checkpoint_goes_on_with_the_same_bits() {
    let path = std::env::temp_dir().join(format!("mesh-contact-{}.gz", std::process::id()));
    let scene = || {
        let x = (0..20).map(|i| [0.05 * f64::from(i), 1.06 + 0.01 * f64::from(i % 3)]).collect();
        let points = Body::points(x, 1.0, 0.05).moving([2.0, -3.0]);
        let mut square = outline([0.0; 2], [1.0; 2], [4, 4]);
        square.m.fill(3.0);
        (MeshContact::new(Coulomb::new(0.3).unwrap()).between(0, 1), [points, square])
    };
    let (mut contact, mut bodies) = scene();
    let run = |contact: &mut MeshContact<2>, bodies: &mut [Body<2>; 2]| {
        (0..20).for_each(|_| {
            advance(contact, bodies, 1e-3);
        });
    };
    run(&mut contact, &mut bodies);
    let mut file = Archive::create(&path).unwrap();
    contact.archive(&mut file).unwrap();
    file.close().unwrap();
    let saved = bodies.clone();
    run(&mut contact, &mut bodies);
    let (mut other, _) = scene();
    let mut again = saved;
    let mut file = Archive::open(&path).unwrap();
    other.archive(&mut file).unwrap();
    file.close().unwrap();
    run(&mut other, &mut again);
    assert!(bodies == again && contact.pairs() == other.pairs());
    let mut stranger = MeshContact::<2>::new(Frictionless).between(0, 1);
    let refused = stranger.archive(&mut Archive::open(&path).unwrap());
    assert!(matches!(refused, Err(CheckpointError::OtherScene { .. })));
    std::fs::remove_file(&path).unwrap();
}
