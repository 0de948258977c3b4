//! Boxes that a detector finds in the colour images of a bag.

use super::{RawMessage, decode_color};
use crate::{
    msg::{
        cdr::decode_header,
        convert::{ConvertError, FindBoxes},
    },
    pipeline::DetectionsMessage,
};
use std::fmt;

/// A detector that looks at messages of the topic of [`Role::Rgb`](crate::topics::Role::Rgb).
pub struct FoundBoxes(FindBoxes);

impl FoundBoxes {
    /// What this detector finds.
    pub fn new(find: FindBoxes) -> Self {
        Self(find)
    }

    /// The boxes of an image, with its stamp and frame, and its width and height in pixels.
    ///
    /// # Errors
    /// When the image cannot be decoded, or the detector fails.
    pub fn of(
        &mut self,
        message: &RawMessage,
    ) -> Result<(DetectionsMessage, (u32, u32)), ConvertError> {
        let header = decode_header(&message.data)?;
        let image = decode_color(message)?;
        let detections = (self.0)(&image).map_err(ConvertError::Detector)?;
        let frame_id = header.frame_id.trim_start_matches('/').to_owned();
        let boxes = DetectionsMessage { stamp: header.stamp.into(), frame_id, detections };
        Ok((boxes, (image.width, image.height)))
    }
}

impl fmt::Debug for FoundBoxes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("FoundBoxes")
    }
}
