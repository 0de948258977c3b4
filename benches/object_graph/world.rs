//! Where the robot drives, and what it measures there.

use ellipsoid_slam::geometry::{Ellipsoid, Pose, retract};
use nalgebra::{SVector, Translation3, UnitQuaternion, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Of the start.
pub(crate) const PRIOR_SIGMAS: [f64; 6] = [1e-3; 6];
/// Of odometry's steps: rotation (rad), translation (m).
pub(crate) const STEP_SIGMAS: [f64; 6] = [0.001, 0.001, 0.005, 0.01, 0.005, 0.001];
/// Of observations: rotation (rad), translation (m), logarithms of semi-axes.
pub(crate) const SEEN_SIGMAS: [f64; 9] = [0.02, 0.02, 0.05, 0.03, 0.03, 0.03, 0.05, 0.05, 0.05];
/// Of the observations' kernel.
pub(crate) const HUBER: f64 = 3.0;
/// One observation in so many is off by [`OUTLIER_SIGMAS`].
const OUTLIER_EVERY: usize = 50;
const OUTLIER_SIGMAS: f64 = 10.0;
const IN_VIEW: usize = 4;
/// A closure is an object that is seen again after so many keyframes.
const CLOSURE_AFTER: usize = 100;

/// What is measured at a keyframe.
pub(crate) struct Keyframe {
    /// Where it truly is.
    pub(crate) at: Pose,
    /// From the keyframe before; at the first one from the origin.
    pub(crate) step: Pose,
    pub(crate) seen: Vec<Seen>,
}

pub(crate) struct Seen {
    pub(crate) object: usize,
    /// In the frame of the keyframe.
    pub(crate) measured: Ellipsoid,
}

/// At which keyframes an object is seen again that was out of view for long.
pub(crate) fn closures(world: &[Keyframe]) -> Vec<bool> {
    let mut last_seen = std::collections::BTreeMap::new();
    let is_closure = |(at, keyframe): (usize, &Keyframe)| {
        let before = keyframe.seen.iter().filter_map(|s| last_seen.insert(s.object, at));
        before.map(|before| at - before >= CLOSURE_AFTER).fold(false, |any, is| any | is)
    };
    world.iter().enumerate().map(is_closure).collect()
}

/// Trips of [`TRIP`] keyframes through rooms that were not seen before, each from the hall and back into it. An object
/// is in view for 40 keyframes.
pub(crate) fn building(keyframes: usize) -> Vec<Keyframe> {
    trips(keyframes, TRIP)
}

/// One trip, from the hall until shortly before it: nothing is seen again.
pub(crate) fn round(keyframes: usize) -> Vec<Keyframe> {
    let mut world = trips(keyframes, keyframes);
    world.truncate(keyframes.saturating_sub(2 * HALL * SPACING));
    world
}

fn trips(keyframes: usize, length: usize) -> Vec<Keyframe> {
    let radius_m = RADIUS_M * length as f64 / TRIP as f64;
    let mut sensor = Sensor::new();
    let hall: Vec<Ellipsoid> = (0..HALL)
        .map(|i| {
            let angle = TAU * i as f64 / HALL as f64;
            sensor.object(2.0 * angle.cos(), 2.0 * angle.sin())
        })
        .collect();
    let mut objects = hall;
    let mut world = Vec::new();
    for trip in 0..keyframes.div_ceil(length) {
        let map_from_trip =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), GOLDEN_ANGLE * trip as f64);
        let on_the_way = |at: f64, aside: f64| {
            let angle = TAU * at / length as f64;
            let radius = radius_m + aside;
            let place = Vector3::new(radius * angle.sin(), radius_m - radius * angle.cos(), 0.0);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            Pose::from_parts((map_from_trip * place).into(), map_from_trip * turn)
        };
        // From the hall's second half over the rooms to its first half.
        let mut along: Vec<usize> = (HALL / 2..HALL).collect();
        for place in HALL / 2..length / SPACING - HALL / 2 {
            let aside = if place % 2 == 0 { 1.5 } else { -1.5 };
            let at = on_the_way((place * SPACING) as f64, aside).translation.vector;
            along.push(objects.len());
            objects.push(sensor.object(at.x, at.y));
        }
        along.extend(0..HALL);
        for at in 0..length.min(keyframes - world.len()) {
            let ahead = at / SPACING;
            let visible: Vec<(usize, &Ellipsoid)> =
                along[ahead..].iter().take(IN_VIEW).map(|i| (*i, &objects[*i])).collect();
            world.push(sensor.keyframe(on_the_way(at as f64, 0.0), &visible));
        }
    }
    world
}

