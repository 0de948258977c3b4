use super::{independent, map_of, observation, observe, only, slam_settings};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Plane, Pose},
    mapping::{
        Association, MappingSettings, Notice, ObjectChange, ObjectId, ObjectMap, ObjectState,
        Observation, Sighting,
    },
    time::Stamp,
};
use nalgebra::Vector3;

fn chair(x: f64, y: f64) -> Observation {
    named("chair", x, y)
}

fn named(label: &str, x: f64, y: f64) -> Observation {
    let e = Ellipsoid::new(Pose::translation(x, y, 0.45), Vector3::new(0.3, 0.25, 0.45));
    observation(label, e, independent(&e, 0.05, 0.03, 0.02))
}

fn empty() -> ObjectMap {
    ObjectMap::new(MappingSettings::default(), slam_settings())
}

#[test]
fn labels_that_detectors_confuse_are_one_object_and_others_are_not() {
    let map = map_of([
        named("chair", 0.0, 0.0),
        named("couch", 0.0, 0.0),
        named("chair", 0.0, 0.0),
        named("potted plant", 0.4, 0.0),
    ]);
    let seen: Vec<(&str, u32)> = map.all().iter().map(|o| (o.label(), o.observations)).collect();
    assert_eq!(seen, [("chair", 3), ("potted plant", 1)]);
}

#[test]
fn what_is_far_is_another_object_and_what_is_in_doubt_waits() {
    // Between the centres: 3 cm each, and 3 cm that every measurement may be off besides, so 5.2 cm together.
    let mut map = empty();
    observe(&mut map, 0.0, vec![chair(0.0, 0.0)]);
    assert_eq!(observe(&mut map, 1.0, vec![chair(0.15, 0.0)]), [Some(ObjectId(1))]);
    // 7 standard deviations off, but half of it is where the object is.
    assert_eq!(observe(&mut map, 2.0, vec![chair(0.4, 0.0)]), [None]);
    assert_eq!(map.all().len(), 1);
    assert_eq!(observe(&mut map, 3.0, vec![chair(0.8, 0.0)]), [Some(ObjectId(2))]);
}

#[test]
fn between_two_objects_that_fit_alike_none_is_guessed() {
    let mut map = empty();
    for second in 0..3 {
        observe(&mut map, f64::from(second), vec![chair(0.0, 0.0), chair(0.7, 0.0)]);
    }
    // As unsure as half a metre: it may be either.
    assert_eq!(observe(&mut map, 3.0, vec![unsure(0.35, 0.5)]), [None]);
    assert_eq!(map.all().iter().map(|o| o.observations).collect::<Vec<_>>(), [3, 3]);
    // Both together are clear: each is one of them.
    let both = observe(&mut map, 4.0, vec![unsure(0.1, 0.5), chair(0.7, 0.0)]);
    assert_eq!(both, [Some(ObjectId(1)), Some(ObjectId(2))]);
}

/// Two chairs in a row that were measured as one.
#[test]
fn what_is_much_larger_than_its_class_does_not_keep_a_part_that_is_not_its_own() {
    let two = Ellipsoid::new(Pose::translation(0.3, 0.0, 0.45), Vector3::new(0.55, 0.25, 0.45));
    let mut first = observation("chair", two, independent(&two, 0.05, 0.03, 0.02));
    let usual = 0.55;
    first.measured = first.measured.map(|measured| measured.doubting_its_size(usual));
    let mut map = empty();
    observe(&mut map, 0.0, vec![first]);
    for second in 1..4 {
        let mut seen = chair(0.0, 0.0);
        let before = seen.measured.as_ref().unwrap().covariance;
        seen.measured = seen.measured.map(|measured| measured.doubting_its_size(usual));
        assert_eq!(seen.measured.as_ref().unwrap().covariance, before, "a usual chair is believed");
        observe(&mut map, f64::from(second), vec![seen]);
    }
    let object = only(&map).ellipsoid();
    assert!(object.center().x.abs() < 0.02, "{}", object.center());
    assert!((object.semi_axes.x - 0.3).abs() < 0.02, "{}", object.semi_axes);
}

/// Known only to so much (m).
fn unsure(x: f64, sigma: f64) -> Observation {
    let mut seen = chair(x, 0.0);
    let measured = seen.measured.as_mut().unwrap();
    measured.covariance = independent(&measured.ellipsoid, 0.05, sigma, 0.02);
    seen
}

