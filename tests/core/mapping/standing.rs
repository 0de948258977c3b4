//! A robot that stands still: it sees the same again and again, which costs nothing and proves nothing.

use super::{independent, observation};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    graph::BoxSide,
    mapping::{
        MappingSettings, Notice, ObjectId, ObjectMap, Observation, ObservedBox, Sighted, Sighting,
        SlamSettings,
    },
    time::Stamp,
};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

fn cup() -> Ellipsoid {
    Ellipsoid::new(Pose::translation(1.5, 0.1, 0.5), Vector3::new(0.06, 0.045, 0.05))
}

/// A round thing with the sides of its box, seen from the origin.
fn seen_with_its_box() -> Observation {
    let e = cup();
    let rotation = UnitQuaternion::from_euler_angles(-FRAC_PI_2, 0.0, -FRAC_PI_2);
    let base_from_camera = Pose::from_parts(nalgebra::Translation3::new(0.0, 0.0, 0.5), rotation);
    // Ahead is x: left of the image is +y.
    let side = |at: f64| Some(BoxSide { at: at / 1.5, sigma: 0.006 });
    let sides = [side(-0.16), side(-0.05), side(-0.04), side(0.05)];
    Observation {
        outline: Outline::Superquadric(0.2, 1.0),
        sides: ObservedBox { base_from_camera, sides },
        ..observation("cup", e, independent(&e, 0.5, 0.02, 0.01))
    }
}

fn look(map: &mut ObjectMap, image: u32, observations: Vec<Observation>) -> Sighted {
    map.observe(&Sighting {
        stamp: Stamp::from_secs(0.2 * f64::from(image)),
        odom_from_base: Pose::identity(),
        odometry_covariance: None,
        observations,
        walls: Vec::new(),
        view: None,
    })
}

#[test]
fn a_cup_that_is_watched_for_hours_costs_no_more_and_is_known_no_better() {
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let (mut factors, mut sigma) = (0, 0.0);
    for image in 0..2500 {
        assert_eq!(look(&mut map, image, vec![seen_with_its_box()]).refused, None);
        if image == 100 {
            (factors, sigma) = (map.factors(), map.all()[0].covariance()[(3, 3)].sqrt());
        }
    }
    let later = map.all()[0].covariance()[(3, 3)].sqrt();
    println!("{factors} and {} factors; {sigma} and {later} m", map.factors());
    // Sixteen views with a box each, and what holds a single object and the first pose.
    assert!(factors < 50 && map.factors() <= factors);
    assert!(later > 0.99 * sigma, "{later} m after {sigma} m");
}

#[test]
fn a_measurement_without_a_covariance_is_left_out_and_nothing_else() {
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    for (image, broken) in [-1.0, f64::NAN].into_iter().enumerate() {
        let mut bad = seen_with_its_box();
        bad.measured.as_mut().unwrap().covariance[(4, 4)] = broken;
        let sighted = look(&mut map, image as u32, vec![bad, seen_with_its_box()]);
        assert_eq!((sighted.refused, sighted.objects), (None, vec![None, Some(ObjectId(1))]));
        assert_eq!(sighted.notices, [Notice::Unusable { measurements: 1 }]);
    }
    assert_eq!(map.all().len(), 1);
}
