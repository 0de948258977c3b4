//! Odometry that drifts, with the covariance it claims.

use super::{
    random::{Purpose, Random},
    settings::OdometrySettings,
};
use crate::geometry::{Pose, yaw_of};
use nalgebra::{Isometry3, Matrix3, Matrix6, Translation3, UnitQuaternion, Vector2, Vector3};

/// What the odometry says at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct OdometryReading {
    /// `odom_from_base`. At the first frame it is the true pose or, on a robot that was just switched on, zero.
    pub odom_from_base: Pose,
    /// Covariance of the absolute pose as in `geometry_msgs/PoseWithCovariance`: translation then rotation about
    /// fixed axes, row-major.
    pub covariance: [f64; 36],
}

/// Every direction has at least this variance (m^2, rad^2): zeros would mean "not filled in".
const VARIANCE_FLOOR: f64 = 1e-9;

/// Readings along a true trajectory.
pub(super) fn readings(
    world_from_base: &[Pose],
    settings: &OdometrySettings,
    seed: u64,
) -> Vec<OdometryReading> {
    let mut random = Random::new(seed, Purpose::Odometry, 0);
    let Some(&first) = world_from_base.first() else {
        return Vec::new();
    };
    let mut odom_from_base = if settings.starts_at_zero { Pose::identity() } else { first };
    let mut covariance = Matrix3::zeros();
    let mut readings = vec![reading(odom_from_base, &covariance, settings)];
    for pair in world_from_base.windows(2) {
        let true_step = pair[0].inverse() * pair[1];
        let noise = StepNoise::of(&true_step, settings);
        let measured = noise.measured(&true_step, settings, &mut random);
        // Odometry knows only what it measured: its covariance is carried on by that.
        covariance = noise.propagated(&covariance, &odom_from_base, &measured);
        odom_from_base *= measured;
        readings.push(reading(odom_from_base, &covariance, settings));
    }
    readings
}

/// Standard deviations of one step.
struct StepNoise {
    /// Unit vector of travel in the base frame.
    along: Vector2<f64>,
    distance_m: f64,
    along_m: f64,
    across_m: f64,
    yaw_rad: f64,
}

impl StepNoise {
    fn of(step: &Pose, settings: &OdometrySettings) -> Self {
        let travel = step.translation.vector.xy();
        let distance_m = travel.norm();
        let along = if distance_m > 1e-12 { travel / distance_m } else { Vector2::x() };
        let root = distance_m.sqrt();
        let turned = yaw_of(step).abs().sqrt();
        Self {
            along,
            distance_m,
            along_m: settings.scale_noise_m_per_root_m * root,
            across_m: settings.slip_noise_m_per_root_m * root,
            yaw_rad: (settings.yaw_noise_rad_per_root_m * root)
                .hypot(settings.yaw_noise_rad_per_root_rad * turned),
        }
    }

    /// The step as the odometry sees it.
    fn measured(&self, step: &Pose, settings: &OdometrySettings, random: &mut Random) -> Pose {
        let across = Vector2::new(-self.along.y, self.along.x);
        let error =
            self.along * random.normal(self.along_m) + across * random.normal(self.across_m);
        let mut translation = step.translation.vector;
        translation.x += self.along.x * self.distance_m * settings.scale_bias + error.x;
        translation.y += self.along.y * self.distance_m * settings.scale_bias + error.y;
        let yaw_error = random.normal(self.yaw_rad) + settings.yaw_bias_rad_per_m * self.distance_m;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_error);
        Isometry3::from_parts(Translation3::from(translation), turn * step.rotation)
    }

    /// Covariance of `(x, y, yaw)` in odom's axes after the step.
    fn propagated(
        &self,
        before: &Matrix3<f64>,
        odom_from_base: &Pose,
        step: &Pose,
    ) -> Matrix3<f64> {
        let moved = odom_from_base.rotation * step.translation.vector;
        let along = (odom_from_base.rotation * Vector3::new(self.along.x, self.along.y, 0.0)).xy();
        let across = Vector2::new(-along.y, along.x);
        let mut transition = Matrix3::identity();
        // An error in heading swings what is driven from then on about where it arose.
        transition[(0, 2)] = -moved.y;
        transition[(1, 2)] = moved.x;
        let mut noise = Matrix3::zeros();
        let slip = along * along.transpose() * self.along_m.powi(2)
            + across * across.transpose() * self.across_m.powi(2);
        noise.fixed_view_mut::<2, 2>(0, 0).copy_from(&slip);
        noise[(2, 2)] = self.yaw_rad.powi(2);
        transition * before * transition.transpose() + noise
    }
}

