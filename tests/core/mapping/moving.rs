//! People: they are in the map while they are there, and nothing hangs on where they are.

use super::{independent, normal, observation, observe_from};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    mapping::{MapObject, MappingSettings, ObjectMap, Observation, SlamSettings},
};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Cabinets on either side of a corridor.
fn cabinets() -> impl Iterator<Item = Ellipsoid> {
    (0..8).map(|i| {
        let side = if i % 2 == 0 { 1.3 } else { -1.3 };
        let place = Vector3::new(0.9 * f64::from(i), side, 0.5);
        Ellipsoid::new(upright_pose(0.3 * f64::from(i), place), Vector3::new(0.4, 0.25, 0.5))
    })
}

/// Who strolls along ahead of the robot, which passes him.
fn person(step: u32) -> Ellipsoid {
    let place = Vector3::new(1.5 + 0.04 * f64::from(step), 0.3, 0.85);
    Ellipsoid::new(upright_pose(0.0, place), Vector3::new(0.25, 0.2, 0.85))
}

enum People {
    Nobody,
    /// Known to move.
    Moving,
    /// Taken for furniture.
    Standing,
}

const STEPS: u32 = 40;

/// After a drive along the corridor with odometry that drifts: the map, and how far off the last pose is (m).
fn driven(people: &People) -> (ObjectMap, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let (mut odom_from_base, mut truth) = (Pose::identity(), Pose::identity());
    for step in 0..STEPS {
        if step > 0 {
            truth *= Pose::translation(0.12, 0.0, 0.0);
            // It slips a little more than it says.
            odom_from_base *= Pose::new(Vector3::new(0.123, 0.001, 0.0), 0.002 * Vector3::z());
        }
        let base_from_map = truth.inverse();
        let seen = |body: Ellipsoid, noise: Vector3<f64>, (label, moves): (&str, bool)| {
            let mut body = body.transformed(&base_from_map);
            body.pose.translation.vector += noise;
            let covariance = independent(&body, 0.05, 0.02, 0.02);
            Observation { moves, ..observation(label, body, covariance) }
        };
        let ahead = truth.translation.vector.x;
        let near = |body: &Ellipsoid| (0.0..4.0).contains(&(body.center().x - ahead));
        let mut noise = || Vector3::from_fn(|_, _| 0.02 * normal(&mut rng));
        let cabinet = |body| seen(body, noise(), ("cabinet", false));
        let mut all: Vec<Observation> = cabinets().filter(near).map(cabinet).collect();
        let moves = match people {
            People::Nobody => None,
            People::Moving => Some(true),
            People::Standing => Some(false),
        };
        all.extend(moves.map(|moves| seen(person(step), Vector3::zeros(), ("person", moves))));
        observe_from(&odom_from_base, &mut map, f64::from(step) * 0.3, all);
    }
    map.finish();
    let estimated = map.map_from_odom() * odom_from_base;
    let off = (estimated.translation.vector - truth.translation.vector).xy().norm();
    (map, off)
}

fn people(map: &ObjectMap) -> Vec<&MapObject> {
    map.confirmed().filter(|object| object.label() == "person").collect()
}

#[test]
fn who_walks_ahead_is_where_he_was_seen_last_and_pulls_nothing_along() {
    let (_, without) = driven(&People::Nobody);
    let (map, with) = driven(&People::Moving);
    let (_, pulled) = driven(&People::Standing);
    println!(
        "off by {without:.3} m without people, {with:.3} m with, {pulled:.3} m if they were furniture"
    );
    assert!((with - without).abs() < 1e-4, "{with} m, {without} m without");
    assert!((pulled - without).abs() > 1e-3, "{pulled} m tells nothing");
    let found = people(&map);
    assert_eq!(found.len(), 1);
    let apart = (found[0].ellipsoid().center() - person(STEPS - 1).center()).norm();
    assert!(apart < 0.15 + with, "{apart} m from where he was seen last");
    // The next step is not known: 90 % of steps are within this.
    assert!(found[0].covariance()[(3, 3)].sqrt() > 0.3);
}

#[test]
fn people_are_not_saved_and_are_forgotten_when_they_have_left() {
    let (mut map, _) = driven(&People::Moving);
    assert!(map.lasting().all(|object| object.label() == "cabinet"));
    assert_eq!(map.lasting().count() + 1, map.confirmed().count());
    let later = f64::from(STEPS) * 0.3 + 90.0;
    observe_from(&Pose::identity(), &mut map, later, Vec::new());
    assert!(people(&map).is_empty());
    assert!(map.lasting().count() >= 6);
}
