//! What to simulate and how well its sensors work.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Where things stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SceneKind {
    /// A desk in the middle of a room, a chair in front of it.
    Desk,
    /// A living room and a bedroom.
    Home,
    /// Two rooms with desks and a corridor.
    Office,
    /// A room of things that look alike: chairs round a table, books in a row, two monitors side by side.
    Crowded,
}

/// How the camera moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrajectoryKind {
    /// Once round the main table at standing height, looking at it.
    Orbit,
    /// A robot drives through the scene with gentle turns.
    Forward,
    /// A robot drives round and comes back to where it started.
    Loop,
}

/// Everything about a simulation. The same settings give the same bytes on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationSettings {
    /// Where things stand.
    pub scene: SceneKind,
    /// How the camera moves.
    pub trajectory: TrajectoryKind,
    /// Draws poses, sizes and clutter, and all noise.
    pub seed: u64,
    /// Which visit to the same scene: another one has another way through it and other noise, from the same `seed`.
    pub visit: u64,
    /// How many frames; 0 for what suits the trajectory.
    pub frames: usize,
    /// The frame from which the first chair stands elsewhere; 0 for never.
    pub moved_from_frame: usize,
    /// How far it is pushed, away from the middle of an orbit (m).
    pub moved_by_m: f64,
    /// Frames a second.
    pub frame_rate_hz: f64,
    /// Stamp of the first frame, seconds since the epoch.
    pub start_time_s: f64,
    /// The colour camera, in whose image the boxes are.
    pub camera: CameraSettings,
    /// The depth image, in the colour camera's frame, where it has another size.
    pub depth_camera: Option<CameraSettings>,
    /// How the camera is carried.
    pub mount: MountSettings,
    /// Depth measurement.
    pub depth: DepthSettings,
    /// 2D detector.
    pub detector: DetectorSettings,
    /// Odometry.
    pub odometry: OdometrySettings,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self {
            scene: SceneKind::Desk,
            trajectory: TrajectoryKind::Orbit,
            seed: 1,
            visit: 0,
            frames: 0,
            moved_from_frame: 0,
            moved_by_m: 0.9,
            frame_rate_hz: 3.0,
            start_time_s: 1_700_000_000.0,
            camera: CameraSettings::default(),
            depth_camera: None,
            mount: MountSettings::default(),
            depth: DepthSettings::default(),
            detector: DetectorSettings::default(),
            odometry: OdometrySettings::default(),
        }
    }
}

/// A pinhole camera without distortion, its principal point in the middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Focal length (px).
    pub focal_px: f64,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self { width: 640, height: 480, focal_px: 525.0 }
    }
}

/// How the camera is carried above the base.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MountSettings {
    /// Height of the camera of a robot above the floor (m).
    pub robot_height_m: f64,
    /// How far a robot's camera looks down (rad).
    pub robot_pitch_down_rad: f64,
    /// Height of the camera on an orbit above the floor (m).
    pub orbit_height_m: f64,
    /// A hand that holds the camera on an orbit moves so much (m); with more than 0 the base is not planar.
    pub hand_sway_m: f64,
    /// A hand that holds the camera on an orbit tilts so much (rad); with more than 0 the base is not planar.
    pub hand_sway_rad: f64,
    /// How far the camera leans to the right of where TF has it (rad).
    pub tf_roll_error_rad: f64,
    /// How much lower the camera looks than TF says (rad).
    pub tf_pitch_error_rad: f64,
}

impl Default for MountSettings {
    fn default() -> Self {
        Self {
            robot_height_m: 0.95,
            robot_pitch_down_rad: 0.2,
            orbit_height_m: 1.5,
            hand_sway_m: 0.0,
            hand_sway_rad: 0.0,
            tf_roll_error_rad: 0.0,
            tf_pitch_error_rad: 0.0,
        }
    }
}

