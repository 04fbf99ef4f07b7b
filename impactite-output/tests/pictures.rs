//! Pictures: positions, colours and rendering time.
//!
//! `IMPACTITE_PICTURES=folder cargo test --release -p mpm-core --test output_pictures` keeps the pictures.

use std::path::PathBuf;
use std::time::Instant;

use impactite_output::picture::{
    Axis, Camera, Chart, ColourMap, Cut, FieldPicture, Mark, Marker, Mirror, Panels, ParticlePicture,
    Picture, Quantity, Series, SeriesView, Stroke,
};
use impactite_output::{Cells, OutputError, ParticleSize, Snapshot};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Radius and length of the undeformed bar, m.
const RADIUS: f64 = 3.2e-3;
const LENGTH: f64 = 32.4e-3;

/// Deformed position of a point of the undeformed bar (radius r, height z), and its plastic strain: a synthetic Taylor bar,
/// shorter, with a mushroomed foot.
fn deformed(r: f64, z: f64) -> (f64, f64, f64) {
    let s = z / LENGTH;
    let flare = 1.0 + 0.80 * (-(s / 0.10).powf(1.25)).exp() + 0.22 * (-(s / 0.42).powi(2)).exp();
    let height = LENGTH * (0.68 * s + 0.32 * s * s * s * (1.0 - 0.35 * s)) * 0.86;
    let strain = 1.9 * (-(s / 0.11).powf(1.2)).exp() * (0.75 + 0.25 * (1.0 - (r / RADIUS).powi(2)))
        + 0.32 * (-(s / 0.4).powi(2)).exp();
    (r * flare, height, strain)
}

/// Three-dimensional bar, whole or its quarter x, y > 0, with particles of edge `h` (m).
fn bar(h: f64, quarter: bool) -> Snapshot {
    let n = (RADIUS / h).ceil() as i64;
    let layers = (LENGTH / h).round() as i64;
    let (mut positions, mut strain, mut velocity) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..layers {
        for j in (if quarter { 0 } else { -n })..n {
            for i in (if quarter { 0 } else { -n })..n {
                let [x, y, z] = [i, j, k].map(|a| (a as f64 + 0.5) * h);
                let r = x.hypot(y);
                if r < RADIUS {
                    let (q, height, e) = deformed(r, z);
                    positions.push([x * q / r, y * q / r, height]);
                    strain.push(e);
                    velocity.push([0.0, 0.0, -190.0 * z / LENGTH]);
                }
            }
        }
    }
    Snapshot::new(3, 8.0e-5, 1234, positions, ParticleSize::Uniform(h))
        .and_then(|s| s.with_scalar("plastic_strain", strain))
        .and_then(|s| s.with_vector("velocity", velocity))
        .expect("a good snapshot")
}

/// Axisymmetric model of the bar.
fn axisymmetric(h: f64) -> Snapshot {
    let (mut positions, mut strain, mut pressure) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..(LENGTH / h) as usize {
        for i in 0..(RADIUS / h) as usize {
            let (r, z) = ((i as f64 + 0.5) * h, (k as f64 + 0.5) * h);
            let (q, height, e) = deformed(r, z);
            positions.push([q, height, 0.0]);
            strain.push(e);
            pressure.push(4.0e8 * (40.0 * z / LENGTH).sin() * (-(z / LENGTH) * 2.0).exp());
        }
    }
    Snapshot::new(2, 8.0e-5, 1234, positions, ParticleSize::Uniform(h))
        .and_then(|s| s.with_scalar("plastic_strain", strain))
        .and_then(|s| s.with_scalar("pressure", pressure))
        .expect("a good snapshot")
}

fn strain() -> Quantity {
    Quantity::scalar("plastic_strain").label("equivalent plastic strain")
}

/// Save a picture for inspection, if requested by the environment.
fn keep(picture: &Picture, name: &str) {
    if let Some(folder) = std::env::var_os("IMPACTITE_PICTURES") {
        picture.save(PathBuf::from(folder).join(name)).expect("the picture is written");
    }
}

fn ink(picture: &Picture) -> usize {
    let all = (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| (x, y)));
    all.filter(|(x, y)| picture.pixel(*x, *y) != Some([255; 3])).count()
}