#[test]
fn a_bad_beginning_does_not_keep_its_place_for_ever() {
    let mut map = empty();
    observe(&mut map, 0.0, vec![chair(0.0, 0.0)]);
    // Too much of it is where the object is to be another one, and it is too far off to be that one.
    let found: Vec<bool> = (1..8)
        .map(|second| observe(&mut map, f64::from(second), vec![chair(0.4, 0.0)])[0].is_some())
        .collect();
    assert_eq!(found, [false, false, true, true, true, true, true]);
    let confirmed: Vec<f64> = map.confirmed().map(|o| o.ellipsoid().center().x).collect();
    assert_eq!(confirmed.len(), 1);
    assert!((confirmed[0] - 0.4).abs() < 0.02, "{confirmed:?}");
}

#[test]
fn what_counts_keeps_its_place_however_often_a_box_does_not_fit() {
    let mut map = empty();
    (0..5).for_each(|second| drop(observe(&mut map, f64::from(second), vec![chair(0.0, 0.0)])));
    for second in 5..15 {
        assert_eq!(observe(&mut map, f64::from(second), vec![chair(0.4, 0.0)]), [None]);
    }
}

#[test]
fn a_second_box_now_and_then_does_not_make_two_of_one() {
    let mut map = empty();
    (0..3).for_each(|second| drop(observe(&mut map, f64::from(second), vec![chair(0.0, 0.0)])));
    for second in 3..20 {
        // The box of a chair behind it is filled by its points.
        let behind = (second % 2 == 0).then(|| chair(0.12, 0.0));
        let boxes = [chair(0.0, 0.0)].into_iter().chain(behind).collect();
        let found = observe(&mut map, f64::from(second), boxes);
        assert!(
            found[0] == Some(ObjectId(1)) && found[1..].iter().all(Option::is_none),
            "{found:?}"
        );
    }
    // In every image: then it is one.
    for second in 20..24 {
        observe(&mut map, f64::from(second), vec![chair(0.0, 0.0), chair(0.12, 0.0)]);
    }
    assert_eq!(map.all().len(), 2);
}

#[test]
fn what_has_come_into_one_place_is_merged_unless_both_were_seen_at_once() {
    for together in [false, true] {
        let mut map = empty();
        if together {
            observe(&mut map, 0.0, vec![chair(0.0, 0.0), unsure(0.7, 0.15)]);
        } else {
            observe(&mut map, 0.0, vec![chair(0.0, 0.0)]);
            observe(&mut map, 1.0, vec![unsure(0.7, 0.15)]);
        }
        assert_eq!(map.all().len(), 2);
        // The second one is much nearer to the first than it seemed.
        observe(&mut map, 2.0, vec![chair(0.3, 0.0)]);
        let seen: Vec<u32> = map.all().iter().map(|object| object.observations).collect();
        assert_eq!(seen, if together { vec![1, 2] } else { vec![3] });
    }
}

/// A chair that was seen twice from afar as two, half beside each other.
#[test]
fn what_overlaps_a_little_is_merged_once_both_count_and_were_never_seen_at_once() {
    for together in [false, true] {
        let mut map = empty();
        let mut second = 0.0;
        let mut look = |map: &mut ObjectMap, boxes: &dyn Fn() -> Vec<Observation>| {
            for _ in 0..6 {
                observe(map, second, boxes());
                second += 1.0;
            }
        };
        if together {
            look(&mut map, &|| vec![chair(0.0, 0.0), chair(0.44, 0.0)]);
        } else {
            look(&mut map, &|| vec![chair(0.0, 0.0)]);
            look(&mut map, &|| vec![chair(0.44, 0.0)]);
        }
        assert_eq!(map.confirmed().count(), if together { 2 } else { 1 });
    }
}

