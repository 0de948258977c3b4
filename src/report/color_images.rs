//! Colour images on their way to the pictures that are made of them.

use crate::{
    msg::convert::{ColorMessage, RgbImage},
    time::Stamp,
};
use std::{collections::VecDeque, rc::Rc};

/// Colour images that wait for their depth image and boxes, at most.
const MAX_WAITING: usize = 64;
/// An image is of the same moment as a depth image if their stamps differ by less (s).
const SAME_MOMENT_S: f64 = 0.05;

/// The colour images of a run until their keyframes have come. An image is decoded when the first one asks for it, and once.
#[derive(Debug, Default)]
pub struct ColorImages {
    waiting: VecDeque<ColorMessage>,
    /// The moment that was last asked for.
    latest: Option<Moment>,
    tally: Tally,
}

#[derive(Debug)]
struct Moment {
    stamp: Stamp,
    message: Option<ColorMessage>,
    /// Once it was tried; nothing if it cannot be decoded.
    decoded: Option<Option<Rc<RgbImage>>>,
}

/// What became of the colour images that were asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) used: usize,
    pub(super) absent: usize,
    pub(super) unusable: usize,
    /// Of the first that could not be used.
    pub(super) why: Option<String>,
}

impl ColorImages {
    /// Takes note of a colour image.
    pub fn hear(&mut self, image: ColorMessage) {
        if self.waiting.len() == MAX_WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(image);
    }

    /// The image of a moment as it came.
    pub fn message(&mut self, stamp: Stamp) -> Option<&ColorMessage> {
        self.moment(stamp).message.as_ref()
    }

    /// The picture of a moment. Why there is none is counted.
    pub fn decoded(&mut self, stamp: Stamp) -> Option<Rc<RgbImage>> {
        let moment = self.moment(stamp);
        if let Some(decoded) = &moment.decoded {
            return decoded.clone();
        }
        let result = moment.message.as_ref()?.decoded().map(Rc::new);
        moment.decoded = Some(result.as_ref().ok().cloned());
        match result {
            Ok(image) => Some(image),
            Err(problem) => {
                self.cannot_use(problem.to_string());
                None
            }
        }
    }

    /// Whether the picture of a moment is at hand, or is known not to be one.
    pub(super) fn is_decoded(&self, stamp: Stamp) -> bool {
        let moment = self.latest.as_ref().filter(|moment| moment.stamp == stamp);
        moment.is_some_and(|moment| moment.decoded.is_some())
    }

    /// Takes note that an image cannot be used.
    pub(super) fn cannot_use(&mut self, why: String) {
        self.tally.unusable += 1;
        self.tally.why.get_or_insert(why);
    }

    /// Nobody asks for a moment up to this one any more.
    pub fn forget_until(&mut self, stamp: Stamp) {
        self.waiting.retain(|image| image.stamp() > stamp);
    }

    pub(super) fn into_tally(self) -> Tally {
        self.tally
    }

    fn moment(&mut self, stamp: Stamp) -> &mut Moment {
        let latest = self.latest.take().filter(|moment| moment.stamp == stamp);
        let latest = latest.unwrap_or_else(|| self.look_up(stamp));
        self.latest.insert(latest)
    }

    fn look_up(&mut self, stamp: Stamp) -> Moment {
        let away = |image: &ColorMessage| image.stamp().seconds_since(stamp).abs();
        let nearest = self.waiting.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let message = nearest.filter(|image| away(image) < SAME_MOMENT_S).cloned();
        let count = if message.is_some() { &mut self.tally.used } else { &mut self.tally.absent };
        *count += 1;
        Moment { stamp, message, decoded: None }
    }
}