/// Number of pixels that differ by more than a tenth of full scale between two pictures of one size.
fn different(a: &Picture, b: &Picture) -> usize {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()));
    let all = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
    let far = |(a, b): (u8, u8)| a.abs_diff(b) > 25;
    let pair = |x, y| (a.pixel(x, y).expect("inside"), b.pixel(x, y).expect("inside"));
    all.map(|(x, y)| pair(x, y)).filter(|(a, b)| a.iter().copied().zip(b.iter().copied()).any(far)).count()
}

#[test]
fn a_bar_of_a_hundred_thousand_particles() {
    let fine = !cfg!(debug_assertions);
    let snapshot = bar(if fine { 2.2e-4 } else { 5.0e-4 }, false);
    let picture = ParticlePicture::new(1200, 900)
        .title("Taylor bar, copper, 190 m/s")
        .caption("80 µs after impact")
        .colour_by(strain());
    for _ in 0..if fine { 5 } else { 1 } {
        let start = Instant::now();
        picture.draw(&snapshot).expect("drawn");
        println!("{} particles: {:?}", snapshot.len(), start.elapsed());
    }
    let picture = picture.draw(&snapshot).expect("drawn");
    assert!(ink(&picture) > 60_000);
    keep(&picture, "bar.png");
    let picture = ParticlePicture::new(1200, 900)
        .colour_by(Quantity::magnitude("velocity").label("speed").unit("m/s", 1.0).map(ColourMap::Inferno))
        .perspective()
        .cut(Cut { normal: [1.0, 0.0, 0.0], through: [0.0; 3] })
        .cut(Cut { normal: [0.0, -1.0, 0.0], through: [0.0; 3] })
        .seen_from([0.8, -1.0, 0.9], [0.0, 0.0, 1.0])
        .draw(&snapshot)
        .expect("drawn");
    keep(&picture, "bar_cut.png");
}

#[test]
fn a_quarter_is_drawn_as_the_whole() {
    let (whole, quarter) = (bar(4.0e-4, false), bar(4.0e-4, true));
    let mirrors = [Mirror::x(0.0), Mirror::y(0.0)];
    let camera = Camera::fit(&quarter, &mirrors, [1.0, -1.0, 0.5], [0.0, 0.0, 1.0]).expect("framed");
    let picture = ParticlePicture::new(300, 400).colour_by(strain()).camera(camera);
    let one = picture.clone().draw(&whole).expect("drawn");
    let four = picture.mirrored(mirrors).draw(&quarter).expect("drawn");
    let different = different(&one, &four);
    assert!(different < 1200, "{different} of 120000 pixels differ");
    keep(&four, "quarter.png");
}

#[test]
fn two_halves_of_an_axisymmetric_field() {
    let snapshot = axisymmetric(1.6e-4);
    let field = FieldPicture::new(700, 900).mirrored([Mirror::x(0.0)]).axes("r", "z");
    let picture = field
        .clone()
        .title("Axisymmetric bar")
        .caption("80 µs after impact")
        .colour_by(Quantity::scalar("pressure").unit("MPa", 1.0e-6).map(ColourMap::CoolWarm))
        .draw(&snapshot)
        .expect("drawn");
    keep(&picture, "field.png");
    let discs = field.mark(Mark::Disc).colour_by(strain()).draw(&snapshot).expect("drawn");
    keep(&discs, "field_discs.png");
    let turned =
        ParticlePicture::new(700, 900).revolved(270.0).colour_by(strain()).draw(&snapshot).expect("drawn");
    keep(&turned, "revolved.png");
}

#[test]
fn a_square_lies_where_its_axes_say() {
    let one = Snapshot::new(2, 0.0, 0, vec![[1.0, 1.0, 0.0]], ParticleSize::Uniform(2.0)).expect("good");
    let picture = FieldPicture::new(400, 400).bounds([0.0, 0.0], [4.0, 4.0]);
    // An isolated cell equals the square.
    let square = picture.clone().mark(Mark::Square).draw(&one).expect("drawn");
    let picture = picture.draw(&one).expect("drawn");
    assert_eq!(square, picture);
    let blue = impactite_output::picture::palette(0);
    let all = (0..400).flat_map(|y| (0..400).map(move |x| (x, y)));
    let area: Vec<_> = all.filter(|(x, y)| picture.pixel(*x, *y) == Some(blue)).collect();
    let (x0, x1) = (area.iter().map(|p| p.0).min().unwrap(), area.iter().map(|p| p.0).max().unwrap());
    let (y0, y1) = (area.iter().map(|p| p.1).min().unwrap(), area.iter().map(|p| p.1).max().unwrap());
    assert_eq!(x1 - x0, y1 - y0, "a square is square");
    assert!(y0 > 160 && x1 < 220, "it fills the lower left, not {x0}..{x1} {y0}..{y1}");
}

