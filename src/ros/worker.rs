//! The one thread that owns the core.

use super::{
    inbox::{Inbox, Work},
    outputs::Outputs,
    status::{Shared, now},
};
use crate::{
    config::Parameters,
    msg::ellipsoid_slam::{QueryObjectsRequest, QueryObjectsResponse},
    perception::{Stage, StageObserver},
    pipeline::ObjectSlam,
    time::Stamp,
};
use std::{path::Path, sync::Arc};
use tokio::sync::oneshot;

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
    /// Look objects up.
    Query(Box<QueryObjectsRequest>, oneshot::Sender<QueryObjectsResponse>),
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
                    self.outputs.hear(&input);
                    let update = self.slam.handle(input, &mut Unobserved);
                    self.outputs.publish(&update, &self.slam);
                    let objects = self.slam.objects().count();
                    self.status.worked(&update, objects, now() - started);
                }
                Work::Command(command) => self.obey(command),
            }
        }
        let update = self.slam.finish(&mut Unobserved);
        self.outputs.publish(&update, &self.slam);
        self.outputs.finish(&self.slam);
        if self.parameters.node.map.save_on_shutdown {
            match self.save("") {
                Ok(done) => tracing::info!("{done}"),
                Err(why) => tracing::error!("the map was not saved: {why}"),
            }
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
            Command::Query(request, answer) => {
                let response = self.outputs.query(&request, &self.slam, self.now());
                let _ = answer.send(response);
                return;
            }
            Command::Settings(parameters) => {
                self.outputs.change_settings(parameters.node.publish);
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
        self.outputs.reset(self.now(), &self.slam);
        self.status.lock().objects = 0;
        Ok(format!("{was} objects forgotten"))
    }

    /// The present of the data that the map is made of.
    fn now(&self) -> Stamp {
        let status = self.status.lock();
        status.present.unwrap_or_else(|| status.ros_time())
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
