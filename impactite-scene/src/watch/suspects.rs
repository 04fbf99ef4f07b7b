//! Default search for the body and point of a finding, for methods without a better criterion.

use crate::body::Body;
use crate::finding::{Finding, GainCause};

/// Return the name of the first body with non-finite sums; empty if there is none.
#[must_use]
pub fn not_finite(bodies: &[&dyn Body]) -> String {
    let broken = bodies.iter().find(|b| !b.totals().is_finite());
    broken.map(|b| b.name().to_string()).unwrap_or_default()
}

/// Return a closure for [`Watcher::look`](super::Watcher::look) that locates an energy gain at the fastest point. `why` returns the cause
/// and the remedy for a body number. Points are visited only after a gain.
pub fn gain_at_the_fastest<'a>(
    bodies: &'a [&'a dyn Body],
    why: impl FnOnce(usize) -> &'static str + 'a,
) -> impl FnOnce(f64, f64) -> Finding + 'a {
    move |share, joules| {
        let (mut fastest, mut position, mut of) = (-1.0, [0.0; 3], 0);
        for (n, body) in bodies.iter().enumerate() {
            body.for_each(&mut |p| {
                let square: f64 = p.velocity.iter().map(|v| v * v).sum();
                if square > fastest {
                    (fastest, position, of) = (square, p.position, n);
                }
            });
        }
        let body = bodies.get(of).map(|body| body.name().to_string()).unwrap_or_default();
        Finding::EnergyGain { share, joules, body, position, cause: GainCause::Other(why(of)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{PointView, Totals};

    struct Points(&'static str, Vec<f64>);

    impl Body for Points {
        fn name(&self) -> &str {
            self.0
        }
        fn law(&self) -> &'static str {
            ""
        }
        fn len(&self) -> usize {
            self.1.len()
        }
        fn state_names(&self) -> Vec<String> {
            Vec::new()
        }
        fn totals(&self) -> Totals {
            let mut sum = Totals::default();
            self.1.iter().for_each(|v| sum.add_point(1.0, &[0.0], &[*v]));
            sum
        }
        fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
            for (n, v) in self.1.iter().enumerate() {
                let position = [n as f64, 0.0, 0.0];
                visit(&PointView { position, velocity: [*v, 0.0, 0.0], ..PointView::default() });
            }
        }
        fn bytes(&self) -> usize {
            0
        }
    }

    #[test]
    fn a_gain_is_where_the_fastest_point_is() {
        let (slow, fast, wall) =
            (Points("slow", vec![1.0]), Points("fast", vec![0.0, 2.0, -3.0]), Points("wall", vec![]));
        let bodies: [&dyn Body; 3] = [&wall, &slow, &fast];
        let found =
            gain_at_the_fastest(&bodies, |n| ["of the wall", "of the slow", "of the fast"][n])(0.1, 5.0);
        let cause = GainCause::Other("of the fast");
        let (body, position) = ("fast".to_string(), [2.0, 0.0, 0.0]);
        assert_eq!(found, Finding::EnergyGain { share: 0.1, joules: 5.0, body, position, cause });
        assert_eq!(not_finite(&bodies), "");
        assert_eq!(not_finite(&[&slow, &Points("broken", vec![f64::NAN])]), "broken");
    }
}