/// An element is drawn in its shape, whatever the mark of particles.
#[test]
fn elements_are_drawn_in_their_shape() {
    let cells = Cells {
        nodes: vec![[1.0, 1.0, 0.0], [3.0, 1.0, 0.0], [3.5, 3.0, 0.0], [2.0, 2.0, 0.0]],
        corners: vec![0, 1, 2, 3],
        ends: vec![4],
    };
    let one = Snapshot::new(2, 0.0, 0, vec![[2.4, 1.7, 0.0]], ParticleSize::Uniform(1.2))
        .and_then(|s| s.with_cells(cells))
        .expect("good");
    let blue = impactite_output::picture::palette(0);
    for mark in [Mark::Cell, Mark::Square, Mark::Disc] {
        let picture = FieldPicture::new(400, 400).mark(mark).bounds([0.0, 0.0], [4.0, 4.0]);
        let picture = picture.draw(&one).expect("drawn");
        let all = (0..400).flat_map(|y| (0..400).map(move |x| (x, y)));
        let area: Vec<_> = all.filter(|(x, y)| picture.pixel(*x, *y) == Some(blue)).collect();
        let span = |of: fn(&(usize, usize)) -> usize| {
            let (low, high) = area.iter().map(of).fold((usize::MAX, 0), |(l, h), v| (l.min(v), h.max(v)));
            (high + 1 - low) as f64
        };
        // Width 2.5 and height 2 of four units, and area 2.25 by the shoelace formula.
        let (wide, high) = (span(|p| p.0), span(|p| p.1));
        assert!((wide / high - 1.25).abs() < 0.03, "{mark:?}: {wide} by {high}");
        assert!((area.len() as f64 / (wide * high) - 2.25 / 5.0).abs() < 0.02, "{mark:?}: {}", area.len());
    }
}

/// Unit bricks in a cube of `n` by `n` by `n` with a corner at the origin, coloured by x.
fn bricks(n: u32) -> Snapshot {
    let m = n + 1;
    let node = |i: u32, j: u32, k: u32| (k * m + j) * m + i;
    let each = |n: u32| (0..n).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| [i, j, k])));
    let nodes = each(m).map(|x| x.map(f64::from)).collect();
    let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let corners = each(n).flat_map(|[i, j, k]| {
        [0, 1].into_iter().flat_map(move |up| ring.map(|[a, b]| node(i + a, j + b, k + up)))
    });
    let cells = Cells { nodes, corners: corners.collect(), ends: (1..=n.pow(3)).map(|e| 8 * e).collect() };
    let positions: Vec<_> = each(n).map(|x| x.map(|c| f64::from(c) + 0.5)).collect();
    let x = positions.iter().map(|p| p[0]).collect();
    Snapshot::new(3, 0.0, 0, positions, ParticleSize::Uniform(1.0))
        .and_then(|s| s.with_cells(cells))
        .and_then(|s| s.with_scalar("x", x))
        .expect("a snapshot")
}

