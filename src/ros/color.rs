//! The latest colour images, until boxes come that were found in one of them.

use crate::{
    msg::convert::{ColorMessage, RgbImage},
    time::Stamp,
};
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

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
