//! Walls hold a robot whose odometry drifts, where it sees no object twice.

use super::normal;
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Pose, Wall, retract},
    mapping::{MappingSettings, ObjectMap, Sighting, SlamSettings, WallSighting},
    time::Stamp,
};
use nalgebra::{Point2, Point3, Rotation2, Vector3, Vector6};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A wall between two points, seen from the left of the way from one to the other.
struct Straight {
    from: Point2<f64>,
    to: Point2<f64>,
}

impl Straight {
    fn line(&self) -> Wall {
        let way = self.to - self.from;
        Wall { point: self.from + way * 0.5, heading: way.y.atan2(way.x) + FRAC_PI_2 }
    }

    /// What a robot within 4 m sees of it, if it looks that way: 2 m around the nearest point.
    fn seen_from(&self, at: &Pose, rng: &mut ChaCha8Rng) -> Option<WallSighting> {
        let (wall, base) = (self.line(), Point2::from(at.translation.vector.xy()));
        let half_m = 0.5 * (self.to - self.from).norm();
        let along = wall.along().dot(&(base - wall.point)).clamp(1.0 - half_m, half_m - 1.0);
        let (middle, across) = (wall.point + wall.along() * along, wall.normal());
        let to_middle = at.inverse() * Point3::new(middle.x, middle.y, 0.0);
        let is_ahead = to_middle.y.atan2(to_middle.x).abs() < 0.8;
        if !is_ahead || to_middle.coords.norm() > 4.0 || wall.signed_distance(&base) < 0.3 {
            return None;
        }
        let turned = Rotation2::new(0.005 * normal(rng)) * across;
        let off = Vector3::new(across.x, across.y, 0.0) * (0.01 * normal(rng));
        let center = to_middle + at.inverse() * off;
        Some(WallSighting {
            center,
            normal: at.inverse() * Vector3::new(turned.x, turned.y, 0.0),
            half_length_m: 1.0,
            sigmas: [0.005, 0.01],
        })
    }
}

/// A room of 6 m by 8 m whose corners are turned by `skew` from right angles.
fn room(skew: f64) -> Vec<Straight> {
    let corners = [(0.0, 0.0), (6.0, 0.0), (6.0 + 8.0 * skew.tan(), 8.0), (8.0 * skew.tan(), 8.0)];
    let corner = |i: usize| Point2::new(corners[i % 4].0, corners[i % 4].1);
    (0..4).map(|i| Straight { from: corner(i), to: corner(i + 1) }).collect()
}

/// Round the middle of the room, looking ahead, 80 steps a round.
fn at(step: usize) -> Pose {
    let angle = step as f64 * TAU / 80.0;
    upright_pose(
        angle + FRAC_PI_2,
        Vector3::new(3.0 + 1.5 * angle.cos(), 4.0 + 1.5 * angle.sin(), 0.0),
    )
}

struct Drive {
    map: ObjectMap,
    /// Root mean square errors of the position, as known at the time and by odometry (m).
    errors: (f64, f64),
}

/// What is said of odometry is about right.
fn knowing_its_odometry() -> SlamSettings {
    let mut settings = SlamSettings::default();
    settings.motion.heading_rad_per_m = 0.1;
    settings
}

/// Odometry's heading is off by 2 degrees after each metre.
fn drive(walls: &[Straight], slam: SlamSettings, steps: usize, seed: u64) -> Drive {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut map = ObjectMap::new(MappingSettings::default(), slam);
    let (mut odom, mut sums) = (at(0), (0.0, 0.0));
    for step in 0..steps {
        let truth = at(step);
        if step > 0 {
            let sigmas = Vector6::new(0.0, 0.0, 0.012, 0.004, 0.002, 0.0);
            let noise = Vector6::from_fn(|i, _| sigmas[i] * normal(&mut rng));
            odom *= retract(&(at(step - 1).inverse() * truth), &noise);
        }
        let seen = walls.iter().filter_map(|wall| wall.seen_from(&truth, &mut rng)).collect();
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(step as f64),
            odom_from_base: odom,
            odometry_covariance: None,
            observations: Vec::new(),
            walls: seen,
            view: None,
        });
        assert_eq!(sighted.refused, None);
        let off = |pose: Pose| (pose.translation.vector - truth.translation.vector).norm_squared();
        sums = (sums.0 + off(map.map_from_odom() * odom), sums.1 + off(odom));
    }
    let count = steps as f64;
    Drive { map, errors: ((sums.0 / count).sqrt(), (sums.1 / count).sqrt()) }
}