#[test]
fn elements_in_space_are_drawn_by_their_faces() {
    // Two tetrahedra that share a face, each in its own body.
    let nodes = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    let corners = vec![0, 1, 2, 3, 1, 2, 3, 4];
    let cells = Cells { nodes, corners, ends: vec![4, 8] };
    let two = Snapshot::new(3, 0.0, 0, vec![[0.25; 3], [0.5; 3]], ParticleSize::Uniform(0.5))
        .and_then(|s| s.with_bodies(vec![0, 1]))
        .and_then(|s| s.with_cells(cells))
        .expect("a snapshot")
        .with_body_names(["one", "other"]);
    let picture = ParticlePicture::new(500, 400).title("Two tetrahedra").draw(&two).expect("drawn");
    keep(&picture, "tetrahedra.png");
    // From below, with x to the left, the first covers the triangle x + y < 1 and the second the other half of the square.
    let from_below = ParticlePicture::new(400, 400)
        .without_marks()
        .camera(Camera::looking([0.5, 0.5, -9.0], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], 1.25).expect("a camera"))
        .draw(&two)
        .expect("drawn");
    let ratio = |p: [f64; 2]| {
        let place = |x: f64| 200.0 + (x - 0.5) * 0.97 * (400.0 - 2.2 * 10.0) / 1.25;
        let [r, _, b] =
            from_below.pixel(place(1.0 - p[0]) as usize, place(1.0 - p[1]) as usize).expect("inside");
        f64::from(r) / f64::from(b.max(1))
    };
    // Blue and vermilion.
    assert!(
        ratio([0.05, 0.05]) < 0.5 && ratio([0.95, 0.95]) > 2.0,
        "{} {}",
        ratio([0.05, 0.05]),
        ratio([0.95, 0.95])
    );

    let solid = bricks(6);
    let picture = ParticlePicture::new(500, 400).colour_by(Quantity::scalar("x")).mirrored([Mirror::y(0.0)]);
    keep(&picture.clone().draw(&solid).expect("drawn"), "bricks.png");
    // The number of coloured pixels equals that of a box; balls at the centres would not fill it.
    let camera = Camera::looking([3.0, 3.0, 99.0], [3.0; 3], [0.0, 1.0, 0.0], 8.0).expect("a camera");
    let above = ParticlePicture::new(400, 400).without_marks().camera(camera).draw(&solid).expect("drawn");
    let side = 6.0 / 8.0 * 0.97 * (400.0 - 22.0);
    assert!((ink(&above) as f64 / (side * side) - 1.0).abs() < 0.02, "{} of {}", ink(&above), side * side);
    // A cut shows the cells behind it.
    let cut = Cut { normal: [0.0, -1.0, 0.0], through: [0.0, 3.0, 0.0] };
    keep(&picture.cut(cut).draw(&solid).expect("drawn"), "bricks_cut.png");
}

#[test]
fn a_film_keeps_size_window_and_colours() {
    let square = |shift: f64, value: f64| {
        let positions = (0..400).map(|n| [f64::from(n % 40) + shift, f64::from(n / 40), 0.0]).collect();
        Snapshot::new(2, 0.0, 0, positions, ParticleSize::Uniform(1.0))
            .and_then(|s| s.with_scalar("von_mises", vec![value; 400]))
            .expect("a snapshot")
    };
    let field =
        FieldPicture::new(10, 10).fitted([400, 800], [200, 800]).colour_by(Quantity::named("von_mises"));
    let mut film = SeriesView::new();
    let first = field.draw_in(&mut film, &square(0.0, 9.0e7)).expect("drawn");
    // Aspect ratio of four, without empty halves.
    assert_eq!(first.width(), 800);
    assert!((250..350).contains(&first.height()), "{}", first.height());
    keep(&first, "film.png");
    let again = field.draw_in(&mut film, &square(0.0, 9.0e7)).expect("drawn");
    assert!(again == first);
    // Colour range and axes are those of the series so far.
    let low = field.draw_in(&mut film, &square(0.0, 1.0e6)).expect("drawn");
    assert!(different(&first, &low) > 0);
    let left_axis = |p: &Picture| (0..p.height()).map(|y| p.pixel(60, y)).collect::<Vec<_>>();
    let moved = field.draw_in(&mut film, &square(1.0, 9.0e7)).expect("drawn");
    assert_eq!(left_axis(&moved), left_axis(&first));
    let mut other = SeriesView::new();
    for (to, from) in other.numbers().zip(film.clone().numbers()) {
        *to = *from;
    }
    let far = square(30.0, 5.0e8);
    assert!(
        field.draw_in(&mut other, &far).expect("drawn") == field.draw_in(&mut film, &far).expect("drawn")
    );
    let mut set = SeriesView::new().with_window([0.0; 3], [20.0, 20.0, 0.0], 2).expect("a window");
    let part = field.draw_in(&mut set, &square(0.0, 9.0e7)).expect("drawn");
    assert!((600..=800).contains(&part.height()), "as high as wide: {} x {}", part.width(), part.height());
    assert!(SeriesView::new().with_window([1.0; 3], [1.0, 2.0, 0.0], 2).is_err());
}

