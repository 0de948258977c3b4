//! What is there, what is hidden and what is gone, by made-up depth images.

use super::{
    forward_camera::{near_face, sighted},
    independent, observation, slam_settings,
};
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, Pose, Rect},
    mapping::{
        Edit, LifeSettings, MappingSettings, Notice, ObjectChange, ObjectId, ObjectMap,
        ObjectState, Observation, Sighted,
    },
    perception::DepthImage,
    time::Stamp,
};
use nalgebra::Vector3;

/// A camera at a height of half a metre that looks along x, and a cabinet 2 m before it; a wall 4 m off.
struct Room {
    map: ObjectMap,
    camera: Camera,
    frames: u32,
    score: f64,
    later_s: f64,
}

fn cabinet(y: f64) -> Ellipsoid {
    Ellipsoid::new(Pose::translation(2.2, y, 0.5), Vector3::new(0.2, 0.3, 0.4))
}

impl Room {
    fn new(life: LifeSettings) -> Self {
        let settings = MappingSettings { life, ..MappingSettings::default() };
        let camera = Camera::new((160, 120), (130.0, 130.0), (79.5, 59.5), Distortion::None);
        Self {
            map: ObjectMap::new(settings, slam_settings()),
            camera: camera.unwrap(),
            frames: 0,
            score: 0.9,
            later_s: 0.0,
        }
    }

    /// A frame with these boxes, in which depth is nearest of the given things: 4 m where there is nothing.
    fn look(&mut self, boxes: &[Ellipsoid], things: &[(Rect, f32)]) -> Vec<ObjectChange> {
        let boxes: Vec<_> = boxes.iter().map(|body| (*body, *body)).collect();
        self.see(&boxes, things).changes
    }

    /// The same, where what was measured and what the box is round need not be the same.
    fn see(&mut self, boxes: &[(Ellipsoid, Ellipsoid)], things: &[(Rect, f32)]) -> Sighted {
        let mut metres = vec![4.0_f32; 160 * 120];
        for (i, depth) in metres.iter_mut().enumerate() {
            let (u, v) = ((i % 160) as f64, (i / 160) as f64);
            for (_, z) in things.iter().filter(|(rect, _)| rect.contains(u, v)) {
                *depth = depth.min(*z);
            }
        }
        let depth = DepthImage::new(160, 120, metres).unwrap();
        // A little to the side each time, so that every view is one of its own.
        let odom_from_base = Pose::translation(0.0, 0.03 * f64::from(self.frames % 8), 0.0);
        let observations = boxes.iter().map(|(measured, boxed)| {
            let in_base = |body: &Ellipsoid| body.transformed(&odom_from_base.inverse());
            let e = in_base(measured);
            let seen = observation("cabinet", e, independent(&e, 0.05, 0.03, 0.02));
            let labels = vec![("cabinet".to_owned(), self.score)];
            Observation { rect: Some(near_face(&self.camera, &in_base(boxed))), labels, ..seen }
        });
        let observations = observations.collect();
        self.frames += 1;
        let stamp = Stamp::from_secs(f64::from(self.frames) + self.later_s);
        let image = (&self.camera, &depth);
        sighted(&mut self.map, image, (stamp, odom_from_base), observations)
    }

    /// Shows two cabinets until both count. Returns what depth sees of them.
    fn with_both(&mut self, one: Ellipsoid, other: Ellipsoid) -> [(Rect, f32); 2] {
        let things = [one, other].map(|body| (near_face(&self.camera, &body), 2.0));
        for _ in 0..8 {
            self.look(&[one, other], &things);
        }
        things
    }

    fn with_cabinet(&mut self) {
        let body = cabinet(0.0);
        for _ in 0..8 {
            let thing = (near_face(&self.camera, &body), 2.0);
            self.look(&[body], &[thing]);
        }
        assert_eq!(self.map.confirmed().count(), 1);
    }
}

#[test]
fn what_stands_there_and_is_missed_loses_belief_slowly() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let before = room.map.all()[0].existence();
    let thing = (near_face(&room.camera, &cabinet(0.0)), 2.0);
    for _ in 0..5 {
        assert_eq!(room.look(&[], &[thing]), []);
    }
    let object = &room.map.all()[0];
    assert!(object.existence() < before && object.state() == ObjectState::Confirmed);
}

#[test]
fn what_is_hidden_loses_nothing_however_long() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let before = room.map.all()[0].existence();
    let person = (Rect::new(20.0, 0.0, 140.0, 119.0).unwrap(), 1.0);
    for _ in 0..50 {
        assert_eq!(room.look(&[], &[person]), []);
    }
    assert_eq!(room.map.all()[0].existence(), before);
}

#[test]
fn what_was_carried_away_is_gone_within_five_looks() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let changes: Vec<_> = (0..5).flat_map(|_| room.look(&[], &[])).collect();
    assert_eq!(changes, [ObjectChange::Removed(ObjectId(1))]);
    assert_eq!(room.map.all().len(), 0);
}

