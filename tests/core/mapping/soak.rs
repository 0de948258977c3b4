//! A day of a robot: it drives to and fro past a row of things for hours, docks before a plant, slips, meets people, and chairs are
//! pushed. Its map is right in the evening, and an image costs what it cost in the morning.

use super::{
    forward_camera::{image_of, sighted},
    independent, normal, observation,
};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Ellipsoid, Outline, Pose},
    mapping::{MappingSettings, ObjectId, ObjectMap, Observation, SlamSettings},
    time::Stamp,
};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

struct Day {
    map: ObjectMap,
    camera: Camera,
    things: Vec<(&'static str, Ellipsoid)>,
    /// Where the robot is, and where its odometry has it.
    world_from_base: Pose,
    odom_from_base: Pose,
    images: u32,
    observations: u32,
    rng: ChaCha8Rng,
}

impl Day {
    fn new() -> Self {
        let thing = |at: usize| {
            let y = 1.3 * at as f64;
            let (label, x, half) = match at % 4 {
                0 => ("cabinet", 3.2, [0.2, 0.3, 0.5]),
                1 => ("chair", 3.0, [0.25, 0.25, 0.45]),
                2 => ("refrigerator", 3.3, [0.3, 0.35, 0.85]),
                _ => ("potted plant", 3.0, [0.2, 0.2, 0.4]),
            };
            (label, Ellipsoid::new(Pose::translation(x, y, half[2]), Vector3::from(half)))
        };
        let camera = Camera::new((160, 120), (90.0, 90.0), (79.5, 59.5), Distortion::None);
        Self {
            map: ObjectMap::new(MappingSettings::default(), SlamSettings::default()),
            camera: camera.unwrap(),
            things: (0..16).map(thing).collect(),
            world_from_base: Pose::identity(),
            odom_from_base: Pose::identity(),
            images: 0,
            observations: 0,
            rng: ChaCha8Rng::seed_from_u64(17),
        }
    }

    /// Goes on by so much along the row (m); odometry is off by some hundredths of it.
    fn drive(&mut self, dy: f64) {
        self.world_from_base = Pose::translation(0.0, dy, 0.0) * self.world_from_base;
        let wrong = |rng: &mut ChaCha8Rng, share: f64| share * dy.abs() * normal(rng);
        let step = Vector3::new(wrong(&mut self.rng, 0.05), dy * 1.01, 0.0);
        let turned = wrong(&mut self.rng, 0.03);
        self.odom_from_base *= upright_pose(turned, step);
    }

    /// Odometry says nothing of a step of this length and this turn.
    fn slip(&mut self, step_m: f64, turn: f64) {
        self.odom_from_base *= upright_pose(turn, Vector3::new(0.0, step_m, 0.0));
    }

    fn look(&mut self, somebody: bool) {
        let in_base = self.world_from_base.inverse();
        let mut bodies: Vec<(&str, Ellipsoid)> =
            self.things.iter().map(|(label, body)| (*label, body.transformed(&in_base))).collect();
        let person = somebody.then(|| Vector3::new(1.8, self.rng.random_range(-1.0..1.0), 0.85));
        if let Some(place) = person {
            let place = Pose::translation(place.x, place.y, place.z);
            bodies.push(("person", Ellipsoid::new(place, Vector3::new(0.2, 0.25, 0.85))));
        }
        bodies.retain(|(_, body)| body.center().y.abs() < 3.5);
        let (depth, rects) = image_of(&self.camera, bodies.iter().map(|(_, body)| body));
        let mut observations = Vec::new();
        for ((label, body), rect) in bodies.iter().zip(rects) {
            // Somebody who stands before a thing hides it.
            let is_hidden = person.is_some_and(|person| {
                let shadow = person.y * body.center().x / person.x;
                body.center().x > person.x && (shadow - body.center().y).abs() < 0.9
            });
            if is_hidden || body.center().y.abs() > 2.4 {
                continue;
            }
            let mut seen = *body;
            let noise = Vector3::from_fn(|_, _| 0.015 * normal(&mut self.rng));
            seen.pose.translation.vector += noise;
            let seen = observation(label, seen, independent(&seen, 0.05, 0.02, 0.02));
            let moves = *label == "person";
            observations.push(Observation { rect, moves, outline: Outline::Cuboid, ..seen });
        }
        self.images += 1;
        self.observations += observations.len() as u32;
        let stamp = Stamp::from_secs(0.2 * f64::from(self.images));
        let image = (&self.camera, &depth);
        sighted(&mut self.map, image, (stamp, self.odom_from_base), observations);
    }

    /// The row from one end to the other, and back on the next lap.
    fn lap(&mut self, lap: u32) {
        let forward = if lap.is_multiple_of(2) { 0.13 } else { -0.13 };
        for step in 0..150 {
            self.drive(forward);
            self.look(lap % 3 == 1 && step % 2 == 0);
        }
    }

    fn confirmed(&self) -> BTreeMap<ObjectId, (String, Vector3<f64>)> {
        let objects = self.map.confirmed().filter(|object| !object.moves);
        let place = |o: &ellipsoid_slam::mapping::MapObject| o.ellipsoid().center().coords;
        objects.map(|o| (o.id, (o.label().to_owned(), place(o)))).collect()
    }
}

#[test]
fn a_day_of_fifty_thousand_observations_leaves_a_map_that_is_right_and_no_larger() {
    let mut day = Day::new();
    (0..6).for_each(|lap| day.lap(lap));
    let (morning, factors) = (day.confirmed(), day.map.factors());
    assert_eq!(morning.len(), day.things.len());
    let mut lap = 6;
    while day.observations < 50_000 {
        match lap % 10 {
            3 => day.slip(0.05, 0.01),
            5 => day.things[1 + 4 * (lap as usize / 10 % 4)].1.pose.translation.vector.y += 0.25,
            8 => (0..700).for_each(|_| day.look(false)),
            _ => {}
        }
        day.lap(lap);
        lap += 1;
    }
    let evening = day.confirmed();
    println!(
        "{} images, {} observations, {lap} laps, {factors} and {} factors, {} keyframes",
        day.images,
        day.observations,
        day.map.factors(),
        day.map.keyframes()
    );
    let ids = |map: &BTreeMap<ObjectId, (String, Vector3<f64>)>| -> Vec<ObjectId> {
        map.keys().copied().collect()
    };
    assert_eq!(
        ids(&evening),
        ids(&morning),
        "each thing is what it was, and nothing else is there"
    );
    for (id, (label, place)) in &evening {
        assert_eq!(*label, morning[id].0);
        let same = day.things.iter().filter(|(name, _)| name == label);
        let off_m = same.map(|(_, body)| (body.center().coords - place).norm()).fold(9.0, f64::min);
        // The row is 20 m long, and how it bends hangs on odometry's first way along it.
        assert!(off_m < 0.25, "{label} {id} is {off_m} m off");
    }
    assert!(day.map.factors() < 3 * factors, "{} after {factors} factors", day.map.factors());
}
