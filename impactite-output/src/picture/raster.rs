//! Rasterizer of balls and faces: a z-buffer at twice the resolution, closing of gaps between balls, shading, edges and marks.

use super::axis::INK;
use super::camera::{Camera, dot, sub};
use super::canvas::{Pen, Picture};
use super::colour::hex;
use super::faces::Face;
use super::matter::{Ball, Matter, Neighbours, dot3};
use super::refill;

/// Balls and faces of a picture.
pub(super) struct Shapes {
    pub balls: Vec<Ball>,
    /// Balls of line elements, which are not part of a surface of matter.
    pub beads: Vec<Ball>,
    pub faces: Vec<Face>,
}

/// Samples per pixel along each side (supersampling).
pub(super) const FINE: usize = 2;

/// Part of the picture that shows the scene.
pub(super) struct Viewport {
    pub left: f32,
    pub top: f32,
    pub width: f32,
    pub height: f32,
    pub camera: Camera,
    pub pixels_per_metre: f64,
}

/// Projected ball: centre, radius and depth (towards the eye) in samples, with its shading parameters apart from the
/// roundness of the ball.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    x: f32,
    y: f32,
    depth: f32,
    radius: f32,
    /// Distance of the front from the centre: the radius before growth.
    front: f32,
    normal: [f32; 3],
    sky: f32,
    colour: [f32; 3],
}

/// Projected face: corners in samples with their depth, and its shaded colour.
#[derive(Clone, Copy)]
pub(super) struct Flat {
    corners: [[f32; 3]; 4],
    count: usize,
    colour: [f32; 3],
    /// Opacity of its edges: 0 if edges would cover small faces.
    edge: f32,
    /// Length of its shortest side, samples.
    front: f32,
}

/// Sample buffers of the viewport.
#[derive(Debug, Default)]
struct Samples {
    depth: Vec<f32>,
    /// Index of the visible object: balls, then faces.
    who: Vec<u32>,
    columns: usize,
    rows: usize,
}

/// Memory of a picture in space while it is drawn.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    matter: Matter,
    neighbours: Neighbours,
    samples: Samples,
    seen: Vec<Seen>,
}

impl Samples {
    /// Set all samples to the background.
    fn clear(&mut self, columns: usize, rows: usize) {
        (self.columns, self.rows) = (columns, rows);
        refill(&mut self.depth, columns * rows, f32::NEG_INFINITY);
        refill(&mut self.who, columns * rows, u32::MAX);
    }
}

