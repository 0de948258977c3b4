//! ATE and RPE on trajectories whose errors are known; `tests/command/evo.rs` compares them with evo.

use ellipsoid_slam::{
    eval::{TrajectoryError, aligned, evaluate_trajectory},
    geometry::Pose,
    time::Stamp,
};
use nalgebra::Vector3;

type Trajectory = Vec<(Stamp, Pose)>;

fn stamped(poses: impl IntoIterator<Item = Pose>) -> Trajectory {
    (0..).map(|i| Stamp::from_secs(f64::from(i))).zip(poses).collect()
}

/// A curve that leaves every plane and turns about every axis.
fn curve() -> Trajectory {
    stamped((0..20).map(|i| {
        let t = f64::from(i) * 0.3;
        let position = Vector3::new(t.cos(), t.sin() + 0.2 * t, 0.3 * (2.0 * t).sin());
        Pose::new(position, Vector3::new(0.1 * t, -0.05 * t, 0.4 * t))
    }))
}

fn near(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-9, "{got} instead of {expected}");
}

#[test]
fn an_offset_is_an_error_only_without_alignment() {
    let offset = Pose::translation(0.0, -0.3, 0.4);
    let estimate: Trajectory = curve().into_iter().map(|(t, p)| (t, offset * p)).collect();
    let scores = evaluate_trajectory(&estimate, &curve()).unwrap();
    for value in [scores.ate_m.rmse, scores.ate_m.mean, scores.ate_m.median, scores.ate_m.max] {
        near(value, 0.5);
    }
    near(scores.aligned_ate_m.max, 0.0);
    near(scores.rpe_m.max, 0.0);
    assert!(scores.rpe_deg.max < 1e-5);
    assert_eq!(scores.poses, 20);
}

#[test]
fn alignment_undoes_a_rigid_transform() {
    let moved = Pose::new(Vector3::new(3.0, -1.0, 0.5), Vector3::new(0.3, -0.4, 2.5));
    let pairs: Vec<_> = curve().into_iter().map(|(_, p)| (moved * p, p)).collect();
    let undone = aligned(&pairs) * moved;
    near(undone.translation.vector.norm(), 0.0);
    near(undone.rotation.angle(), 0.0);
}

#[test]
fn alignment_does_not_mirror() {
    let mut mirrored = curve();
    for (_, pose) in &mut mirrored {
        pose.translation.vector.z = -pose.translation.vector.z;
    }
    let scores = evaluate_trajectory(&mirrored, &curve()).unwrap();
    assert!(scores.aligned_ate_m.rmse > 0.1, "{scores:?}");
}

#[test]
fn alignment_does_not_scale() {
    let line =
        |step: f64| stamped((0..5).map(|i| Pose::translation(step * f64::from(i), 0.0, 0.0)));
    let scores = evaluate_trajectory(&line(1.1), &line(1.0)).unwrap();
    // 0, 0.1, 0.2, 0.3, 0.4; about the middle 0.2, 0.1, 0, 0.1, 0.2.
    near(scores.ate_m.rmse, 0.06f64.sqrt());
    near(scores.ate_m.median, 0.2);
    near(scores.aligned_ate_m.rmse, 0.02f64.sqrt());
    near(scores.aligned_ate_m.mean, 0.12);
    near(scores.aligned_ate_m.median, 0.1);
    near(scores.aligned_ate_m.max, 0.2);
    near(scores.rpe_m.rmse, 0.1);
}

#[test]
fn steps_are_compared_in_the_frame_of_the_robot() {
    // Each step turns by 10 degrees instead of 7.
    let turning = |step_deg: f64| {
        stamped(
            (0..8).map(|i| Pose::rotation(Vector3::z() * (step_deg * f64::from(i)).to_radians())),
        )
    };
    let scores = evaluate_trajectory(&turning(10.0), &turning(7.0)).unwrap();
    near(scores.rpe_deg.mean, 3.0);
    near(scores.rpe_m.max, 0.0);
    // A heading that is wrong by a constant does not change a step as the robot sees it.
    let turn = Pose::rotation(Vector3::z() * 0.3);
    let estimate: Trajectory = curve().into_iter().map(|(t, p)| (t, turn * p)).collect();
    near(evaluate_trajectory(&estimate, &curve()).unwrap().rpe_m.max, 0.0);
    // Half of the steps are 0.1 m too long.
    let xs = [0.0, 1.0, 2.1, 3.1, 4.2];
    let uneven = stamped(xs.map(|x| Pose::translation(x, 0.0, 0.0)));
    let even = stamped((0..5).map(|x| Pose::translation(f64::from(x), 0.0, 0.0)));
    let scores = evaluate_trajectory(&uneven, &even).unwrap();
    near(scores.rpe_m.median, 0.05);
    near(scores.rpe_m.rmse, 0.005f64.sqrt());
}

#[test]
fn poses_are_paired_by_the_nearest_stamp() {
    let truth: Trajectory = (0..100)
        .map(|i| (Stamp::from_secs(0.03 * f64::from(i)), Pose::translation(f64::from(i), 0.0, 0.0)))
        .collect();
    let at = |secs: f64, x: f64| (Stamp::from_secs(secs), Pose::translation(x, 0.0, 0.0));
    // 0.014 s is nearer to the first, 0.016 s to the second; the last has none.
    let estimate = [at(0.014, 0.0), at(0.046, 2.0), at(1.5, 50.0), at(2.991, 7.0)];
    let scores = evaluate_trajectory(&estimate, &truth).unwrap();
    assert_eq!(scores.poses, 3);
    near(scores.ate_m.max, 0.0);
}

#[test]
fn clocks_that_do_not_fit_are_refused() {
    let late: Trajectory = curve().into_iter().map(|(t, p)| (t.shifted(1000.0), p)).collect();
    let refused = evaluate_trajectory(&late, &curve()).unwrap_err();
    assert_eq!(refused, TrajectoryError::TooFewPairs { matched: 0, poses: 20 });
    assert!(refused.to_string().contains("same clock"));
    assert!(evaluate_trajectory(&[], &curve()).is_err());
    assert!(evaluate_trajectory(&curve(), &[]).is_err());
}
