//! Where am I, from objects alone: random homes, and maps that are made to deceive.

use super::{independent, normal, observation, observe, slam_settings};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose, yaw_of},
    mapping::{
        Constellation, Continuation, ExpectedPlace, Landmark, MappingSettings, NotRelocalised,
        ObjectChange, ObjectMap, RelocalisationSettings, Relocalised, SavedMap, SavedObject,
    },
    time::Stamp,
};
use nalgebra::{SMatrix, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::{collections::BTreeMap, f64::consts::PI};

/// Class, usual half extents (m), height of what it stands on (m), and how many a home has of it at most.
const CLASSES: [(&str, [f64; 3], f64, usize); 12] = [
    ("chair", [0.28, 0.25, 0.45], 0.0, 6),
    ("couch", [0.9, 0.45, 0.42], 0.0, 2),
    ("dining table", [0.7, 0.42, 0.37], 0.0, 2),
    ("cabinet", [0.5, 0.2, 0.6], 0.0, 4),
    ("bed", [1.0, 0.75, 0.45], 0.0, 2),
    ("tv", [0.5, 0.1, 0.3], 0.5, 2),
    ("refrigerator", [0.35, 0.32, 0.85], 0.0, 1),
    ("potted plant", [0.25, 0.24, 0.5], 0.0, 3),
    ("suitcase", [0.3, 0.15, 0.3], 0.0, 1),
    ("cup", [0.06, 0.045, 0.05], 0.75, 3),
    ("book", [0.12, 0.09, 0.02], 0.75, 3),
    ("microwave", [0.25, 0.2, 0.15], 0.9, 1),
];

type Thing = (&'static str, Ellipsoid);

/// A home of some rooms: furniture stands along the axes, as it does along walls, or anyhow.
fn home(rng: &mut ChaCha8Rng) -> Vec<Thing> {
    let (width, depth) = (rng.random_range(7.0..12.0), rng.random_range(4.0..8.0));
    let mut things = Vec::new();
    for (label, half, height, most) in CLASSES {
        for _ in 0..rng.random_range(1..=most) {
            let scale = Vector3::from_fn(|_, _| rng.random_range(0.8..1.2));
            let size = Vector3::from(half).component_mul(&scale);
            let place = Vector3::new(
                rng.random_range(0.0..width),
                rng.random_range(0.0..depth),
                height + size.z,
            );
            let quarter = f64::from(rng.random_range(0..4u8)) * 0.5 * PI;
            let anyhow = if rng.random_bool(0.5) { 0.0 } else { rng.random_range(-PI..PI) };
            things.push((label, Ellipsoid::new(upright_pose(quarter + anyhow, place), size)));
        }
    }
    things
}

/// As replays of simulated homes measure: a horizontal direction may be known ten times worse than the other, and the
/// errors that are claimed come on top of some centimetres that are not.
fn measured((label, truth): &Thing, rng: &mut ChaCha8Rng) -> Landmark {
    let mut sigmas = SVector::<f64, 9>::repeat(1e-3);
    sigmas[2] = rng.random_range(0.02..0.05);
    sigmas[3] = rng.random_range(0.015..0.06);
    sigmas[4] = if rng.random_bool(0.3) { rng.random_range(0.1..0.22) } else { sigmas[3] };
    sigmas[5] = rng.random_range(0.01..0.04);
    for i in 6..9 {
        sigmas[i] = if rng.random_bool(0.2) { 0.25 } else { rng.random_range(0.02..0.1) };
    }
    let unclaimed = SVector::from([0.0, 0.0, 0.01, 0.03, 0.03, 0.005, 0.05, 0.05, 0.02]);
    let noise =
        SVector::<f64, 9>::from_fn(|i, _| normal(rng) * sigmas[i] + normal(rng) * unclaimed[i]);
    let belief = rng.random_range(0.7..1.0);
    let other = CLASSES[rng.random_range(0..CLASSES.len())].0;
    let mut labels = BTreeMap::from([((*label).to_owned(), belief)]);
    *labels.entry(other.to_owned()).or_default() += 1.0 - belief;
    Landmark {
        labels,
        ellipsoid: truth.retract(&noise),
        covariance: SMatrix::from_diagonal(&sigmas.map(|s| s * s)),
    }
}

/// A map of these things: measured, and now and then wrong.
fn map_of(things: &[Thing], rng: &mut ChaCha8Rng) -> Vec<Landmark> {
    things.iter().map(|thing| measured(thing, rng)).collect()
}

/// What a robot has seen that looked about from somewhere: the nearest things, some of them missed, and now and then
/// one that is new.
fn seen_in(things: &[Thing], count: usize, rng: &mut ChaCha8Rng) -> (Vec<Landmark>, Pose) {
    let start = &things[rng.random_range(0..things.len())].1;
    let mut near: Vec<&Thing> = things.iter().filter(|_| rng.random_bool(0.9)).collect();
    let away = |thing: &&Thing| (thing.1.center() - start.center()).xy().norm();
    near.sort_by(|a, b| away(a).total_cmp(&away(b)));
    near.truncate(count);
    let place = Vector3::new(
        rng.random_range(-5.0..5.0),
        rng.random_range(-5.0..5.0),
        rng.random_range(-0.05..0.05),
    );
    let seen_from_map = upright_pose(rng.random_range(-PI..PI), place);
    let mut seen: Vec<Landmark> = near.into_iter().map(|thing| measured(thing, rng)).collect();
    if rng.random_bool(0.3) {
        let mut stranger = measured(&things[rng.random_range(0..things.len())], rng);
        let step = Vector3::new(rng.random_range(-2.0..2.0), rng.random_range(-2.0..2.0), 0.0);
        stranger.ellipsoid.pose.translation.vector = start.center().coords + step;
        seen.push(stranger);
    }
    for landmark in &mut seen {
        landmark.ellipsoid = landmark.ellipsoid.transformed(&seen_from_map);
    }
    (seen, seen_from_map.inverse())
}

#[expect(clippy::result_large_err, reason = "a reason is what is looked at")]
fn located(map: &[Landmark], seen: &[Landmark]) -> Result<Relocalised, NotRelocalised> {
    Constellation::new(map, RelocalisationSettings::default()).locate(seen, None)
}

/// Whether what was seen is put to where it is, within half a metre and ten degrees.
fn is_right(found: &Relocalised, seen: &[Landmark], truth: &Pose) -> bool {
    let error = truth.inverse() * found.map_from_seen;
    let middle =
        seen.iter().map(|l| l.ellipsoid.center().coords).sum::<Vector3<f64>>() / seen.len() as f64;
    (error * nalgebra::Point3::from(middle) - middle).coords.norm() < 0.5
        && yaw_of(&error).abs() < 10.0_f64.to_radians()
}

/// The mirror image of a home: every distance is the same, and no rotation takes one to the other.
fn mirrored(things: &[Thing]) -> Vec<Thing> {
    let flip = |(label, e): &Thing| {
        let mut place = e.pose.translation.vector;
        place.x = -place.x;
        (*label, Ellipsoid::new(upright_pose(PI - yaw_of(&e.pose), place), e.semi_axes))
    };
    things.iter().map(flip).collect()
}

/// The same places with other things at them.
fn shuffled(things: &[Thing], rng: &mut ChaCha8Rng) -> Vec<Thing> {
    let mut order: Vec<usize> = (0..things.len()).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, rng.random_range(0..=i));
    }
    let put = |(at, from): (usize, &usize)| {
        let (label, e) = &things[*from];
        let mut place = things[at].1.pose.translation.vector;
        place.z = e.pose.translation.vector.z;
        (*label, Ellipsoid::new(upright_pose(yaw_of(&e.pose), place), e.semi_axes))
    };
    order.iter().enumerate().map(put).collect()
}