impl Viewport {
    pub fn render(&self, shapes: &Shapes, buffers: &mut Buffers, picture: &mut Picture) {
        let [right, up, out] = self.camera.basis();
        let at = self.camera.target();
        let fine = FINE as f64;
        let scale = self.pixels_per_metre * fine;
        let distance = self.camera.distance();
        let (px0, py0) = (self.left.floor() as usize, self.top.floor() as usize);
        let columns = ((self.width as usize).min(picture.width().saturating_sub(px0))) * FINE;
        let rows = ((self.height as usize).min(picture.height().saturating_sub(py0))) * FINE;
        let (cx, cy) = (0.5 * columns as f64, 0.5 * rows as f64);
        // Position and depth in samples, and perspective magnification.
        let project = |x: [f64; 3]| {
            let d = sub(x, at);
            let toward = dot(d, out);
            let zoom = if self.camera.is_perspective() {
                if toward > 0.95 * distance {
                    return None;
                }
                distance / (distance - toward)
            } else {
                1.0
            };
            let (x, y) = (cx + dot(d, right) * scale * zoom, cy - dot(d, up) * scale * zoom);
            Some(([x, y, toward * scale], zoom))
        };
        let is_outside = |x: f64, y: f64, radius: f64| {
            x + radius < 0.0 || y + radius < 0.0 || x - radius > columns as f64 || y - radius > rows as f64
        };

        let balls = &shapes.balls;
        let Buffers { matter, neighbours, samples, seen } = buffers;
        matter.measure(balls);
        seen.clear();
        matter.sort(balls, neighbours);
        for (i, ball) in balls.iter().enumerate() {
            if matter.hides(i) {
                continue;
            }
            let (g, sky) = matter.surface(i, ball.x);
            let normal = [dot(g, right) as f32, dot(g, up) as f32, dot(g, out) as f32];
            // Back-facing balls are hidden by their own matter.
            if normal[2] < -0.5 && !matter.coarse {
                continue;
            }
            let Some(([x, y, depth], zoom)) = project(ball.x) else { continue };
            let front = (ball.radius * scale * zoom).max(0.75);
            let radius = front * f64::from(matter.growth(i, ball, neighbours));
            if is_outside(x, y, radius) {
                continue;
            }
            let colour = ball.colour.map(f32::from);
            let (x, y, radius, depth) = (x as f32, y as f32, radius as f32, depth as f32);
            seen.push(Seen { x, y, depth, radius, front: front as f32, normal, sky, colour });
        }
        for bead in &shapes.beads {
            let Some(([x, y, depth], zoom)) = project(bead.x) else { continue };
            let radius = (bead.radius * scale * zoom).max(1.5);
            if !is_outside(x, y, radius) {
                let colour = bead.colour.map(f32::from);
                let (x, y, radius, depth) = (x as f32, y as f32, radius as f32, depth as f32);
                seen.push(Seen { x, y, depth, radius, front: radius, normal: [0.0; 3], sky: 1.0, colour });
            }
        }
        let mut flats = Vec::with_capacity(shapes.faces.len());
        for face in &shapes.faces {
            let mut corners = [[0.0_f32; 3]; 4];
            let mut there = true;
            for (corner, x) in corners.iter_mut().zip(&face.corners[..face.count]) {
                match project(*x) {
                    Some((x, _)) => *corner = x.map(|c| c as f32),
                    None => there = false,
                }
            }
            let inside = |d: usize, most: usize| {
                let places = || corners[..face.count].iter().map(|c| c[d]);
                places().any(|c| c >= 0.0) && places().any(|c| c <= most as f32)
            };
            if there && inside(0, columns) && inside(1, rows) {
                flats.push(Flat::of(corners, face));
            }
        }

        // Bounding box of all objects in the viewport.
        let mut part = [f32::INFINITY, f32::INFINITY, 0.0, 0.0];
        let mut hold = |x: f32, y: f32, r: f32| {
            part = [part[0].min(x - r), part[1].min(y - r), part[2].max(x + r), part[3].max(y + r)];
        };
        seen.iter().for_each(|ball| hold(ball.x, ball.y, ball.radius));
        flats.iter().flat_map(|f| &f.corners[..f.count]).for_each(|c| hold(c[0], c[1], 1.0));
        let [left, top] = [part[0], part[1]].map(|c| (c.max(0.0) as usize).saturating_sub(1) / FINE * FINE);
        let (left, top) = (left.min(columns), top.min(rows));
        let columns = ((part[2] as usize).saturating_add(2 + FINE) / FINE * FINE).clamp(left, columns) - left;
        let rows = ((part[3] as usize).saturating_add(2 + FINE) / FINE * FINE).clamp(top, rows) - top;
        for ball in seen.iter_mut() {
            (ball.x, ball.y) = (ball.x - left as f32, ball.y - top as f32);
        }
        for corner in flats.iter_mut().flat_map(|flat| &mut flat.corners) {
            (corner[0], corner[1]) = (corner[0] - left as f32, corner[1] - top as f32);
        }
        samples.clear(columns, rows);
        for (i, ball) in seen.iter().enumerate() {
            splat(ball, i as u32, &mut samples.depth, &mut samples.who, columns, rows);
        }
        close_gaps(seen, samples);
        for (i, flat) in flats.iter().enumerate() {
            flat.fill((seen.len() + i) as u32, samples);
        }
        shade(seen, &flats, samples, picture, [px0 + left / FINE, py0 + top / FINE]);
    }

