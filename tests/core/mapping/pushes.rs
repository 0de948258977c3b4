//! Chairs that somebody pushes, after they were seen for long.

use super::{
    forward_camera::{image_of, sighted},
    independent, normal, observation,
};
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, Outline, Pose},
    mapping::{Edit, MappingSettings, ObjectId, ObjectMap, Observation, SlamSettings},
    time::Stamp,
};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A robot that drives to and fro before things in a row, looks at them along x, and knows where it is by odometry.
struct Watch {
    map: ObjectMap,
    camera: Camera,
    things: Vec<(&'static str, Ellipsoid)>,
    looks: u32,
    rng: ChaCha8Rng,
}

fn chair(y: f64) -> Ellipsoid {
    Ellipsoid::new(Pose::translation(3.0, y, 0.45), Vector3::new(0.25, 0.25, 0.45))
}

fn cabinet(y: f64) -> Ellipsoid {
    Ellipsoid::new(Pose::translation(3.2, y, 0.5), Vector3::new(0.2, 0.3, 0.5))
}

impl Watch {
    fn new(things: Vec<(&'static str, Ellipsoid)>) -> Self {
        let camera = Camera::new((160, 120), (90.0, 90.0), (79.5, 59.5), Distortion::None);
        Self {
            map: ObjectMap::new(MappingSettings::default(), SlamSettings::default()),
            camera: camera.unwrap(),
            things,
            looks: 0,
            rng: ChaCha8Rng::seed_from_u64(5),
        }
    }

    fn look(&mut self) {
        // From one place to the next after every third look.
        let odom_from_base =
            Pose::translation(0.0, 0.12 * f64::from(self.looks / 3 % 5) - 0.24, 0.0);
        let in_base = odom_from_base.inverse();
        let bodies: Vec<Ellipsoid> =
            self.things.iter().map(|(_, body)| body.transformed(&in_base)).collect();
        let (depth, rects) = image_of(&self.camera, bodies.iter());
        let mut observations = Vec::new();
        for (((label, _), body), rect) in self.things.iter().zip(&bodies).zip(rects) {
            let mut seen = *body;
            let noise = Vector3::from_fn(|_, _| 0.015 * normal(&mut self.rng));
            seen.pose.translation.vector += noise;
            let seen = observation(label, seen, independent(&seen, 0.05, 0.02, 0.02));
            observations.push(Observation { rect, outline: Outline::Cuboid, ..seen });
        }
        self.looks += 1;
        let stamp = Stamp::from_secs(0.2 * f64::from(self.looks));
        let image = (&self.camera, &depth);
        sighted(&mut self.map, image, (stamp, odom_from_base), observations);
    }

    fn chairs(&self) -> Vec<(ObjectId, f64)> {
        let chairs = self.map.confirmed().filter(|object| object.label() == "chair");
        chairs.map(|object| (object.id, object.ellipsoid().center().y)).collect()
    }
}

#[test]
fn a_chair_that_was_seen_3000_times_is_at_its_new_place_within_five_looks() {
    for by in [0.1, 0.2, 0.4, 0.5] {
        let things =
            vec![("cabinet", cabinet(1.3)), ("chair", chair(0.0)), ("cabinet", cabinet(-1.3))];
        let mut watch = Watch::new(things);
        (0..3000).for_each(|_| watch.look());
        let [(id, before)] = watch.chairs()[..] else { panic!("{:?}", watch.chairs()) };
        assert!(before.abs() < 0.02, "{before}");
        watch.things[1].1 = chair(by);
        (0..5).for_each(|_| watch.look());
        let after = watch.chairs();
        println!("pushed by {by} m: {after:?}");
        assert_eq!(after.iter().map(|chair| chair.0).collect::<Vec<_>>(), [id]);
        assert!((after[0].1 - by).abs() < 0.03, "pushed by {by} m: {after:?}");
        assert_eq!(watch.map.all().len(), 3);
    }
}

#[test]
fn of_six_alike_chairs_the_pushed_one_is_elsewhere_and_all_keep_their_identities() {
    for by in [0.1, 0.2, 0.4, 0.5] {
        let places = [-1.6, -1.0, -0.4, 0.2, 0.8, 1.4];
        let mut watch = Watch::new(places.iter().map(|y| ("chair", chair(*y))).collect());
        (0..300).for_each(|_| watch.look());
        let before = watch.chairs();
        assert_eq!(before.len(), 6);
        watch.things[5].1 = chair(1.4 + by);
        (0..5).for_each(|_| watch.look());
        let after = watch.chairs();
        println!("pushed by {by} m: {after:?}");
        for (i, ((id, y), (known_as, was))) in after.iter().zip(&before).enumerate() {
            let moved = if (was - 1.4).abs() < 0.1 { by } else { 0.0 };
            assert_eq!(id, known_as);
            assert!((y - was - moved).abs() < 0.04, "chair {i}, pushed by {by} m: {after:?}");
        }
        assert_eq!(watch.map.all().len(), 6);
    }
}

#[test]
fn a_locked_chair_stays_where_it_is_and_the_one_that_is_seen_beside_it_is_another() {
    let things = vec![("cabinet", cabinet(1.3)), ("chair", chair(0.0)), ("cabinet", cabinet(-1.3))];
    let mut watch = Watch::new(things);
    (0..60).for_each(|_| watch.look());
    let [(id, before)] = watch.chairs()[..] else { panic!("{:?}", watch.chairs()) };
    watch.map.edit(&Edit::Lock(id, true), Stamp::default()).unwrap();
    watch.things[1].1 = chair(0.6);
    (0..20).for_each(|_| watch.look());
    let after = watch.chairs();
    assert_eq!(after.len(), 2, "{after:?}");
    assert_eq!(after[0].0, id);
    assert!((after[0].1 - before).abs() < 0.02 && (after[1].1 - 0.6).abs() < 0.03, "{after:?}");
}
