//! What waits for the worker: bounded, and what does not fit any more is counted.

use super::worker::Command;
use crate::pipeline::Input;
use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

/// Something for the worker.
pub(super) enum Work {
    /// A message.
    Input(Input),
    /// What a service asked for.
    Command(Command),
}

/// A queue between the subscriptions and perception.
pub(super) struct Inbox {
    state: Mutex<State>,
    arrived: Condvar,
    most_depth: usize,
}

struct State {
    waiting: VecDeque<Work>,
    dropped: Overflow,
    closed: bool,
}

/// Messages that were dropped because the worker was behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Overflow {
    /// Depth images.
    pub(super) depth: u64,
    /// Other messages.
    pub(super) other: u64,
}

/// Odometry, transforms and boxes are small, but a worker that hangs must not eat all memory.
const MOST_OTHERS: usize = 20_000;

impl Inbox {
    pub(super) fn new(most_depth: usize) -> Self {
        let state = State { waiting: VecDeque::new(), dropped: Overflow::default(), closed: false };
        Self { state: Mutex::new(state), arrived: Condvar::new(), most_depth }
    }

    /// Adds a message. When there are too many depth images, the oldest goes.
    pub(super) fn put(&self, input: Input) {
        let mut state = self.lock();
        let is_depth = matches!(input, Input::Depth(_));
        let most = if is_depth { self.most_depth } else { MOST_OTHERS };
        let same = |work: &Work| matches!(work, Work::Input(Input::Depth(_))) == is_depth;
        if state.waiting.iter().filter(|work| same(work)).count() >= most
            && let Some(oldest) = state.waiting.iter().position(same)
        {
            state.waiting.remove(oldest);
            let dropped = &mut state.dropped;
            *if is_depth { &mut dropped.depth } else { &mut dropped.other } += 1;
        }
        state.waiting.push_back(Work::Input(input));
        self.arrived.notify_one();
    }

    /// Adds what a service asked for; its turn comes after the messages that are there already.
    pub(super) fn order(&self, command: Command) {
        self.lock().waiting.push_back(Work::Command(command));
        self.arrived.notify_one();
    }

    /// No more will be added: the worker ends when it has worked off what is there.
    pub(super) fn close(&self) {
        self.lock().closed = true;
        self.arrived.notify_all();
    }

    /// The oldest entry; waits for one. Nothing when the inbox was closed and is empty.
    pub(super) fn take(&self) -> Option<Work> {
        let mut state = self.lock();
        loop {
            if let Some(work) = state.waiting.pop_front() {
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
