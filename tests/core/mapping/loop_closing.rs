//! A robot whose odometry jumps on the way round: everything it comes back to looks new.

use super::{independent, observation};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    mapping::{
        MappingSettings, ObjectChange, ObjectMap, RelocalisationSettings, Sighting, SlamSettings,
    },
    time::Stamp,
};
use nalgebra::{SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What stands along the way: label, place, heading, half extents.
fn things() -> Vec<(&'static str, Ellipsoid)> {
    let thing = |label, x, y, yaw, half: [f64; 3]| {
        let place = Vector3::new(x, y, half[2]);
        (label, Ellipsoid::new(upright_pose(yaw, place), Vector3::from(half)))
    };
    vec![
        thing("cabinet", 1.0, 1.5, 0.0, [0.5, 0.2, 0.6]),
        thing("chair", 2.0, -1.2, 0.7, [0.28, 0.25, 0.45]),
        thing("couch", 3.2, 1.6, 0.1, [0.9, 0.45, 0.42]),
        thing("potted plant", 2.9, -1.9, 0.0, [0.25, 0.2, 0.5]),
        thing("suitcase", 0.4, -1.7, 0.4, [0.3, 0.15, 0.3]),
        thing("bed", 12.0, 1.8, 0.0, [1.0, 0.75, 0.4]),
        thing("refrigerator", 14.0, -1.5, 0.0, [0.35, 0.3, 0.85]),
        thing("bench", 16.0, 1.5, 0.2, [0.6, 0.2, 0.25]),
    ]
}

/// There and back again along x, always looking ahead of x, between some things. `odometry` says where the robot
/// believes to be at a step.
fn drive(
    things: &[(&str, Ellipsoid)],
    mut odometry: impl FnMut(i32, &Pose) -> Pose,
    seed: u64,
) -> (ObjectMap, Vec<(Pose, Pose, usize)>, usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let (mut steps, mut merged) = (Vec::new(), 0);
    for step in 0..160 {
        let along = f64::from(if step < 80 { step } else { 160 - step }) * 0.2;
        let truth = upright_pose(0.0, Vector3::new(along, 0.0, 0.0));
        let odom = odometry(step, &truth);
        let mut observations = Vec::new();
        for (label, e) in things {
            let seen = e.transformed(&truth.inverse());
            if seen.center().coords.norm() > 3.5 {
                continue;
            }
            let sigmas = [0.001, 0.001, 0.03, 0.02, 0.02, 0.02, 0.05, 0.05, 0.05];
            let seen = seen.retract(&SVector::<f64, 9>::from_fn(|i, _| sigmas[i] * normal()));
            let covariance = independent(&seen, 0.03, 0.02, 0.02);
            observations.push(observation(label, seen, covariance));
        }
        let sighted = map.observe(&Sighting {
            stamp: Stamp::from_secs(f64::from(step)),
            odom_from_base: odom,
            odometry_covariance: None,
            observations,
            walls: Vec::new(),
            view: None,
        });
        assert_eq!(sighted.refused, None);
        let changes = map.close_loop(&RelocalisationSettings::default());
        let merges = changes.iter().filter(|c| matches!(c, ObjectChange::Merged { .. }));
        merged += merges.count();
        steps.push((truth, odom, map.keyframes()));
    }
    map.finish();
    (map, steps, merged)
}

/// Odometry that slips on the way back without noticing.
fn slipping(slip: Pose) -> impl FnMut(i32, &Pose) -> Pose {
    move |step, truth| if step < 100 { *truth } else { slip * truth }
}

/// Odometry whose heading drifts by so much in each step (rad).
fn drifting(turn: f64) -> impl FnMut(i32, &Pose) -> Pose {
    let mut last: Option<(Pose, Pose)> = None;
    move |_, truth| {
        let odom = last.map_or(*truth, |(true_last, odom_last)| {
            odom_last * upright_pose(turn, Vector3::zeros()) * true_last.inv_mul(truth)
        });
        last = Some((*truth, odom));
        odom
    }
}

/// Distance from the true place at the end (m), optimised and by odometry.
fn final_errors(map: &ObjectMap, steps: &[(Pose, Pose, usize)]) -> (f64, f64) {
    let (truth, odom, keyframes) = steps.last().unwrap();
    let stamp = Stamp::from_secs(steps.len() as f64 - 1.0);
    let pose = map.map_from_odom_at(stamp, *keyframes) * odom;
    let apart = |pose: &Pose| (pose.translation.vector - truth.translation.vector).norm();
    (apart(&pose), apart(odom))
}

#[test]
fn what_a_jump_of_odometry_has_doubled_becomes_one_again() {
    let slip = upright_pose(0.15, Vector3::new(0.5, 2.4, 0.0));
    for seed in 0..3 {
        let (map, steps, merged) = drive(&things(), slipping(slip), seed);
        let (optimised, raw) = final_errors(&map, &steps);
        println!("seed {seed}: {merged} merged, {optimised:.3} m off instead of {raw:.3} m");
        assert!(merged >= 3, "seed {seed}: {merged}");
        assert!(optimised < 0.1 && raw > 0.5, "seed {seed}: {optimised} m, {raw} m");
        // What was seen shortly before the jump and shortly after it is not long ago, and stays double until association
        // sees it again: that is the far end, of which the robot drives away.
        let doubled = map.confirmed().count() - things().len();
        assert!(doubled <= 3 && merged + doubled <= things().len(), "seed {seed}: {doubled}");
    }
}

#[test]
fn a_way_without_drift_has_no_loop_to_close() {
    let (map, _, merged) = drive(&things(), slipping(Pose::identity()), 1);
    assert_eq!((merged, map.confirmed().count()), (0, things().len()));
}

/// Too few to recognise a place by, but the graph knows that it may have drifted so far.
#[test]
fn two_objects_are_the_same_after_a_way_that_drifted_by_a_metre() {
    let two: Vec<_> = things().into_iter().take(2).collect();
    for (seed, turn) in [(0, 9e-4), (1, -9e-4)] {
        let (map, steps, merged) = drive(&two, drifting(turn), seed);
        let (optimised, raw) = final_errors(&map, &steps);
        println!("turn {turn}: {merged} merged, {optimised:.3} m off instead of {raw:.3} m");
        assert_eq!((merged, map.confirmed().count()), (0, 2), "turn {turn}");
        assert!(optimised < 0.1 && raw > 1.0, "turn {turn}: {optimised} m, {raw} m");
    }
}
