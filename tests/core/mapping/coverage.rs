//! Whether covariances of objects and poses hold what they promise, over many drives with white noise and no images.
//!
//! They may promise too little: floors and the robust kernel are there for errors that are not white.

use super::{given_identities, independent, normal, observation, ring_of_cabinets, round_the_ring};
use ellipsoid_slam::{
    eval::{EstimatedObject, GroundTruth, TrueObject, evaluate_identified},
    geometry::{Ellipsoid, Pose, local, retract},
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

/// Once and a half round some cabinets, so that those at the start are seen again.
fn drive(seed: u64) -> Held {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cabinets = ring_of_cabinets();
    let mut map = ObjectMap::new(given_identities(), SlamSettings::default());
    let at = round_the_ring;
    let (mut odom, mut claimed) = (at(0), Matrix3::zeros());
    // What views of an object from one direction have in common.
    let mut common: BTreeMap<(usize, i64), SVector<f64, 9>> = BTreeMap::new();
    for step in 0..118 {
        let truth = at(step);
        if step > 0 {
            let [along, across, heading] = STEP.map(|sigma| sigma * normal(&mut rng));
            let noise = Vector6::new(0.0, 0.0, heading, along, across, 0.0);
            let next = odom * retract(&(at(step - 1).inverse() * truth), &noise);
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
            let sector = (eye.y.atan2(eye.x) / 20.0_f64.to_radians()).round() as i64;
            let shared = *common.entry((i, sector)).or_insert_with(|| error(&mut rng));
            let seen = seen.retract(&((shared + error(&mut rng)) * 0.5_f64.sqrt()));
            let covariance = independent(&seen, HEADING, CENTER, SIZE);
            let seen = observation("cabinet", seen, covariance);
            observations.push(Observation { track: Some(i as u64), ..seen });
        }
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(step as f64),
            odom_from_base: odom,
            odometry_covariance: Some(Box::new(absolute(&claimed))),
            observations,
            view: None,
        });
        assert_eq!(sighted.refused, None);
    }
    map.finish();
    held(&map, &odom, &cabinets, &at(117))
}

/// Of one measurement, as `independent` claims it.
fn error(rng: &mut ChaCha8Rng) -> SVector<f64, 9> {
    let sizes = [SIZE / 0.4, SIZE / 0.25, SIZE / 0.4];
    let sigmas = [0.001, 0.001, HEADING, CENTER, CENTER, CENTER, sizes[0], sizes[1], sizes[2]];
    SVector::from_fn(|i, _| sigmas[i] * normal(rng))
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
    // The robot moves in the plane: heading, x and y.
    let rows = [2, 3, 4];
    let error = local(&pose, true_pose);
    let error = Vector3::from_fn(|i, _| error[rows[i]]);
    let covariance = Matrix3::from_fn(|i, j| covariance[(rows[i], rows[j])]);
    let nees = error.dot(&covariance.cholesky().unwrap().solve(&error));
    // The 90 % quantile of the chi-square distribution with 3 degrees of freedom.
    Held { objects: objects.collect(), pose: nees < 6.251 }
}

#[test]
fn ninety_percent_regions_of_objects_and_poses_hold_at_least_what_they_promise() {
    let drives: Vec<Held> = (0..50).map(drive).collect();
    let objects: Vec<bool> = drives.iter().flat_map(|drive| drive.objects.clone()).collect();
    let share =
        |held: &[bool]| held.iter().filter(|held| **held).count() as f64 / held.len() as f64;
    let (objects, poses) =
        (share(&objects), share(&drives.iter().map(|drive| drive.pose).collect::<Vec<_>>()));
    assert!(objects >= 0.8, "objects {objects}, poses {poses}");
    assert!(poses >= 0.8, "objects {objects}, poses {poses}");
}