/// Depth noise of a structured-light camera: Khoshelham and Elberink 2012, Nguyen et al. 2012.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DepthSettings {
    /// Standard deviation close to the camera (m).
    pub sigma_m: f64,
    /// Growth of the standard deviation with the square of the depth beyond 0.4 m (1/m).
    pub sigma_growth_per_m: f64,
    /// Step of the disparity (px); 0 for none.
    pub disparity_step_px: f64,
    /// Distance between projector and camera (m).
    pub baseline_m: f64,
    /// Probability that a pixel beside a depth edge has no reading.
    pub edge_dropout: f64,
    /// Width of the band beside a depth edge (px).
    pub edge_radius_px: usize,
    /// A jump of more than this fraction of the depth is an edge.
    pub edge_jump_ratio: f64,
    /// Whether there is none where the second camera, or the projector, at the right does not see.
    pub shadow: bool,
    /// Near things grow by this much at their edges: half of the window that is matched (px).
    pub fattened_px: usize,
    /// Noise is alike over this much (px); 0 for noise that is each pixel's own.
    pub correlation_px: usize,
    /// Readings are too large by this fraction: an error of calibration.
    pub scale_error: f64,
    /// Probability that something black has no reading.
    pub dark_dropout: f64,
    /// Readings start to drop out beyond this angle from the surface normal (rad).
    pub grazing_from_rad: f64,
    /// No readings beyond this angle from the surface normal (rad).
    pub grazing_to_rad: f64,
    /// No readings nearer than this (m).
    pub min_range_m: f64,
    /// No readings farther than this (m).
    pub max_range_m: f64,
}

impl Default for DepthSettings {
    fn default() -> Self {
        Self {
            sigma_m: 0.0012,
            sigma_growth_per_m: 0.0019,
            disparity_step_px: 0.125,
            baseline_m: 0.075,
            edge_dropout: 0.5,
            edge_radius_px: 2,
            edge_jump_ratio: 0.03,
            shadow: false,
            fattened_px: 0,
            correlation_px: 0,
            scale_error: 0.0,
            dark_dropout: 0.0,
            grazing_from_rad: 1.40,
            grazing_to_rad: 1.54,
            min_range_m: 0.4,
            max_range_m: 5.0,
        }
    }
}

/// A 2D detector of which nothing is perfect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DetectorSettings {
    /// Objects with fewer visible pixels are not seen.
    pub min_visible_pixels: usize,
    /// Standard deviation of each side of a box (px).
    pub side_noise_px: f64,
    /// Standard deviation of each side as a fraction of the box's width or height.
    pub side_noise_ratio: f64,
    /// The same, but constant as long as the view of an object is about the same.
    pub lasting_side_noise_ratio: f64,
    /// Of objects with so many visible pixels half are found, the others not as long as the view is about the same; 0 for all.
    pub half_found_pixels: f64,
    /// Probability that a visible object is missed.
    pub miss: f64,
    /// Mean number of boxes an image around nothing.
    pub false_positives_per_frame: f64,
    /// Probability that an object gets the label of a similar class.
    pub label_flicker: f64,
    /// Mean confidence of a large, unobstructed object.
    pub confidence: f64,
    /// Confidence lost by a tiny object; fades with some thousand visible pixels.
    pub small_object_penalty: f64,
    /// Standard deviation of the confidence.
    pub confidence_noise: f64,
    /// Detections are published so much after their image (s).
    pub delay_s: f64,
    /// The delay varies by up to so much (s).
    pub delay_jitter_s: f64,
}

impl Default for DetectorSettings {
    fn default() -> Self {
        Self {
            min_visible_pixels: 120,
            side_noise_px: 1.0,
            side_noise_ratio: 0.01,
            lasting_side_noise_ratio: 0.0,
            half_found_pixels: 0.0,
            miss: 0.05,
            false_positives_per_frame: 0.05,
            label_flicker: 0.03,
            confidence: 0.9,
            small_object_penalty: 0.25,
            confidence_noise: 0.06,
            delay_s: 0.1,
            delay_jitter_s: 0.05,
        }
    }
}

/// Odometry that drifts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OdometrySettings {
    /// Standard deviation of the distance after one metre; grows with the root of the distance.
    pub scale_noise_m_per_root_m: f64,
    /// Standard deviation of the position across the direction of travel after one metre; grows with its root.
    pub slip_noise_m_per_root_m: f64,
    /// Standard deviation of the heading after one metre (rad); grows with its root.
    pub yaw_noise_rad_per_root_m: f64,
    /// Standard deviation of the heading after turning by one radian (rad); grows with its root.
    pub yaw_noise_rad_per_root_rad: f64,
    /// Distances are overestimated by this fraction; not part of the covariance that is claimed.
    pub scale_bias: f64,
    /// Heading gained with each metre (rad/m); not part of the covariance that is claimed.
    pub yaw_bias_rad_per_m: f64,
    /// The covariance that is claimed is the true one times this.
    pub claimed_covariance_factor: f64,
    /// Odometry starts at zero wherever the robot is, as it does on a robot that was switched on; otherwise at the
    /// true pose, so that `odom` and the world agree at the first frame.
    pub starts_at_zero: bool,
    /// Its stamps are so much later than the moments they belong to (s).
    pub stamped_late_s: f64,
}

