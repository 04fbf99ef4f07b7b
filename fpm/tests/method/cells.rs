//! Division into cells.

use fpm::{Cells, Domain, Notch, relaxed, scattered};
use impactite_geometry::structured::{Spacing, box_mesh};
use impactite_geometry::{Cuboid, Polygon};

use crate::common::{lattice, random};

#[test]
fn cells_fill_their_domain_and_meet_at_faces() {
    let disordered = random([0.0, 0.0], [2.0, 1.0], 0.1, 3);
    let area: f64 = disordered.volumes().iter().sum();
    assert!((area - 2.0).abs() < 1e-13, "{area}");
    assert!((180..=210).contains(&disordered.len()), "{}", disordered.len());
    // About six neighbours in the plane; the surface is that of the domain.
    let edge: f64 = disordered.outer().iter().map(|f| f.area).sum();
    assert!((edge - 6.0).abs() < 1e-12, "{edge}");
    let mean = 2.0 * disordered.faces().len() as f64 / disordered.len() as f64;
    assert!((4.8..6.0).contains(&mean), "{mean}");

    let space = random([0.0; 3], [1.0; 3], 0.15, 5);
    let volume: f64 = space.volumes().iter().sum();
    assert!((volume - 1.0).abs() < 1e-13, "{volume}");
    let surface: f64 = space.outer().iter().map(|f| f.area).sum();
    assert!((surface - 6.0).abs() < 1e-12, "{surface}");
    for face in space.faces() {
        let [a, b] = face.cells.map(|c| space.points()[c as usize]);
        let along: f64 = (0..3).map(|d| (b[d] - a[d]) * face.normal[d]).sum();
        assert!(along > 0.0, "{face:?}");
    }
}

#[test]
fn a_lattice_makes_squares_and_cubes() {
    let plane = lattice([1.0, 2.0], [5, 4], 0.5);
    assert_eq!((plane.len(), plane.faces().len(), plane.outer().len()), (20, 4 * 4 + 5 * 3, 18));
    assert!(plane.volumes().iter().all(|v| (v - 0.25).abs() < 1e-14));
    assert!(plane.faces().iter().all(|f| (f.area - 0.5).abs() < 1e-14));
    assert_eq!(plane.corners(7).len(), 4);
    let space = lattice([0.0; 3], [3, 4, 2], 1.0);
    assert_eq!((space.len(), space.faces().len()), (24, 2 * 8 + 3 * 6 + 12));
}

#[test]
fn a_mesh_makes_the_same_cells_as_its_points() {
    let body = Cuboid::new([1.0, 2.0], [3.5, 4.0]).unwrap();
    let mesh = Cells::of_mesh(&box_mesh(&body, [5, 4]).unwrap()).unwrap();
    let points = lattice([1.0, 2.0], [5, 4], 0.5);
    assert_eq!(mesh.faces().len(), points.faces().len());
    for (a, b) in mesh.faces().iter().zip(points.faces()) {
        assert_eq!(a.cells, b.cells);
        assert!((a.area - b.area).abs() < 1e-14 && (a.normal[0] - b.normal[0]).abs() < 1e-14);
    }
    // Triangles, bricks that are not boxes, tetrahedra.
    let triangles = box_mesh(&body, [5, 4]).unwrap().split_to_triangles().unwrap();
    assert_eq!(Cells::of_mesh(&triangles).unwrap().len(), 40);
    let graded = [Spacing::graded(4, 3.0), Spacing::uniform(3), Spacing::uniform(3)];
    let cube = box_mesh(&Cuboid::new([0.0; 3], [1.0; 3]).unwrap(), graded).unwrap();
    let twisted =
        cube.clone().mapped(|[x, y, z]| [x + 0.1 * y * z, y - 0.2 * x * z, z + 0.1 * x * y]).unwrap();
    let cells = Cells::of_mesh(&twisted).unwrap();
    assert_eq!(cells.len(), 36);
    // Faces that are not flat are split into two triangles.
    assert!(cells.faces().len() > Cells::of_mesh(&cube).unwrap().faces().len());
    assert_eq!(Cells::of_mesh(&cube.split_to_tetrahedra().unwrap()).unwrap().volumes().len() % 36, 0);
}

