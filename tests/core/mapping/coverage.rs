//! Whether covariances of objects and poses hold what they promise, over many drives with white noise and no images.

use super::{
    given_identities, independent, normal, observation, ring_of_cabinets, round_the_ring,
    slam_settings,
};
use ellipsoid_slam::{
    eval::{
        Calibration, EstimatedObject, GroundTruth, TrueObject, evaluate_identified, pose_error,
    },
    geometry::{Ellipsoid, Pose, retract},
    mapping::{ObjectMap, Observation, Sighting, SlamSettings},
    time::Stamp,
};
use nalgebra::{Matrix3, SVector, Vector3, Vector6};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Noise of odometry's steps along, across and in heading (m, m, rad).
const STEP: [f64; 3] = [0.02, 0.01, 0.01];
/// Noise of single measurements (rad, m, m).
const HEADING: f64 = 0.03;
const CENTER: f64 = 0.02;
const SIZE: f64 = 0.02;

/// One value an object: whether it is in its region. And whether the last pose is.
struct Held {
    objects: Vec<bool>,
    pose: bool,
}

/// What is measured is wrong as the settings say that it is: by errors that all views of an object have in common (the
/// floors), that views from one direction have in common, and of each view alone.
struct Errors {
    settings: SlamSettings,
    /// Of each object.
    lasting: Vec<SVector<f64, 9>>,
    /// Of each object and direction.
    by_direction: BTreeMap<(usize, i64), SVector<f64, 9>>,
}

impl Errors {
    fn new(settings: SlamSettings, cabinets: &[Ellipsoid], rng: &mut ChaCha8Rng) -> Self {
        let heading = settings.min_heading_sigma_deg.to_radians();
        let (place, size) = (settings.min_position_sigma_m, settings.min_size_sigma_m);
        let lasting = cabinets.iter().map(|e| {
            let [a, b, c] = [0, 1, 2].map(|i| size / e.semi_axes[i]);
            drawn([0.0, 0.0, heading, place, place, place, a, b, c], rng)
        });
        Self { settings, lasting: lasting.collect(), by_direction: BTreeMap::new() }
    }

    fn draw(&mut self, object: usize, bearing: f64, rng: &mut ChaCha8Rng) -> SVector<f64, 9> {
        let direction = (bearing / self.settings.similar_views_deg.to_radians()).round() as i64;
        let sigmas = sigmas();
        let similar =
            *self.by_direction.entry((object, direction)).or_insert_with(|| drawn(sigmas, rng));
        let common = self.settings.similar_views_correlation;
        let alone = drawn(sigmas, rng);
        self.lasting[object] + similar * common.sqrt() + alone * (1.0 - common).sqrt()
    }
}

/// Once and a half round some cabinets, so that those at the start are seen again. Odometry takes each metre for so many.
fn drive(seed: u64, settings: SlamSettings, odometry_scale: f64) -> Held {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cabinets = ring_of_cabinets();
    let mut map = ObjectMap::new(given_identities(), settings);
    let at = round_the_ring;
    let (mut odom, mut claimed) = (at(0), Matrix3::zeros());
    let mut errors = Errors::new(settings, &cabinets, &mut rng);
    for step in 0..118 {
        let truth = at(step);
        if step > 0 {
            let [along, across, heading] = STEP.map(|sigma| sigma * normal(&mut rng));
            let noise = Vector6::new(0.0, 0.0, heading, along, across, 0.0);
            let mut moved = at(step - 1).inverse() * truth;
            moved.translation.vector *= odometry_scale;
            let next = odom * retract(&moved, &noise);
            claimed = grown(&claimed, &odom, &next);
            odom = next;
        }
        let mut observations = Vec::new();
        for (i, cabinet) in cabinets.iter().enumerate() {
            let seen = cabinet.transformed(&truth.inverse());
            if seen.center().coords.norm() > 3.5 {
                continue;
            }
            let eye = cabinet.pose.inverse_transform_point(&truth.translation.vector.into());
            let seen = seen.retract(&errors.draw(i, eye.y.atan2(eye.x), &mut rng));
            let covariance = independent(&seen, HEADING, CENTER, SIZE);
            let seen = observation("cabinet", seen, covariance);
            observations.push(Observation { track: Some(i as u64), ..seen });
        }
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(step as f64),
            odom_from_base: odom,
            odometry_covariance: Some(Box::new(absolute(&claimed))),
            observations,
            walls: Vec::new(),
            view: None,
        });
        assert_eq!(sighted.refused, None);
    }
    map.finish();
    held(&map, &odom, &cabinets, &at(117))
}

