//! Why a message cannot be used.

use crate::{
    geometry::CameraError,
    msg::cdr::CdrError,
    perception::{DepthError, DetectionError, MaskError},
};
use thiserror::Error;

/// Why a message, or a part of it, cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ConvertError {
    /// The bytes are not the message.
    #[error(transparent)]
    Cdr(#[from] CdrError),
    /// Pixels in an encoding that is not known here.
    #[error("the image encoding `{encoding}` is not supported; known are {known}")]
    UnknownEncoding {
        /// What the message says.
        encoding: String,
        /// What can be read.
        known: &'static str,
    },
    /// The number of bytes does not fit the size.
    #[error(
        "an image of {width}x{height} in {encoding} with {step} bytes a row does not fit {got} bytes of data"
    )]
    ImageSize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Encoding.
        encoding: String,
        /// Bytes from one row to the next.
        step: u32,
        /// Bytes given.
        got: usize,
    },
    /// More pixels than any camera has: a damaged size.
    #[error("an image of {width}x{height} is larger than any camera takes")]
    ImageTooLarge {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// An image of another size than its calibration.
    #[error("the depth image is {}x{}, the camera info says {}x{}", got.0, got.1, info.0, info.1)]
    SizesDiffer {
        /// Columns and rows of the image.
        got: (u32, u32),
        /// What the calibration says.
        info: (u32, u32),
    },
    /// A name that is none.
    #[error("the {what} `{name}` has a name longer than any")]
    LongName {
        /// What it is the name of.
        what: &'static str,
        /// Its beginning.
        name: String,
    },
    /// A compressed image that does not decode.
    #[error("the compressed image (`{format}`) cannot be decoded: {problem}")]
    BadCompressedImage {
        /// What the message says about its format.
        format: String,
        /// What the decoder met.
        problem: String,
    },
    /// Pixels and size do not fit.
    #[error(transparent)]
    Depth(#[from] DepthError),
    /// Calibration that is none.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// A distortion model that is not known here.
    #[error(
        "the distortion model `{model}` with {coefficients} coefficients is not supported; \
         plumb_bob and rational_polynomial are, and rectified images need none"
    )]
    UnknownDistortion {
        /// What the message says.
        model: String,
        /// How many coefficients it has.
        coefficients: usize,
    },
    /// A position or quaternion that is not finite, or a quaternion of length zero.
    #[error("the pose of `{child}` in `{parent}` is not finite or its quaternion has no length")]
    BadPose {
        /// Parent frame.
        parent: String,
        /// Child frame.
        child: String,
    },
    /// A box or its classes make no sense.
    #[error("a detection is not usable: {0}")]
    Detection(#[from] DetectionError),
    /// A mask that is none, or of another box.
    #[error("a detection's mask is not used, its box is: {0}")]
    Mask(#[from] MaskError),
    /// A mask of an image of another size than the boxes.
    #[error(
        "a detection's mask is not used, its box is: it is of an image of {}x{}, the camera info says {}x{}",
        got.0, got.1, info.0, info.1
    )]
    MaskSize {
        /// Columns and rows that the mask says.
        got: (i32, i32),
        /// What the calibration says.
        info: (u32, u32),
    },
    /// The detector could not look at an image.
    #[error("the detector failed: {0}")]
    Detector(String),
    /// A box without any pixel of the image.
    #[error("a detection's box lies outside the image of {width}x{height}")]
    BoxOutside {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

impl ConvertError {
    /// A short, stable key for counting.
    pub fn reason(&self) -> &'static str {
        match self {
            Self::Cdr(_) => "bad_cdr",
            Self::UnknownEncoding { .. } => "unknown_encoding",
            Self::ImageSize { .. }
            | Self::ImageTooLarge { .. }
            | Self::SizesDiffer { .. }
            | Self::Depth(_) => "size_mismatch",
            Self::LongName { .. } => "long_name",
            Self::BadCompressedImage { .. } => "bad_image",
            Self::Camera(_) => "bad_camera",
            Self::UnknownDistortion { .. } => "unknown_distortion",
            Self::BadPose { .. } => "bad_pose",
            Self::Detection(DetectionError::BadBox) => "bad_box",
            Self::Detection(DetectionError::NoClass) => "no_class",
            Self::Detection(DetectionError::NoFrame) => "no_frame",
            Self::Detection(DetectionError::BadPlace) => "bad_place",
            Self::Detection(DetectionError::BadExtents) => "bad_extents",
            Self::Mask(_) | Self::MaskSize { .. } => "bad_mask",
            Self::Detector(_) => "detector_failed",
            Self::BoxOutside { .. } => "box_outside",
        }
    }
}
