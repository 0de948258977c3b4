//! One RGB-D image with its pose and its boxes, for who has arrays and no messages.

use super::{
    CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, ObjectSlam, OdometryMessage,
    Update,
};
use crate::{
    geometry::{Camera, Pose, Rect},
    perception::{DepthError, DepthImage, Detection, DetectionError, Mask, MaskError},
    time::Stamp,
};
use thiserror::Error;

/// An image of a camera whose pose is known, by odometry or otherwise.
///
/// The camera frame is the optical one: x right, y down, z forward. The pose is in a fixed frame whose z axis is up, against
/// gravity: drift in it is corrected, a tilt is not.
#[derive(Clone, Debug)]
pub struct RgbdFrame {
    stamp: Stamp,
    camera: Camera,
    odom_from_camera: Pose,
    depth: DepthImage,
    boxes: Vec<Detection>,
}

/// Why arrays are not an image.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FrameError {
    /// The depth's length does not fit the camera.
    #[error(transparent)]
    Depth(#[from] DepthError),
    /// A number of the pose is not finite.
    #[error("the camera's pose is not finite")]
    Pose,
    /// A box that cannot be.
    #[error(transparent)]
    Box(#[from] DetectionError),
    /// A mask that is not of its box.
    #[error(transparent)]
    Mask(#[from] MaskError),
}

impl RgbdFrame {
    /// An image without boxes: `depth_m` has `width * height` depths along the optical axis (m), row by row; zero or NaN is no
    /// reading. Depth is aligned to the image in which the boxes are, and `camera` is of both.
    ///
    /// # Errors
    /// When the depth does not fit the camera's size, or the pose is not finite.
    pub fn new(
        stamp: Stamp,
        camera: &Camera,
        odom_from_camera: &Pose,
        depth_m: &[f32],
    ) -> Result<Self, FrameError> {
        let numbers = odom_from_camera.to_homogeneous();
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(FrameError::Pose);
        }
        let depth = DepthImage::new(camera.width(), camera.height(), depth_m.to_vec())?;
        let (camera, odom_from_camera) = (camera.clone(), *odom_from_camera);
        Ok(Self { stamp, camera, odom_from_camera, depth, boxes: Vec::new() })
    }

    /// The same with a detector's box more: its corners `[x_min, y_min, x_max, y_max]` (px), the name of its class, and the
    /// detector's score from 0 to 1.
    ///
    /// # Errors
    /// When the box is inverted or not finite, or the score is not in (0, 1].
    pub fn with_box(
        mut self,
        corners: [f64; 4],
        label: &str,
        score: f64,
    ) -> Result<Self, FrameError> {
        let [x_min, y_min, x_max, y_max] = corners;
        let rect = Rect::new(x_min, y_min, x_max, y_max).ok_or(DetectionError::BadBox)?;
        self.boxes.push(Detection::new(rect, vec![(label.to_owned(), score)])?);
        Ok(self)
    }

    /// The same with the mask of the box that was added last: whether the pixel of a column and a row of the image is the object.
    /// Without a box nothing changes.
    ///
    /// # Errors
    /// When the mask has hardly anything to do with the box.
    pub fn masked(mut self, is_inside: impl Fn(i64, i64) -> bool) -> Result<Self, FrameError> {
        if let Some(last) = self.boxes.last_mut() {
            last.mask = Some(Mask::from_pixels(&last.rect, is_inside)?);
        }
        Ok(self)
    }

    /// The same with boxes more, each with all the classes that its detector considers, and with its mask.
    #[must_use]
    pub fn with_boxes(mut self, boxes: impl IntoIterator<Item = Detection>) -> Self {
        self.boxes.extend(boxes);
        self
    }
}

impl ObjectSlam {
    /// Takes an image with its pose and its boxes. Stamps must grow from image to image. The update may be of the image
    /// before, since a pose is interpolated; [`ObjectSlam::finish`] works off the last one.
    pub fn see(&mut self, frame: RgbdFrame) -> Update {
        let RgbdFrame { stamp, camera, odom_from_camera, depth: image, boxes: detections } = frame;
        let frame_id = || CAMERA_FRAME.to_owned();
        let odometry = OdometryMessage {
            stamp,
            frame_id: ODOM_FRAME.to_owned(),
            child_frame_id: frame_id(),
            odom_from_base: odom_from_camera,
            covariance: None,
        };
        let role = CameraRole::Color;
        let inputs = [
            Input::Camera(CameraMessage { role, stamp, frame_id: frame_id(), camera }),
            Input::Odometry(odometry),
            Input::Depth(DepthMessage { stamp, frame_id: frame_id(), image }),
            Input::Detections(DetectionsMessage { stamp, frame_id: frame_id(), detections }),
        ];
        let mut all = Update::default();
        for input in inputs {
            all.append(self.handle(input, &mut ()));
        }
        all
    }
}

/// Names of the frames that have none of their own: the camera is its own base.
const CAMERA_FRAME: &str = "camera";
const ODOM_FRAME: &str = "odom";
