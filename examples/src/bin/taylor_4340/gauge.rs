//! Sizes of a bar from particles and their initial positions.
//!
//! Particles are within the surface or on it. Each row along an axis of the undeformed bar is extrapolated linearly through its last two
//! particles to the initial surface.

use sph::{Composition, Layout, Sph};

use crate::scene::{LENGTH, RADIUS};

/// Height of the second diameter above the face, over the initial length.
pub const WAIST: f64 = 0.2;

/// Sizes for comparison, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Length from the lowest point of the face to the mean of the other end.
    pub length: f64,
    /// Diameter of the face.
    pub face: f64,
    /// Diameter at [`WAIST`].
    pub waist: f64,
}

/// Point of the undeformed surface on the line from particle `behind` through `last`, at `share` of their distance beyond `last`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct End {
    last: usize,
    behind: usize,
    share: f64,
}

/// Particles that define the sizes, by their numbers in the layout.
#[derive(Clone, Debug)]
pub struct Gauge {
    foot: Vec<End>,
    top: Vec<End>,
    /// For each layer from the foot up: outermost ring of particles, ring behind, and extrapolation factor to the surface.
    mantle: Vec<([Vec<usize>; 2], f64)>,
}

/// Tolerance of equal initial coordinates, m.
const ROUNDING: f64 = 1e-9 * RADIUS;

impl Gauge {
    /// Create the gauge of a layout with rows along the axis, the last coordinate, in rings around it.
    pub fn of<const D: usize>(layout: &Layout<D>) -> Self {
        let at = &layout.positions;
        let height = |n: &usize| at[*n][D - 1];
        let layers = levels((0..at.len()).collect(), height);
        let end = |z: f64, last: Option<&Vec<usize>>, behind: Option<&Vec<usize>>| -> Vec<End> {
            let sorted = |layer: Option<&Vec<usize>>| {
                let mut layer = layer.cloned().unwrap_or_default();
                layer.sort_by(|a, b| {
                    at[*a][..D - 1].partial_cmp(&at[*b][..D - 1]).unwrap_or(std::cmp::Ordering::Equal)
                });
                layer
            };
            let rows = sorted(last).into_iter().zip(sorted(behind));
            rows.map(|(last, behind)| {
                let share = (z - height(&last)) / (height(&last) - height(&behind));
                End { last, behind, share }
            })
            .collect()
        };
        let radius = |n: &usize| radius(&at[*n]);
        let mantle = layers.iter().map(|layer| {
            let mut rings = levels(layer.clone(), radius);
            let mut outer = || rings.pop().unwrap_or_default();
            let rings = [outer(), outer()];
            let r = |ring: &Vec<usize>| ring.first().map_or(f64::NAN, radius);
            let share = (RADIUS - r(&rings[0])) / (r(&rings[0]) - r(&rings[1]));
            (rings, share)
        });
        Gauge {
            foot: end(0.0, layers.first(), layers.get(1)),
            top: end(LENGTH, layers.last(), layers.iter().rev().nth(1)),
            mantle: mantle.collect(),
        }
    }

    /// Return the current sizes of a body of this layout.
    pub fn sizes<const D: usize, M: Composition<D>>(&self, body: &Sph<D, M>) -> Sizes {
        let mut at = vec![[f64::NAN; D]; body.positions().len()];
        for (x, &n) in body.positions().iter().zip(body.numbers()) {
            at[n as usize] = *x;
        }
        self.measure(&at)
    }

    fn measure<const D: usize>(&self, at: &[[f64; D]]) -> Sizes {
        let height = |end: &End| on(end.share, at[end.last][D - 1], at[end.behind][D - 1]);
        let lowest = self.foot.iter().map(height).fold(f64::INFINITY, f64::min);
        let top = mean(self.top.iter().map(height));
        let outline: Vec<[f64; 2]> = self
            .mantle
            .iter()
            .map(|(rings, share)| {
                let of = |what: &dyn Fn(&[f64; D]) -> f64| {
                    let [outer, inner] = [0, 1].map(|k| mean(rings[k].iter().map(|n| what(&at[*n]))));
                    on(*share, outer, inner)
                };
                [of(&|x| radius(x)), of(&|x| x[D - 1])]
            })
            .collect();
        // The face is extrapolated along the axis, too.
        let ends = |ring: &[usize]| {
            let of = self.foot.iter().filter(|end| ring.contains(&end.last));
            mean(of.map(|end| on(end.share, radius(&at[end.last]), radius(&at[end.behind]))))
        };
        let face = self
            .mantle
            .first()
            .map_or(f64::NAN, |(rings, share)| on(*share, ends(&rings[0]), ends(&rings[1])));
        let waist = radius_at(&outline, lowest + WAIST * LENGTH);
        Sizes { length: top - lowest, face: 2.0 * face, waist: 2.0 * waist }
    }
}

/// Group numbers of equal `key`, in order of the key.
fn levels(mut list: Vec<usize>, key: impl Fn(&usize) -> f64) -> Vec<Vec<usize>> {
    list.sort_by(|a, b| key(a).total_cmp(&key(b)));
    list.chunk_by(|a, b| key(b) - key(a) < ROUNDING).map(<[usize]>::to_vec).collect()
}

/// Return the distance from the axis.
fn radius<const D: usize>(x: &[f64; D]) -> f64 {
    x[..D - 1].iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / count
}

/// Extrapolate from `behind` through `last` by `share` of their distance.
fn on(share: f64, last: f64, behind: f64) -> f64 {
    last + share * (last - behind)
}

/// Interpolate the radius of an outline of radii and heights at a height; NaN outside.
fn radius_at(outline: &[[f64; 2]], height: f64) -> f64 {
    let around = outline.windows(2).find(|pair| pair[0][1] <= height && height < pair[1][1]);
    around.map_or(f64::NAN, |pair| {
        let ([r, low], [above, high]) = (pair[0], pair[1]);
        r + (height - low) / (high - low) * (above - r)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{quarter, scene};

    /// Map to a cone of two thirds of the length with a face of twice the radius.
    fn cone<const D: usize>(x: &[f64; D]) -> [f64; D] {
        let z = x[D - 1];
        std::array::from_fn(|d| if d < D - 1 { x[d] * (2.0 - z / LENGTH) } else { 2.0 / 3.0 * z + 1e-4 })
    }

    fn is_measured<const D: usize>(layout: &Layout<D>) {
        let at: Vec<[f64; D]> = layout.positions.iter().map(cone).collect();
        let Sizes { length, face, waist } = Gauge::of(layout).measure(&at);
        let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 1e-9, "{value} {exact}");
        near(length, 2.0 / 3.0 * LENGTH);
        near(face, 4.0 * RADIUS);
        near(waist, 2.0 * RADIUS * (2.0 - 1.5 * WAIST));
    }

    #[test]
    fn a_cone_is_measured_whatever_the_layout() {
        is_measured(&scene::within(RADIUS / 5.0).unwrap());
        is_measured(&scene::on_the_ends(RADIUS / 5.0).unwrap());
        is_measured(&quarter::layout(RADIUS / 5.0));
    }
}
