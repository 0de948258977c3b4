//! From a bag's messages to the core's inputs.

use super::RawMessage;
use crate::{
    msg::{
        Message, SkipCount, Skipped,
        cdr::decode,
        convert::{self, ColorMessage, ConvertError, RgbImage},
        sensor_msgs::CompressedImage,
        yolo_msgs::DetectionArray,
    },
    pipeline::{CameraRole, DepthMessage, Input},
    topics::Roles,
};

/// Decodes the messages of the topics that have a role.
#[derive(Clone, Debug)]
pub struct Decoder {
    roles: Roles,
    /// `(width, height)` of the images that the boxes live in, once a calibration said so.
    color_size: Option<(u32, u32)>,
    /// The same of the depth camera's images, where it has a calibration of its own.
    depth_size: Option<(u32, u32)>,
    skipped: SkipCount,
}

impl Decoder {
    /// A decoder that has seen nothing yet.
    pub fn new(roles: Roles) -> Self {
        Self { roles, color_size: None, depth_size: None, skipped: SkipCount::default() }
    }

    /// The core's input from a message, or nothing if its topic has no role. A message that cannot be used is
    /// refused and counted; boxes and transforms that cannot be used are left out of their message and counted.
    ///
    /// # Errors
    /// When nothing of the message can be used.
    pub fn decode(&mut self, message: &RawMessage) -> Result<Option<Input>, Skipped> {
        let mut left_out = Vec::new();
        let outcome = self.convert(message, &mut left_out);
        let skipped = |why| Skipped { topic: message.topic.to_string(), why };
        left_out.into_iter().map(skipped).for_each(|part| self.skipped.add(part));
        self.note(message, outcome)
    }

    /// Counts a message that could not be used.
    pub(super) fn note<T>(
        &mut self,
        message: &RawMessage,
        outcome: Result<T, ConvertError>,
    ) -> Result<T, Skipped> {
        outcome.map_err(|why| {
            let skipped = Skipped { topic: message.topic.to_string(), why };
            self.skipped.add(skipped.clone());
            skipped
        })
    }

    /// What has been left out so far.
    pub fn skipped(&self) -> &SkipCount {
        &self.skipped
    }

    /// The sizes that depth images can have, once all calibrations have come: depth may be registered to colour.
    fn depth_sizes(&self) -> Vec<(u32, u32)> {
        let own = self.roles.depth_camera_info.is_some();
        match (self.depth_size, self.color_size) {
            (None, _) if own => Vec::new(),
            (_, None) => Vec::new(),
            (depth, color) => depth.into_iter().chain(color).collect(),
        }
    }

    fn convert(
        &mut self,
        message: &RawMessage,
        left_out: &mut Vec<ConvertError>,
    ) -> Result<Option<Input>, ConvertError> {
        let (topic, data) = (&*message.topic, message.data.as_slice());
        let is = |role: &Option<String>| role.as_deref() == Some(topic);
        let roles = &self.roles;
        let input = if topic == roles.depth {
            Input::Depth(depth(message, &self.depth_sizes())?)
        } else if topic == roles.camera_info {
            let rectified = roles.is_color_rectified();
            let message = convert::camera(&decode(data)?, CameraRole::Color, rectified)?;
            self.color_size = Some((message.camera.width(), message.camera.height()));
            Input::Camera(message)
        } else if is(&roles.depth_camera_info) {
            let rectified = roles.is_depth_rectified();
            let message = convert::camera(&decode(data)?, CameraRole::Depth, rectified)?;
            self.depth_size = Some((message.camera.width(), message.camera.height()));
            Input::Camera(message)
        } else if is(&roles.odometry) {
            Input::Odometry(convert::odometry(&decode(data)?)?)
        } else if topic == roles.detections {
            let (boxes, bad) = if &*message.type_name == DetectionArray::TYPE {
                convert::yolo_detections(&decode(data)?, self.color_size)
            } else {
                convert::detections(&decode(data)?, self.color_size)
            };
            left_out.extend(bad);
            Input::Detections(boxes)
        } else if is(&roles.detections_3d) {
            let (found, bad) = if &*message.type_name == DetectionArray::TYPE {
                convert::yolo_found_in_space(&decode(data)?)
            } else {
                convert::found_in_space(&decode(data)?)
            };
            left_out.extend(bad);
            Input::Detections3d(found)
        } else if let Some(is_static) = transforms_of(roles, topic) {
            let (transforms, bad) = convert::transforms(&decode(data)?);
            left_out.extend(bad);
            Input::Transforms { is_static, transforms }
        } else {
            return Ok(None);
        };
        Ok(Some(input))
    }
}

/// Depth from either of the two image types.
fn depth(message: &RawMessage, sizes: &[(u32, u32)]) -> Result<DepthMessage, ConvertError> {
    if &*message.type_name == CompressedImage::TYPE {
        convert::compressed_depth_image(&decode(&message.data)?, sizes)
    } else {
        convert::depth_image(&decode(&message.data)?, sizes)
    }
}

/// The picture in a message on the topic of [`Role::Rgb`](crate::topics::Role::Rgb); called only when one is to be drawn.
///
/// # Errors
/// When the picture cannot be decoded.
pub fn decode_color(message: &RawMessage) -> Result<RgbImage, ConvertError> {
    color_message(message)?.decoded()
}

/// The same as it came, for whoever knows only later whether it is to be drawn.
///
/// # Errors
/// When the bytes are no image.
pub fn color_message(message: &RawMessage) -> Result<ColorMessage, ConvertError> {
    Ok(if &*message.type_name == CompressedImage::TYPE {
        ColorMessage::Compressed(decode(&message.data)?)
    } else {
        ColorMessage::Raw(decode(&message.data)?)
    })
}

/// Whether the topic carries fixed transforms; nothing if it carries none.
fn transforms_of(roles: &Roles, topic: &str) -> Option<bool> {
    let among = |topics: &[String]| topics.iter().any(|name| name == topic);
    if among(&roles.tf_static) {
        Some(true)
    } else if among(&roles.tf) {
        Some(false)
    } else {
        None
    }
}
