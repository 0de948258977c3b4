//! What others ask the map.

use super::{independent, map_of, observation};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, OrientedBox, Outline, Pose},
    mapping::{ObjectId, ObjectMap, Observation, Queries, Region},
};
use nalgebra::{Point2, Point3, UnitQuaternion, Vector3};

/// A thing seen three times, so that it counts.
fn thing(label: &str, at: [f64; 3], yaw: f64, half: [f64; 3]) -> Vec<Observation> {
    let e = Ellipsoid::new(upright_pose(yaw, Vector3::from(at)), Vector3::from(half));
    vec![observation(label, e, independent(&e, 0.02, 0.03, 0.02)); 8]
}

/// A cabinet at (2, 0), a suitcase at (0, 3), turned by 30 degrees, and a bed far away.
fn room() -> ObjectMap {
    let mut all = thing("cabinet", [2.0, 0.0, 0.5], 0.0, [0.4, 0.2, 0.5]);
    all.extend(thing("suitcase", [0.0, 3.0, 0.3], 30.0_f64.to_radians(), [0.3, 0.15, 0.3]));
    all.extend(thing("bed", [9.0, 9.0, 0.3], 0.0, [1.0, 0.8, 0.3]));
    map_of(all)
}

fn labels<'a>(
    objects: impl IntoIterator<Item = &'a ellipsoid_slam::mapping::MapObject>,
) -> Vec<String> {
    objects.into_iter().map(|object| object.label().to_owned()).collect()
}

#[test]
fn by_label_and_belief() {
    let map = room();
    let found = map.labelled("suitcase", 0.5);
    assert_eq!(labels(found.iter().map(|(object, _)| *object)), ["suitcase"]);
    assert!(found[0].1 > 0.9);
    assert!(map.labelled("piano", 0.0).is_empty());
}

#[test]
fn within_a_region_with_its_probability() {
    let map = room();
    let inside = |region: &Region, p| labels(map.within(region, p).iter().map(|d| d.object));
    let corners = [[-1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [-1.0, 4.0]];
    let corners: Vec<Point2<f64>> = corners.map(Point2::from).to_vec();
    let ell = |heights_m| Region::Prism { corners: corners.clone(), heights_m };
    let mut found = inside(&ell([0.0, 1.0]), 0.5);
    found.sort();
    assert_eq!(found, ["cabinet", "suitcase"]);
    // The suitcase is lower than this.
    assert_eq!(inside(&ell([0.4, 1.0]), 0.5), ["cabinet"]);
    // Its centre is a third of a metre from the notch of the polygon, which is not convex.
    let notch = Region::Prism {
        corners: vec![Point2::new(1.0, 1.0), Point2::new(3.0, 1.0), Point2::new(3.0, 4.0)],
        heights_m: [0.0, 1.0],
    };
    assert!(inside(&notch, 0.5).is_empty());
    let sphere = Region::Sphere { center: Point3::new(2.0, 0.0, 0.5), radius_m: 0.3 };
    assert_eq!(inside(&sphere, 0.99), ["cabinet"]);
    let turned = OrientedBox {
        pose: upright_pose(std::f64::consts::FRAC_PI_4, Vector3::new(0.0, 3.0, 0.0)),
        half_extents: Vector3::new(0.5, 0.5, 1.0),
    };
    assert_eq!(inside(&Region::Box(turned), 0.9), ["suitcase"]);
    // On the border it is even odds, and three standard deviations outside hardly any.
    let at_border = |x: f64| {
        let center = Point3::new(x, 0.0, 0.5);
        let found = map.within(&Region::Sphere { center, radius_m: 1.0 }, 0.0);
        let cabinet = found.iter().find(|d| d.object.label() == "cabinet").unwrap();
        (cabinet.probability_inside(), cabinet.sigma_m)
    };
    let (even, sigma) = at_border(1.0);
    assert!((even - 0.5).abs() < 0.05, "{even}");
    assert!((0.005..0.03).contains(&sigma), "{sigma} m from views of 0.03 m");
    assert!(at_border(1.0 - 3.0 * sigma).0 < 0.01);
}

#[test]
fn nearest_by_the_distance_to_the_box() {
    let map = room();
    let found = map.nearest(&Point3::new(0.6, 0.0, 0.5), None, 2);
    assert_eq!(labels(found.iter().map(|d| d.object)), ["cabinet", "suitcase"]);
    // From x = 0.6 to the cabinet's face at 1.6.
    assert!((found[0].distance_m - 1.0).abs() < 0.01, "{}", found[0].distance_m);
    let inside = map.nearest(&Point3::new(2.0, 0.1, 0.5), Some("cabinet"), 5);
    assert_eq!(inside.len(), 1);
    assert!((inside[0].distance_m + 0.1).abs() < 0.01, "{}", inside[0].distance_m);
}

#[test]
fn in_view_of_a_camera() {
    let map = room();
    let camera = Camera::new((640, 480), (500.0, 500.0), (319.5, 239.5), Distortion::None).unwrap();
    // At the origin, half a metre up, looking along x: right is -y, down is -z.
    let looking =
        UnitQuaternion::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()]);
    let eye = Pose::from_parts(Vector3::new(0.0, 0.0, 0.5).into(), looking);
    let seen = map.in_view(&camera, &eye, 5.0);
    assert_eq!(labels(seen.iter().map(|v| v.object)), ["cabinet"]);
    let (rect, depth) = (seen[0].rect, seen[0].depth_m);
    assert!((depth - 2.0).abs() < 0.01);
    // The front face is 0.4 m wide and 1.6 m away.
    assert!((rect.width() - 500.0 * 0.4 / 1.6).abs() < 2.0, "{rect:?}");
    assert!((rect.center().0 - 319.5).abs() < 1.0 && seen[0].share > 0.9);
    assert!(map.in_view(&camera, &eye, 1.0).is_empty());
}

#[test]
fn footprints_hold_the_outline_and_grow_with_doubt() {
    let map = room();
    let suitcase = map.labelled("suitcase", 0.5)[0].0;
    let exact = suitcase.footprint(0.0);
    assert_eq!(exact.len(), 4);
    let area = |corners: &[Point2<f64>]| -> f64 {
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let sides = corners.iter().enumerate().map(|(i, p)| p.coords.perp(&next(i).coords));
        sides.sum::<f64>() / 2.0
    };
    // Counter-clockwise, so positive: 0.6 m by 0.3 m.
    assert!((area(&exact) - 0.18).abs() < 0.005, "{}", area(&exact));
    let corner = upright_pose(30.0_f64.to_radians(), Vector3::new(0.0, 3.0, 0.0))
        * Point3::new(0.3, 0.15, 0.0);
    assert!(exact.iter().any(|p| (p - corner.xy()).norm() < 0.01), "{exact:?}");
    let wide = suitcase.footprint(3.0);
    assert!(area(&wide) > 1.1 * area(&exact));
    let grown = suitcase.oriented_box(3.0).half_extents - suitcase.oriented_box(0.0).half_extents;
    assert!(grown.iter().all(|g| (0.02..0.2).contains(g)), "{grown}");
    let round = Observation {
        outline: Outline::Cylinder,
        ..thing("cup", [0.0; 3], 0.0, [0.2, 0.2, 0.1])[0].clone()
    };
    let cup = map_of(vec![round; 8]);
    let round = cup.all().iter().find(|o| o.id == ObjectId(1)).unwrap().footprint(0.0);
    let circle = std::f64::consts::PI * 0.04;
    assert!(area(&round) > circle * 0.99 && area(&round) < circle * 1.05, "{}", area(&round));
}
