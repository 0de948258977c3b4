//! Colour images of `result.mcap` with what is known of them: drawn into them, and beside them for viewers that draw it.

use crate::{
    io::{BagError, BagWriter},
    msg::{
        convert::{ColorMessage, camera_info, compressed_color_message, header, pose_message},
        foxglove_msgs::ImageAnnotations,
        geometry_msgs::PoseStamped,
        sensor_msgs::{CameraInfo, CompressedImage},
    },
    pipeline::{CameraMessage, CameraRole, Keyframe, ObjectSlam},
    publication::{View, draw_debug_image, image_annotations},
    report::ColorImages,
    time::Stamp,
};

/// With boxes and outlines drawn in, as the live node's debug image would be compressed.
const DRAWN: &str = "/ellipsoid_slam/debug_image/compressed";
/// The image itself.
pub(super) const PLAIN: &str = "/ellipsoid_slam/image/compressed";
/// Its calibration, with which Foxglove draws markers over it, too.
pub(super) const CAMERA: &str = "/ellipsoid_slam/camera_info";
/// Where its camera was in the map, as known at the time.
pub(super) const POSE: &str = "/ellipsoid_slam/camera_pose";
/// What Foxglove draws over it.
const ANNOTATIONS: &str = "/ellipsoid_slam/annotations";

const QUALITY: u8 = 70;
/// Time from one image to the next at the beginning (s).
const PERIOD_S: f64 = 1.0;
/// After so many bytes the time between images doubles: two hours bring 45 MB at most, of whatever size images are.
const SAME_PERIOD_BYTES: usize = 6_000_000;

/// Says which images are taken.
#[derive(Debug)]
pub(super) struct Annotator {
    period_s: f64,
    /// Of images since the time between them changed.
    bytes: usize,
    latest: Option<Stamp>,
}

/// An image with all that belongs to it.
#[derive(Debug)]
pub(super) struct Annotated {
    stamp: Stamp,
    plain: CompressedImage,
    drawn: CompressedImage,
    annotations: ImageAnnotations,
    camera: CameraInfo,
    pose: PoseStamped,
}

impl Default for Annotator {
    fn default() -> Self {
        Self { period_s: PERIOD_S, bytes: 0, latest: None }
    }
}

impl Annotator {
    /// Whether it is time for another image; to be asked once for each keyframe.
    pub(super) fn takes(&mut self, stamp: Stamp) -> bool {
        let since = self.latest.map(|latest| stamp.seconds_since(latest));
        if since.is_some_and(|since| (0.0..self.period_s).contains(&since)) {
            return false;
        }
        self.latest = Some(stamp);
        true
    }

    /// One was taken.
    pub(super) fn took(&mut self, image: &Annotated) {
        self.bytes += image.plain.data.len() + image.drawn.data.len();
        if self.bytes >= SAME_PERIOD_BYTES {
            (self.bytes, self.period_s) = (0, 2.0 * self.period_s);
        }
    }
}

impl Annotated {
    /// A keyframe's image with what is known at its time; nothing if it has none that can be used.
    pub(super) fn of(
        keyframe: &Keyframe,
        slam: &ObjectSlam,
        map_frame: &str,
        images: &mut ColorImages,
    ) -> Option<Self> {
        let (stamp, map_from_camera) = (keyframe.stamp, keyframe.map_from_camera);
        let view = View { camera: keyframe.camera.clone(), map_from_camera };
        let image = images.decoded(stamp)?;
        let message = images.message(stamp)?;
        let frame_id = message.frame_id().to_owned();
        let in_camera = header(stamp, &frame_id);
        let plain = match message {
            ColorMessage::Compressed(as_it_came) => {
                CompressedImage { header: in_camera.clone(), ..as_it_came.clone() }
            }
            ColorMessage::Raw(_) => {
                compressed_color_message(in_camera.clone(), &image, QUALITY).ok()?
            }
        };
        let mut drawn = (*image).clone();
        draw_debug_image(&mut drawn, keyframe, slam.objects(), &view);
        let annotations = image_annotations(keyframe, slam.objects(), &view);
        let role = CameraRole::Color;
        Some(Self {
            stamp,
            plain,
            drawn: compressed_color_message(in_camera, &drawn, QUALITY).ok()?,
            annotations,
            camera: camera_info(&CameraMessage { role, stamp, frame_id, camera: view.camera }),
            pose: PoseStamped {
                header: header(stamp, map_frame),
                pose: pose_message(&map_from_camera),
            },
        })
    }

    /// Writes all of it.
    pub(super) fn write(&self, bag: &mut BagWriter) -> Result<(), BagError> {
        bag.write(CAMERA, &self.camera, self.stamp)?;
        bag.write(POSE, &self.pose, self.stamp)?;
        bag.write(PLAIN, &self.plain, self.stamp)?;
        bag.write(ANNOTATIONS, &self.annotations, self.stamp)?;
        bag.write(DRAWN, &self.drawn, self.stamp)
    }
}
