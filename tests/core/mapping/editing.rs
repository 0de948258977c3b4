//! What people say of objects.

use super::{independent, map_of, observation, observe, only};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    mapping::{
        Edit, MapObject, MappingSettings, NewObject, ObjectId, ObjectMap, Observation, SavedMap,
        SlamSettings,
    },
    time::Stamp,
};
use nalgebra::{UnitQuaternion, Vector3};

const NOW: Stamp = Stamp::from_nanos(5_000_000_000);

fn cabinet() -> Observation {
    let e =
        Ellipsoid::new(upright_pose(0.3, Vector3::new(2.0, 0.0, 0.5)), Vector3::new(0.4, 0.2, 0.5));
    observation("cabinet", e, independent(&e, 0.02, 0.03, 0.02))
}

fn map() -> ObjectMap {
    map_of(vec![cabinet(); 8])
}

fn new_chair() -> NewObject {
    NewObject {
        label: "chair".into(),
        pose: upright_pose(1.0, Vector3::new(0.0, 3.0, 0.45)),
        size_m: Vector3::new(0.5, 0.4, 0.9),
        outline: Outline::Cuboid,
        locked: false,
    }
}

#[test]
fn a_named_object_is_found_by_both_its_names_and_still_seen_as_what_it_is() {
    let mut map = map();
    map.edit(&Edit::Rename(ObjectId(1), " Grandma's ".into()), NOW).unwrap();
    let object = only(&map);
    assert_eq!((object.name(), object.label()), ("Grandma's", "cabinet"));
    assert!(
        object.is_called("Grandma's") && object.is_called("cabinet") && !object.is_called("bed")
    );
    assert_eq!(observe(&mut map, 20.0, vec![cabinet()]), [Some(ObjectId(1))]);
    assert_eq!(only(&map).name(), "Grandma's");
}

#[test]
fn what_is_deleted_and_still_there_is_found_anew_under_another_identity() {
    let mut map = map();
    map.edit(&Edit::Delete(ObjectId(1)), NOW).unwrap();
    assert_eq!(map.all().len(), 0);
    for second in 20..26 {
        assert_eq!(observe(&mut map, f64::from(second), vec![cabinet()]), [Some(ObjectId(2))]);
    }
    assert_eq!(map.confirmed().count(), 1);
}

#[test]
fn what_is_added_is_in_the_map_and_takes_what_is_seen_of_it() {
    let mut map = map();
    let id = map.edit(&Edit::Add(new_chair()), NOW).unwrap();
    let chair =
        |map: &ObjectMap| -> MapObject { map.confirmed().find(|o| o.id == id).unwrap().clone() };
    let told = chair(&map).ellipsoid();
    assert!((told.center() - nalgebra::Point3::new(0.0, 3.0, 0.45)).norm() < 1e-6, "{told:?}");
    assert!((told.semi_axes - Vector3::new(0.25, 0.2, 0.45)).norm() < 1e-6, "{told:?}");
    let seen = Ellipsoid::new(upright_pose(1.0, Vector3::new(0.06, 3.0, 0.45)), told.semi_axes);
    let seen = observation("chair", seen, independent(&seen, 0.02, 0.02, 0.02));
    assert_eq!(observe(&mut map, 20.0, vec![seen.clone()]), [Some(id)]);
    let x = chair(&map).ellipsoid().center().x;
    assert!((0.01..0.07).contains(&x), "{x}");
    // A first map may be made by hand.
    let mut by_hand = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    assert_eq!(by_hand.edit(&Edit::Add(new_chair()), NOW).unwrap(), ObjectId(1));
    assert_eq!(observe(&mut by_hand, 1.0, vec![seen]), [Some(ObjectId(1))]);
}

#[test]
fn names_and_locks_outlive_the_run() {
    let mut map = map();
    map.edit(&Edit::Rename(ObjectId(1), "wardrobe".into()), NOW).unwrap();
    map.edit(&Edit::Lock(ObjectId(1), true), NOW).unwrap();
    let saved = SavedMap::of(map.lasting(), "map");
    assert_eq!(
        (saved.objects[0].name.as_deref(), saved.objects[0].locked),
        (Some("wardrobe"), true)
    );
    assert_eq!(saved.objects[0].label, "cabinet");
}

#[test]
fn a_locked_object_is_merged_into_no_other_one() {
    let mut map = map();
    let id = map.edit(&Edit::Add(new_chair()), NOW).unwrap();
    map.edit(&Edit::Lock(id, true), NOW).unwrap();
    assert!(map.merge(ObjectId(1), id).unwrap_err().to_string().contains("locked"));
    assert_eq!(map.confirmed().count(), 2);
    map.merge(id, ObjectId(1)).unwrap();
    assert!(only(&map).is_locked());
}

#[test]
fn what_cannot_be_is_refused_in_a_sentence_and_changes_nothing() {
    let rename = |name: &str| Edit::Rename(ObjectId(1), name.into());
    let add = |change: fn(&mut NewObject)| {
        let mut new = new_chair();
        change(&mut new);
        Edit::Add(new)
    };
    let tilted = |new: &mut NewObject| {
        let roll = UnitQuaternion::from_euler_angles(0.2, 0.0, 0.0);
        new.pose = Pose::from_parts(new.pose.translation, roll);
    };
    let refused = [
        (rename("  "), "must not be empty"),
        (rename(&"x".repeat(256)), "256 bytes"),
        (rename("a\nb"), "control character"),
        (Edit::Rename(ObjectId(9), "x".into()), "no object 9"),
        (Edit::Delete(ObjectId(0)), "no object 0"),
        (Edit::Lock(ObjectId(u64::MAX), true), "no object 18446744073709551615"),
        (add(|new| new.label.clear()), "must not be empty"),
        (add(|new| new.pose.translation.x = f64::NAN), "position"),
        (add(|new| new.pose.translation.y = 1e300), "position"),
        (add(tilted), "upright"),
        (add(|new| new.size_m.x = 0.0), "size"),
        (add(|new| new.size_m.y = -1.0), "size"),
        (add(|new| new.size_m.z = f64::INFINITY), "size"),
    ];
    let mut map = map();
    let before = SavedMap::of(map.confirmed(), "map");
    for (edit, words) in refused {
        let why = map.edit(&edit, NOW).unwrap_err().to_string();
        assert!(why.contains(words), "{edit:?}: {why}");
    }
    assert_eq!(SavedMap::of(map.confirmed(), "map"), before);
}
