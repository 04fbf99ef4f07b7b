//! Check of weakly compressible liquids: their speed of sound has to be above ten times their speeds.

use super::Watcher;
use crate::body::Body;
use crate::clock::Clock;
use crate::finding::Finding;

/// Largest speed over the speed of sound: the density differs by half of its square, 1 %.
const FASTEST: f64 = 0.15;
/// Share of the mass that may be faster: single drops of a splash have no pressure.
const DROPS: f64 = 0.01;
/// Speed of sound over the largest speed that the remedy names.
const ENOUGH: f64 = 10.0;

impl Watcher {
    /// Warn of weakly compressible liquids of which more than 1 % is faster than 0.15 of their speed of sound, once a body.
    pub(super) fn look_for_compression(&mut self, clock: &Clock, bodies: &[&dyn Body]) {
        for body in bodies {
            let Some(sound) = body.chosen_sound_speed().filter(|sound| *sound > 0.0) else { continue };
            if self.knows(|f| matches!(f, Finding::Compressed { body: b, .. } if b == body.name())) {
                continue;
            }
            let (mut mass, mut fast, mut speeds) = (0.0, 0.0, Vec::new());
            body.for_each(&mut |p| {
                let speed = p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
                mass += p.mass;
                if speed > FASTEST * sound {
                    fast += p.mass;
                    speeds.push((speed, p.mass));
                }
            });
            if fast <= DROPS * mass {
                continue;
            }
            // The speed that a share of the mass exceeds.
            speeds.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut rest = DROPS * mass;
            let speed = speeds.iter().find(|(_, m)| {
                rest -= m;
                rest < 0.0
            });
            let speed = speed.map_or(FASTEST * sound, |(speed, _)| *speed);
            let (body, share) = (body.name().to_string(), fast / mass);
            self.warn_once(
                clock,
                Finding::Compressed { body, share, speed, sound, needed: ENOUGH * speed },
                |_| false,
            );
        }
    }
}