/// A home that looks the same when it is turned by half a turn: two places for everything.
fn doubled(things: &[Thing]) -> Vec<Thing> {
    let half_turn = upright_pose(PI, Vector3::new(-1.0, 0.0, 0.0));
    let other = things.iter().map(|(label, e)| (*label, e.transformed(&half_turn)));
    things.iter().copied().chain(other).collect()
}

#[derive(Debug, Default)]
struct Tally {
    right: usize,
    wrong: usize,
    refused: usize,
}

/// Trials that each draw a home, a map from it, and what is seen of the home.
fn trials(
    seeds: std::ops::Range<u64>,
    map_things: impl Fn(&[Thing], &mut ChaCha8Rng) -> Vec<Thing>,
    has_place: bool,
) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let things = home(&mut rng);
        let known = map_things(&things, &mut rng);
        let map = map_of(&known, &mut rng);
        let count = rng.random_range(4..12);
        let (seen, truth) = seen_in(&things, count, &mut rng);
        match located(&map, &seen) {
            Ok(found) if has_place && is_right(&found, &seen, &truth) => tally.right += 1,
            Ok(found) => {
                println!(
                    "seed {seed}: wrong, {} of {} seen: {found:?}",
                    found.matches.len(),
                    seen.len()
                );
                tally.wrong += 1;
            }
            Err(why) => {
                if has_place {
                    println!("seed {seed}: {} seen: {why}", seen.len());
                }
                tally.refused += 1;
            }
        }
    }
    tally
}