    /// Draw the coordinate axes and, in orthographic projection, a scale bar.
    pub fn marks(&self, picture: &mut Picture, size: f32, dimension: usize) {
        let [right, up, out] = self.camera.basis();
        let length = 2.1 * size;
        let origin = [self.left + 2.0 * length * 0.72, self.top + self.height - 1.1 * length];
        let mut axes: Vec<(usize, f64)> = (0..dimension).map(|d| (d, out[d])).collect();
        axes.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (d, _) in axes {
            let colour = [hex(0xb5383b), hex(0x3a7d44), hex(0x2f62a8)][d];
            let (dx, dy) = (right[d] as f32, -up[d] as f32);
            let long = dx.hypot(dy);
            if long < 0.12 {
                continue;
            }
            let tip = [origin[0] + length * dx, origin[1] + length * dy];
            picture.line(origin, tip, (size / 8.0).max(1.5), colour);
            let (ux, uy) = (dx / long, dy / long);
            let (a, b) = (0.42 * size, 0.17 * size);
            picture.polygon(
                &[
                    [tip[0] + a * ux, tip[1] + a * uy],
                    [tip[0] - b * uy, tip[1] + b * ux],
                    [tip[0] + b * uy, tip[1] - b * ux],
                ],
                colour,
            );
            let far = length * long + 1.05 * size;
            let at = [origin[0] + far * ux, origin[1] + far * uy + 0.33 * size];
            picture.text(["x", "y", "z"][d], at, &Pen::new(size, colour).bold().centred());
        }
        if self.camera.is_perspective() {
            return;
        }
        let wanted = f64::from(self.width) * 0.16 / self.pixels_per_metre;
        let decade = 10.0_f64.powf(wanted.log10().floor());
        let metres = [5.0, 2.0, 1.0].into_iter().map(|m| m * decade).find(|l| *l <= wanted).unwrap_or(decade);
        let (unit, factor) = super::length_unit(metres);
        let pixels = (metres * self.pixels_per_metre) as f32;
        let x1 = self.left + self.width - 0.6 * size;
        let y = self.top + self.height - 0.5 * size;
        let thick = (size / 6.0).max(2.0);
        picture.fill([x1 - pixels, y - thick], [x1, y], INK);
        let text = format!("{} {unit}", (metres * factor * 1e6).round() / 1e6);
        picture.text(&text, [x1 - 0.5 * pixels, y - thick - 0.45 * size], &Pen::new(size, INK).centred());
    }
}

/// Draw a ball into the z-buffer. Its front is a paraboloid, so that balls of equal size intersect in straight
/// lines.
fn splat(ball: &Seen, id: u32, depth: &mut [f32], who: &mut [u32], columns: usize, rows: usize) {
    let r = ball.radius;
    // Casts to usize truncate and map negative numbers to 0.
    let y0 = (ball.y - r) as usize;
    let y1 = ((ball.y + r) as usize).saturating_add(1).min(rows);
    let front = ball.depth + ball.front;
    for y in y0..y1 {
        let dy = y as f32 + 0.5 - ball.y;
        let half = r * r - dy * dy;
        if half <= 0.0 {
            continue;
        }
        let half = half.sqrt();
        let x0 = (ball.x - half + 0.5) as usize;
        let x1 = ((ball.x + half + 0.5) as usize).min(columns);
        if x0 >= x1 {
            continue;
        }
        let row = y * columns;
        let depths = &mut depth[row + x0..row + x1];
        let names = &mut who[row + x0..row + x1];
        let base = front - dy * dy / r;
        let mut dx = x0 as f32 + 0.5 - ball.x;
        for (d, name) in depths.iter_mut().zip(names) {
            let here = base - dx * dx / r;
            let nearer = here > *d;
            *d = if nearer { here } else { *d };
            *name = if nearer { id } else { *name };
            dx += 1.0;
        }
    }
}