#[test]
fn what_comes_to_count_gets_the_measurements_that_its_neighbour_had_of_it() {
    let mut map = empty();
    (0..3).for_each(|second| drop(observe(&mut map, f64::from(second), vec![chair(0.0, 0.0)])));
    assert_eq!(observe(&mut map, 3.0, vec![unsure(0.7, 0.3)]), [Some(ObjectId(1))]);
    let mut changes = Vec::new();
    for second in 4..10 {
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(f64::from(second)),
            odom_from_base: Pose::identity(),
            odometry_covariance: None,
            observations: vec![chair(0.0, 0.0), chair(0.7, 0.0)],
            walls: Vec::new(),
            view: None,
        });
        assert_eq!(sighted.objects, [Some(ObjectId(1)), Some(ObjectId(2))]);
        changes.extend(sighted.changes);
    }
    let split = ObjectChange::Split { from: ObjectId(1), into: ObjectId(2) };
    assert_eq!(changes.iter().filter(|change| **change == split).count(), 1, "{changes:?}");
}

#[test]
fn six_chairs_round_a_table_keep_their_identities_when_odometry_slips() {
    let places = [(0.0, 0.0), (0.6, 0.0), (1.2, 0.0), (0.0, 1.5), (0.6, 1.5), (1.2, 1.5)];
    let mut map = empty();
    let mut first = Vec::new();
    for second in 0..20 {
        // A common error of the pose, a quarter of the way to the neighbour, and one of them is missed.
        let slip = 0.15 * f64::from(second % 3 - 1);
        let mut seen: Vec<Observation> = places.iter().map(|(x, y)| chair(x + slip, *y)).collect();
        if second > 0 {
            seen.remove(second as usize % 6);
        }
        let found = observe(&mut map, f64::from(second), seen);
        if second == 0 {
            first = found;
            continue;
        }
        let mut expected = first.clone();
        expected.remove(second as usize % 6);
        for (found, expected) in found.iter().zip(&expected) {
            assert!(found.is_none() || found == expected, "{second}: {found:?}, not {expected:?}");
        }
    }
    assert_eq!(map.confirmed().count(), 6);
    assert_eq!(map.all().len(), 6);
}

#[test]
fn a_flickering_label_is_outvoted_however_it_began() {
    let mut seen = vec![named("couch", 0.0, 0.0), named("couch", 0.0, 0.0)];
    seen.extend((0..5).map(|_| named("chair", 0.0, 0.0)));
    let map = map_of(seen);
    assert_eq!(only(&map).label(), "chair");
    assert!(only(&map).labels()["chair"] > 0.99);
}

#[test]
fn what_stands_on_top_is_another_object() {
    let mut upper = chair(0.0, 0.0);
    upper.measured.as_mut().unwrap().ellipsoid.pose.translation.z = 2.0;
    assert_eq!(map_of([chair(0.0, 0.0), upper]).all().len(), 2);
}

#[test]
fn of_two_neighbours_each_gets_its_own_whatever_the_order() {
    for swapped in [false, true] {
        let mut map = empty();
        let first = observe(&mut map, 0.0, vec![chair(0.0, 0.0), chair(0.6, 0.0)]);
        assert_eq!(first, [Some(ObjectId(1)), Some(ObjectId(2))]);
        // Both moved towards the first: the second one is within reach of both.
        let mut pair = vec![chair(0.05, 0.0), chair(0.4, 0.0)];
        let mut expected = vec![Some(ObjectId(1)), Some(ObjectId(2))];
        if swapped {
            pair.reverse();
            expected.reverse();
        }
        assert_eq!(observe(&mut map, 1.0, pair), expected);
    }
}

#[test]
fn one_frame_gives_an_object_one_measurement() {
    let mut map = empty();
    let ids = observe(&mut map, 0.0, vec![chair(0.0, 0.0), chair(0.02, 0.0)]);
    assert_ne!(ids[0], ids[1], "two boxes are two objects until a third view tells");
}

#[test]
fn an_object_counts_after_enough_measurements() {
    let mut map = empty();
    // From one place: false alarms that a view causes come again and again in it.
    for second in 0..5 {
        assert_eq!(map.confirmed().count(), 0);
        observe(&mut map, f64::from(second), vec![chair(0.0, 0.0)]);
    }
    assert_eq!(map.confirmed().count(), 1);
    let object = only(&map);
    assert_eq!(object.state(), ObjectState::Confirmed);
    assert_eq!(object.first_seen, Stamp::from_secs(0.0));
    assert_eq!(object.last_seen, Stamp::from_secs(4.0));
    assert!(object.existence() > 0.9);
}

