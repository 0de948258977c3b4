//! A bag as a robot would have recorded it: which topic and frame has which name, in one place.

use super::{Failure, results::MAP_FRAME};
use crate::{
    eval::GroundTruth,
    geometry::{Camera, Pose},
    io::{BagError, BagWriter, write_atomically},
    msg::{
        convert::{
            boxes_3d, camera_info, compressed_depth_message, depth_image_message, detection_array,
            header, odometry_message, tf_message, yolo_detection_array,
        },
        sensor_msgs::{CompressedImage, Image},
    },
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, OdometryMessage,
        StampedTransform,
    },
    sim::RobotKind,
    time::Stamp,
};
use anyhow::Context;
use std::path::{Path, PathBuf};

pub(super) const CAMERA_FRAME: &str = "camera_color_optical_frame";
pub(super) const ODOM_FRAME: &str = "odom";
pub(super) const BASE_FRAME: &str = "base_link";

const ODOMETRY: &str = "/odom";
pub(super) const DETECTIONS: &str = "/detections";
const TRUE_ODOMETRY: &str = "/ground_truth/odom";
const TRUE_OBJECTS: &str = "/ground_truth/objects";
const TRUE_DETECTIONS: &str = "/ground_truth/detections";

/// How a robot calls what its camera and its detector send.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names {
    pub(super) camera_frame: &'static str,
    color: &'static str,
    camera_info: &'static str,
    depth: &'static str,
    depth_camera_info: &'static str,
    detections: &'static str,
    /// Whether boxes are `yolo_msgs` and not `vision_msgs`.
    is_yolo: bool,
}

impl Names {
    /// With boxes that may have masks.
    pub(super) fn with_masks(self) -> Self {
        Self { is_yolo: true, ..self }
    }
}

impl Default for Names {
    fn default() -> Self {
        Self {
            camera_frame: CAMERA_FRAME,
            color: "/camera/color/image_raw",
            camera_info: "/camera/color/camera_info",
            depth: "/camera/aligned_depth_to_color/image_raw",
            depth_camera_info: "/camera/aligned_depth_to_color/camera_info",
            detections: DETECTIONS,
            is_yolo: false,
        }
    }
}

impl From<RobotKind> for Names {
    fn from(robot: RobotKind) -> Self {
        match robot {
            RobotKind::Turtlebot4 => Self {
                camera_frame: "oakd_rgb_camera_optical_frame",
                color: "/oakd/rgb/preview/image_raw",
                camera_info: "/oakd/rgb/preview/camera_info",
                depth: "/oakd/stereo/image_raw",
                depth_camera_info: "/oakd/stereo/camera_info",
                detections: "/yolo/detections",
                is_yolo: true,
            },
            RobotKind::Realsense => Self {
                color: "/camera/camera/color/image_raw",
                camera_info: "/camera/camera/color/camera_info",
                depth: "/camera/camera/aligned_depth_to_color/image_raw",
                depth_camera_info: "/camera/camera/aligned_depth_to_color/camera_info",
                ..Self::default()
            },
            RobotKind::Kinect => Self {
                camera_frame: "camera_rgb_optical_frame",
                color: "/camera/rgb/image_rect_color",
                camera_info: "/camera/rgb/camera_info",
                depth: "/camera/depth_registered/image_rect",
                depth_camera_info: "/camera/depth_registered/camera_info",
                ..Self::default()
            },
        }
    }
}

/// A bag that is being written.
pub(super) struct Recording {
    bag: BagWriter,
    names: Names,
    /// Width and height of the images in which the boxes are.
    image_size: (u32, u32),
}

/// Where the true objects of a bag are written: `STEM.gt.json` beside it.
pub(super) fn truth_path(bag: &Path) -> PathBuf {
    bag.with_extension("gt.json")
}

/// Refuses to overwrite files that are there already.
pub(super) fn refuse_existing(files: &[&Path], force: bool) -> Result<(), Failure> {
    match files.iter().find(|file| file.exists()) {
        Some(file) if !force => Err(Failure::Usage(format!(
            "{} exists already; give --force to overwrite",
            file.display()
        ))),
        _ => Ok(()),
    }
}

/// Writes `STEM.gt.json` beside a bag.
pub(super) fn write_truth(bag: &Path, truth: &GroundTruth) -> anyhow::Result<()> {
    let path = truth_path(bag);
    write_atomically(&path, truth.to_json()?.as_bytes())
        .with_context(|| format!("cannot write {}", path.display()))
}

impl Recording {
    /// A new bag; an existing file stays until this one is finished.
    pub(super) fn create(path: &Path, names: Names) -> Result<Self, BagError> {
        Ok(Self { bag: BagWriter::create(path)?, names, image_size: (0, 0) })
    }

    /// Completes the bag and gives it its name.
    pub(super) fn finish(self) -> Result<(), BagError> {
        self.bag.finish()
    }

