//! Camera, mirrors and cuts.

use super::super::{FARTHEST, OutputError, Snapshot, is_place};

/// Symmetry plane normal to an axis, across which a picture mirrors the particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// Axis normal to the plane: 0 is x, 1 is y, 2 is z.
    pub axis: usize,
    /// Coordinate of the plane along that axis, m.
    pub at: f64,
}

impl Mirror {
    /// Create the plane x = `at` (m).
    #[must_use]
    pub fn x(at: f64) -> Self {
        Self { axis: 0, at }
    }
    /// Create the plane y = `at` (m).
    #[must_use]
    pub fn y(at: f64) -> Self {
        Self { axis: 1, at }
    }
    /// Create the plane z = `at` (m).
    #[must_use]
    pub fn z(at: f64) -> Self {
        Self { axis: 2, at }
    }

    /// Compute all copies of a point under a list of mirrors, the point itself first.
    pub(crate) fn copies(mirrors: &[Self], point: [f64; 3], copies: &mut Vec<[f64; 3]>) {
        copies.clear();
        copies.push(point);
        for mirror in mirrors {
            for i in 0..copies.len() {
                let mut copy = copies[i];
                copy[mirror.axis] = 2.0 * mirror.at - copy[mirror.axis];
                copies.push(copy);
            }
        }
    }

    pub(crate) fn check(mirrors: &[Self]) -> Result<(), OutputError> {
        if mirrors.len() > 6 {
            return Err(OutputError::value("number of mirrors", mirrors.len(), "at most 6 (64 copies)"));
        }
        for mirror in mirrors {
            if mirror.axis > 2 {
                return Err(OutputError::value("axis of a mirror", mirror.axis, "0, 1 or 2"));
            }
            if !(-FARTHEST..=FARTHEST).contains(&mirror.at) {
                return Err(OutputError::value(
                    "place of a mirror",
                    mirror.at,
                    "at most 1e30 m from the origin",
                ));
            }
        }
        Ok(())
    }
}

/// Cutting plane: matter beyond it, on the side of its normal, is not drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Normal, towards the removed side; any length.
    pub normal: [f64; 3],
    /// Point of the plane, m.
    pub through: [f64; 3],
}

impl Cut {
    pub(crate) fn removes(&self, x: [f64; 3]) -> bool {
        dot(self.normal, sub(x, self.through)) > 0.0
    }
}

/// Camera: position, target and field of view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    from: [f64; 3],
    at: [f64; 3],
    up: [f64; 3],
    width: f64,
    height: f64,
    perspective: bool,
}

impl Camera {
    /// Create a camera that looks from one point at another (m), with `up` (any length) upwards in the picture; the plane
    /// through `at` is visible over `width` (m). Projection is orthographic unless
    /// [`with_perspective`](Self::with_perspective).
    ///
    /// # Errors
    /// Coordinates beyond 1e30, a width outside 1e-30 to 1e30 m, `from` equal to `at`, or `up` parallel to the line
    /// of sight.
    pub fn looking(from: [f64; 3], at: [f64; 3], up: [f64; 3], width: f64) -> Result<Self, OutputError> {
        if ![from, at, up].iter().all(is_place) {
            let given = format!("{from:?}, {at:?}, {up:?}");
            return Err(OutputError::value("camera", given, "numbers of a magnitude of at most 1e30"));
        }
        if !(1.0 / FARTHEST..=FARTHEST).contains(&width) {
            return Err(OutputError::value("camera width", width, "a length from 1e-30 to 1e30 m"));
        }
        let toward = sub(from, at);
        let side = cross(up, toward);
        if dot(side, side) <= 1e-20 * dot(up, up) * dot(toward, toward) {
            let given = format!("from {from:?} at {at:?}, up {up:?}");
            return Err(OutputError::value(
                "camera",
                given,
                "two different points, and up not along their line",
            ));
        }
        Ok(Self { from, at, up, width, height: 0.0, perspective: false })
    }

    /// Frame a snapshot and its mirror copies, seen from the direction `toward` (from the matter to the eye, any
    /// length).
    ///
    /// # Errors
    /// A snapshot without particles at finite positions, or the errors of [`looking`](Self::looking) for the directions.
    pub fn fit(
        snapshot: &Snapshot,
        mirrors: &[Mirror],
        toward: [f64; 3],
        up: [f64; 3],
    ) -> Result<Self, OutputError> {
        let [low, high] = Self::extent(snapshot, mirrors, toward, up)?;
        Self::framing(low, high, toward, up)
    }