impl Default for OdometrySettings {
    fn default() -> Self {
        Self {
            scale_noise_m_per_root_m: 0.015,
            slip_noise_m_per_root_m: 0.005,
            yaw_noise_rad_per_root_m: 0.008,
            yaw_noise_rad_per_root_rad: 0.012,
            scale_bias: 0.0,
            yaw_bias_rad_per_m: 0.0,
            claimed_covariance_factor: 1.0,
            starts_at_zero: false,
            stamped_late_s: 0.0,
        }
    }
}

/// Why settings cannot be simulated.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{name} is {value}, but has to be {wanted}")]
pub struct SettingsError {
    /// The setting, with the name of its group.
    pub name: &'static str,
    /// What it is.
    pub value: f64,
    /// What it has to be.
    pub wanted: &'static str,
}

impl SimulationSettings {
    /// The same scene and trajectory without any noise, bias, miss, delay, drop-out or limit of range.
    pub fn perfect(mut self) -> Self {
        self.mount.hand_sway_m = 0.0;
        self.mount.hand_sway_rad = 0.0;
        self.mount.tf_roll_error_rad = 0.0;
        self.mount.tf_pitch_error_rad = 0.0;
        self.depth = DepthSettings {
            sigma_m: 0.0,
            sigma_growth_per_m: 0.0,
            disparity_step_px: 0.0,
            edge_dropout: 0.0,
            shadow: false,
            fattened_px: 0,
            correlation_px: 0,
            scale_error: 0.0,
            dark_dropout: 0.0,
            grazing_from_rad: 1.6,
            grazing_to_rad: 1.6,
            min_range_m: 0.0,
            max_range_m: 1000.0,
            ..self.depth
        };
        self.detector = DetectorSettings {
            side_noise_px: 0.0,
            side_noise_ratio: 0.0,
            lasting_side_noise_ratio: 0.0,
            half_found_pixels: 0.0,
            miss: 0.0,
            false_positives_per_frame: 0.0,
            label_flicker: 0.0,
            confidence: 1.0,
            small_object_penalty: 0.0,
            confidence_noise: 0.0,
            delay_s: 0.0,
            delay_jitter_s: 0.0,
            ..self.detector
        };
        self.odometry = OdometrySettings {
            scale_noise_m_per_root_m: 0.0,
            slip_noise_m_per_root_m: 0.0,
            yaw_noise_rad_per_root_m: 0.0,
            yaw_noise_rad_per_root_rad: 0.0,
            scale_bias: 0.0,
            yaw_bias_rad_per_m: 0.0,
            claimed_covariance_factor: 1.0,
            stamped_late_s: 0.0,
            ..self.odometry
        };
        self
    }

    /// The seed of everything but the scene.
    pub(super) fn visit_seed(&self) -> u64 {
        /// Odd, so that different visits never have the same seed (Knuth's multiplicative hashing).
        const STRIDE: u64 = 0x9e37_79b9_7f4a_7c15;
        self.seed.wrapping_add(self.visit.wrapping_mul(STRIDE))
    }