#[test]
fn what_is_locked_stays_however_long_one_looks_through_its_place() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let before = room.map.all()[0].existence();
    room.map.edit(&Edit::Lock(ObjectId(1), true), Stamp::default()).unwrap();
    let changes: Vec<_> = (0..40).flat_map(|_| room.look(&[], &[])).collect();
    assert_eq!(changes, []);
    assert_eq!(room.map.all()[0].existence(), before);
    room.map.edit(&Edit::Lock(ObjectId(1), false), Stamp::default()).unwrap();
    let changes: Vec<_> = (0..5).flat_map(|_| room.look(&[], &[])).collect();
    assert_eq!(changes, [ObjectChange::Removed(ObjectId(1))]);
}

#[test]
fn what_was_carried_away_behind_something_is_gone_only_once_one_sees_it() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let person = (Rect::new(20.0, 0.0, 140.0, 119.0).unwrap(), 1.0);
    for _ in 0..20 {
        assert_eq!(room.look(&[], &[person]), []);
    }
    assert_eq!(room.map.confirmed().count(), 1);
    let changes: Vec<_> = (0..5).flat_map(|_| room.look(&[], &[])).collect();
    assert_eq!(changes, [ObjectChange::Removed(ObjectId(1))]);
}

#[test]
fn an_image_without_depth_says_nothing() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let before = room.map.all()[0].existence();
    let blind = (Rect::new(-1.0, -1.0, 160.0, 120.0).unwrap(), f32::NEG_INFINITY);
    for _ in 0..20 {
        room.look(&[], &[blind]);
    }
    assert_eq!(room.map.all()[0].existence(), before);
}

#[test]
fn a_false_detection_never_counts() {
    let mut room = Room::new(LifeSettings::default());
    let ghost = cabinet(0.0);
    let thing = (near_face(&room.camera, &ghost), 2.0);
    room.look(&[ghost], &[thing]);
    for _ in 0..20 {
        assert_eq!(room.map.confirmed().count(), 0);
        room.look(&[], &[thing]);
    }
    assert!(room.map.all().iter().all(|object| object.existence() < 0.3));
}

#[test]
fn what_was_moved_keeps_its_identity_or_not_as_one_likes() {
    for keeps in [true, false] {
        let life = LifeSettings { moved_keeps_id: keeps, ..LifeSettings::default() };
        let mut room = Room::new(life);
        room.with_cabinet();
        let body = cabinet(-0.8);
        for _ in 0..8 {
            let thing = (near_face(&room.camera, &body), 2.0);
            room.look(&[body], &[thing]);
        }
        let ids: Vec<ObjectId> = room.map.confirmed().map(|object| object.id).collect();
        assert_eq!(ids, [ObjectId(if keeps { 1 } else { 2 })]);
        let y = room.map.all()[0].ellipsoid().center().y;
        assert!((y + 0.8).abs() < 0.05, "{y}");
    }
}

/// A detector that has become blind to an object is no proof of it.
#[test]
fn misses_never_raise_belief_however_many() {
    let mut room = Room::new(LifeSettings::default());
    room.with_cabinet();
    let thing = (near_face(&room.camera, &cabinet(0.0)), 2.0);
    let mut last = room.map.all()[0].existence();
    for _ in 0..600 {
        room.look(&[], &[thing]);
        let Some(object) = room.map.all().first() else { return };
        assert!(object.existence() <= last);
        last = object.existence();
    }
    assert!(last < 0.9, "{last}");
}

/// The pose is wrong, not the furniture.
#[test]
fn where_most_seems_gone_at_once_nothing_is() {
    let mut room = Room::new(LifeSettings::default());
    let bodies = [0.8, 0.0, -0.8]
        .map(|y| Ellipsoid::new(Pose::translation(2.2, y, 0.5), Vector3::new(0.2, 0.2, 0.4)));
    let things = bodies.map(|body| (near_face(&room.camera, &body), 2.0));
    for _ in 0..8 {
        room.look(&bodies, &things);
    }
    assert_eq!(room.map.confirmed().count(), 3);
    for _ in 0..50 {
        let sighted = room.see(&[(bodies[0], bodies[0])], &things[..1]);
        assert_eq!(sighted.changes, []);
        assert_eq!(sighted.notices, [Notice::MostlyEmpty { empty: 2, expected: 3 }]);
    }
    // One alone may well have been carried away.
    let two = [(bodies[0], bodies[0]), (bodies[1], bodies[1])];
    let changes: Vec<_> = (0..5).flat_map(|_| room.see(&two, &things[..2]).changes).collect();
    assert_eq!(changes, [ObjectChange::Removed(ObjectId(3))]);
}