/// Depth step at which a gap begins, in addition to a quarter of the ball radius, samples: more than the curvature of a ball.
const FALL: f32 = 2.5;

/// Close gaps between balls that are narrower than a ball, along rows and
/// columns. A gap is a deeper run of samples between two samples of similar depth.
fn close_gaps(seen: &[Seen], samples: &mut Samples) {
    let (columns, rows) = (samples.columns, samples.rows);
    // Start of the gap of each column, or `usize::MAX` outside of gaps.
    let (mut starts, mut looked) = (vec![usize::MAX; columns], Vec::new());
    for y in 0..rows {
        let mut start = usize::MAX;
        let mut x = 1;
        while x < columns {
            if start == usize::MAX {
                // Fast search: most samples have the depth of the previous one, or both are empty.
                let row = &samples.depth[y * columns + x - 1..(y + 1) * columns];
                match row.windows(2).position(|pair| pair[1] < pair[0] - FALL) {
                    Some(n) => x += n,
                    None => break,
                }
            }
            let at = y * columns + x;
            gap(seen, samples, &mut start, x, at, 1);
            x += 1;
        }
        if y == 0 {
            continue;
        }
        let (before, here) = samples.depth.split_at(y * columns);
        let pairs = before[(y - 1) * columns..].iter().zip(here).zip(&starts);
        looked.clear();
        looked.extend(
            pairs
                .enumerate()
                .filter(|(_, ((b, h), s))| **h < **b - FALL || **s != usize::MAX)
                .map(|(x, _)| x),
        );
        for &x in &looked {
            gap(seen, samples, &mut starts[x], y, y * columns + x, columns);
        }
    }
}

/// Process sample `at`, position `k` of a line of samples with stride `step`: begin a gap, close a gap, or
/// discard a gap that is too wide.
fn gap(seen: &[Seen], samples: &mut Samples, start: &mut usize, k: usize, at: usize, step: usize) {
    let (here, before) = (samples.depth[at], samples.depth[at - step]);
    if *start == usize::MAX {
        let rim = seen.get(samples.who[at - step] as usize);
        if rim.is_some_and(|rim| here < before - FALL - 0.25 * rim.front) {
            *start = k;
        }
        return;
    }
    let rim = at - (k + 1 - *start) * step;
    let Some(first) = seen.get(samples.who[rim] as usize) else { return };
    let (from, length) = (samples.depth[rim], k - *start);
    if length as f32 > 0.8 * first.front + 1.0 {
        *start = usize::MAX;
        return;
    }
    if here < from - FALL - 0.25 * first.front {
        return;
    }
    *start = usize::MAX;
    if here > from + 2.0 * first.front {
        return;
    }
    for n in 0..length {
        let (to, part) = (at - (length - n) * step, (n + 1) as f32 / (length + 1) as f32);
        samples.depth[to] = from + part * (here - from);
        samples.who[to] = samples.who[if part < 0.5 { rim } else { at }];
    }
}

const KEY: [f32; 3] = [-0.50, 0.62, 0.60];
const FILL: [f32; 3] = [0.75, -0.10, 0.55];

/// Light sources of the scene.
struct Light {
    key: [f32; 3],
    half: [f32; 3],
    fill: [f32; 3],
}

impl Light {
    fn new() -> Self {
        let key = normalised(KEY);
        Light { key, half: normalised([key[0], key[1], key[2] + 1.0]), fill: normalised(FILL) }
    }

