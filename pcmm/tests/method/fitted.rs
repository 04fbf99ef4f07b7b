//! Packings up to the surface of shapes: what their elements cover.

use impactite_geometry::{Ball, Cylinder, Lattice, Polygon, Shape, Shell};
use impactite_scene::{Embedding, FullSpace, PlaneStrain, SceneError, Solver};
use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
use pcmm::{LocalDelaunay, Masses, Method, Packing, Pcmm};

use crate::common::random;

/// Spacing, m.
const H: f64 = 0.1;
/// Density, kg/m^3.
const DENSITY: f64 = 1000.0;

fn law() -> Solid<Elastic<f64>, LogarithmicBulk<f64>> {
    let moduli = Moduli::young_poisson(1e6, 0.3).unwrap();
    Solid::new(Elastic::new(moduli.shear).unwrap(), LogarithmicBulk::new(DENSITY, moduli.bulk).unwrap())
}

/// Volume that the elements of a shape's packing cover over that of the shape, and offset of their centroid in spacings.
fn covered<const D: usize>(embedding: impl Embedding<D>, tolerance: f64, shape: &dyn Shape<D>) -> (f64, f64) {
    let mut packing = Packing::fitted(shape, &Lattice::new([0.0; D], H).unwrap()).unwrap();
    let delaunay = LocalDelaunay::new(tolerance * H, 2.0).unwrap();
    let method = Method::consistent(embedding, delaunay);
    let made = loop {
        let law = law();
        match Pcmm::new(method, law, &packing, |_| [0.0; D], Masses::FromElements) {
            Ok(made) => break made,
            Err(SceneError::NoMass { particle, .. }) => {
                packing.positions.remove(particle);
                packing.radii.remove(particle);
            }
            Err(error) => panic!("{error}"),
        }
    };
    let (mut mass, mut moment) = (0.0, [0.0; D]);
    made.bodies()[0].for_each(&mut |p| {
        mass += p.mass;
        (0..D).for_each(|d| moment[d] += p.mass * p.position[d]);
    });
    let (measure, centre) = (shape.measure().unwrap(), shape.centroid().unwrap());
    let off = (0..D).map(|d| (moment[d] / mass - centre[d]).powi(2)).sum::<f64>().sqrt() / H;
    (mass / DENSITY / measure, off)
}

/// Polygon of these corners, turned and moved at random.
fn polygon(corners: &[[f64; 2]], seed: u64) -> Polygon {
    let (sin, cos) = (6.0 * random(seed, 0)).sin_cos();
    let at = |[x, y]: &[f64; 2]| [random(seed, 1) + cos * x - sin * y, random(seed, 2) + sin * x + cos * y];
    Polygon::new(corners.iter().map(at).collect()).unwrap()
}

#[test]
fn elements_cover_shapes_wherever_they_are() {
    let hexagon: Vec<[f64; 2]> =
        (0..6).map(|n| f64::from(n) * std::f64::consts::FRAC_PI_3).map(|a| [a.cos(), a.sin()]).collect();
    let triangle = [[0.0, 0.0], [1.6, 0.0], [0.6, 1.3]];
    let angle = [[0.0, 0.0], [1.5, 0.0], [1.5, 0.6], [0.6, 0.6], [0.6, 1.3], [0.0, 1.3]];
    for seed in 0..8 {
        let centre = [random(seed, 5), random(seed, 6)];
        let shapes: [(&str, Box<dyn Shape<2>>); 5] = [
            ("hexagon", Box::new(polygon(&hexagon, seed))),
            ("triangle", Box::new(polygon(&triangle, seed))),
            ("angle", Box::new(polygon(&angle, seed))),
            ("disc", Box::new(Ball::new(centre, 0.6 + 0.4 * random(seed, 7)).unwrap())),
            ("ring", Box::new(Shell::new(centre, 0.5, 0.9 + 0.2 * random(seed, 7)).unwrap())),
        ];
        for (name, shape) in shapes {
            let (part, off) = covered(PlaneStrain, 0.5, &*shape);
            assert!(
                (0.97..1.01).contains(&part) && off < 0.1,
                "{name} {seed}: {part} of the volume, {off} h"
            );
        }
    }
    for seed in 0..3 {
        let centre = [random(seed, 5), random(seed, 6), random(seed, 7)];
        let direction = [random(seed, 8), random(seed, 9), 0.3];
        let shapes: [(&str, Box<dyn Shape<3>>); 2] = [
            ("ball", Box::new(Ball::new(centre, 0.5).unwrap())),
            ("rod", Box::new(Cylinder::<3>::new(centre, direction, 1.0, 0.4).unwrap())),
        ];
        for (name, shape) in shapes {
            let (part, off) = covered(FullSpace, 0.8, &*shape);
            assert!(
                (0.97..1.01).contains(&part) && off < 0.1,
                "{name} {seed}: {part} of the volume, {off} h"
            );
        }
    }
}