#[test]
fn boxes_of_a_low_score_hardly_prove_anything() {
    let after = |score: f64| {
        let mut room = Room::new(LifeSettings { confirmed_from: 0.9, ..LifeSettings::default() });
        room.score = score;
        let body = cabinet(0.0);
        for _ in 0..6 {
            let thing = (near_face(&room.camera, &body), 2.0);
            room.look(&[body], &[thing]);
        }
        room.map.confirmed().count()
    };
    assert_eq!((after(0.9), after(0.11)), (1, 0));
}

/// What left yesterday does not come back as what is found today.
#[test]
fn identities_of_what_left_long_ago_are_not_given_again() {
    for (wait_s, id) in [(60.0, 1), (700.0, 2)] {
        let mut room = Room::new(LifeSettings::default());
        room.with_cabinet();
        (0..5).for_each(|_| drop(room.look(&[], &[])));
        assert_eq!(room.map.all().len(), 0);
        room.later_s += wait_s;
        let body = cabinet(-0.8);
        for _ in 0..8 {
            let thing = (near_face(&room.camera, &body), 2.0);
            room.look(&[body], &[thing]);
        }
        let ids: Vec<ObjectId> = room.map.confirmed().map(|object| object.id).collect();
        assert_eq!(ids, [ObjectId(id)]);
    }
}

/// Of things that stand behind each other, a box can show one and the depth in it the other.
#[test]
fn a_box_waits_where_another_one_shows_what_was_measured_in_it() {
    let mut room = Room::new(LifeSettings::default());
    let (left, right) = (cabinet(0.35), cabinet(-0.35));
    let things = room.with_both(left, right);
    let ids: Vec<_> = room.map.confirmed().map(|object| Some(object.id)).collect();
    assert_eq!(ids.len(), 2);
    // A box between the two, in which the left one was measured.
    let unclear = (left, cabinet(0.0));
    assert_eq!(room.see(&[unclear], &things).objects, [ids[0]]);
    // The next box is round the left one, though the right one was measured in it.
    assert_eq!(room.see(&[unclear, (right, left)], &things).objects, [None, None]);
    assert_eq!(room.see(&[unclear, (right, right)], &things).objects, [ids[0], ids[1]]);
}

/// A table that was first seen through a slit between chairs.
#[test]
fn what_its_boxes_contradict_more_often_than_they_fit_begins_anew() {
    let mut room = Room::new(LifeSettings::default());
    let whole = cabinet(0.0);
    let part = Ellipsoid::new(Pose::translation(2.2, 0.12, 0.3), Vector3::new(0.2, 0.15, 0.2));
    let thing = (near_face(&room.camera, &whole), 2.0);
    for _ in 0..6 {
        room.look(&[part], &[thing]);
    }
    assert_eq!(room.map.confirmed().count(), 1);
    for _ in 0..12 {
        room.look(&[whole], &[thing]);
    }
    let objects: Vec<_> = room.map.confirmed().collect();
    assert_eq!(objects.len(), 1);
    let e = objects[0].ellipsoid().relabelled_towards(0.0);
    assert_eq!(objects[0].id, ObjectId(1));
    assert!((e.center() - whole.center()).norm() < 0.02, "{e:?}");
    assert!((e.semi_axes - whole.semi_axes).norm() < 0.02, "{e:?}");
}

/// What stands in its place has a box of its own each time, so it is no detector's blindness that it has none.
#[test]
fn what_is_missed_where_another_one_is_found_is_gone_soon() {
    // How sure one is of something that seemed to stand before the cabinet, with and without the cabinet's own boxes.
    let after = |is_found: bool| {
        let mut room = Room::new(LifeSettings::default());
        let whole = cabinet(0.0);
        let ghost =
            Ellipsoid::new(Pose::translation(1.9, 0.0, 0.5), Vector3::new(0.12, 0.25, 0.35));
        let thing = (near_face(&room.camera, &whole), 2.0);
        for _ in 0..8 {
            room.look(&[whole, ghost], &[thing]);
        }
        assert_eq!(room.map.confirmed().count(), 2);
        let found = if is_found { vec![whole] } else { vec![] };
        for _ in 0..8 {
            room.look(&found, &[thing]);
        }
        room.map.all().iter().find(|o| o.id == ObjectId(2)).map_or(0.0, |o| o.existence())
    };
    assert!(after(true) < after(false), "{} {}", after(true), after(false));
}

/// Two boxes of one image in which the same was measured: the one round what it was measured of may claim it.
#[test]
fn a_box_claims_what_was_measured_in_another_one_too() {
    let mut room = Room::new(LifeSettings::default());
    let (left, right) = (cabinet(0.35), cabinet(-0.35));
    let things = room.with_both(left, right);
    let between = cabinet(0.15);
    let ids: Vec<_> = room.map.confirmed().map(|object| Some(object.id)).collect();
    assert_eq!(room.see(&[(left, between)], &things).objects, [ids[0]]);
    // With the box of the left one beside it, in which the same was measured worse, nobody can tell.
    assert_eq!(room.see(&[(left, between), (between, left)], &things).objects, [None, None]);
}
