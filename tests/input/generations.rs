//! A robot that drives the same round every day, and is switched off and on between: each day's map is the next day's.

use ellipsoid_slam::{
    io::{BagInput, map_json, read_map},
    mapping::SavedMap,
    pipeline::{FrontEnd, ObjectSlam, Perceived, Settings},
};
use std::path::Path;

const DAYS: usize = 100;

/// What perception makes of the demo bag, which is the same every day.
fn perceived() -> Vec<Perceived> {
    let bag = BagInput::open(Path::new("bags/desk.mcap"), &[]).unwrap();
    let mut front_end = FrontEnd::new(Settings::default());
    let mut all: Vec<Perceived> =
        bag.inputs().map(|input| front_end.take(input, &mut ())).collect();
    all.push(front_end.finish(&mut ()));
    all.retain(|perceived| !perceived.is_empty());
    // A round is as well known from every third image.
    all.into_iter().step_by(3).collect()
}

/// The map after a drive, and whether the place in the one before was recognised.
fn driven(mut slam: ObjectSlam, all: &[Perceived]) -> (SavedMap, bool) {
    let mut updates: Vec<_> =
        all.iter().map(|perceived| slam.join(perceived.clone(), &mut ())).collect();
    updates.push(slam.finish(&mut ()));
    let recognised = updates.iter().any(|update| update.relocalised.is_some());
    (slam.maps("map").map, recognised)
}

#[test]
fn the_demo_bag_finds_its_place_in_its_own_map_a_hundred_days_running() {
    let all = perceived();
    let (first, _) = driven(ObjectSlam::new(Settings::default()), &all);
    let names = |map: &SavedMap| -> Vec<(u64, String)> {
        map.objects.iter().map(|o| (o.id, o.label.clone())).collect()
    };
    assert!(first.objects.len() >= 5);
    let (mut today, mut farthest) = (first.clone(), 0.0_f64);
    for day in 1..=DAYS {
        let saved = read_map(&map_json(&today).unwrap()).unwrap();
        let (next, recognised) =
            driven(ObjectSlam::continuing(Settings::default(), saved, None), &all);
        assert!(recognised, "day {day}");
        assert_eq!(names(&next), names(&first), "day {day}");
        for (now, then) in next.objects.iter().zip(&first.objects) {
            farthest = farthest.max((now.ellipsoid.center() - then.ellipsoid.center()).norm());
        }
        today = next;
    }
    println!("after {DAYS} days an object is at most {farthest:.3} m from where it was");
    assert!(farthest < 0.03, "{farthest} m");
}