#[test]
fn labels_are_probabilities_by_the_rule_of_bayes() {
    let mut unsure = chair(0.0, 0.0);
    unsure.labels = vec![("chair".into(), 0.5), ("couch".into(), 0.4)];
    let map = map_of([chair(0.0, 0.0), unsure]);
    let labels = only(&map).labels();
    // Called a chair 1.4 times and a couch 0.4 times; either is called by the other's name one time in ten.
    let odds = 9.0_f64.powf(1.4 - 0.4);
    assert!((labels["chair"] - odds / (1.0 + odds)).abs() < 1e-12);
    assert!((labels.values().sum::<f64>() - 1.0).abs() < 1e-12);
    assert_eq!(only(&map).label(), "chair");
}

#[test]
fn the_height_of_the_support_is_averaged() {
    let on = |height: Option<f64>| {
        let mut seen = chair(0.0, 0.0);
        let up = Vector3::z_axis();
        let plane = height.map(|height| Plane { normal: up, offset: -height });
        seen.measured.as_mut().unwrap().support = plane;
        seen
    };
    let map = map_of([on(None), on(Some(0.02)), on(Some(0.04)), on(None)]);
    let height = only(&map).support_height_m.unwrap();
    // The poses are held to a tenth of a millimetre.
    assert!((height - 0.03).abs() < 1e-4, "{height}");
}

#[test]
fn given_identities_decide_against_label_and_distance() {
    let settings =
        MappingSettings { association: Association::Given, ..MappingSettings::default() };
    let given = |track: Option<u64>, observation: Observation| Observation { track, ..observation };
    let mut map = ObjectMap::new(settings, slam_settings());
    let first = vec![given(Some(7), chair(0.0, 0.0)), given(Some(9), chair(0.02, 0.0))];
    let ids = observe(&mut map, 0.0, first);
    assert_eq!(ids, [Some(ObjectId(1)), Some(ObjectId(2))]);
    // A label that flickers, a box around nothing, a view that is far off, and one object twice.
    let second = vec![
        given(Some(9), named("couch", 0.0, 0.0)),
        given(None, chair(0.0, 0.0)),
        given(Some(7), chair(2.0, 0.0)),
        given(Some(7), chair(0.0, 0.0)),
    ];
    let ids = observe(&mut map, 1.0, second);
    assert_eq!(ids, [Some(ObjectId(2)), None, Some(ObjectId(1)), Some(ObjectId(1))]);
    let seen: Vec<_> = map.all().iter().map(|o| (o.track, o.observations)).collect();
    assert_eq!(seen, [(Some(7), 3), (Some(9), 2)]);
}

#[test]
fn identities_mean_nothing_where_the_map_decides() {
    let with = |track: u64, x: f64| Observation { track: Some(track), ..chair(x, 0.0) };
    let map = map_of([with(7, 0.0), with(9, 0.05), with(7, 3.0)]);
    let seen: Vec<u32> = map.all().iter().map(|o| o.observations).collect();
    assert_eq!(seen, [2, 1]);
}

#[test]
fn a_measurement_that_cannot_be_is_left_out_and_nothing_is_lost() {
    let mut map = empty();
    observe(&mut map, 0.0, vec![chair(0.0, 0.0)]);
    let before = only(&map).ellipsoid();
    // Known exactly in every direction: no measurement is.
    let mut exact = chair(0.1, 0.0);
    exact.measured.as_mut().unwrap().covariance.fill(0.0);
    let sighted = map.observe(&Sighting {
        stamp: Stamp::from_secs(1.0),
        odom_from_base: Pose::translation(0.5, 0.0, 0.0),
        odometry_covariance: None,
        observations: vec![chair(2.0, 0.0), exact],
        walls: Vec::new(),
        view: None,
    });
    assert_eq!(sighted.notices, [Notice::Unusable { measurements: 1 }]);
    assert_eq!(sighted.objects, [Some(ObjectId(2)), None]);
    let first = &map.all()[0];
    assert_eq!((first.observations, first.ellipsoid()), (1, before));
    // What comes next is joined as if nothing had happened.
    assert_eq!(observe(&mut map, 2.0, vec![chair(0.0, 0.0)]), [Some(ObjectId(1))]);
    assert_eq!(map.all()[0].observations, 2);
}
