//! The thread ahead of the worker's: it perceives, so that images do not wait while the graph works.

use super::{
    inbox::{Inbox, Work},
    status::now,
    worker::Command,
};
use crate::pipeline::{CameraMessage, CameraRole, FrontEnd, Input, Perceived};
use std::{
    sync::{Arc, mpsc::SyncSender},
    time::Duration,
};

/// What the worker does next, in the order in which the messages came.
pub(super) enum Job {
    /// Join what was perceived, which took so long.
    Join(Perceived, Duration),
    /// Take note of an input that outputs follow from.
    Hear(Input),
    /// A service asked for it.
    Obey(Command),
}

/// Three seconds of depth at 30 Hz. As many of them hold an image, of 1.2 MB, as the detector has looked at. Where the worker
/// is further behind, perception waits for it, and the inbox drops the oldest images.
pub(super) const MOST_JOBS: usize = 90;

/// The front end with what surrounds it on its thread.
pub(super) struct Perceiver {
    front_end: FrontEnd,
    inbox: Arc<Inbox>,
    jobs: SyncSender<Job>,
    paused: bool,
    /// The colour camera as the worker knows it: outputs follow from it.
    camera: Option<CameraMessage>,
}

/// The worker has ended.
struct Alone;

impl Perceiver {
    pub(super) fn new(front_end: FrontEnd, inbox: Arc<Inbox>, jobs: SyncSender<Job>) -> Self {
        Self { front_end, inbox, jobs, paused: false, camera: None }
    }

    /// Works until the inbox is closed and empty, or there is no worker any more.
    pub(super) fn run(mut self) {
        while let Some(work) = self.inbox.take() {
            let done = match work {
                Work::Input(_) if self.paused => Ok(()),
                Work::Input(input) => self.perceive(input),
                Work::Command(command) => self.pass_on(command),
            };
            if done.is_err() {
                return;
            }
        }
        let started = now();
        let last = self.front_end.finish(&mut ());
        // A worker that has ended misses nothing.
        let _ = self.join(last, now() - started);
    }

    fn perceive(&mut self, input: Input) -> Result<(), Alone> {
        if let Input::Camera(camera) = &input
            && camera.role == CameraRole::Color
            && !self.camera.as_ref().is_some_and(|known| is_same(known, camera))
        {
            self.camera = Some(camera.clone());
            self.give(Job::Hear(input.clone()))?;
        }
        let started = now();
        let perceived = self.front_end.take(input, &mut ());
        self.join(perceived, now() - started)
    }

    /// What concerns messages is obeyed here as well; calibrations and transforms outlive a map.
    fn pass_on(&mut self, command: Command) -> Result<(), Alone> {
        match &command {
            Command::Pause(paused, _) => self.paused = *paused,
            Command::Settings(parameters) => {
                self.front_end.change_settings(parameters.slam.clone());
            }
            _ => (),
        }
        self.give(Job::Obey(command))
    }

    fn join(&self, perceived: Perceived, took: Duration) -> Result<(), Alone> {
        if perceived.is_empty() { Ok(()) } else { self.give(Job::Join(perceived, took)) }
    }

    fn give(&self, job: Job) -> Result<(), Alone> {
        self.jobs.send(job).map_err(|_| Alone)
    }
}

/// Whether only their stamps differ.
fn is_same(a: &CameraMessage, b: &CameraMessage) -> bool {
    (&a.frame_id, &a.camera) == (&b.frame_id, &b.camera)
}