#[test]
fn the_right_place_is_found_and_never_a_wrong_one() {
    let same = trials(0..400, |things, _| things.to_vec(), true);
    println!("the same home: {same:?}");
    let mirror = trials(1000..1200, |things, _| mirrored(things), false);
    println!("mirrored: {mirror:?}");
    let other = trials(2000..2200, shuffled, false);
    println!("shuffled: {other:?}");
    let twice = trials(3000..3200, |things, _| doubled(things), false);
    println!("with two equal answers: {twice:?}");
    assert_eq!([same.wrong, mirror.wrong, other.wrong, twice.wrong], [0; 4]);
    assert!(same.right >= 380, "{same:?}");
}

#[test]
fn two_objects_are_too_few() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let things = home(&mut rng);
    let map = map_of(&things, &mut rng);
    let why = located(&map, &map[..2]).unwrap_err();
    assert_eq!(why, NotRelocalised::TooFewObjects { seen: 2, needed: 3 });
    let none = located(&[], &map[..6]).unwrap_err();
    assert_eq!(none, NotRelocalised::TooSmallMap { known: 0, needed: 3 });
}

#[test]
fn a_place_that_is_expected_settles_what_would_be_ambiguous() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let things = home(&mut rng);
    let map = map_of(&doubled(&things), &mut rng);
    let (seen, truth) = seen_in(&things, 8, &mut rng);
    let why = located(&map, &seen).unwrap_err();
    assert!(matches!(why, NotRelocalised::Ambiguous { .. }), "{why}");
    let covariance = nalgebra::Matrix4::from_diagonal(&nalgebra::Vector4::new(0.04, 0.1, 0.1, 0.1));
    let expected = ExpectedPlace { pose: truth, covariance };
    let constellation = Constellation::new(&map, RelocalisationSettings::default());
    let found = constellation.locate(&seen, Some(&expected)).unwrap();
    assert!(is_right(&found, &seen, &truth));
}

#[test]
#[expect(clippy::disallowed_methods, reason = "the time is what is measured")]
fn a_place_among_a_thousand_objects_is_found_in_time() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut things: Vec<Thing> = Vec::new();
    let mut homes = 0;
    while things.len() < 1000 {
        let aside =
            Pose::translation(14.0 * f64::from(homes % 8), 10.0 * f64::from(homes / 8), 0.0);
        things.extend(home(&mut rng).into_iter().map(|(l, e)| (l, e.transformed(&aside))));
        homes += 1;
    }
    let map = map_of(&things, &mut rng);
    let (mut right, mut slowest) = (0, 0.0_f64);
    for _ in 0..5 {
        let (seen, truth) = seen_in(&things, 15, &mut rng);
        let start = std::time::Instant::now();
        let found = located(&map, &seen);
        slowest = slowest.max(start.elapsed().as_secs_f64());
        match found {
            Ok(found) => {
                assert!(is_right(&found, &seen, &truth));
                right += 1;
            }
            Err(why) => println!("{why}"),
        }
    }
    println!("{right} of 5 places among {} objects, at most {slowest:.3} s each", things.len());
    assert!(right >= 4, "{right}");
    // Measured: a small part of it; the machine may be busy.
    assert!(slowest < 5.0, "{slowest} s");
}

/// A saved object that claims to be known as well as these measurements.
fn saved(id: u64, label: &str, ellipsoid: Ellipsoid) -> SavedObject {
    SavedObject {
        id,
        label: label.into(),
        name: None,
        locked: false,
        labels: BTreeMap::from([(label.into(), 1.0)]),
        existence: 0.99,
        observations: 10,
        first_seen: Stamp::default(),
        last_seen: Stamp::default(),
        ellipsoid,
        outline: Outline::Cuboid,
        support_height_m: None,
        covariance: size_known_to_a_tenth(&ellipsoid),
    }
}

fn size_known_to_a_tenth(e: &Ellipsoid) -> SMatrix<f64, 9, 9> {
    let mut covariance = independent(e, 0.05, 0.06, 0.1);
    (6..9).for_each(|i| covariance[(i, i)] = 0.01);
    covariance
}

