//! A colour image as it came.

use super::{ConvertError, RgbImage, color_image, compressed_color_image};
use crate::{
    msg::sensor_msgs::{CompressedImage, Image},
    time::Stamp,
};

/// A colour image as it came, so that only those are decoded that are shown.
#[derive(Clone, Debug)]
pub enum ColorMessage {
    /// As it is.
    Raw(Image),
    /// JPEG or PNG.
    Compressed(CompressedImage),
}

impl ColorMessage {
    /// When it was taken.
    pub fn stamp(&self) -> Stamp {
        match self {
            Self::Raw(image) => image.header.stamp.into(),
            Self::Compressed(image) => image.header.stamp.into(),
        }
    }

    /// The frame that it is in.
    pub fn frame_id(&self) -> &str {
        match self {
            Self::Raw(image) => &image.header.frame_id,
            Self::Compressed(image) => &image.header.frame_id,
        }
    }

    /// The picture.
    ///
    /// # Errors
    /// When it cannot be decoded.
    pub fn decoded(&self) -> Result<RgbImage, ConvertError> {
        match self {
            Self::Raw(image) => color_image(image),
            Self::Compressed(image) => compressed_color_image(image),
        }
    }
}