fn reading(
    odom_from_base: Pose,
    planar: &Matrix3<f64>,
    settings: &OdometrySettings,
) -> OdometryReading {
    const ROWS: [usize; 3] = [0, 1, 5];
    let mut full = Matrix6::from_diagonal_element(VARIANCE_FLOOR);
    for (i, row) in ROWS.into_iter().enumerate() {
        for (j, column) in ROWS.into_iter().enumerate() {
            full[(row, column)] += planar[(i, j)] * settings.claimed_covariance_factor;
        }
    }
    let covariance = std::array::from_fn(|i| full[(i / 6, i % 6)]);
    OdometryReading { odom_from_base, covariance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;

    fn curve() -> Vec<Pose> {
        let step = Isometry3::new(Vector3::new(0.1, 0.01, 0.0), Vector3::z() * 0.04);
        std::iter::successors(Some(Pose::identity()), |pose| Some(pose * step)).take(60).collect()
    }

    #[test]
    fn without_noise_it_is_the_truth() {
        let truth = curve();
        let perfect = crate::sim::SimulationSettings::default().perfect().odometry;
        for (reading, pose) in readings(&truth, &perfect, 1).iter().zip(&truth) {
            let error = crate::geometry::local(pose, &reading.odom_from_base).norm();
            assert!(error < 1e-9, "{error}");
        }
    }

    #[test]
    fn errors_are_as_large_as_claimed() {
        let truth = curve();
        let last = truth[truth.len() - 1];
        const RUNS: u64 = 400;
        let mut sum = 0.0;
        for seed in 0..RUNS {
            let readings = readings(&truth, &OdometrySettings::default(), seed);
            let end = &readings[readings.len() - 1];
            let translation = end.odom_from_base.translation.vector - last.translation.vector;
            let rotation = (end.odom_from_base.rotation * last.rotation.inverse()).scaled_axis();
            let error = Vector6::new(
                translation.x,
                translation.y,
                translation.z,
                rotation.x,
                rotation.y,
                rotation.z,
            );
            let covariance = Matrix6::from_row_slice(&end.covariance);
            sum += error.dot(&covariance.cholesky().unwrap().solve(&error));
        }
        let mean = sum / RUNS as f64;
        // Chi-square with 3 degrees of freedom has mean 3 and variance 6: 0.37 are three standard errors.
        assert!((mean - 3.0).abs() < 0.37, "mean normalised squared error {mean}");
    }

    #[test]
    fn biases_stretch_and_bend() {
        let truth = curve();
        let mut settings = crate::sim::SimulationSettings::default().perfect().odometry;
        settings.scale_bias = 0.1;
        let step = |readings: &[OdometryReading]| {
            readings[0].odom_from_base.inverse() * readings[1].odom_from_base
        };
        let stretched = step(&readings(&truth, &settings, 1)).translation.vector;
        assert!((stretched - Vector3::new(0.11, 0.011, 0.0)).norm() < 1e-12, "{stretched}");
        settings.yaw_bias_rad_per_m = 0.5;
        let bent = yaw_of(&step(&readings(&truth, &settings, 1)));
        assert!((bent - (0.04 + 0.5 * 0.1f64.hypot(0.01))).abs() < 1e-9, "{bent}");
    }
}