#[test]
fn walls_hold_the_robot_where_odometry_drifts() {
    for (seed, skew) in [(1, 0.0), (2, 0.0), (3, 0.3)] {
        let found = drive(&room(skew), knowing_its_odometry(), 320, seed);
        let (ours, odometry) = found.errors;
        println!("{ours:.3} m, odometry {odometry:.3} m");
        assert!(ours < 0.06 && ours < 0.3 * odometry, "{ours} of {odometry}");
        assert_eq!(found.map.walls().count(), 4, "each wall is one");
    }
}

#[test]
fn without_them_it_drifts() {
    let slam = SlamSettings { walls: false, ..knowing_its_odometry() };
    let found = drive(&room(0.0), slam, 320, 1);
    assert!((found.errors.0 - found.errors.1).abs() < 1e-6);
    assert_eq!(found.map.walls().count(), 0);
}

#[test]
fn given_poses_stay_as_they_are() {
    let slam = SlamSettings { optimize_poses: false, ..knowing_its_odometry() };
    let found = drive(&room(0.0), slam, 100, 1);
    assert!((found.errors.0 - found.errors.1).abs() < 1e-6);
}

#[test]
fn walls_are_where_they_stand() {
    let walls = room(0.0);
    let found = drive(&walls, knowing_its_odometry(), 320, 4);
    for truth in walls.iter().map(Straight::line) {
        let off = found.map.walls().map(|wall| wall.local(&truth)).map(|o| (o.x.abs(), o.y.abs()));
        let (turn, shift) = off.min_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1))).unwrap();
        assert!(turn < 0.02 && shift < 0.1, "{turn} rad, {shift} m");
    }
}

#[test]
fn a_parallel_wall_is_another_one() {
    // A niche: the northern wall steps back by 0.6 m.
    let mut walls = room(0.0);
    let north = [(6.0, 8.0), (3.0, 8.0), (3.0, 8.6), (0.0, 8.6)].map(|(x, y)| Point2::new(x, y));
    walls.splice(2..3, [0, 2].map(|i| Straight { from: north[i], to: north[i + 1] }));
    let found = drive(&walls, knowing_its_odometry(), 320, 5);
    assert!(found.errors.0 < 0.05, "{:?}", found.errors);
    assert_eq!(found.map.walls().count(), 5);
}

/// One lap after another the same walls are seen from the same places: the graph does not grow.
#[test]
fn a_long_drive_does_not_make_the_graph_larger() {
    let laps = |count: usize| {
        let found = drive(&room(0.0), knowing_its_odometry(), 80 * count, 6);
        assert!(found.errors.0 < 0.1, "{:?}", found.errors);
        found.map.poses()
    };
    let (eight, sixteen, many) = (laps(8), laps(16), laps(32));
    println!("{eight} poses after 8 laps, {sixteen} after 16, {many} after 32");
    assert!(many < sixteen + sixteen / 4, "{sixteen} poses, then {many}");
}

/// Who has driven far without seeing anything does not know which of two parallel walls this is.
#[test]
fn a_robot_that_is_lost_takes_a_wall_for_new() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut slam = SlamSettings::default();
    slam.motion.position_m_per_m = 0.3;
    let mut map = ObjectMap::new(MappingSettings::default(), slam);
    let wall = |x: f64| Straight { from: Point2::new(x, -5.0), to: Point2::new(x, 5.0) };
    let mut second = 0.0;
    let mut look = |at: &Pose, walls: &[Straight]| {
        let seen = walls.iter().filter_map(|wall| wall.seen_from(at, &mut rng)).collect();
        second += 1.0;
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(second),
            odom_from_base: *at,
            odometry_covariance: None,
            observations: Vec::new(),
            walls: seen,
            view: None,
        });
        assert_eq!(sighted.refused, None);
        let off = map.map_from_odom().translation.vector.norm();
        (off, map.walls().count())
    };
    // Towards the nearer wall, then 20 m to and fro with eyes closed.
    for step in 0..10 {
        look(&upright_pose(0.0, Vector3::new(0.05 * f64::from(step), 0.0, 0.0)), &[wall(3.0)]);
    }
    for step in 0..200 {
        let x = 0.45 - 0.1 * f64::from(if step < 100 { step } else { 200 - step });
        look(&upright_pose(0.0, Vector3::new(x, 0.0, 0.0)), &[]);
    }
    // Now the nearer one is not in the way any more.
    let (mut off, mut count) = (0.0, 0);
    for step in 0..10 {
        let at = upright_pose(0.0, Vector3::new(0.45 + 0.05 * f64::from(step), 0.0, 0.0));
        (off, count) = look(&at, &[wall(3.35)]);
    }
    assert_eq!(count, 2);
    assert!(off < 0.05, "pulled by {off} m");
}
