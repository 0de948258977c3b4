//! Maps that are looked at for long and continued often: they are recognised as on the first day.

use super::{independent, observation, observe, slam_settings};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    io::{load_saved_map, map_json, read_map, save_map},
    mapping::{
        Constellation, Continuation, Landmark, MappingSettings, ObjectMap, Observation,
        RelocalisationSettings, SavedMap,
    },
};
use nalgebra::Vector3;

/// What it is, what detectors now and then call it, where it stands (m), half extents (m).
const THINGS: [(&str, &str, [f64; 2], [f64; 3]); 6] = [
    ("cabinet", "refrigerator", [2.0, 1.5], [0.5, 0.2, 0.6]),
    ("couch", "chair", [3.5, -1.0], [0.9, 0.45, 0.42]),
    ("suitcase", "backpack", [1.5, -1.6], [0.3, 0.15, 0.3]),
    ("refrigerator", "suitcase", [4.0, 2.0], [0.35, 0.3, 0.85]),
    ("chair", "couch", [2.5, 0.2], [0.28, 0.25, 0.45]),
    ("bed", "couch", [6.0, 0.5], [1.0, 0.75, 0.45]),
];

/// All things as they are seen from a start; one image in seven gives another name to each.
fn seen(image: usize, start_from_room: &Pose) -> Vec<Observation> {
    let of = |(label, other, [x, y], half): &(&str, &str, [f64; 2], [f64; 3])| {
        let place = upright_pose(0.4 * x, Vector3::new(*x, *y, half[2]));
        let body = Ellipsoid::new(start_from_room * place, Vector3::from(*half));
        let called = if image % 7 == 3 { other } else { label };
        observation(called, body, independent(&body, 0.05, 0.03, 0.03))
    };
    THINGS.iter().map(of).collect()
}

fn empty() -> ObjectMap {
    ObjectMap::new(MappingSettings::default(), slam_settings())
}

/// Where the robot was switched on, one of many places.
fn start(visit: usize) -> Pose {
    let angle = 0.7 * visit as f64;
    upright_pose(angle, Vector3::new(angle.sin(), angle.cos(), 0.0))
}

/// A visit that continues a map, and the map after it.
fn visited(saved: SavedMap, visit: usize) -> SavedMap {
    let mut map = empty().continuing(&saved);
    let mut waiting = Continuation::new(saved, None, RelocalisationSettings::default());
    for image in 0..5 {
        observe(&mut map, (100 * visit + image) as f64, seen(visit + image, &start(visit)));
    }
    let found = waiting.attempt(&mut map, true);
    assert!(found.is_some(), "visit {visit}: {}", waiting.why());
    map.finish();
    SavedMap::of(map.confirmed(), "map")
}

fn names(map: &SavedMap) -> Vec<(u64, &str)> {
    map.objects.iter().map(|o| (o.id, o.label.as_str())).collect()
}

#[test]
fn a_map_that_was_looked_at_ten_thousand_times_is_recognised_at_the_second_visit() {
    let mut map = empty();
    for image in 0..10_000 {
        observe(&mut map, 0.1 * image as f64, seen(image, &Pose::identity()));
    }
    map.finish();
    let first = SavedMap::of(map.confirmed(), "map");
    assert_eq!(first.objects.len(), THINGS.len());
    for object in &first.objects {
        assert_eq!(object.observations, 10_000);
        let sum: f64 = object.labels.values().sum();
        let least = object.labels.values().copied().fold(1.0, f64::min);
        assert!((sum - 1.0).abs() < 1e-12 && least > 1e-7, "{:?}", object.labels);
    }
    assert_eq!(names(&visited(first.clone(), 1)), names(&first));
}

#[test]
fn a_map_of_a_hundred_visits_and_restarts_is_recognised_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let mut map = empty();
    for image in 0..5 {
        observe(&mut map, image as f64, seen(image, &Pose::identity()));
    }
    map.finish();
    let first = SavedMap::of(map.confirmed(), "map");
    save_map(&path, &first).unwrap();
    for visit in 1..=100 {
        let next = visited(load_saved_map(&path).unwrap(), visit);
        assert_eq!(names(&next), names(&first), "visit {visit}");
        for (now, then) in next.objects.iter().zip(&first.objects) {
            let moved = (now.ellipsoid.center() - then.ellipsoid.center()).norm();
            assert!(moved < 0.01, "visit {visit}: {} moved by {moved} m", now.label);
        }
        save_map(&path, &next).unwrap();
    }
}

#[test]
fn a_file_whose_probabilities_an_earlier_version_let_vanish_is_recognised() {
    let mut map = empty();
    for image in 0..5 {
        observe(&mut map, image as f64, seen(image, &Pose::identity()));
    }
    let mut first = SavedMap::of(map.confirmed(), "map");
    for object in &mut first.objects {
        object.labels.values_mut().for_each(|p| *p = 0.0);
        object.labels.insert(object.label.clone(), 1.0);
        object.labels.insert("toaster".into(), 0.0);
    }
    let read = read_map(&map_json(&first).unwrap()).unwrap();
    for object in &read.objects {
        let sum: f64 = object.labels.values().sum();
        assert!((sum - 1.0).abs() < 1e-12 && object.labels.values().all(|p| *p > 0.0));
    }
    assert_eq!(names(&visited(read, 1)), names(&first));

    // And whatever is handed in, nothing is divided by zero.
    let landmarks: Vec<Landmark> = first.objects.iter().map(|o| o.landmark()).collect();
    let constellation = Constellation::new(&landmarks, RelocalisationSettings::default());
    assert!(constellation.locate(&landmarks, None).is_ok());
}
