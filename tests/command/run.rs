//! Runs the program and makes bags for it.

use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose, Rect},
    io::BagWriter,
    msg::{
        convert::{camera_info, depth_image_message, detection_array, header, odometry_message},
        sensor_msgs::CompressedImage,
    },
    perception::{DepthImage, Detection},
    pipeline::{
        CameraMessage, CameraPose, CameraRole, DepthMessage, DetectionsMessage, OdometryMessage,
    },
    time::Stamp,
};
use nalgebra::{Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

pub(crate) const CAMERA: &str = "camera_optical";
pub(crate) const FRAMES: usize = 6;
/// Where the camera is on the base, which stands on the floor: it looks down by 30 degrees.
pub(crate) const CAMERA_POSE: &str = "0,0,1.2,0,30,0";

/// The program with arguments, in the project's folder.
pub(crate) fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(args)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap()
}

/// A bag with a flaw, replayed: what the program said, and the folder of its results, which disappears with the first.
pub(crate) fn replayed(flaw: Flaw) -> (tempfile::TempDir, Output, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, flaw);
    let output =
        run(&["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    (folder, output, out)
}

/// What was printed where errors go.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What to leave out of, or spoil in, a bag that is otherwise good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Flaw {
    None,
    NoDepth,
    NoCameraInfo,
    NoDetections,
    SizesDiffer,
    NoPose,
    /// Odometry is of a base, and nothing says where the camera is on it.
    NoTransforms,
    NanPose,
    BoxesOutside,
    /// A label that is HTML.
    HostileLabel,
    /// Colour images that are none.
    BrokenColor,
    /// The depth camera dies, and the robot lives on for seven seconds.
    DepthDies,
    /// In the end, odometry is of a minute and a half ago.
    ClockGoesBack,
}

pub(crate) const HOSTILE_LABEL: &str = "</script><img src=x onerror=alert(1)>";

pub(crate) fn stamp(i: usize) -> Stamp {
    Stamp::from_nanos(1_700_000_000_000_000_000 + 200_000_000 * i as i64)
}

fn camera() -> Camera {
    Camera::new((160, 120), (130.0, 130.0), (79.5, 59.5), Distortion::None).unwrap()
}

