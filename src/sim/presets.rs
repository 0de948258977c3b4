//! Sensors and robots by name, with numbers that the estimator does not know: of data sheets where a comment says so,
//! otherwise chosen to be like what such cameras send.

use super::settings::{CameraSettings, DepthSettings, DetectorSettings, SimulationSettings};

/// A depth camera with the colour camera beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorKind {
    /// A Kinect of the first kind or one like it, its depth registered to colour.
    Kinect,
    /// A RealSense D435, its depth aligned to colour.
    D435,
    /// An OAK-D, its depth aligned to the full colour image, of which detectors get a small square.
    OakD,
}

/// A robot: a sensor, and where it is mounted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotKind {
    /// A TurtleBot 4 with its OAK-D, hardly above the floor.
    Turtlebot4,
    /// A base with a RealSense D435 on a mast.
    Realsense,
    /// A base with a Kinect at the height of a table.
    Kinect,
}

/// A detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectorKind {
    /// Exact boxes of all that shows, with their right names.
    Ideal,
    /// A small network such as YOLO-nano, as it runs on a robot without a graphics card.
    YoloNano,
}

impl DetectorKind {
    /// The settings with this detector.
    #[must_use]
    pub fn applied(self, mut settings: SimulationSettings) -> SimulationSettings {
        match self {
            Self::Ideal => settings.detector = settings.clone().perfect().detector,
            // Ge et al. 2021, YOLOX: nano has an AP of 26 %; COCO's "medium" things, of 32 to 96 px a side, are found half of the time
            // by networks of that size, and boxes overlap the truth by about 0.8, which 4 % a side give.
            Self::YoloNano => {
                settings.detector = DetectorSettings {
                    half_found_pixels: 1500.0,
                    lasting_side_noise_ratio: 0.035,
                    side_noise_ratio: 0.02,
                    miss: 0.1,
                    false_positives_per_frame: 0.1,
                    label_flicker: 0.08,
                    confidence: 0.7,
                    small_object_penalty: 0.3,
                    confidence_noise: 0.12,
                    ..DetectorSettings::default()
                };
            }
        }
        settings
    }
}

impl SensorKind {
    /// The settings with this sensor.
    #[must_use]
    pub fn applied(self, settings: SimulationSettings) -> SimulationSettings {
        let (camera, depth_camera) = self.cameras();
        SimulationSettings { camera, depth_camera, depth: self.depth(), ..settings }
    }

    /// The colour camera, and the depth image's own where it has another size.
    fn cameras(self) -> (CameraSettings, Option<CameraSettings>) {
        let lens = |width, height, focal_px| CameraSettings { width, height, focal_px };
        match self {
            Self::Kinect => (CameraSettings::default(), None),
            // Colour covers 69 x 42 degrees at 16:9, of which 640x480 is the middle: 621 px. 616 px is chosen.
            Self::D435 => (lens(640, 480, 616.0), None),
            // Luxonis' data sheet: 69 degrees, here over 1280 columns; the preview is the middle 720x720 at 250x250.
            Self::OakD => (lens(250, 250, 324.0), Some(lens(1280, 720, 932.0))),
        }
    }

    fn depth(self) -> DepthSettings {
        let kinect = DepthSettings { shadow: true, ..DepthSettings::default() };
        match self {
            Self::Kinect => kinect,
            // Chosen: 50 mm between the imagers, 0.08 px root mean square of disparity and 447 px at 848x480, so that the standard
            // deviation grows by 0.08 / (447 x 0.05).
            Self::D435 => DepthSettings {
                sigma_m: 0.001,
                sigma_growth_per_m: 0.0036,
                disparity_step_px: 1.0 / 32.0,
                baseline_m: 0.05,
                correlation_px: 6,
                fattened_px: 2,
                scale_error: 0.01,
                dark_dropout: 0.3,
                min_range_m: 0.28,
                max_range_m: 8.0,
                ..kinect
            },
            // Luxonis' documentation: 75 mm, 441 px at 640x400, steps of an eighth of a pixel, at least 441 x 0.075 / 95 = 0.35 m, less than 2 %
            // off below 4 m. Chosen: 0.15 px root mean square of disparity, windows of 5 to 7 of those pixels, which are 10 to 14 of the
            // aligned image.
            Self::OakD => DepthSettings {
                sigma_m: 0.001,
                sigma_growth_per_m: 0.0045,
                disparity_step_px: 0.125,
                baseline_m: 0.075,
                correlation_px: 12,
                fattened_px: 4,
                scale_error: 0.01,
                dark_dropout: 0.4,
                min_range_m: 0.35,
                max_range_m: 8.0,
                ..kinect
            },
        }
    }
}

impl RobotKind {
    /// The settings with this robot.
    #[must_use]
    pub fn applied(self, settings: SimulationSettings) -> SimulationSettings {
        let (sensor, height_m, pitch_down_rad) = match self {
            // turtlebot4_description, the standard model: base 6.42, shell 3, bracket 5.26 and camera 9.68 cm above each other, level.
            Self::Turtlebot4 => (SensorKind::OakD, 0.244, 0.0),
            // Chosen, like the next one.
            Self::Realsense => (SensorKind::D435, 0.7, 0.15),
            Self::Kinect => (SensorKind::Kinect, 0.95, 0.2),
        };
        let mut settings = sensor.applied(settings);
        settings.mount.robot_height_m = height_m;
        settings.mount.robot_pitch_down_rad = pitch_down_rad;
        settings
    }
}