    /// Bounding box of a snapshot and its mirror copies along the directions of a camera ([`basis`](Self::basis)), m.
    pub(crate) fn extent(
        snapshot: &Snapshot,
        mirrors: &[Mirror],
        toward: [f64; 3],
        up: [f64; 3],
    ) -> Result<[[f64; 3]; 2], OutputError> {
        Mirror::check(mirrors)?;
        let basis = Self::looking(toward, [0.0; 3], up, 1.0)?.basis();
        let mut lo = [f64::INFINITY; 3];
        let mut hi = [f64::NEG_INFINITY; 3];
        let mut copies = Vec::new();
        let mut hold = |x: [f64; 3], half: f64| {
            Mirror::copies(mirrors, x, &mut copies);
            for x in &copies {
                for (d, axis) in basis.into_iter().enumerate() {
                    let place = dot(axis, *x);
                    lo[d] = lo[d].min(place - half);
                    hi[d] = hi[d].max(place + half);
                }
            }
        };
        for (i, x) in snapshot.positions().iter().enumerate() {
            if is_place(x) {
                hold(*x, 0.75 * snapshot.size_of(i));
            }
        }
        if let Some(cells) = snapshot.cells() {
            cells.nodes.iter().filter(|x| is_place(x)).for_each(|x| hold(*x, 0.0));
        }
        if lo[0] > hi[0] {
            return Err(OutputError::value(
                "number of particles to frame",
                0,
                "at least 1, at a finite place",
            ));
        }
        Ok([lo, hi])
    }

    /// Bounding box, along the directions of a camera, of an axis-aligned box and its mirror copies, m.
    pub(crate) fn extent_of_box(
        [low, high]: [[f64; 3]; 2],
        mirrors: &[Mirror],
        toward: [f64; 3],
        up: [f64; 3],
    ) -> Result<[[f64; 3]; 2], OutputError> {
        let basis = Self::looking(toward, [0.0; 3], up, 1.0)?.basis();
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut copies = Vec::new();
        for corner in 0..8 {
            let x = [0, 1, 2].map(|d| if corner >> d & 1 == 0 { low[d] } else { high[d] });
            Mirror::copies(mirrors, x, &mut copies);
            for (copy, (d, axis)) in copies.iter().flat_map(|x| basis.iter().enumerate().map(move |a| (x, a)))
            {
                let place = dot(*axis, *copy);
                (lo[d], hi[d]) = (lo[d].min(place), hi[d].max(place));
            }
        }
        Ok([lo, hi])
    }

    /// Frame a box along the directions of the camera, m.
    pub(crate) fn framing(
        lo: [f64; 3],
        hi: [f64; 3],
        toward: [f64; 3],
        up: [f64; 3],
    ) -> Result<Self, OutputError> {
        let [right, top, out] = Self::looking(toward, [0.0; 3], up, 1.0)?.basis();
        let mid = [0, 1, 2].map(|d| 0.5 * (lo[d] + hi[d]));
        let at = [0, 1, 2].map(|c| right[c] * mid[0] + top[c] * mid[1] + out[c] * mid[2]);
        let span = (0..3).map(|d| hi[d] - lo[d]).fold(0.0, f64::max);
        let from = [0, 1, 2].map(|c| at[c] + 3.5 * span * out[c]);
        let (width, height) = (hi[0] - lo[0], hi[1] - lo[1]);
        // Far from the origin, a small span is lost to rounding.
        if !(width > 0.0 && height > 0.0 && sub(from, at) != [0.0; 3]) {
            let allowed = "more than the rounding of the particles' coordinates";
            return Err(OutputError::value("extent of the snapshot", span, allowed));
        }
        Ok(Self { from, at, up, width, height, perspective: false })
    }

    /// Aspect ratio of the frame, height over width; 3/4 if the height is unknown.
    pub(crate) fn aspect(&self) -> f64 {
        if self.height > 0.0 { self.height / self.width } else { 0.75 }
    }

    /// Use perspective projection with the eye at `from`.
    #[must_use]
    pub fn with_perspective(self) -> Self {
        Self { perspective: true, ..self }
    }

    /// Zoom out (`factor` < 1) or in (> 1).
    #[must_use]
    pub fn zoomed(self, factor: f64) -> Self {
        Self { width: self.width / factor, height: self.height / factor, ..self }
    }

    /// True for perspective projection.
    pub(crate) fn is_perspective(&self) -> bool {
        self.perspective
    }

    /// Unit vectors to the right, upwards and to the eye.
    pub(crate) fn basis(&self) -> [[f64; 3]; 3] {
        let out = unit(sub(self.from, self.at));
        let right = unit(cross(self.up, out));
        [right, cross(out, right), out]
    }

    pub(crate) fn target(&self) -> [f64; 3] {
        self.at
    }

    /// Distance from the eye to the plane shown in true size, m.
    pub(crate) fn distance(&self) -> f64 {
        let d = sub(self.from, self.at);
        dot(d, d).sqrt()
    }

    /// Pixels per metre in a view of this size in pixels.
    pub(crate) fn pixels_per_metre(&self, width: f64, height: f64) -> f64 {
        let across = width / self.width;
        if self.height > 0.0 { across.min(height / self.height) } else { across }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