/// The camera stands 1.2 m above the floor and looks down at a box of 0.4 x 0.3 x 0.5 m, from further left each time.
pub(crate) fn world_from_camera(i: usize) -> Pose {
    let eye = Point3::new(-1.6, 0.4 - 0.16 * i as f64, 1.2);
    let forward = (Point3::new(0.0, 0.0, 0.25) - eye) / (Point3::new(0.0, 0.0, 0.25) - eye).norm();
    let right = forward.cross(&Vector3::z()) / forward.cross(&Vector3::z()).norm();
    let axes = nalgebra::Matrix3::from_columns(&[right, forward.cross(&right), forward]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Pose::from_parts(Translation3::from(eye.coords), rotation)
}

/// True centre and half extents of the box.
pub(crate) fn truth() -> (Point3<f64>, Vector3<f64>) {
    (Point3::new(0.0, 0.0, 0.25), Vector3::new(0.2, 0.15, 0.25))
}

/// Depth of the floor and the box, and the box's pixels.
fn rendered(i: usize) -> (DepthImage, Rect) {
    let (pose, camera) = (world_from_camera(i), camera());
    let (mut metres, mut low, mut high) = (Vec::new(), (f64::MAX, f64::MAX), (0.0_f64, 0.0_f64));
    for v in 0..camera.height() {
        for u in 0..camera.width() {
            let ray = camera.ray(f64::from(u), f64::from(v));
            let direction = pose.rotation * ray;
            let origin = pose.translation.vector;
            let floor = if direction.z < 0.0 { -origin.z / direction.z } else { f64::INFINITY };
            let hit = box_hit(&origin, &direction);
            if hit < floor {
                low = (low.0.min(f64::from(u)), low.1.min(f64::from(v)));
                high = (high.0.max(f64::from(u)), high.1.max(f64::from(v)));
            }
            metres.push(hit.min(floor) as f32);
        }
    }
    let rect = Rect::new(low.0, low.1, high.0, high.1).unwrap();
    (DepthImage::new(camera.width(), camera.height(), metres).unwrap(), rect)
}

/// Where a ray enters the box (Kay and Kajiya 1986), infinity if it does not.
fn box_hit(origin: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
    let (center, half) = truth();
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let at = |side: f64| (center[axis] + side * half[axis] - origin[axis]) / direction[axis];
        let (a, b) = (at(-1.0), at(1.0));
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    if near < far { near } else { f64::INFINITY }
}

/// Writes a bag of a suitcase on a floor.
pub(crate) fn write_bag(path: &Path, flaw: Flaw) {
    let mut bag = BagWriter::create(path).unwrap();
    for i in 0..FRAMES {
        let at = stamp(i);
        let (image, rect) = rendered(i);
        let mut pose = world_from_camera(i);
        if flaw == Flaw::NanPose && i == 2 {
            pose.translation.vector.x = f64::NAN;
        }
        let on_base =
            (flaw == Flaw::NoTransforms).then(|| CAMERA_POSE.parse::<CameraPose>().unwrap());
        let camera_from_base =
            on_base.and_then(|on_base| on_base.base_from_camera()).map(|pose| pose.inverse());
        let odometry = OdometryMessage {
            stamp: at,
            frame_id: "odom".into(),
            child_frame_id: if camera_from_base.is_some() { "base_link" } else { CAMERA }.into(),
            odom_from_base: pose * camera_from_base.unwrap_or_default(),
            covariance: None,
        };
        let size = if flaw == Flaw::SizesDiffer { (320, 240) } else { (160, 120) };
        let info = CameraMessage {
            role: CameraRole::Color,
            stamp: at,
            frame_id: CAMERA.into(),
            camera: Camera::new(size, (130.0, 130.0), (79.5, 59.5), Distortion::None).unwrap(),
        };
        let depth = DepthMessage { stamp: at, frame_id: CAMERA.into(), image };
        let shift = if flaw == Flaw::BoxesOutside { 1000.0 } else { 0.0 };
        let rect =
            Rect::new(rect.x_min + shift, rect.y_min, rect.x_max + shift, rect.y_max).unwrap();
        let label = if flaw == Flaw::HostileLabel { HOSTILE_LABEL } else { "suitcase" };
        if flaw == Flaw::BrokenColor {
            let (format, data) = ("jpeg".into(), vec![0xff, 0xd8, 0xff, 0x00]);
            let image = CompressedImage { header: header(at, CAMERA), format, data };
            bag.write("/camera/image/compressed", &image, at).unwrap();
        }
        let boxes = DetectionsMessage {
            stamp: at,
            frame_id: CAMERA.into(),
            detections: vec![Detection::new(rect, vec![(label.into(), 0.9)]).unwrap()],
        };
        if flaw != Flaw::NoPose {
            bag.write("/odom", &odometry_message(&odometry), at).unwrap();
        }
        if flaw != Flaw::NoCameraInfo {
            bag.write("/camera/camera_info", &camera_info(&info), at).unwrap();
        }
        if flaw != Flaw::NoDepth && !(flaw == Flaw::DepthDies && i > 3) {
            bag.write("/camera/depth/image", &depth_image_message(&depth), at).unwrap();
        }
        if flaw != Flaw::NoDetections {
            bag.write("/detections", &detection_array(&boxes), at.shifted(0.05)).unwrap();
        }
    }
    write_late_readings(&mut bag, flaw);
    bag.finish().unwrap();
}

/// What odometry says after the last image.
fn write_late_readings(bag: &mut BagWriter, flaw: Flaw) {
    let (from, back_s) = match flaw {
        Flaw::DepthDies => (FRAMES..FRAMES + 35, 0.0),
        Flaw::ClockGoesBack => (FRAMES..FRAMES + 1, -90.0),
        _ => (0..0, 0.0),
    };
    for i in from {
        let reading = OdometryMessage {
            stamp: stamp(i).shifted(back_s),
            frame_id: "odom".into(),
            child_frame_id: CAMERA.into(),
            odom_from_base: world_from_camera(FRAMES - 1),
            covariance: None,
        };
        bag.write("/odom", &odometry_message(&reading), stamp(i)).unwrap();
    }
}