#[test]
fn domains_are_convex() {
    let hexagon: Vec<[f64; 2]> =
        (0..6).map(|k| f64::from(k).to_radians() * 60.0).map(|a| [a.cos(), a.sin()]).collect();
    let domain = Domain::polygon(&Polygon::new(hexagon).unwrap()).unwrap();
    assert!((domain.volume() - 1.5 * 3.0f64.sqrt()).abs() < 1e-14);
    let cells = Cells::voronoi(&scattered(&domain, 1, |_| 0.2).unwrap(), &domain).unwrap();
    let area: f64 = cells.volumes().iter().sum();
    assert!((area - domain.volume()).abs() < 1e-13);
    let arrow = Polygon::new(vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]]).unwrap();
    assert!(Domain::polygon(&arrow).is_err());
    let octant = Domain::cuboid([0.0; 3], [1.0; 3]).unwrap().cut([1.0, 1.0, 1.0], 1.0).unwrap();
    assert!((octant.volume() - 1.0 / 6.0).abs() < 1e-15);
    let cells = Cells::voronoi(&scattered(&octant, 1, |_| 0.2).unwrap(), &octant).unwrap();
    let volume: f64 = cells.volumes().iter().sum();
    assert!((volume - 1.0 / 6.0).abs() < 1e-14);
}

#[test]
fn densities_follow_the_spacing() {
    let domain = Domain::cuboid([0.0; 2], [1.0; 2]).unwrap();
    let spacing = |[x, _]: [f64; 2]| if x < 0.5 { 0.1 } else { 0.03 };
    let points = scattered(&domain, 11, spacing).unwrap();
    let coarse = points.iter().filter(|x| x[0] < 0.5).count() as f64;
    let fine = points.len() as f64 - coarse;
    assert!((coarse / 50.0 - 1.0).abs() < 0.2 && (fine / 555.6 - 1.0).abs() < 0.1, "{coarse} {fine}");
    assert_eq!(points, scattered(&domain, 11, spacing).unwrap());
    assert_ne!(points, scattered(&domain, 12, spacing).unwrap());
    // Lloyd's algorithm makes cells more uniform.
    let spread = |points: &[[f64; 2]]| {
        let cells = Cells::voronoi(points, &domain).unwrap();
        let mean = 1.0 / cells.len() as f64;
        cells.volumes().iter().map(|v| (v / mean - 1.0).powi(2)).sum::<f64>() * mean
    };
    let points = scattered(&domain, 11, |_| 0.05).unwrap();
    assert!(spread(&relaxed(points.clone(), &domain, 10).unwrap()) < 0.5 * spread(&points));
}

#[test]
fn notches_open_the_faces_that_they_cross() {
    let cells = lattice([0.0; 2], [10, 10], 0.1);
    let notch = |to: f64| Notch::segment([0.0, 0.5], [to, 0.5]).unwrap();
    let cut = cells.clone().with_notch(&notch(0.4)).unwrap();
    let open: Vec<_> = cut.faces().iter().filter(|f| f.open).collect();
    assert_eq!(open.len(), 4);
    assert!(open.iter().all(|f| f.normal[1] == 1.0 && (f.centroid[1] - 0.5).abs() < 1e-12));
    // Notch faces of random points interlock; those of rows do not.
    let domain = Domain::cuboid([0.0; 2], [1.0; 2]).unwrap();
    let points = relaxed(scattered(&domain, 3, |_| 0.1).unwrap(), &domain, 2).unwrap();
    let off = |points: &[[f64; 2]]| {
        let cut = Cells::voronoi(points, &domain).unwrap().with_notch(&notch(0.5)).unwrap();
        let open = cut.faces().iter().filter(|f| f.open);
        open.map(|f| 1.0 - f.normal[1].abs()).fold(0.0, f64::max)
    };
    assert!(off(&points) > 0.05);
    let lined = notch(0.5).lined(points, &domain, 0.1).unwrap();
    assert!(off(&lined) < 1e-12, "{}", off(&lined));
    assert!(cells.with_notch(&notch(0.04)).unwrap_err().to_string().contains("at least one"));
}

#[test]
fn points_that_cannot_be_are_refused_by_name() {
    let domain = Domain::cuboid([0.0; 2], [1.0; 2]).unwrap();
    let said = |points: &[[f64; 2]]| Cells::voronoi(points, &domain).unwrap_err().to_string();
    assert!(said(&[]).contains("points = 0"));
    assert!(said(&[[0.5, 0.5], [1.5, 0.5]]).contains("cell 1 at [1.5, 0.5]"));
    assert!(said(&[[0.5, 0.5], [0.2, 0.5], [0.5, 0.5]]).contains("distance to another point"));
    assert!(said(&[[f64::NAN, 0.5]]).contains("NaN"));
    assert!(scattered(&domain, 1, |_| -1.0).unwrap_err().to_string().contains("spacing = -1"));
    // The cell of a single point is the domain.
    assert_eq!(Cells::voronoi(&[[0.2, 0.3]], &domain).unwrap().volumes(), [1.0]);
}
