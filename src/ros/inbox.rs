//! What waits for perception: bounded, and what does not fit any more is counted.

use crate::pipeline::{Input, Settings};
use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

/// Something for perception.
pub(super) enum Work {
    /// A message.
    Input(Input),
    /// Parameters changed: from now on these count.
    Settings(Box<Settings>),
}

/// A queue between the subscriptions and perception.
pub(super) struct Inbox {
    state: Mutex<State>,
    arrived: Condvar,
    most_depth: usize,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<Work>,
    depth: usize,
    bytes: usize,
    dropped: Overflow,
    paused: bool,
    /// Whether the node is active, as its manager has it.
    active: bool,
    closed: bool,
}

/// Messages that were dropped because perception was behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Overflow {
    /// Depth images.
    pub(super) depth: u64,
    /// Other messages.
    pub(super) other: u64,
}

/// Odometry, transforms and boxes are small, but perception that hangs must not eat all memory.
const MOST_OTHERS: usize = 20_000;
/// Of all that waits: ten depth images of four megapixels and what comes with them.
const MOST_BYTES: usize = 96 << 20;

impl Inbox {
    pub(super) fn new(most_depth: usize) -> Self {
        Self { state: Mutex::default(), arrived: Condvar::new(), most_depth }
    }

    /// Adds a message. When there are too many of its kind, the oldest of them goes; when all are too large together, the
    /// oldest depth image goes, and where there is none, the message itself. While perception pauses, and while the node is
    /// not active, images and boxes are not kept.
    pub(super) fn put(&self, input: Input) {
        let mut state = self.lock();
        let is_depth = matches!(input, Input::Depth(_));
        let rests = state.paused || !state.active;
        if state.closed || rests && is_seen(&input) {
            return;
        }
        let (there, most) = if is_depth {
            (state.depth, self.most_depth)
        } else {
            (state.waiting.len() - state.depth, MOST_OTHERS)
        };
        if there >= most {
            state.drop_oldest(is_depth);
        }
        while state.bytes + input.bytes() > MOST_BYTES {
            if !state.drop_oldest(true) {
                state.dropped.count(is_depth);
                return;
            }
        }
        state.depth += usize::from(is_depth);
        state.bytes += input.bytes();
        state.waiting.push_back(Work::Input(input));
        self.arrived.notify_one();
    }

    /// From now on these settings count.
    pub(super) fn change_settings(&self, settings: Settings) {
        self.lock().waiting.push_back(Work::Settings(Box::new(settings)));
        self.arrived.notify_one();
    }

    /// Whether images and boxes that come are dropped. Odometry, transforms and calibrations are taken: what was sent once
    /// is not sent again, and where the robot goes meanwhile has to be known.
    pub(super) fn pause(&self, paused: bool) {
        self.lock().paused = paused;
    }

    /// The same for a node that begins or ceases to be active. It begins by not being so.
    pub(super) fn activate(&self, active: bool) {
        self.lock().active = active;
    }

    /// Drops the images and boxes that wait: they are of another map or state.
    pub(super) fn drop_images(&self) {
        let mut state = self.lock();
        let state = &mut *state;
        state.waiting.retain(|work| {
            let Work::Input(input) = work else { return true };
            let stays = !is_seen(input);
            state.bytes -= if stays { 0 } else { input.bytes() };
            stays
        });
        state.depth = 0;
    }

    /// No more will be taken: perception ends when it has worked off what is there.
    pub(super) fn close(&self) {
        self.lock().closed = true;
        self.arrived.notify_all();
    }

    /// The oldest entry; waits for one. Nothing when the inbox was closed and is empty.
    pub(super) fn take(&self) -> Option<Work> {
        let mut state = self.lock();
        loop {
            if let Some(work) = state.waiting.pop_front() {
                state.has_gone(&work);
                return Some(work);
            }
            if state.closed {
                return None;
            }
            state = self.arrived.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// What has been dropped so far.
    pub(super) fn dropped(&self) -> Overflow {
        self.lock().dropped
    }

    /// The state stays whole even where a thread panicked while it held the lock: nothing in here is left half-done.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether it is of what a camera saw.
fn is_seen(input: &Input) -> bool {
    matches!(input, Input::Depth(_) | Input::Detections(_) | Input::Detections3d(_))
}

impl State {
    /// Whether there was one.
    fn drop_oldest(&mut self, depth: bool) -> bool {
        let is_one = |work: &Work| match work {
            Work::Input(input) => matches!(input, Input::Depth(_)) == depth,
            Work::Settings(_) => false,
        };
        let oldest = self.waiting.iter().position(is_one);
        let Some(gone) = oldest.and_then(|index| self.waiting.remove(index)) else { return false };
        self.has_gone(&gone);
        self.dropped.count(depth);
        true
    }

    fn has_gone(&mut self, work: &Work) {
        let Work::Input(input) = work else { return };
        self.depth -= usize::from(matches!(input, Input::Depth(_)));
        self.bytes -= input.bytes();
    }
}

impl Overflow {
    fn count(&mut self, is_depth: bool) {
        *if is_depth { &mut self.depth } else { &mut self.other } += 1;
    }
}