#[test]
fn what_was_saved_counts_a_third_of_what_it_claims() {
    let thing = |label, x: f64, y: f64, half: [f64; 3]| {
        (label, Ellipsoid::new(Pose::translation(x, y, half[2]), Vector3::from(half)))
    };
    let things = [
        thing("cabinet", 2.0, 1.5, [0.5, 0.2, 0.6]),
        thing("couch", 3.5, -1.0, [0.9, 0.45, 0.42]),
        thing("suitcase", 1.5, -1.6, [0.3, 0.15, 0.3]),
        thing("refrigerator", 4.0, 2.0, [0.35, 0.3, 0.85]),
    ];
    let objects = (1..).zip(&things).map(|(id, (label, e))| saved(id, label, *e)).collect();
    let map_file = SavedMap { frame_id: "map".into(), objects };
    let mut map = ObjectMap::new(MappingSettings::default(), slam_settings()).continuing(&map_file);
    // Everything is a tenth wider now, five times.
    for second in 0..5 {
        let wider = things.iter().map(|(label, e)| {
            let mut seen = *e;
            seen.semi_axes.x *= 1.1;
            observation(label, seen, size_known_to_a_tenth(&seen))
        });
        observe(&mut map, f64::from(second), wider.collect());
    }
    let settings = RelocalisationSettings::default();
    let mut waiting = Continuation::new(map_file, Some(Pose::identity()), settings);
    assert!(waiting.attempt(&mut map, true).is_some(), "{}", waiting.why());
    map.finish();
    assert_eq!(map.confirmed().count(), things.len());
    // Five measurements, and a third of one.
    let expected = 1.1_f64.ln() * 5.0 / (5.0 + 1.0 / 3.0);
    for (object, (label, before)) in map.confirmed().zip(&things) {
        assert_eq!(object.label(), *label);
        let wider = (object.ellipsoid().semi_axes.x / before.semi_axes.x).ln();
        assert!((wider - expected).abs() < 0.003, "{label}: {wider} instead of {expected}");
    }
}

#[test]
fn of_two_places_alike_it_is_the_one_where_somebody_says_the_robot_is() {
    let thing = |label, x: f64, y: f64, half: [f64; 3]| {
        (label, Ellipsoid::new(Pose::translation(x, y, half[2]), Vector3::from(half)))
    };
    let things = [
        thing("cabinet", 2.0, 1.5, [0.5, 0.2, 0.6]),
        thing("couch", 3.5, -1.0, [0.9, 0.45, 0.42]),
        thing("suitcase", 1.5, -1.6, [0.3, 0.15, 0.3]),
        thing("refrigerator", 4.0, 2.0, [0.35, 0.3, 0.85]),
        thing("bed", 6.0, 0.5, [1.0, 0.8, 0.3]),
    ];
    let other_room = upright_pose(0.7, Vector3::new(20.0, 5.0, 0.0));
    let there = things.iter().map(|(label, e)| (*label, e.transformed(&other_room)));
    let all: Vec<_> = things.iter().copied().chain(there).collect();
    let objects = (1..).zip(&all).map(|(id, (label, e))| saved(id, label, *e)).collect();
    let map_file = SavedMap { frame_id: "map".into(), objects };
    let mut map = ObjectMap::new(MappingSettings::default(), slam_settings()).continuing(&map_file);
    for second in 0..5 {
        let seen = things.iter().map(|(label, e)| observation(label, *e, size_known_to_a_tenth(e)));
        observe(&mut map, f64::from(second), seen.collect());
    }
    let mut waiting = Continuation::new(map_file, None, RelocalisationSettings::default());
    assert!(waiting.attempt(&mut map, true).is_none(), "nobody can tell the two rooms apart");
    // The base is not where the frame of what was seen begins, and people are off by a little.
    let seen_from_base = upright_pose(0.4, Vector3::new(1.0, -0.5, 0.0));
    let off = upright_pose(0.1, Vector3::new(0.15, -0.1, 0.0));
    waiting.place(&mut map, &(other_room * seen_from_base * off), Some(seen_from_base));
    let (_, changes) =
        waiting.attempt(&mut map, true).unwrap_or_else(|| panic!("{}", waiting.why()));
    let kept = changes.iter().filter_map(|change| match change {
        ObjectChange::Merged { kept, .. } => Some(kept.0),
        _ => None,
    });
    let mut kept: Vec<u64> = kept.collect();
    kept.sort_unstable();
    assert_eq!(kept, [6, 7, 8, 9, 10]);
}
