//! Conformance tests of bodies of particles.

use super::{Broken, ROUND_OFF, require};
use crate::particles::ParticleBody;
use crate::vector::{difference, length, sum, times, unit, wide};

/// Number of checked steps.
const STEPS: usize = 4;

/// Test a body of particles: particles are its points; surface data are finite and in its dimensions; an impulse changes the velocity of
/// one particle by that over its mass; a step conserves momentum except for the exchange (along the axis, if axisymmetric). `make` creates
/// a body of at least one particle that can make some steps of 1e-3 over its Courant rate.
///
/// # Errors
/// First violated property.
pub fn particle_body<const D: usize, B: ParticleBody<D>>(make: impl Fn() -> B) -> Result<(), Broken> {
    let mut body = make();
    body.rename("another name".into());
    require(body.name() == "another name", "a body is called as it was renamed", || body.name().into())?;
    let rate = body.rate();
    require(rate > 0.0 && rate.is_finite(), "a positive Courant rate", || format!("{rate} 1/s"))?;
    let mut start = vec![[f64::NAN; D]; 7];
    for n in 0..STEPS {
        particles(&body)?;
        surface(&body)?;
        step(&mut body, 1e-3 / rate, n, &mut start)?;
    }
    Ok(())
}

/// Check that particles are the points of the body, finite, with masses and radii.
fn particles<const D: usize>(body: &impl ParticleBody<D>) -> Result<(), Broken> {
    let points = body.points();
    require(!points.is_empty() && points.len() == body.len(), "particles that are counted", || {
        format!("{} of {}", points.len(), body.len())
    })?;
    let mut fastest = 0.0f64;
    for (n, point) in points.iter().enumerate() {
        let p = body.particle(n);
        let show = || format!("particle {n} is {p:?}, and the point {:?}", (point.position, point.velocity));
        let finite = p.position.iter().chain(&p.velocity).all(|x| x.is_finite());
        require(finite, "finite positions and velocities", show)?;
        require(p.mass > 0.0 && p.mass.is_finite(), "a positive mass", show)?;
        require(p.radius > 0.0 && p.radius.is_finite(), "a positive radius", show)?;
        // Points have velocities at the time of their positions, particles those at the start of the next step: half a step apart.
        let apart = p.velocity.iter().zip(&point.velocity).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let speed = point.velocity.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let same = wide(&p.position) == point.position
            && apart <= 0.01 * speed.max(fastest)
            && p.mass == point.mass
            && point.number == n;
        require(same, "particles that are the points of the body", show)?;
        fastest = fastest.max(length(wide(&p.velocity)));
    }
    let error = (body.fastest() - fastest).abs();
    require(error <= ROUND_OFF * fastest, "the greatest speed is that of a particle", || {
        format!("{} m/s, and {fastest} m/s of the particles", body.fastest())
    })
}

/// Check the surface data of a body.
fn surface<const D: usize>(body: &impl ParticleBody<D>) -> Result<(), Broken> {
    for n in 0..body.len() {
        let (facing, beyond) = (body.facing(n), body.beyond(n));
        let show = || format!("{facing:?}, surface {beyond} m beyond particle {n}");
        let vectors = [facing.area, facing.mass];
        require(vectors.iter().flatten().all(|c| c.is_finite()), "a finite surface", show)?;
        let flat = vectors.iter().all(|v| v[D.min(3)..].iter().all(|c| *c == 0.0));
        require(flat, "a surface in the dimensions of the scene", show)?;
        // On the axis an area per radian is zero.
        let on_axis = body.axisymmetric() && body.particle(n).position[0] == 0.0;
        let both = facing.lone || on_axis || (length(facing.area) > 0.0) == (length(facing.mass) > 0.0);
        require(both, "area and mass of a surface that are both zero, or none", show)?;
        require(beyond >= 0.0 && beyond.is_finite(), "a surface at or beyond the centre", show)?;
        let mut near = Vec::new();
        body.around(n, &mut |m| near.push(m));
        let count = near.len();
        let own = near.contains(&n) && near.iter().all(|m| *m < body.len());
        near.sort_unstable();
        near.dedup();
        require(
            own && near.len() == count,
            "each particle of a piece of surface once, the one asked for among them",
            || format!("{near:?} around particle {n}"),
        )?;
        let traction = body.traction(n, &unit(facing.area).unwrap_or_default());
        require(traction.is_finite(), "a finite traction", || format!("{traction} Pa at particle {n}"))?;
    }
    Ok(())
}

/// Check a step with an impulse on one particle.
fn step<const D: usize>(
    body: &mut impl ParticleBody<D>,
    dt: f64,
    round: usize,
    start: &mut Vec<[f64; D]>,
) -> Result<(), Broken> {
    let velocities = |body: &dyn ParticleBody<D>| -> Vec<[f64; D]> {
        (0..body.len()).map(|n| body.particle(n).velocity).collect()
    };
    let made =
        |what: Result<(), String>| what.or_else(|error| require(false, "a body that makes steps", || error));
    let (before, totals, exchange) = (velocities(body), body.totals(), body.exchange());
    made(body.check(dt).map_err(|e| e.to_string()))?;
    made(body.accelerate(dt, start).map_err(|e| e.to_string()))?;
    require(*start == before, "the velocities at the start of a step are kept", || {
        format!("{} of {} particles", start.len(), body.len())
    })?;
    let trial = velocities(body);
    let n = (7 * round) % body.len();
    let mass = body.particle(n).mass;
    let impulse: [f64; 3] = std::array::from_fn(|d| if d < D { 1e-3 * mass * (d as f64 + 1.0) } else { 0.0 });
    body.push(n, &impulse);
    for (m, (now, then)) in velocities(body).iter().zip(&trial).enumerate() {
        let change = difference(wide(now), wide(then));
        let wanted = if m == n { times(impulse, 1.0 / mass) } else { [0.0; 3] };
        let error = length(difference(change, wanted));
        let scale = length(wide(then)) + length(wanted);
        require(error <= ROUND_OFF * scale, "an impulse is on one particle", || {
            format!(
                "{impulse:?} N s on {mass} kg of particle {n} changed the velocity of {m} by {change:?} m/s"
            )
        })?;
    }
    made(body.advance(dt, start).map_err(|e| e.to_string()))?;
    made(body.finish(dt).map_err(|e| e.to_string()))?;
    let (now, given) = (body.totals(), body.exchange());
    let given = sum(difference(given.impulse, exchange.impulse), difference(given.load, exchange.load));
    let change = difference(now.momentum, totals.momentum);
    let mut missing = difference(change, sum(given, impulse));
    if body.axisymmetric() {
        // Hoop stresses act along the radius.
        missing[0] = 0.0;
    }
    let missing = length(missing);
    let scale = totals.momentum_scale.max(now.momentum_scale) + length(given);
    require(missing <= 1e-12 * scale, "momentum is conserved", || format!("{missing} of {scale} kg m/s"))
}
