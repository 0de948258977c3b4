//! The latest colour images, until boxes come that were found in one of them.

use crate::{
    msg::{
        convert::{ConvertError, RgbImage, color_image, compressed_color_image},
        sensor_msgs::{CompressedImage, Image},
    },
    time::Stamp,
};
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// A colour image as it came: only those that are drawn into are decoded.
#[derive(Clone)]
pub(super) enum ColorMessage {
    Raw(Image),
    Compressed(CompressedImage),
}

/// Shared between the subscription and the worker.
#[derive(Clone, Default)]
pub(super) struct ColorImages(Arc<Mutex<VecDeque<Arc<ColorMessage>>>>);

/// Images of 30 Hz during the time that a detector takes (0.6 s).
const KEPT: usize = 18;
/// An image is of the same moment as a depth image if their stamps differ by less (s).
const SAME_MOMENT_S: f64 = 0.05;

impl ColorImages {
    pub(super) fn add(&self, image: Arc<ColorMessage>) {
        let mut images = self.lock();
        if images.len() == KEPT {
            images.pop_front();
        }
        images.push_back(image);
    }

    /// The image of a moment and the frame it is in, or why there is none.
    pub(super) fn at(&self, stamp: Stamp) -> Result<(String, RgbImage), String> {
        let nearest = {
            let images = self.lock();
            let away = |image: &ColorMessage| image.stamp().seconds_since(stamp).abs();
            let nearest = images.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            nearest.filter(|image| away(image) < SAME_MOMENT_S).cloned()
        };
        let image = nearest.ok_or("no colour image is near the depth image's stamp")?;
        let decoded = image.decoded().map_err(|e| e.to_string())?;
        Ok((image.frame_id().to_owned(), decoded))
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Arc<ColorMessage>>> {
        // Images stay images, whoever panicked while it held the lock.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ColorMessage {
    pub(super) fn stamp(&self) -> Stamp {
        match self {
            Self::Raw(image) => image.header.stamp.into(),
            Self::Compressed(image) => image.header.stamp.into(),
        }
    }

    pub(super) fn frame_id(&self) -> &str {
        match self {
            Self::Raw(image) => &image.header.frame_id,
            Self::Compressed(image) => &image.header.frame_id,
        }
    }

    pub(super) fn decoded(&self) -> Result<RgbImage, ConvertError> {
        match self {
            Self::Raw(image) => color_image(image),
            Self::Compressed(image) => compressed_color_image(image),
        }
    }
}
