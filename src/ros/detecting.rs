//! A detector of our own, on a thread of its own: it looks at the newest colour image whenever it has time.

use super::{inbox::Inbox, status::Shared, status::now};
use crate::{
    config::NodeSettings,
    msg::convert::{ColorMessage, ConvertError, FindBoxes},
    pipeline::{DetectionsMessage, Input},
};
use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// The latest colour image that nobody has looked at yet: an older one is dropped for it.
#[derive(Default)]
pub(super) struct NewestImage {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    image: Option<Image>,
    closed: bool,
}

/// An image and its topic.
type Image = (Arc<str>, Arc<ColorMessage>);

impl NewestImage {
    pub(super) fn put(&self, topic: &Arc<str>, image: Arc<ColorMessage>) {
        self.lock().image = Some((Arc::clone(topic), image));
        self.changed.notify_one();
    }

    fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_one();
    }

    /// The newest image at `earliest` or, if there is none then, the next one. Nothing once it is closed.
    fn take(&self, earliest: Instant) -> Option<Image> {
        let mut state = self.lock();
        loop {
            let early = earliest.saturating_duration_since(now());
            if state.closed {
                return None;
            }
            state = if !early.is_zero() {
                let waited = self.changed.wait_timeout(state, early);
                waited.unwrap_or_else(PoisonError::into_inner).0
            } else if let Some(image) = state.image.take() {
                return Some(image);
            } else {
                self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
            };
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // An image stays an image, whoever panicked while it held the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The detector's thread.
pub(super) struct Detecting {
    newest: Arc<NewestImage>,
    thread: thread::JoinHandle<()>,
}

impl Detecting {
    pub(super) fn start(
        mut find: FindBoxes,
        settings: &NodeSettings,
        inbox: &Arc<Inbox>,
        status: &Shared,
    ) -> io::Result<Self> {
        let newest = Arc::new(NewestImage::default());
        let images = Arc::clone(&newest);
        let (inbox, status) = (Arc::clone(inbox), status.clone());
        let between = Duration::from_secs_f64(1.0 / settings.detector.max_hz);
        let work = move || {
            let mut earliest = now();
            while let Some((topic, image)) = images.take(earliest) {
                earliest = now() + between;
                match boxes_of(&image, &mut find) {
                    Ok(boxes) => inbox.put(Input::Detections(boxes)),
                    Err(why) => status.skipped(&topic, why),
                }
            }
        };
        let thread = thread::Builder::new().name("detector".into()).spawn(work)?;
        Ok(Self { newest, thread })
    }

    /// Where the colour images go.
    pub(super) fn newest(&self) -> Arc<NewestImage> {
        Arc::clone(&self.newest)
    }

    /// Ends after the image that it looks at, for which nobody waits: its boxes are of no use any more.
    pub(super) fn stop(self) {
        self.newest.close();
        if self.thread.is_finished() && self.thread.join().is_err() {
            tracing::error!("the detector's thread has ended by itself; its last words are above");
        }
    }
}

fn boxes_of(image: &ColorMessage, find: &mut FindBoxes) -> Result<DetectionsMessage, ConvertError> {
    let detections = find(&image.decoded()?).map_err(ConvertError::Detector)?;
    let frame_id = image.frame_id().trim_start_matches('/').to_owned();
    Ok(DetectionsMessage { stamp: image.stamp(), frame_id, detections })
}
