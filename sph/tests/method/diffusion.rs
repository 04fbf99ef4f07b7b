//! Density diffusion.

use impactite_scene::{Axisymmetric, Embedding, FullSpace, PlaneStrain, Solver, TimeControl, Watch};
use mpm_materials::{Fluid, Tait};
use sph::{
    ArtificialStress, Composition, DensityDiffusion, GradientCorrection, Kernel, Layout, Method,
    PairViscosity, Sph, Updated, WendlandC2,
};

use crate::common::{block, noise};

type Water = Fluid<Tait<f64>>;

/// Water of density 1 and wave speed 1.
fn water() -> Water {
    Fluid::new(Tait::new(1.0, 1.0).unwrap())
}

const KERNEL: WendlandC2 = WendlandC2::NARROW;

fn method<const D: usize, E: Embedding<D> + std::fmt::Debug>(space: E) -> impl Composition<D> {
    Method::new(space, KERNEL, Updated, GradientCorrection, DensityDiffusion::default())
}

/// Disordered particles, far from an axis.
fn disordered<const D: usize>(hoop: bool) -> Layout<D> {
    let mut layout = block([0.0; D], [6.0; D], 1.0, false);
    for (n, (x, volume)) in layout.positions.iter_mut().zip(&mut layout.volumes).enumerate() {
        let shift = noise(*x, n as f64);
        (0..D).for_each(|d| x[d] += 0.15 * shift[d]);
        if hoop {
            x[0] += 20.0;
            *volume = x[0];
        }
    }
    layout
}

/// Water at rest with this initial density.
fn at_rest<const D: usize, M: Composition<D>>(
    method: M,
    layout: &Layout<D>,
    density: impl Fn([f64; D]) -> f64,
) -> Sph<D, M> {
    let mut body = Sph::new(method, water(), layout, |_| [0.0; D]).unwrap();
    body.set_watch(Watch::off());
    body.set_states::<Water>(|x, mut state| {
        state.volume_ratio = 1.0 / density(x);
        state
    })
    .unwrap();
    body
}

fn densities<const D: usize, M: Composition<D>>(body: &Sph<D, M>) -> Vec<f64> {
    (0..body.positions().len()).map(|i| body.mass(i) / volume(body, i)).collect()
}

fn volume<const D: usize, M: Composition<D>>(body: &Sph<D, M>, i: usize) -> f64 {
    body.material().describe_point(&body.particle_state(i).unwrap()).unwrap().volume_ratio * body.mass(i)
}

/// Return the rate of the logarithm of density, summed over every pair by the formula.
fn plain<const D: usize, M: Composition<D>>(body: &Sph<D, M>, delta: f64) -> Vec<f64> {
    let hoop = M::Embedding::HOOP;
    let (places, rho) = (body.positions(), densities(body));
    let (count, h) = (places.len(), KERNEL.ratio());
    // Kernel derivative over r.
    let slope = |i: usize, j: usize| {
        let r = (0..D).map(|d| (places[i][d] - places[j][d]).powi(2)).sum::<f64>().sqrt();
        let inside = j != i && r < 2.0 * h;
        if inside { KERNEL.norm(D) * KERNEL.slope(r / h) / h.powi(D as i32 + 2) } else { 0.0 }
    };
    let area = |j: usize| volume(body, j) / if hoop { places[j][0] } else { 1.0 };
    let away = |i: usize, j: usize, d: usize| places[j][d] - places[i][d];
    let gradient = |i: usize| {
        let mut moments = nalgebra::DMatrix::<f64>::zeros(D, D);
        let mut sum = nalgebra::DVector::<f64>::zeros(D);
        for j in 0..count {
            let weight = -area(j) * slope(i, j);
            for a in 0..D {
                sum[a] += weight * (rho[j] - rho[i]) * away(i, j, a);
                (0..D).for_each(|c| moments[(a, c)] += weight * away(i, j, a) * away(i, j, c));
            }
        }
        moments.try_inverse().unwrap() * sum
    };
    let gradients: Vec<_> = (0..count).map(gradient).collect();
    let speed =
        |i: usize| body.material().describe_point(&body.particle_state(i).unwrap()).unwrap().wave_speed;
    let speeds: Vec<f64> = (0..count).map(speed).collect();
    let of = |i: usize| {
        let mut sum = 0.0;
        for j in 0..count {
            let linear: f64 = (0..D).map(|d| 0.5 * (gradients[i][d] + gradients[j][d]) * away(i, j, d)).sum();
            let c = 0.5 * (speeds[i] + speeds[j]);
            sum -= area(j) * slope(i, j) * 2.0 * delta * h * c * (rho[j] - rho[i] - linear);
        }
        sum / rho[i]
    };
    (0..count).map(of).collect()
}

