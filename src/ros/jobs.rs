//! What waits for the worker: what was perceived, in its order, and before that what services ask for.

use super::{perceiver::Job, status::now, worker::Command};
use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// The queue between perception and the worker.
#[derive(Default)]
pub(super) struct Jobs {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    commands: VecDeque<Command>,
    perceived: VecDeque<Job>,
    /// Nothing more is perceived.
    complete: bool,
    /// When the worker stops, whatever waits.
    end: Option<Instant>,
}

/// What the worker does next.
pub(super) enum Next {
    /// What a service asked for.
    Obey(Command),
    /// What was perceived.
    Work(Job),
}

/// The worker takes nothing more.
pub(super) struct Ended;

/// Three seconds of depth at 30 Hz. As many of them hold an image, of 1.2 MB, as the detector has looked at. Where the worker
/// is further behind, perception waits for it, and the inbox drops the oldest images.
const MOST: usize = 90;

impl Jobs {
    /// Adds what was perceived; waits for room.
    pub(super) fn give(&self, job: Job) -> Result<(), Ended> {
        let mut state = self.lock();
        while state.perceived.len() >= MOST {
            if state.end.is_some_and(|end| end <= now()) {
                return Err(Ended);
            }
            state = self.wait(state);
        }
        state.perceived.push_back(job);
        self.changed.notify_all();
        Ok(())
    }

    /// Adds what a service asks for: it is done before what waits.
    pub(super) fn order(&self, command: Command) {
        self.lock().commands.push_back(command);
        self.changed.notify_all();
    }

    /// Adds what a service asks for, and drops the images that wait: they are of another map or state.
    pub(super) fn begin_anew(&self, command: Command) {
        let mut state = self.lock();
        state.perceived.retain(|job| !matches!(job, Job::Join(..)));
        state.commands.push_back(command);
        self.changed.notify_all();
    }

    /// Nothing more is perceived: the worker ends when it has worked off what is there.
    pub(super) fn complete(&self) {
        self.lock().complete = true;
        self.changed.notify_all();
    }

    /// The worker ends after this time at the latest, or with what it is at then; what still waits is dropped.
    pub(super) fn end_within(&self, time: Duration) {
        self.lock().end = Some(now() + time);
        self.changed.notify_all();
    }

    /// The next one; waits for it. Nothing at the end.
    pub(super) fn take(&self) -> Option<Next> {
        let mut state = self.lock();
        loop {
            if state.end.is_some_and(|end| end <= now()) {
                return None;
            }
            let next = match state.commands.pop_front() {
                Some(command) => Some(Next::Obey(command)),
                None => state.perceived.pop_front().map(Next::Work),
            };
            if next.is_some() || state.complete {
                self.changed.notify_all();
                return next;
            }
            state = self.wait(state);
        }
    }

    /// Waits for a change, and for the end where there is one.
    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        match state.end {
            None => self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            Some(end) => {
                let left = end.saturating_duration_since(now());
                let waited = self.changed.wait_timeout(state, left);
                waited.unwrap_or_else(PoisonError::into_inner).0
            }
        }
    }

    /// The state stays whole even where a thread panicked while it held the lock: nothing in here is left half-done.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
