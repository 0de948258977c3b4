//! Mounts and clocks that are not as TF and stamps say: learnt, corrected, said.

use super::{Run, at, camera_info, transform};
use crate::scene::{Scene, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{OrientedBox, Pose, intersection_over_union},
    pipeline::{
        Calibration, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage, Settings,
    },
};
use nalgebra::{UnitQuaternion, Vector3};

const CAMERA_HEIGHT_M: f64 = 0.8;

/// A room of 6 x 5 m with a suitcase, and the number of that.
fn room() -> (Scene, usize) {
    let mut scene = Scene::with_floor();
    for (x, y, along) in
        [(3.1, 0.0, true), (-3.1, 0.0, true), (0.0, 2.6, false), (0.0, -2.6, false)]
    {
        let half = if along { [0.1, 2.7, 1.25] } else { [3.2, 0.1, 1.25] };
        scene.add(standing(0.0, [x, y, 1.25], half));
    }
    let suitcase = scene.add(standing(0.3, [2.2, 0.3, 0.35], [0.15, 0.25, 0.35]));
    (scene, suitcase)
}

/// Where TF has the camera.
fn described() -> Pose {
    looking([0.0, 0.0, CAMERA_HEIGHT_M], 0.0, 10.0)
}

/// Where it is, turned by angles about the base's x and y axes (rad).
fn mounted(roll: f64, pitch: f64) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(roll, pitch, 0.0));
    Pose::from_parts(described().translation, turn * described().rotation)
}

fn standing_at(x: f64, yaw: f64) -> Pose {
    Pose::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * yaw)
}

fn odometry(ms: i64, odom_from_base: Pose) -> Input {
    Input::Odometry(OdometryMessage {
        stamp: at(ms),
        frame_id: "odom".into(),
        child_frame_id: "base_link".into(),
        odom_from_base,
        covariance: None,
    })
}

/// A robot whose camera is where TF does not have it.
struct Robot {
    run: Run,
    scene: Scene,
    suitcase: usize,
    base_from_camera: Pose,
}

impl Robot {
    fn new(base_from_camera: Pose) -> Self {
        let (scene, suitcase) = room();
        let mut run = Run::new(Settings::default());
        let tf = transform(true, 0, ["base_link", "camera"], described());
        run.feed([camera_info(CameraRole::Color, "camera", camera()), tf]);
        Self { run, scene, suitcase, base_from_camera }
    }

    fn look(&mut self, ms: i64, world_from_base: &Pose) {
        let camera_at = world_from_base * self.base_from_camera;
        let view = self.scene.seen_with(&camera_at, Some(ms as u64));
        let rect = view.try_box_around(self.suitcase).filter(|rect| rect.width() > 20.0);
        let detections = rect.map(|rect| detection("suitcase", rect)).into_iter().collect();
        let (stamp, frame_id) = (at(ms), "camera".to_owned());
        self.run.feed([
            Input::Depth(DepthMessage { stamp, frame_id: frame_id.clone(), image: view.depth }),
            Input::Detections(DetectionsMessage { stamp, frame_id, detections }),
        ]);
    }

    fn calibration(&self) -> Calibration {
        self.run.total.keyframes.last().unwrap().calibration
    }

    fn iou(&self) -> f64 {
        let truth = self.scene.thing(self.suitcase);
        let found = self.run.slam.objects().next().unwrap();
        let found: OrientedBox = (&found.ellipsoid()).into();
        intersection_over_union(&found, truth)
    }
}

#[test]
fn a_camera_that_is_tilted_on_its_mount_maps_as_one_that_is_not() {
    let drive = |roll: f64, pitch: f64| {
        let mut robot = Robot::new(mounted(roll, pitch));
        for i in 0..15 {
            let base = standing_at(-1.5 + 0.1 * i as f64, 0.0);
            robot.run.feed([odometry(200 * i, base)]);
            robot.look(200 * i, &base);
        }
        robot
    };
    let (roll, pitch) = ((-1.0_f64).to_radians(), 1.5_f64.to_radians());
    let (upright, tilted) = (drive(0.0, 0.0), drive(roll, pitch));
    let found = tilted.calibration();
    assert!((found.roll_rad - roll).abs() < 0.15_f64.to_radians(), "{found:?}");
    assert!((found.pitch_rad - pitch).abs() < 0.15_f64.to_radians(), "{found:?}");
    let said = [
        "the camera looks 1.5 degrees lower than TF says",
        "the camera leans 1.0 degrees more to the left than TF says",
    ];
    assert_eq!(found.sentences(), said);
    assert!(upright.calibration().sentences().is_empty(), "{:?}", upright.calibration());
    // Uncorrected, a degree and a half is 9 cm at 3.5 m.
    assert!(tilted.iou() > 0.9 * upright.iou(), "{} and {}", tilted.iou(), upright.iou());
}

#[test]
fn a_camera_in_a_hand_has_no_mount() {
    let (scene, _) = room();
    let mut run = Run::new(Settings::default());
    run.feed([camera_info(CameraRole::Color, "camera", camera())]);
    // Three degrees off by odometry: nothing but odometry says how a hand holds it.
    let held = looking([0.0, 0.0, CAMERA_HEIGHT_M], 0.0, 13.0);
    let image = scene.seen_from(&described()).depth;
    let (stamp, frame_id) = (at(0), "camera".to_owned());
    run.feed([
        Input::Odometry(OdometryMessage {
            stamp,
            frame_id: "odom".into(),
            child_frame_id: frame_id.clone(),
            odom_from_base: held,
            covariance: None,
        }),
        Input::Depth(DepthMessage { stamp, frame_id: frame_id.clone(), image }),
        Input::Detections(DetectionsMessage { stamp, frame_id, detections: Vec::new() }),
    ]);
    let found = run.total.keyframes[0].calibration;
    assert_eq!((found.roll_rad, found.pitch_rad), (0.0, 0.0));
}

/// Turns to and fro on the spot, a second each way with a rest between; odometry's stamps are late (s).
fn turned(late_s: f64) -> Robot {
    let mut robot = Robot::new(described());
    let heading = |s: f64| {
        let part = s.rem_euclid(4.0);
        0.8 * part.min(1.0).min((3.0 - part).max(0.0))
    };
    let mut odometry_ms = 0;
    for image in 0..80_i64 {
        let ms = 200 * image;
        let late_ms = (1e3 * late_s) as i64;
        while odometry_ms <= ms + 300 {
            let truth = standing_at(0.0, heading(odometry_ms as f64 / 1e3) - 0.4);
            robot.run.feed([odometry(odometry_ms + late_ms, truth)]);
            odometry_ms += 20;
        }
        robot.look(ms, &standing_at(0.0, heading(ms as f64 / 1e3) - 0.4));
    }
    robot
}

#[test]
fn odometry_that_is_stamped_late_is_found_out_by_walls_that_turn_along() {
    let (exact, late) = (turned(0.0).calibration(), turned(0.04).calibration());
    assert!(exact.stamp_offset_s.abs() < 0.008, "{exact:?}");
    assert!((late.stamp_offset_s - 0.04).abs() < 0.008, "{late:?}");
    assert!(exact.sentences().is_empty(), "{exact:?}");
    let [said] = &late.sentences()[..] else { panic!("{late:?}") };
    assert!(said.starts_with("odometry is stamped ") && said.contains(" ms later than images"));
}
