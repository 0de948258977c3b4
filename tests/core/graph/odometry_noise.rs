use super::covariances;
use crate::geometry::poses;
use ellipsoid_slam::{
    geometry::{Pose, adjoint, exp, local},
    graph::{MotionModel, NotOdometry, StepSource, step_covariance},
    sim::{OdometryReading, OdometrySettings, Simulation, SimulationSettings, TrajectoryKind},
};
use nalgebra::{Cholesky, Matrix6, Vector3, Vector6};
use proptest::prelude::*;

/// Floors that are there, but change nothing, and a model that finds anything credible.
fn open_minded() -> MotionModel {
    MotionModel { floor_m: 1e-6, floor_deg: 1e-4, credible_factor: 1e6, ..MotionModel::default() }
}

/// From our tangent to what ROS sends: translation then rotation, about fixed axes.
fn as_ros(pose: &Pose, covariance: &Matrix6<f64>) -> [f64; 36] {
    let fixed_from_own = pose.rotation.to_rotation_matrix().into_inner();
    let mut change = Matrix6::zeros();
    change.fixed_view_mut::<3, 3>(0, 3).copy_from(&fixed_from_own);
    change.fixed_view_mut::<3, 3>(3, 0).copy_from(&fixed_from_own);
    let ros = change * covariance * change.transpose();
    std::array::from_fn(|i| ros[(i / 6, i % 6)])
}

fn diagonal(variances: [f64; 6]) -> [f64; 36] {
    std::array::from_fn(|i| if i % 7 == 0 { variances[i / 7] } else { 0.0 })
}

fn step() -> Pose {
    exp(&Vector6::new(0.0, 0.0, 0.2, 0.5, 0.02, 0.0))
}

/// The step from here on is uncertain by these variances of x, y and yaw only (m^2, rad^2).
fn growing(variances: [f64; 3]) -> (Matrix6<f64>, StepSource) {
    let from = Pose::identity();
    let [x, y, yaw] = variances;
    let after = as_ros(&step(), &Matrix6::from_diagonal(&Vector6::new(0.0, 0.0, yaw, x, y, 0.0)));
    let start = diagonal([0.0; 6]);
    step_covariance((&from, Some(&start)), (&step(), Some(&after)), &MotionModel::default())
}

proptest! {
    /// A white random walk in space: what is claimed grows by the step's own covariance, and nothing else.
    #[test]
    fn the_step_of_a_random_walk_is_found_again(
        start in poses(), steps in prop::collection::vec((poses(), covariances::<6>()), 5),
    ) {
        let (mut pose, mut claimed) = (start, Matrix6::identity() * 1e-6);
        for (step, covariance) in steps {
            let back = adjoint(&step.inverse());
            let (next, grown) = (pose * step, back * claimed * back.transpose() + covariance);
            let (before, after) = (as_ros(&pose, &claimed), as_ros(&next, &grown));
            let (got, source) =
                step_covariance((&pose, Some(&before)), (&next, Some(&after)), &open_minded());
            prop_assert_eq!(source, StepSource::Odometry);
            // Positions that are uncertain by metres are subtracted.
            prop_assert!((got - covariance).norm() < 1e-9 * (1.0 + grown.norm()), "{}", got - covariance);
            (pose, claimed) = (next, grown);
        }
    }

    #[test]
    fn whatever_comes_in_a_covariance_comes_out(
        from in poses(), to in poses(), claims in prop::collection::vec(-1.0..1.0, 72),
    ) {
        let claim = |offset: usize| std::array::from_fn::<f64, 36, _>(|i| claims[offset + i]);
        let model = MotionModel::default();
        let (before, after) = (claim(0), claim(36));
        let (got, _) = step_covariance((&from, Some(&before)), (&to, Some(&after)), &model);
        prop_assert!(Cholesky::new(got).is_some());
    }
}

#[test]
fn what_cannot_be_right_is_told_apart() {
    let model = MotionModel::default();
    let source = |before: Option<[f64; 36]>, after: Option<[f64; 36]>| {
        let from = Pose::identity();
        step_covariance((&from, before.as_ref()), (&step(), after.as_ref()), &model).1
    };
    let not = StepSource::Model;
    let zeros = diagonal([0.0; 6]);
    assert_eq!(source(None, Some(zeros)), not(NotOdometry::NotFilledIn));
    assert_eq!(source(Some(zeros), None), not(NotOdometry::NotFilledIn));
    assert_eq!(source(Some(zeros), Some(zeros)), not(NotOdometry::NotFilledIn));
    let broken = diagonal([1.0, 1.0, f64::NAN, 1.0, 1.0, 1.0]);
    assert_eq!(source(Some(zeros), Some(broken)), not(NotOdometry::NotFinite));
    // What many drivers send: the same for ever, however far the robot goes.
    let constant = diagonal([1e-3, 1e-3, 1e6, 1e6, 1e6, 0.03]);
    assert_eq!(source(Some(constant), Some(constant)), not(NotOdometry::NotASum));

    // Half a metre: a millimetre or two for each is what a good odometry has.
    assert_eq!(growing([1e-5, 1e-5, 1e-5]).1, StepSource::Odometry);
    assert_eq!(growing([1e-12, 1e-12, 1e-5]).1, not(NotOdometry::TooSmall));
    assert_eq!(growing([1e-5, 1e-5, 1e-12]).1, not(NotOdometry::TooSmall));
    // 0.3 rad for every metre.
    assert_eq!(growing([1e-5, 1e-5, 0.15 * 0.15]).1, not(NotOdometry::TooLarge));
    assert_eq!(growing([0.5, 1e-5, 1e-5]).1, not(NotOdometry::TooLarge));
}