/// Of one measurement, as `independent` claims it.
fn sigmas() -> [f64; 9] {
    let [a, b, c] = [0.4, 0.25, 0.4].map(|semi_axis| SIZE / semi_axis);
    [0.001, 0.001, HEADING, CENTER, CENTER, CENTER, a, b, c]
}

fn drawn(sigmas: [f64; 9], rng: &mut ChaCha8Rng) -> SVector<f64, 9> {
    SVector::from(sigmas.map(|sigma| sigma * normal(rng)))
}

/// Covariance of `(x, y, yaw)` in odom's axes after a step.
fn grown(before: &Matrix3<f64>, odom: &Pose, next: &Pose) -> Matrix3<f64> {
    let moved = next.translation.vector - odom.translation.vector;
    let mut transition = Matrix3::identity();
    (transition[(0, 2)], transition[(1, 2)]) = (-moved.y, moved.x);
    let turn = next.rotation.to_rotation_matrix().into_inner();
    let noise = Matrix3::from_diagonal(&Vector3::from(STEP.map(|sigma| sigma * sigma)));
    transition * before * transition.transpose() + turn * noise * turn.transpose()
}

/// As in `geometry_msgs/PoseWithCovariance`.
fn absolute(planar: &Matrix3<f64>) -> [f64; 36] {
    let row = |i: usize| [0, 1, 5].iter().position(|at| *at == i);
    std::array::from_fn(|at| match (row(at / 6), row(at % 6)) {
        (Some(i), Some(j)) => planar[(i, j)] + if i == j { 1e-9 } else { 0.0 },
        _ => {
            if at % 7 == 0 {
                1e-9
            } else {
                0.0
            }
        }
    })
}

fn held(map: &ObjectMap, odom: &Pose, cabinets: &[Ellipsoid], true_pose: &Pose) -> Held {
    let objects = map.all().iter().map(|object| {
        let track = object.track.unwrap();
        let truth = &cabinets[track as usize];
        let truth = TrueObject {
            id: track,
            label: "cabinet".into(),
            pose: truth.pose,
            size: truth.semi_axes * 2.0,
            observations: 5,
        };
        let estimate = EstimatedObject {
            id: object.id.0,
            label: "cabinet".into(),
            ellipsoid: object.ellipsoid(),
            covariance: object.covariance(),
        };
        let truth = GroundTruth { frame_id: "map".into(), objects: vec![truth] };
        let scores = evaluate_identified(&[(track, estimate)], &truth);
        scores.calibration.within_90.unwrap() > 0.5
    });
    let pose = map.map_from_odom() * odom;
    let covariance = map.base_covariance(odom).unwrap();
    let error = pose_error(&pose, &covariance, true_pose).unwrap();
    let pose = Calibration::new(&[error]).within_90.unwrap() > 0.5;
    Held { objects: objects.collect(), pose }
}

/// Which share of the 90 % regions of objects and of last poses holds the truth, over 50 drives.
fn shares(name: &str, settings: SlamSettings, odometry_scale: f64) -> (f64, f64) {
    let drives: Vec<Held> = (0..50).map(|seed| drive(seed, settings, odometry_scale)).collect();
    let share = |held: Vec<bool>| held.iter().filter(|h| **h).count() as f64 / held.len() as f64;
    let objects = share(drives.iter().flat_map(|drive| drive.objects.clone()).collect());
    let poses = share(drives.iter().map(|drive| drive.pose).collect());
    println!("{name}: objects {objects:.3}, poses {poses:.3}");
    (objects, poses)
}

/// No kernel, no floors, and views of one direction are independent.
fn plain() -> SlamSettings {
    SlamSettings { optimize_poses: true, ..slam_settings() }
}

#[test]
fn ninety_percent_regions_hold_nine_times_in_ten() {
    let (objects, poses) = shares("independent errors", plain(), 1.0);
    assert!((0.80..=0.97).contains(&objects), "{objects}");
    assert!((0.80..=0.97).contains(&poses), "{poses}");
}

/// The kernel takes weight from what is right as well, and what views of one direction have in common is counted as if
/// it made the robot's pose less certain, too: both err to the safe side.
#[test]
fn with_the_default_settings_regions_hold_at_least_what_they_promise() {
    let (objects, poses) = shares("default settings", SlamSettings::default(), 1.0);
    assert!(objects >= 0.9, "{objects}");
    assert!(poses >= 0.9, "{poses}");
}

/// Odometry does not know that its wheels are larger than it believes, and claims too little.
#[test]
fn a_biased_scale_of_odometry_spoils_few_regions_of_what_is_seen_again() {
    let (objects, poses) = shares("odometry 1 % too long", plain(), 1.01);
    assert!(objects >= 0.8, "{objects}");
    assert!(poses >= 0.8, "{poses}");
}