    /// Diffuse factor and specular summand of the colour for this surface normal.
    fn on(&self, n: [f32; 3], sky: f32) -> (f32, f32) {
        let lit = dot3(n, self.key).max(0.0);
        let gloss = dot3(n, self.half).max(0.0);
        let gloss = gloss * gloss;
        let gloss = gloss * gloss;
        let gloss = gloss * gloss;
        let rim = (1.0 - n[2]).clamp(0.0, 1.0);
        let around = 0.60 + 0.07 * n[1] + 0.12 * dot3(n, self.fill).max(0.0);
        (sky * around + 0.38 * lit, sky * (26.0 * gloss + 30.0 * rim * rim + 5.0))
    }
}

impl Flat {
    fn of(corners: [[f32; 3]; 4], face: &Face) -> Self {
        let count = face.count;
        let between = |a: usize, b: usize| [0, 1, 2].map(|d| corners[b][d] - corners[a][d]);
        let (a, b) = if count == 4 { (between(0, 2), between(1, 3)) } else { (between(0, 1), between(0, 2)) };
        // Components along right, up and out: rows count downwards. Both sides of a face look alike.
        let (a, b) = ([a[0], -a[1], a[2]], [b[0], -b[1], b[2]]);
        let n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let n = normalised(if n[2] < 0.0 { n.map(|c| -c) } else { n });
        let (light, shine) = Light::new().on(n, 1.0);
        let colour = face.colour.map(|c| (f32::from(c) * light + shine).min(255.0));
        let length = |a: [f32; 3]| dot3(a, a).sqrt();
        let sides = (0..count).map(|i| length(between(i, (i + 1) % count)));
        let shortest = sides.fold(f32::INFINITY, f32::min);
        let edge = 0.5 * ((shortest / FINE as f32 - 3.0) / 7.0).clamp(0.0, 1.0);
        Flat { corners, count, colour, edge, front: shortest.max(3.0) }
    }

    /// Draw the face into the z-buffer.
    fn fill(&self, id: u32, samples: &mut Samples) {
        let [a, b, c, d] = self.corners;
        triangle([a, b, c], id, samples);
        if self.count == 4 {
            triangle([a, c, d], id, samples);
        }
    }

    /// Coverage of a sample by an edge.
    fn edge_at(&self, x: f32, y: f32) -> f32 {
        let mut nearest = f32::INFINITY;
        for i in 0..self.count {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let distance = (dx * (y - p[1]) - dy * (x - p[0])).abs() / dx.hypot(dy).max(1e-3);
            nearest = nearest.min(distance);
        }
        (1.2 - nearest).clamp(0.0, 1.0)
    }
}

/// Draw a triangle into the z-buffer.
fn triangle([a, b, c]: [[f32; 3]; 3], id: u32, samples: &mut Samples) {
    let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if twice == 0.0 || !twice.is_finite() {
        return;
    }
    let range = |d: usize, count: usize| {
        let (low, high) = (a[d].min(b[d]).min(c[d]), a[d].max(b[d]).max(c[d]));
        // Casts to usize truncate and map negative numbers to 0.
        (low - 0.5) as usize..((high + 0.5) as usize).saturating_add(1).min(count)
    };
    let over = 1.0 / twice;
    // Barycentric coordinates of b and c at a sample, and their increments along a row.
    let step_b = (c[1] - a[1]) * over;
    let step_c = -(b[1] - a[1]) * over;
    let columns = range(0, samples.columns);
    for y in range(1, samples.rows) {
        let (dx, dy) = (columns.start as f32 + 0.5 - a[0], y as f32 + 0.5 - a[1]);
        let mut of_b = dx * step_b - dy * (c[0] - a[0]) * over;
        let mut of_c = dx * step_c + dy * (b[0] - a[0]) * over;
        for x in columns.clone() {
            if of_b >= -1e-4 && of_c >= -1e-4 && of_b + of_c <= 1.0002 {
                let here = a[2] + of_b * (b[2] - a[2]) + of_c * (c[2] - a[2]);
                let at = y * samples.columns + x;
                if here > samples.depth[at] {
                    samples.depth[at] = here;
                    samples.who[at] = id;
                }
            }
            of_b += step_b;
            of_c += step_c;
        }
    }
}