    /// A transform for all time.
    pub(super) fn static_transform(
        &mut self,
        transform: &StampedTransform,
    ) -> Result<(), BagError> {
        let message = tf_message(std::slice::from_ref(transform));
        self.bag.write("/tf_static", &message, transform.stamp)
    }

    /// A reading of the odometry, and the same as a transform.
    pub(super) fn odometry(&mut self, reading: &OdometryMessage) -> Result<(), BagError> {
        let transform = StampedTransform {
            stamp: reading.stamp,
            frame_id: reading.frame_id.clone(),
            child_frame_id: reading.child_frame_id.clone(),
            parent_from_child: reading.odom_from_base,
        };
        self.bag.write("/tf", &tf_message(&[transform]), reading.stamp)?;
        self.bag.write(ODOMETRY, &odometry_message(reading), reading.stamp)
    }

    /// Where `child_frame` is in truth.
    pub(super) fn true_pose(
        &mut self,
        stamp: Stamp,
        child_frame: &str,
        map_from_child: &Pose,
    ) -> Result<(), BagError> {
        let reading = OdometryMessage {
            stamp,
            frame_id: MAP_FRAME.into(),
            child_frame_id: child_frame.into(),
            odom_from_base: *map_from_child,
            covariance: None,
        };
        self.bag.write(TRUE_ODOMETRY, &odometry_message(&reading), stamp)
    }

    /// The true objects.
    pub(super) fn true_objects(
        &mut self,
        stamp: Stamp,
        truth: &GroundTruth,
    ) -> Result<(), BagError> {
        let boxes = truth.objects.iter().map(|o| (o.id, o.label.as_str(), o.oriented_box()));
        self.bag.write(TRUE_OBJECTS, &boxes_3d(boxes, stamp, &truth.frame_id), stamp)
    }

    /// Calibration of the colour camera, in whose image the boxes are, or of the depth camera.
    pub(super) fn camera(
        &mut self,
        stamp: Stamp,
        role: CameraRole,
        camera: &Camera,
    ) -> Result<(), BagError> {
        let topic = match role {
            CameraRole::Color => {
                self.image_size = (camera.width(), camera.height());
                self.names.camera_info
            }
            CameraRole::Depth => self.names.depth_camera_info,
        };
        let (frame_id, camera) = (self.names.camera_frame.into(), camera.clone());
        self.bag.write(topic, &camera_info(&CameraMessage { role, stamp, frame_id, camera }), stamp)
    }

    /// Width of the images in which the boxes are, once their calibration was written.
    pub(super) fn image_width(&self) -> u32 {
        self.image_size.0
    }

    /// A colour image in a file format, which is `jpeg` or `png`.
    pub(super) fn compressed_color(
        &mut self,
        stamp: Stamp,
        format: &str,
        file: Vec<u8>,
    ) -> Result<(), BagError> {
        let image = CompressedImage {
            header: header(stamp, self.names.camera_frame),
            format: format!("rgb8; {format} compressed bgr8"),
            data: file,
        };
        self.bag.write(&format!("{}/compressed", self.names.color), &image, stamp)
    }

    /// A colour image of `size` = width, height, as it is.
    pub(super) fn raw_color(
        &mut self,
        stamp: Stamp,
        (width, height): (u32, u32),
        rgb: Vec<u8>,
    ) -> Result<(), BagError> {
        let image = Image {
            header: header(stamp, self.names.camera_frame),
            height,
            width,
            encoding: "rgb8".into(),
            is_bigendian: 0,
            step: 3 * width,
            data: rgb,
        };
        self.bag.write(self.names.color, &image, stamp)
    }

    /// A depth image in the colour camera's frame.
    pub(super) fn depth(&mut self, depth: &DepthMessage, raw: bool) -> anyhow::Result<()> {
        if raw {
            self.bag.write(self.names.depth, &depth_image_message(depth), depth.stamp)?;
        } else {
            let topic = format!("{}/compressedDepth", self.names.depth);
            self.bag.write(&topic, &compressed_depth_message(depth)?, depth.stamp)?;
        }
        Ok(())
    }

    /// Boxes that come at `arrival`, and once more as truth with the object that each of them shows.
    pub(super) fn detections(
        &mut self,
        message: &DetectionsMessage,
        true_ids: impl IntoIterator<Item = String>,
        arrival: Stamp,
    ) -> Result<(), BagError> {
        let mut boxes = detection_array(message);
        if self.names.is_yolo {
            let boxes = yolo_detection_array(message, self.image_size);
            self.bag.write(self.names.detections, &boxes, arrival)?;
        } else {
            self.bag.write(self.names.detections, &boxes, arrival)?;
        }
        for (detection, id) in boxes.detections.iter_mut().zip(true_ids) {
            detection.id = id;
        }
        self.bag.write(TRUE_DETECTIONS, &boxes, arrival)
    }
}
