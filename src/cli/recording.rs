//! A bag as a robot would have recorded it: which topic and frame has which name, in one place.

use super::{Failure, results::MAP_FRAME};
use crate::{
    eval::GroundTruth,
    geometry::{Camera, Pose},
    io::{BagError, BagWriter, write_atomically},
    msg::{
        convert::{
            boxes_3d, camera_info, compressed_depth_message, depth_image_message, detection_array,
            header, odometry_message, tf_message,
        },
        sensor_msgs::{CompressedImage, Image},
    },
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, OdometryMessage,
        StampedTransform,
    },
    time::Stamp,
};
use anyhow::Context;
use std::path::{Path, PathBuf};

pub(super) const CAMERA_FRAME: &str = "camera_color_optical_frame";
pub(super) const ODOM_FRAME: &str = "odom";
pub(super) const BASE_FRAME: &str = "base_link";

const COLOR: &str = "/camera/color/image_raw";
const COMPRESSED_COLOR: &str = "/camera/color/image_raw/compressed";
const CAMERA_INFO: &str = "/camera/color/camera_info";
const DEPTH: &str = "/camera/aligned_depth_to_color/image_raw";
const COMPRESSED_DEPTH: &str = "/camera/aligned_depth_to_color/image_raw/compressedDepth";
const ODOMETRY: &str = "/odom";
pub(super) const DETECTIONS: &str = "/detections";
const TRUE_ODOMETRY: &str = "/ground_truth/odom";
const TRUE_OBJECTS: &str = "/ground_truth/objects";
const TRUE_DETECTIONS: &str = "/ground_truth/detections";

/// A bag that is being written.
pub(super) struct Recording {
    bag: BagWriter,
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
    pub(super) fn create(path: &Path) -> Result<Self, BagError> {
        Ok(Self { bag: BagWriter::create(path)? })
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

    /// Calibration of the camera, in whose image the boxes are.
    pub(super) fn camera(&mut self, stamp: Stamp, camera: &Camera) -> Result<(), BagError> {
        let info = CameraMessage {
            role: CameraRole::Color,
            stamp,
            frame_id: CAMERA_FRAME.into(),
            camera: camera.clone(),
        };
        self.bag.write(CAMERA_INFO, &camera_info(&info), stamp)
    }

    /// A colour image in a file format, which is `jpeg` or `png`.
    pub(super) fn compressed_color(
        &mut self,
        stamp: Stamp,
        format: &str,
        file: Vec<u8>,
    ) -> Result<(), BagError> {
        let image = CompressedImage {
            header: header(stamp, CAMERA_FRAME),
            format: format!("rgb8; {format} compressed bgr8"),
            data: file,
        };
        self.bag.write(COMPRESSED_COLOR, &image, stamp)
    }

    /// A colour image of `size` = width, height, as it is.
    pub(super) fn raw_color(
        &mut self,
        stamp: Stamp,
        (width, height): (u32, u32),
        rgb: Vec<u8>,
    ) -> Result<(), BagError> {
        let image = Image {
            header: header(stamp, CAMERA_FRAME),
            height,
            width,
            encoding: "rgb8".into(),
            is_bigendian: 0,
            step: 3 * width,
            data: rgb,
        };
        self.bag.write(COLOR, &image, stamp)
    }

    /// A depth image that is registered to the colour camera.
    pub(super) fn depth(&mut self, depth: &DepthMessage, raw: bool) -> anyhow::Result<()> {
        if raw {
            self.bag.write(DEPTH, &depth_image_message(depth), depth.stamp)?;
        } else {
            self.bag.write(COMPRESSED_DEPTH, &compressed_depth_message(depth)?, depth.stamp)?;
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
        self.bag.write(DETECTIONS, &boxes, arrival)?;
        for (detection, id) in boxes.detections.iter_mut().zip(true_ids) {
            detection.id = id;
        }
        self.bag.write(TRUE_DETECTIONS, &boxes, arrival)
    }
}