/// A film reuses the memory of its pictures; a clone begins without it.
#[test]
fn the_memory_of_a_film_leaves_no_trace() {
    let mut film = SeriesView::new();
    for h in [2.0e-4, 4.0e-4, 3.0e-4] {
        let field = FieldPicture::new(300, 500).colour_by(strain()).mirrored([Mirror::x(0.0)]);
        for mark in [Mark::Cell, Mark::Square, Mark::Disc] {
            let (mut fresh, field) = (film.clone(), field.clone().mark(mark));
            let scene = axisymmetric(h);
            let drawn = field.draw_in(&mut film, &scene).expect("drawn");
            assert!(drawn == field.draw_in(&mut fresh, &scene).expect("drawn"), "{mark:?}, {h}");
        }
    }
    let mut film = SeriesView::new();
    let picture = ParticlePicture::new(300, 300);
    for scene in [bar(4.0e-4, true), bricks(3), bar(8.0e-4, false)] {
        let mut fresh = film.clone();
        let drawn = picture.draw_in(&mut film, &scene).expect("drawn");
        assert!(drawn == picture.draw_in(&mut fresh, &scene).expect("drawn"), "{} points", scene.len());
    }
}

#[test]
fn stretched_surfaces_have_no_holes() {
    // Tube wall of two layers, with columns 1.9 sizes apart.
    let h = 0.1;
    let mut positions = Vec::new();
    for k in 0..60 {
        for layer in 0..2 {
            let r = 1.5 - h * f64::from(layer);
            for n in 0..50 {
                let phi = (f64::from(n) + 0.5 * f64::from(layer)) / 50.0 * std::f64::consts::TAU;
                positions.push([r * phi.cos(), r * phi.sin(), 0.6 * h * f64::from(k)]);
            }
        }
    }
    let tube = Snapshot::new(3, 0.0, 0, positions, ParticleSize::Uniform(h)).expect("a snapshot");
    let camera = Camera::looking([9.0, 0.0, 1.8], [0.0, 0.0, 1.8], [0.0, 0.0, 1.0], 4.0).expect("a camera");
    let picture = ParticlePicture::new(800, 800).without_marks().camera(camera).draw(&tube).expect("drawn");
    keep(&picture, "tube.png");
    let holes = (300..500).flat_map(|y| (300..500).map(move |x| (x, y)));
    let white = holes.filter(|&(x, y)| picture.pixel(x, y) == Some([255; 3])).count();
    assert_eq!(white, 0);
}

#[test]
fn curves() {
    let h: Vec<f64> = (0..5).map(|i| 1.0e-3 / 2.0_f64.powi(i)).collect();
    let error = |c: f64, p: f64| h.iter().map(|h| c * (h / 1.0e-3).powf(p)).collect::<Vec<_>>();
    let convergence = Chart::new(900, 700)
        .title("Convergence of the foot's radius")
        .x(Axis::new("cell size").unit("mm", 1.0e3).logarithmic())
        .y(Axis::new("relative error").logarithmic())
        .series(
            Series::new("linear shape functions", &h, &error(3.0e-2, 1.1)).unwrap().marker(Marker::Circle),
        )
        .series(Series::new("GIMP", &h, &error(1.6e-2, 1.8)).unwrap().marker(Marker::Square))
        .series(Series::new("B-splines", &h, &error(8.0e-3, 2.1)).unwrap().marker(Marker::Triangle))
        .series(Series::slope("second order", 2.0, (1.0e-3, 5.0e-3), (1.0e-3, 6.25e-5)))
        .draw()
        .expect("drawn");
    keep(&convergence, "convergence.png");
    let t: Vec<f64> = (0..400).map(|i| f64::from(i) * 2.0e-7).collect();
    let length: Vec<f64> = t.iter().map(|t| LENGTH * (0.66 + 0.34 * (-t / 2.5e-5).exp())).collect();
    let other: Vec<f64> = t.iter().map(|t| LENGTH * (0.68 + 0.32 * (-t / 2.2e-5).exp())).collect();
    let measured = Series::new("measured", &[8.0e-5], &[2.14e-2]).unwrap();
    let history = Chart::new(900, 700)
        .title("Length of the bar")
        .x(Axis::new("time").unit("µs", 1.0e6).range(0.0, 8.2e-5))
        .y(Axis::new("length").unit("mm", 1.0e3))
        .series(Series::new("3D", &t, &length).unwrap())
        .series(Series::new("axisymmetric", &t, &other).unwrap().stroke(Stroke::Dashed))
        .series(measured.stroke(Stroke::None).marker(Marker::Diamond).colour([40; 3]))
        .draw()
        .expect("drawn");
    keep(&history, "history.png");
    let both = Panels::new(2).panel("(a)", convergence).panel("(b)", history).compose().expect("composed");
    keep(&both, "charts.png");
    assert_eq!(both.width(), 1800);
    // Empty, single and NaN points must not cause a panic.
    Chart::new(200, 100).draw().expect("empty");
    let odd = Series::new("odd", &[1.0, f64::NAN, -1.0], &[f64::INFINITY, 1.0, 0.0]).unwrap();
    Chart::new(200, 100).x(Axis::new("x").logarithmic()).series(odd).draw().expect("odd");
}