    /// Checks every number once.
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        let (depth, detector, odometry) = (&self.depth, &self.detector, &self.odometry);
        let probabilities = [
            ("depth.edge_dropout", depth.edge_dropout),
            ("depth.dark_dropout", depth.dark_dropout),
            ("detector.miss", detector.miss),
            ("detector.label_flicker", detector.label_flicker),
            ("detector.confidence", detector.confidence),
            ("detector.small_object_penalty", detector.small_object_penalty),
        ];
        let levels = [
            ("mount.hand_sway_m", self.mount.hand_sway_m),
            ("mount.hand_sway_rad", self.mount.hand_sway_rad),
            ("depth.sigma_m", depth.sigma_m),
            ("depth.sigma_growth_per_m", depth.sigma_growth_per_m),
            ("depth.disparity_step_px", depth.disparity_step_px),
            ("depth.edge_jump_ratio", depth.edge_jump_ratio),
            ("depth.min_range_m", depth.min_range_m),
            ("detector.side_noise_px", detector.side_noise_px),
            ("detector.side_noise_ratio", detector.side_noise_ratio),
            ("detector.lasting_side_noise_ratio", detector.lasting_side_noise_ratio),
            ("detector.half_found_pixels", detector.half_found_pixels),
            ("detector.false_positives_per_frame", detector.false_positives_per_frame),
            ("detector.confidence_noise", detector.confidence_noise),
            ("detector.delay_s", detector.delay_s),
            ("detector.delay_jitter_s", detector.delay_jitter_s),
            ("odometry.scale_noise_m_per_root_m", odometry.scale_noise_m_per_root_m),
            ("odometry.slip_noise_m_per_root_m", odometry.slip_noise_m_per_root_m),
            ("odometry.yaw_noise_rad_per_root_m", odometry.yaw_noise_rad_per_root_m),
            ("odometry.yaw_noise_rad_per_root_rad", odometry.yaw_noise_rad_per_root_rad),
            ("odometry.claimed_covariance_factor", odometry.claimed_covariance_factor),
        ];
        let positive = [
            ("frame_rate_hz", self.frame_rate_hz),
            ("camera.width", f64::from(self.camera.width)),
            ("camera.height", f64::from(self.camera.height)),
            ("camera.focal_px", self.camera.focal_px),
            ("mount.robot_height_m", self.mount.robot_height_m),
            ("mount.orbit_height_m", self.mount.orbit_height_m),
            ("depth.baseline_m", depth.baseline_m),
            ("depth.max_range_m", depth.max_range_m),
        ];
        let finite = [
            ("start_time_s", self.start_time_s),
            ("moved_by_m", self.moved_by_m),
            ("mount.robot_pitch_down_rad", self.mount.robot_pitch_down_rad),
            ("mount.tf_roll_error_rad", self.mount.tf_roll_error_rad),
            ("mount.tf_pitch_error_rad", self.mount.tf_pitch_error_rad),
            ("depth.grazing_from_rad", depth.grazing_from_rad),
            ("depth.grazing_to_rad", depth.grazing_to_rad),
            ("odometry.scale_bias", odometry.scale_bias),
            ("odometry.yaw_bias_rad_per_m", odometry.yaw_bias_rad_per_m),
            ("odometry.stamped_late_s", odometry.stamped_late_s),
            ("depth.scale_error", depth.scale_error),
        ];
        refuse(&probabilities, "between 0 and 1", |x| (0.0..=1.0).contains(&x))?;
        refuse(&levels, "a number that is not negative", |x| x >= 0.0 && x.is_finite())?;
        refuse(&positive, "a positive number", |x| x > 0.0 && x.is_finite())?;
        refuse(&finite, "a finite number", f64::is_finite)
    }
}

fn refuse(
    settings: &[(&'static str, f64)],
    wanted: &'static str,
    is_good: impl Fn(f64) -> bool,
) -> Result<(), SettingsError> {
    match settings.iter().find(|(_, value)| !is_good(*value)) {
        Some(&(name, value)) => Err(SettingsError { name, value, wanted }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_and_their_perfect_form_are_allowed() {
        assert_eq!(SimulationSettings::default().check(), Ok(()));
        assert_eq!(SimulationSettings::default().perfect().check(), Ok(()));
    }

    #[test]
    fn a_bad_number_is_named() {
        let mut settings = SimulationSettings::default();
        settings.detector.miss = 1.5;
        let sentence = settings.check().unwrap_err().to_string();
        assert_eq!(sentence, "detector.miss is 1.5, but has to be between 0 and 1");
        let settings = SimulationSettings { frame_rate_hz: f64::NAN, ..Default::default() };
        assert_eq!(settings.check().unwrap_err().name, "frame_rate_hz");
    }

    #[test]
    fn unknown_keys_are_refused() {
        let text = r#"{"scene": "home", "detector": {"mis": 0.1}}"#;
        assert!(serde_json::from_str::<SimulationSettings>(text).is_err());
        let text = r#"{"scene": "home", "detector": {"miss": 0.1}}"#;
        let settings: SimulationSettings = serde_json::from_str(text).unwrap();
        assert_eq!((settings.scene, settings.detector.miss), (SceneKind::Home, 0.1));
    }
}
