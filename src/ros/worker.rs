//! The one thread that owns the core.

use super::{
    broadcast::Correction,
    inbox::{Inbox, Work},
    outputs::Outputs,
    status::{Shared, now},
};
use crate::{
    config::Parameters,
    perception::{Stage, StageObserver},
    pipeline::{ObjectSlam, Update},
};
use std::{path::Path, sync::Arc};
use tokio::sync::{oneshot, watch};

/// What was done, or why not.
pub(super) type Answer = oneshot::Sender<Result<String, String>>;

/// What a service asks of the worker.
pub(super) enum Command {
    /// Forget everything.
    Reset(Answer),
    /// Stop or go on working on messages.
    Pause(bool, Answer),
    /// Write the map to a file; empty: the parameter `map.file`.
    Save(String, Answer),
    /// Parameters changed.
    Settings(Box<Parameters>),
}

/// Writes a map into a file. Handed in, because files are the shell's business.
pub type SaveMap = Box<dyn FnMut(&ObjectSlam, &Path) -> Result<(), String> + Send>;

/// The core with what surrounds it on its thread.
pub(super) struct Worker {
    pub(super) slam: ObjectSlam,
    pub(super) parameters: Parameters,
    pub(super) outputs: Outputs,
    pub(super) inbox: Arc<Inbox>,
    pub(super) status: Shared,
    pub(super) correction: watch::Sender<Option<Correction>>,
    pub(super) save_map: SaveMap,
    pub(super) paused: bool,
}

impl Worker {
    /// Works until the inbox is closed and empty; saves the map then, if a parameter says so.
    pub(super) fn run(mut self) {
        while let Some(work) = self.inbox.take() {
            match work {
                Work::Input(_) if self.paused => (),
                Work::Input(input) => {
                    let started = now();
                    let update = self.slam.handle(input, &mut Unobserved);
                    self.take(&update);
                    let objects = self.slam.objects().count();
                    self.status.worked(&update, objects, now() - started);
                }
                Work::Command(command) => self.obey(command),
            }
        }
        let update = self.slam.finish(&mut Unobserved);
        self.take(&update);
        if self.parameters.node.map.save_on_shutdown {
            match self.save("") {
                Ok(done) => tracing::info!("{done}"),
                Err(why) => tracing::error!("the map was not saved: {why}"),
            }
        }
    }

    fn take(&mut self, update: &Update) {
        self.outputs.publish(update, &self.slam);
        if let Some(pose) = update.poses.last() {
            let (odom_frame, _) = self.slam.frames();
            self.correction.send_replace(Some(Correction {
                odom_frame: odom_frame.to_owned(),
                map_from_odom: pose.map_from_base * pose.odom_from_base.inverse(),
            }));
        }
    }

    fn obey(&mut self, command: Command) {
        let (answer, outcome) = match command {
            Command::Reset(answer) => (answer, self.reset()),
            Command::Pause(paused, answer) => {
                self.paused = paused;
                self.status.lock().paused = paused;
                let said = if paused { "paused" } else { "going on" };
                (answer, Ok(said.into()))
            }
            Command::Save(path, answer) => (answer, self.save(&path)),
            Command::Settings(parameters) => {
                self.slam.change_settings(parameters.slam.clone());
                self.parameters = *parameters;
                return;
            }
        };
        // Who asked may have gone away: that is no concern of the map.
        let _ = answer.send(outcome);
    }

    fn reset(&mut self) -> Result<String, String> {
        let was = self.slam.objects().count();
        self.slam = ObjectSlam::new(self.parameters.slam.clone());
        self.correction.send_replace(None);
        self.outputs.clear(self.status.lock().ros_time());
        self.status.lock().objects = 0;
        Ok(format!("{was} objects forgotten"))
    }

    fn save(&mut self, given: &str) -> Result<String, String> {
        let path = if given.is_empty() { &self.parameters.node.map.file } else { given };
        if path.is_empty() {
            return Err("no path was given, and the parameter map.file is empty".into());
        }
        (self.save_map)(&self.slam, Path::new(path))?;
        Ok(format!("{} objects saved in {path}", self.slam.objects().count()))
    }
}

/// Nobody times the stages here: diagnostics have the time of whole keyframes.
struct Unobserved;

impl StageObserver for Unobserved {
    fn enter(&mut self, _: Option<Stage>) {}
}