/// Keyframes a trip.
const TRIP: usize = 500;
/// Keyframes from one object to the next.
const SPACING: usize = 10;
/// Objects in the hall.
const HALL: usize = 4;
/// Of a trip of that length, which is a circle (m).
const RADIUS_M: f64 = 8.0;
/// Between the directions of trips: no two are the same (rad).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// A random walk on a lattice of aisles among objects: closures all the time.
pub(crate) fn lattice(keyframes: usize) -> Vec<Keyframe> {
    let side = ((keyframes as f64 / KEYFRAMES_A_CELL).sqrt().round() as i64).max(3);
    let mut sensor = Sensor::new();
    let objects: Vec<Ellipsoid> = (0..side * side)
        .map(|cell| {
            let off = 0.3 * sensor.normal();
            let (x, y) = ((cell % side) as f64, (cell / side) as f64);
            sensor.object(x * CELL_M + off, y * CELL_M + off)
        })
        .collect();
    let mut world = Vec::new();
    let (mut cell, mut heading) = ((1, 1), 0);
    while world.len() < keyframes {
        heading = sensor.turn(cell, heading, side);
        let (dx, dy) = DIRECTIONS[heading];
        for part in 0..KEYFRAMES_AN_EDGE.min(keyframes - world.len()) {
            let share = part as f64 / KEYFRAMES_AN_EDGE as f64;
            let x = (cell.0 as f64 + share * dx as f64 - 0.5) * CELL_M;
            let y = (cell.1 as f64 + share * dy as f64 - 0.5) * CELL_M;
            let yaw = FRAC_PI_2 * heading as f64;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
            let at = Pose::from_parts(Translation3::new(x, y, 0.0), turn);
            let visible = nearest_ahead(&at, &objects);
            world.push(sensor.keyframe(at, &visible));
        }
        cell = (cell.0 + dx, cell.1 + dy);
    }
    world
}

fn nearest_ahead<'a>(at: &Pose, objects: &'a [Ellipsoid]) -> Vec<(usize, &'a Ellipsoid)> {
    let mut ahead: Vec<(f64, usize)> = Vec::new();
    for (number, object) in objects.iter().enumerate() {
        let place = at.inverse_transform_point(&object.center());
        if place.x > 0.2 && place.x < 5.0 && place.y.abs() < place.x.max(1.5) {
            ahead.push((place.coords.norm(), number));
        }
    }
    ahead.sort_by(|a, b| a.0.total_cmp(&b.0));
    ahead.iter().take(IN_VIEW).map(|(_, number)| (*number, &objects[*number])).collect()
}

/// As many cells as make an object for ten keyframes.
const KEYFRAMES_A_CELL: f64 = 10.0;
const KEYFRAMES_AN_EDGE: usize = 8;
/// From one object to the next (m).
const CELL_M: f64 = 2.0;
const DIRECTIONS: [(i64, i64); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Noise, and where the robot was.
struct Sensor {
    random: ChaCha8Rng,
    last: Pose,
    seen: usize,
}

impl Sensor {
    fn new() -> Self {
        Self { random: ChaCha8Rng::seed_from_u64(1), last: Pose::identity(), seen: 0 }
    }

    /// An upright object of any size and heading there (m).
    fn object(&mut self, x: f64, y: f64) -> Ellipsoid {
        let yaw = TAU * self.random.random::<f64>();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let semi_axes = Vector3::from_fn(|_, _| 0.2 + 0.3 * self.random.random::<f64>());
        Ellipsoid::new(Pose::from_parts(Translation3::new(x, y, 0.4), turn), semi_axes)
    }

    fn keyframe(&mut self, at: Pose, visible: &[(usize, &Ellipsoid)]) -> Keyframe {
        let error = Vector6::from(STEP_SIGMAS.map(|sigma| sigma * self.normal()));
        let step = retract(&self.last.inv_mul(&at), &error);
        self.last = at;
        let seen = visible.iter().map(|(object, truth)| {
            self.seen += 1;
            let factor = if self.seen.is_multiple_of(OUTLIER_EVERY) { OUTLIER_SIGMAS } else { 1.0 };
            let error = SVector::from(SEEN_SIGMAS.map(|sigma| factor * sigma * self.normal()));
            let measured = truth.transformed(&at.inverse()).retract(&error);
            Seen { object: *object, measured }
        });
        Keyframe { at, step, seen: seen.collect() }
    }

    /// Straight on more often than to a side, and back only at a dead end.
    fn turn(&mut self, cell: (i64, i64), heading: usize, side: i64) -> usize {
        let inside = |turn: &usize| {
            let (dx, dy) = DIRECTIONS[(heading + turn) % 4];
            (0..side).contains(&(cell.0 + dx)) && (0..side).contains(&(cell.1 + dy))
        };
        let open: Vec<usize> = [0, 0, 0, 1, 3].into_iter().filter(inside).collect();
        let turn = if open.is_empty() { 2 } else { open[self.random.random_range(0..open.len())] };
        (heading + turn) % 4
    }

    /// A draw from the standard normal distribution: Box and Muller 1958.
    fn normal(&mut self) -> f64 {
        let (a, b): (f64, f64) = (self.random.random(), self.random.random());
        (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
    }
}