#[test]
fn panels_of_three_and_two_dimensions() {
    let (solid, flat) = (bar(4.0e-4, true), axisymmetric(2.0e-4));
    let mirrors = [Mirror::x(0.0), Mirror::y(0.0)];
    let left = ParticlePicture::new(800, 800)
        .colour_by(strain().range(0.0, 2.0))
        .mirrored(mirrors)
        .cut(Cut { normal: [1.0, 0.0, 0.0], through: [0.0; 3] })
        .cut(Cut { normal: [0.0, -1.0, 0.0], through: [0.0; 3] })
        .draw(&solid)
        .expect("drawn");
    let right = FieldPicture::new(600, 800)
        .colour_by(strain().range(0.0, 2.0))
        .mirrored([Mirror::x(0.0)])
        .axes("r", "z")
        .draw(&flat)
        .expect("drawn");
    let both = Panels::new(2)
        .title("Taylor bar, copper, 190 m/s, 80 µs")
        .panel("(a) three dimensions, a quarter computed", left)
        .panel("(b) axisymmetric", right)
        .compose()
        .expect("composed");
    assert_eq!(both.width(), 1400);
    keep(&both, "panels.png");
}

#[test]
fn a_png_reads_back_to_the_same_pixels() {
    let folder = std::env::temp_dir().join(format!("impactite-png-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("square.png");
    let one = Snapshot::new(2, 0.0, 0, vec![[1.0, 1.0, 0.0]], ParticleSize::Uniform(2.0)).expect("good");
    let picture = FieldPicture::new(120, 90).draw(&one).expect("drawn");
    picture.save(&path).expect("saved");
    let file = std::io::BufReader::new(std::fs::File::open(&path).expect("there"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut bytes).expect("a frame");
    for (i, rgb) in bytes.chunks(3).enumerate() {
        assert_eq!(picture.pixel(i % 120, i / 120).expect("inside"), rgb);
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn bad_input_is_refused_by_name() {
    let snapshot = bar(1.6e-3, true);
    let said = |result: Result<Picture, OutputError>| result.expect_err("refused").to_string();
    let picture = ParticlePicture::new(100, 100);
    let missing = said(picture.clone().colour_by(Quantity::scalar("heat")).draw(&snapshot));
    assert_eq!(missing, "no scalar field \"heat\" in the snapshot; it has \"plastic_strain\"");
    let range = said(picture.clone().colour_by(strain().range(2.0, 1.0)).draw(&snapshot));
    assert!(range.contains("range of \"plastic_strain\" = 2 to 1"), "{range}");
    let up = said(picture.clone().seen_from([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]).draw(&snapshot));
    assert!(up.contains("up not along their line"), "{up}");
    assert!(said(FieldPicture::new(100, 100).draw(&snapshot)).starts_with("dimension = 3"));
    assert!(said(ParticlePicture::new(0, 100).draw(&snapshot)).starts_with("picture width = 0"));
    assert!(said(Panels::new(2).compose()).starts_with("number of panels = 0"));
    assert!(said(picture.revolved(360.0).draw(&snapshot)).starts_with("dimension = 3"));
    let lost = Snapshot::new(3, 0.0, 0, vec![[f64::NAN; 3]], ParticleSize::Uniform(1.0)).expect("accepted");
    assert!(said(ParticlePicture::new(100, 100).draw(&lost)).starts_with("number of particles to frame = 0"));
    let hall = said(ParticlePicture::new(100, 100).mirrored([Mirror::x(0.0); 7]).draw(&snapshot));
    assert!(hall.starts_with("number of mirrors = 7"), "{hall}");
    assert!(Series::new("short", &[1.0, 2.0], &[1.0]).is_err());
}

#[test]
fn far_debris_changes_neither_speed_nor_looks_of_the_bulk() {
    let near = bar(8.0e-4, false);
    let camera = Camera::fit(&near, &[], [1.0, -1.0, 0.5], [0.0, 0.0, 1.0]).expect("framed");
    let mut positions = near.positions().to_vec();
    positions.extend([[1.0e4, 0.0, 0.0], [0.0, -3.0e5, 0.0], [0.0, 0.0, 1.0e7]]);
    let far = Snapshot::new(3, 0.0, 0, positions, near.size().clone()).expect("good");
    let picture = ParticlePicture::new(200, 200).camera(camera);
    let different = different(&picture.draw(&far).expect("drawn"), &picture.draw(&near).expect("drawn"));
    assert!(different < 400, "{different} of 40000 pixels differ");
}

#[test]
fn hostile_scenes_are_drawn_without_a_panic() {
    // Remote debris, very different sizes, one particle, and positions that are not finite.
    let scenes: [(Vec<[f64; 3]>, ParticleSize); 4] = [
        (vec![[0.0; 3], [1.0e3, 2.0e3, -1.0e3]], ParticleSize::Uniform(1.0e-6)),
        (vec![[0.0; 3], [1.0e-3, 0.0, 0.0]], ParticleSize::Each(vec![1.0, 1.0e-9])),
        (vec![[1.0e9; 3]], ParticleSize::Uniform(1.0e-3)),
        (vec![[f64::NAN; 3], [1.0, 0.0, f64::INFINITY], [0.0; 3]], ParticleSize::Uniform(1.0)),
    ];
    for (positions, size) in scenes {
        let n = positions.len();
        let snapshot = Snapshot::new(3, 0.0, 0, positions, size)
            .and_then(|s| s.with_scalar("odd", vec![f64::NAN; n]))
            .expect("accepted");
        for perspective in [false, true] {
            let picture = ParticlePicture::new(160, 120).colour_by(Quantity::scalar("odd").logarithmic());
            let picture = if perspective { picture.perspective() } else { picture };
            picture.mirrored([Mirror::z(0.0)]).draw(&snapshot).expect("drawn");
        }
    }
}

#[test]
fn pictures_beyond_memory_are_refused() {
    let two = Snapshot::new(2, 0.0, 0, vec![[0.0; 3], [1.0, 1.0, 0.0]], ParticleSize::Uniform(0.1)).unwrap();
    let refused = FieldPicture::new(16384, 16384).draw(&two).unwrap_err().to_string();
    assert!(refused.starts_with("a picture of so many pixels would take"), "{refused}");
    // 4096 copies of each particle.
    let far = vec![[1e9, 0.0, 0.0]; 100_000];
    let far = Snapshot::new(2, 0.0, 0, far, ParticleSize::Uniform(1e-3)).unwrap();
    let refused = ParticlePicture::new(100, 100).revolved(360.0).draw(&far).unwrap_err().to_string();
    assert!(refused.contains("turned about the axis would take"), "{refused}");
    for size in [0.0, f32::NAN, 1e9] {
        let text = FieldPicture::new(100, 100).letters(size).draw(&two).unwrap_err().to_string();
        assert!(text.starts_with("size of letters ="), "{text}");
        assert!(ParticlePicture::new(100, 100).letters(size).draw(&two).is_err());
        assert!(Chart::new(100, 100).letters(size).draw().is_err());
    }
    // Debris at any distance is omitted or framed.
    for x in [1e12, 1e20, 1e30, 1e300, f64::MAX] {
        let list = vec![[0.0; 3], [1e-3, 0.0, 0.0], [x, 0.0, 0.0], [-x, x, 0.0]];
        for dimension in [2, 3] {
            let scene = Snapshot::new(dimension, 0.0, 0, list.clone(), ParticleSize::Uniform(1e-3)).unwrap();
            let drawn = ParticlePicture::new(60, 60).mirrored([Mirror::x(1e30)]).draw(&scene);
            assert!(drawn.is_ok(), "{x:e}: {drawn:?}");
            if dimension == 2 {
                FieldPicture::new(60, 60).draw(&scene).unwrap();
            }
        }
    }
    let zoomed = Camera::looking([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.0).unwrap().zoomed(0.0);
    assert!(ParticlePicture::new(60, 60).camera(zoomed).draw(&two).is_err());
    // Logarithmic axis from the smallest number to the largest.
    let all = Series::new("all", &[5e-324, 1.0, f64::MAX], &[-f64::MAX, 0.0, f64::MAX]).unwrap();
    let chart = Chart::new(90, 90).x(Axis::new("x").logarithmic()).series(all.marker(Marker::Circle));
    chart.draw().unwrap();
}

/// Strategy for any number, uniform in magnitude.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-1.0..1.0f64, -320..309i32).prop_map(|(m, e)| m * 10f64.powi(e)),
        2 => -3.0..3.0f64,
        1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::MAX), Just(-f64::MAX)],
    ]
}

fn point<const D: usize>() -> impl Strategy<Value = [f64; D]> {
    prop::collection::vec(number(), D).prop_map(|v| std::array::from_fn(|i| v[i]))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 100, failure_persistence: None, rng_seed: RngSeed::Fixed(8), ..ProptestConfig::default()
    })]

    #[test]
    fn any_scene_is_a_picture_or_an_error(
        list in prop::collection::vec(point::<3>(), 1..6), size in number(), at in number(), value in point::<3>(),
        looks in prop::array::uniform2(point::<3>()), scale in number(), factor in number(), log: bool,
    ) {
        let of = |list: &[[f64; 3]], dimension, size: f64| {
            let values = (0..list.len()).map(|i| value[i % 3]).collect();
            Snapshot::new(dimension, 0.0, 0, list.to_vec(), ParticleSize::Uniform(size)).and_then(|s| s.with_scalar("v", values))
        };
        let colour = if log { Quantity::scalar("v").logarithmic() } else { Quantity::scalar("v").unit("x", factor) };
        for size in [size, 1e-3] {
            if let Ok(scene) = of(&list, 3, size) {
                let picture = ParticlePicture::new(40, 30).colour_by(colour.clone());
                let _ = picture.draw(&scene);
                let _ = picture.clone().perspective().mirrored([Mirror::y(at)]).draw(&scene);
                let _ = picture.clone().seen_from(looks[0], looks[1]).particle_scale(scale).draw(&scene);
                if let Ok(camera) = Camera::looking(looks[0], looks[1], [0.0, 0.0, 1.0], size) {
                    let _ = picture.clone().camera(camera.zoomed(factor)).draw(&scene);
                    let _ = picture.camera(camera.with_perspective()).draw(&scene);
                }
            }
            let flat: Vec<[f64; 3]> = list.iter().map(|x| [x[0], x[1], 0.0]).collect();
            if let Ok(scene) = of(&flat, 2, size) {
                let picture = FieldPicture::new(40, 30).colour_by(colour.clone());
                let _ = picture.draw(&scene);
                let _ = picture.clone().mirrored([Mirror::x(at)]).particle_scale(scale).draw(&scene);
                let _ = picture.bounds([at, factor], [size, scale]).draw(&scene);
                let _ = ParticlePicture::new(40, 30).revolved(at.abs()).draw(&scene);
            }
        }
        let [x, y] = [0, 1].map(|d| list.iter().map(|p| p[d]).collect::<Vec<f64>>());
        let curve = Series::new("c", &x, &y).expect("as long").marker(Marker::Diamond);
        let axis = |a: Axis| if log { a.logarithmic() } else { a };
        let chart = Chart::new(80, 60).x(axis(Axis::new("x").unit("u", factor))).y(axis(Axis::new("y"))).series(curve);
        let _ = chart.draw();
        let _ = chart.x(Axis::new("x").range(at, scale)).draw();
    }
}
