use super::{independent, map_of, observation, observe, slam_settings};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    mapping::{MappingSettings, MergeError, ObjectId, ObjectMap, Observation},
    time::Stamp,
};
use nalgebra::Vector3;

fn chair(x: f64) -> Observation {
    let e = Ellipsoid::new(Pose::translation(x, 0.0, 0.45), Vector3::new(0.3, 0.25, 0.45));
    observation("chair", e, independent(&e, 0.05, 0.03, 0.02))
}

/// Two chairs, one seen three times at 0, the other once at 1.
fn two() -> ObjectMap {
    let mut map = ObjectMap::new(MappingSettings::default(), slam_settings());
    for second in 0..3 {
        observe(&mut map, f64::from(second), vec![chair(0.0)]);
    }
    observe(&mut map, 3.0, vec![chair(1.0)]);
    map
}

#[test]
fn a_merged_object_is_where_all_measurements_together_say() {
    let mut map = two();
    map.merge(ObjectId(2), ObjectId(1)).unwrap();
    map.finish();
    let [object] = map.all() else { panic!("{:?}", map.all()) };
    assert_eq!((object.id, object.observations), (ObjectId(2), 4));
    assert_eq!((object.first_seen, object.last_seen), (Stamp::default(), Stamp::from_secs(3.0)));
    // Four measurements that weigh the same.
    assert!((object.ellipsoid().center().x - 0.25).abs() < 1e-3, "{}", object.ellipsoid().center());
    let sigma = object.covariance()[(3, 3)].sqrt();
    assert!((sigma - 0.03 / 2.0).abs() < 1e-3, "{sigma}");
}

#[test]
fn what_cannot_be_merged_stays() {
    let mut map = two();
    let (one, none) = (ObjectId(1), ObjectId(7));
    assert_eq!(map.merge(one, one), Err(MergeError::Same(one)));
    assert_eq!(map.merge(one, none), Err(MergeError::Unknown(none)));
    assert_eq!(map.merge(none, one), Err(MergeError::Unknown(none)));
    assert_eq!(map.remove(none), Err(MergeError::Unknown(none)));
    assert_eq!(map.all().len(), 2);
    assert_eq!(observe(&mut map, 4.0, vec![chair(0.0)]), [Some(one)]);
}

#[test]
fn a_removed_object_leaves_the_others_as_they_were() {
    let mut map = two();
    map.remove(ObjectId(1)).unwrap();
    map.finish();
    let [object] = map.all() else { panic!("{:?}", map.all()) };
    assert!((object.ellipsoid().center().x - 1.0).abs() < 1e-3);
    let alone = map_of([chair(1.0)]);
    assert!((object.covariance() - alone.all()[0].covariance()).norm() < 1e-6);
    // An identity is never used twice.
    assert_eq!(observe(&mut map, 4.0, vec![chair(0.0)]), [Some(ObjectId(3))]);
}

/// A chair and another 0.5 m beside it, both in three images; the other one, better seen, turns out to be where the lower half of
/// the first is. In the images after that they are seen together or by turns.
fn in_each_other(stay_together: bool) -> ObjectMap {
    let size = Vector3::new(0.25, 0.25, 0.45);
    let whole = Ellipsoid::new(Pose::translation(0.0, 0.0, 0.45), size);
    let lower = |y: f64, sigma_m: f64| {
        let size = Vector3::new(0.2, 0.2, 0.25);
        let e = Ellipsoid::new(Pose::translation(0.0, y, 0.25), size);
        observation("chair", e, independent(&e, 0.05, sigma_m, 0.02))
    };
    let whole = || observation("chair", whole, independent(&whole, 0.05, 0.02, 0.02));
    let mut map = ObjectMap::new(MappingSettings::default(), slam_settings());
    for second in 0..3 {
        observe(&mut map, f64::from(second), vec![whole(), lower(0.5, 0.2)]);
    }
    for second in 3..13 {
        let both = [whole(), lower(0.1, 0.02)];
        let one = usize::from(second % 2 == 0);
        let seen = if stay_together { both.to_vec() } else { vec![both[one].clone()] };
        observe(&mut map, f64::from(second), seen);
    }
    map
}

#[test]
fn half_a_thing_in_the_whole_one_is_the_same_unless_both_are_mostly_seen() {
    assert_eq!(in_each_other(false).all().len(), 1);
    assert_eq!(in_each_other(true).all().len(), 2);
}