/// Return the largest deviation of the rates of a step from the plain sums, over the largest rate.
fn off<const D: usize, M: Composition<D>>(method: M, hoop: bool) -> f64 {
    let mut body = at_rest(method, &disordered::<D>(hoop), |x| 1.0 + 1e-2 * noise(x, 5.0)[0]);
    let (dt, before, wanted) = (1e-7, densities(&body), plain(&body, 0.1));
    body.set_time_control(TimeControl::Fixed(dt)).unwrap();
    body.step_at_most(f64::INFINITY).unwrap();
    let after = densities(&body);
    let largest = wanted.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let rates = before.iter().zip(&after).map(|(before, after)| (after / before).ln() / dt);
    rates.zip(&wanted).map(|(found, wanted)| (found - wanted).abs() / largest).fold(0.0, f64::max)
}

#[test]
fn rates_are_the_plain_sums() {
    for (name, off) in [
        ("plane", off(method(PlaneStrain), false)),
        ("around the axis", off(method(Axisymmetric), true)),
        ("space", off(method(FullSpace), false)),
    ] {
        assert!(off < 1e-4, "{name}: {off:e}");
    }
}

#[test]
fn a_density_that_is_linear_stays_up_to_the_surface() {
    let linear = |x: [f64; 2]| 1.0 + 1e-2 * x[0] - 2e-2 * x[1];
    let mut body = at_rest(method(PlaneStrain), &disordered::<2>(false), linear);
    let (dt, before) = (1e-7, densities(&body));
    body.set_time_control(TimeControl::Fixed(dt)).unwrap();
    body.step_at_most(f64::INFINITY).unwrap();
    // Motion in this time changes densities by 1e-7 of their differences, and so does rounding.
    let rates = before.iter().zip(densities(&body)).map(|(before, after)| ((after / before).ln() / dt).abs());
    let largest = rates.fold(0.0, f64::max);
    assert!(largest < 1e-2 * 1e-4, "{largest:e}");
}

/// The energy exchange of density diffusion with the law is booked, with any other stabilisation too, and momentum is conserved.
#[test]
fn energy_that_diffusion_makes_or_takes_is_booked() {
    fn check<M: Composition<2>>(stabilisation: M) {
        let mut body = at_rest(stabilisation, &disordered::<2>(false), |x| 1.0 + 0.02 * noise(x, 2.0)[0]);
        // The energy error of the leapfrog is proportional to the square of the step.
        body.set_time_control(TimeControl::Courant { factor: 0.175, growth: 1.1 }).unwrap();
        let before = body.totals();
        body.run_until(3.0).unwrap();
        let (after, booked) = (body.totals(), (body.exchange().impacts + body.exchange().viscosity));
        let energy = |t: &impactite_scene::Totals| t.kinetic + t.internal;
        let error = energy(&after) + booked - energy(&before);
        assert!(booked > 0.1 * energy(&before), "{}: {booked:e}", body.describe());
        assert!(error.abs() < 0.02 * booked, "{}: {error:e} of {booked:e}", body.describe());
        assert!(after.momentum[0].abs() < 1e-12 * after.momentum_scale);
    }
    let with = DensityDiffusion::default();
    let wide = WendlandC2::default();
    check(Method::new(PlaneStrain, wide, Updated, GradientCorrection, with));
    check(Method::new(PlaneStrain, wide, Updated, GradientCorrection, (ArtificialStress::default(), with)));
    check(Method::new(PlaneStrain, wide, Updated, GradientCorrection, (PairViscosity::default(), with)));
    let all = (ArtificialStress::default(), PairViscosity::default(), with);
    check(Method::new(PlaneStrain, wide, Updated, GradientCorrection, all));
}

#[test]
fn coefficients_that_cannot_be_are_refused() {
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        let said = DensityDiffusion::new(bad).expect_err("refused").to_string();
        assert!(said.contains("delta of the diffusion of density"), "{said}");
    }
}