/// Shade the samples, draw outlines and average the samples of each pixel.
fn shade(seen: &[Seen], flats: &[Flat], samples: &Samples, picture: &mut Picture, [px0, py0]: [usize; 2]) {
    let Samples { depth, who, columns, rows } = samples;
    let (columns, rows) = (*columns, *rows);
    let lights = Light::new();
    let width = picture.width();
    let pixels = picture.pixels_mut();
    for py in 0..rows / FINE {
        for px in 0..columns / FINE {
            let mut sum = [0.0_f32; 3];
            let mut covered = 0.0_f32;
            let corner = py * FINE * columns + px * FINE;
            let first = who[corner];
            let alone =
                (0..FINE).all(|sy| who[corner + sy * columns..][..FINE].iter().all(|other| *other == first));
            if alone && first == u32::MAX {
                continue;
            }
            // A pixel covered by one ball is shaded once.
            let (fine, weight) =
                if alone && (first as usize) < seen.len() { (1, (FINE * FINE) as f32) } else { (FINE, 1.0) };
            for sy in 0..fine {
                for sx in 0..fine {
                    let (x, y) = (px * FINE + sx, py * FINE + sy);
                    let at = y * columns + x;
                    let id = who[at];
                    if id == u32::MAX {
                        continue;
                    }
                    let id = id as usize;
                    let front = if id < seen.len() { seen[id].front } else { flats[id - seen.len()].front };
                    // Outline where the surface behind is far away.
                    let mut behind = 0.0_f32;
                    for (bx, by) in [(1_i64, 0_i64), (-1, 0), (0, 1), (0, -1)] {
                        let (qx, qy) = (x as i64 + bx, y as i64 + by);
                        if qx >= 0 && qy >= 0 && (qx as usize) < columns && (qy as usize) < rows {
                            let other = depth[qy as usize * columns + qx as usize];
                            behind = behind.max((depth[at] - other) / (6.0 * front));
                        }
                    }
                    let mut dim = 1.0 - 0.38 * (behind - 0.35).clamp(0.0, 1.0);
                    if id < seen.len() {
                        let ball = &seen[id];
                        let (dx, dy) = (
                            (x as f32 + 0.5 - ball.x) / ball.radius,
                            (y as f32 + 0.5 - ball.y) / ball.radius,
                        );
                        let dz = (1.0 - dx * dx - dy * dy).max(0.0).sqrt();
                        let own = 0.30;
                        let n = normalised([
                            ball.normal[0] + own * dx,
                            ball.normal[1] - own * dy,
                            ball.normal[2] + own * dz,
                        ]);
                        let (light, shine) = lights.on(n, ball.sky);
                        for c in 0..3 {
                            sum[c] += weight * (ball.colour[c] * (light * dim) + shine).min(255.0);
                        }
                    } else {
                        let flat = &flats[id - seen.len()];
                        if flat.edge > 0.0 {
                            dim *= 1.0 - flat.edge * flat.edge_at(x as f32 + 0.5, y as f32 + 0.5);
                        }
                        for c in 0..3 {
                            sum[c] += weight * flat.colour[c] * dim;
                        }
                    }
                    covered += weight;
                }
            }
            if covered > 0.0 {
                let pixel = &mut pixels[(py0 + py) * width + px0 + px];
                let all = (FINE * FINE) as f32;
                for c in 0..3 {
                    let under = f32::from(pixel[c]) * (all - covered);
                    pixel[c] = ((sum[c] + under) / all + 0.5) as u8;
                }
            }
        }
    }
}

fn normalised(a: [f32; 3]) -> [f32; 3] {
    let scale = 1.0 / dot3(a, a).sqrt().max(1e-6);
    [a[0] * scale, a[1] * scale, a[2] * scale]
}