#[test]
fn a_covariance_that_never_changes_is_not_believed_in_turns_on_the_spot() {
    let model = MotionModel::default();
    let constant = diagonal([1e-3, 1e-3, 1e6, 1e6, 1e6, 0.03]);
    for turn in [0.1, 0.3, 0.5] {
        let turned = Pose::rotation(Vector3::z() * turn);
        let claims = ((&Pose::identity(), Some(&constant)), (&turned, Some(&constant)));
        let (got, source) = step_covariance(claims.0, claims.1, &model);
        assert_ne!(source, StepSource::Odometry, "{turn} rad");
        // The floors alone are a tenth of a degree.
        assert!(got[(2, 2)].sqrt() > 0.03 * turn, "{turn} rad: {}", got[(2, 2)].sqrt());
    }
}

#[test]
fn what_odometry_leaves_out_has_a_floor() {
    let (got, source) = growing([1e-5, 2e-5, 3e-5]);
    assert_eq!(source, StepSource::Odometry);
    let (turn, shift) = (0.1_f64.to_radians().powi(2), 1e-6);
    // Rotation, then translation; of these only heading, x and y are odometry's.
    let expected = [turn, turn, 3e-5 + turn, 1e-5 + shift, 2e-5 + shift, shift];
    let difference = got - Matrix6::from_diagonal(&Vector6::from(expected));
    assert!(difference.norm() < 1e-15, "{difference}");
}

#[test]
fn the_model_grows_with_the_way() {
    let model = MotionModel::default();
    let sigmas = |step: Pose| {
        let (covariance, _) = step_covariance((&Pose::identity(), None), (&step, None), &model);
        covariance.diagonal().map(f64::sqrt)
    };
    let still = sigmas(Pose::identity());
    let floor = 0.1_f64.to_radians();
    let expected = Vector6::new(floor, floor, floor, 0.001, 0.001, 0.001);
    assert!((still - expected).norm() < 1e-12, "{still}");
    let driven = sigmas(Pose::translation(2.0, 0.0, 0.0));
    let expected = Vector6::new(floor, floor, 0.04, 0.06, 0.06, 0.001);
    assert!((driven - expected).amax() < 1e-4, "{driven}");
    let turned = sigmas(Pose::rotation(Vector3::z() * 2.0));
    let expected = Vector6::new(floor, floor, 0.06, 0.02, 0.02, 0.001);
    assert!((turned - expected).amax() < 1e-4, "{turned}");
}

/// Readings of a simulated robot, without images.
fn simulated() -> Vec<OdometryReading> {
    let mut settings =
        SimulationSettings { trajectory: TrajectoryKind::Forward, ..SimulationSettings::default() };
    (settings.camera.width, settings.camera.height, settings.camera.focal_px) = (16, 12, 10.0);
    Simulation::new(settings).unwrap().frames().map(|frame| frame.odometry).collect()
}

#[test]
fn the_simulator_s_odometry_is_believed() {
    let readings = simulated();
    let claim = |i: usize| (&readings[i].odom_from_base, Some(&readings[i].covariance));
    let (model, noise) = (MotionModel::default(), OdometrySettings::default());
    let (first, source) = step_covariance(claim(0), claim(1), &model);
    assert_eq!(source, StepSource::Odometry);
    // Noise is that of the true way, which is 0.12 m with a sigma of 4.4 % to the measured one: three of them.
    let way = local(claim(0).0, claim(1).0).fixed_rows::<3>(3).norm();
    let (scale, slip) = (noise.scale_noise_m_per_root_m, noise.slip_noise_m_per_root_m);
    let expected = (scale * scale + slip * slip) * way;
    let got = first[(3, 3)] + first[(4, 4)] - 2.0 * model.floor_m.powi(2);
    assert!((got / expected - 1.0).abs() < 0.14, "{got} where {expected} was added");
    for from in (0..readings.len() - 5).step_by(5) {
        let (_, source) = step_covariance(claim(from), claim(from + 5), &model);
        assert_eq!(source, StepSource::Odometry, "from frame {from}");
    }
}
