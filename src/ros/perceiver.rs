//! The thread ahead of the worker's: it perceives, so that images do not wait while the graph works.

use super::{
    inbox::{Inbox, Work},
    jobs::{Ended, Jobs},
    status::now,
};
use crate::pipeline::{CameraMessage, CameraRole, FrontEnd, Input, Perceived};
use std::{sync::Arc, time::Duration};

/// What the worker does with what was perceived, in the order in which the messages came.
pub(super) enum Job {
    /// Join what was perceived, which took so long.
    Join(Perceived, Duration),
    /// Take note of an input that outputs follow from.
    Hear(Input),
}

/// The front end with what surrounds it on its thread.
pub(super) struct Perceiver {
    front_end: FrontEnd,
    inbox: Arc<Inbox>,
    jobs: Arc<Jobs>,
    /// The colour camera as the worker knows it: outputs follow from it.
    camera: Option<CameraMessage>,
}

impl Perceiver {
    pub(super) fn new(front_end: FrontEnd, inbox: Arc<Inbox>, jobs: Arc<Jobs>) -> Self {
        Self { front_end, inbox, jobs, camera: None }
    }

    /// Works until the inbox is closed and empty, or the worker takes nothing more.
    pub(super) fn run(mut self) {
        while let Some(work) = self.inbox.take() {
            let done = match work {
                Work::Input(input) => self.perceive(input),
                Work::Settings(settings) => {
                    self.front_end.change_settings(*settings);
                    Ok(())
                }
            };
            if done.is_err() {
                return;
            }
        }
        let started = now();
        let last = self.front_end.finish(&mut ());
        // A worker that has ended misses nothing.
        let _ = self.join(last, now() - started);
        self.jobs.complete();
    }

    fn perceive(&mut self, input: Input) -> Result<(), Ended> {
        if let Input::Camera(camera) = &input
            && camera.role == CameraRole::Color
            && !self.camera.as_ref().is_some_and(|known| is_same(known, camera))
        {
            self.camera = Some(camera.clone());
            self.jobs.give(Job::Hear(input.clone()))?;
        }
        let started = now();
        let perceived = self.front_end.take(input, &mut ());
        self.join(perceived, now() - started)
    }

    fn join(&self, perceived: Perceived, took: Duration) -> Result<(), Ended> {
        if perceived.is_empty() { Ok(()) } else { self.jobs.give(Job::Join(perceived, took)) }
    }
}

/// Whether only their stamps differ.
fn is_same(a: &CameraMessage, b: &CameraMessage) -> bool {
    (&a.frame_id, &a.camera) == (&b.frame_id, &b.camera)
}
