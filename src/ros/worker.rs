//! The one thread that owns the core.

use super::{
    outputs::Outputs,
    perceiver::Job,
    status::{Shared, now},
};
use crate::{
    config::Parameters,
    geometry::Pose,
    mapping::SavedMap,
    msg::ellipsoid_slam::{QueryObjectsRequest, QueryObjectsResponse},
    pipeline::{ObjectSlam, Update},
    time::Stamp,
};
use std::{
    path::{Path, PathBuf},
    sync::mpsc::Receiver,
    time::Duration,
};
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
    /// Put the map of a file in place of this one; empty: the parameter `map.file`. How many objects it has.
    Load(String, oneshot::Sender<Result<u32, String>>),
    /// Look objects up.
    Query(Box<QueryObjectsRequest>, oneshot::Sender<QueryObjectsResponse>),
    /// Parameters changed.
    Settings(Box<Parameters>),
}

/// Maps of files. Handed in, because files are the shell's business; what goes wrong is said in a sentence.
pub struct MapFiles {
    /// The map that the node begins with.
    pub at_start: Option<SavedMap>,
    /// Reads a file.
    pub load: LoadMap,
    /// Writes a file.
    pub save: SaveMap,
}

/// Reads the map of a file.
pub type LoadMap = Box<dyn FnMut(&Path) -> Result<SavedMap, String> + Send>;
/// Writes a map into a file.
pub type SaveMap = Box<dyn FnMut(&Path, &SavedMap) -> Result<(), String> + Send>;

/// The core with what surrounds it on its thread.
pub(super) struct Worker {
    pub(super) slam: ObjectSlam,
    pub(super) parameters: Parameters,
    pub(super) outputs: Outputs,
    pub(super) jobs: Receiver<Job>,
    pub(super) status: Shared,
    pub(super) files: MapFiles,
}

impl Worker {
    /// Works until nothing more is perceived; saves the map then, if a parameter says so.
    pub(super) fn run(mut self) {
        if let Some(saved) = self.files.at_start.take() {
            let start = self.parameters.node.map.start_pose.map_from_base();
            self.begin_with(saved, start);
        }
        while let Ok(job) = self.jobs.recv() {
            match job {
                Job::Hear(input) => self.outputs.hear(&input),
                Job::Join(perceived, perceiving) => {
                    let started = now();
                    let update = self.slam.join(perceived, &mut ());
                    self.outputs.publish(&update, &self.slam);
                    self.status.worked(&update, &self.slam, perceiving + (now() - started));
                }
                Job::Obey(command) => self.obey(command),
            }
        }
        let update = self.slam.finish(&mut ());
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
                self.status.lock().paused = paused;
                let said = if paused { "paused" } else { "going on" };
                (answer, Ok(said.into()))
            }
            Command::Save(path, answer) => (answer, self.save(&path)),
            Command::Load(path, answer) => {
                let _ = answer.send(self.load(&path));
                return;
            }
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
        self.begin(ObjectSlam::new(self.parameters.slam.clone()));
        Ok(format!("{was} objects forgotten"))
    }

    /// A saved map, once the place in it is recognised.
    fn begin_with(&mut self, saved: SavedMap, start: Option<Pose>) {
        tracing::info!("a map of {} objects is loaded", saved.objects.len());
        self.begin(ObjectSlam::continuing(self.parameters.slam.clone(), saved, start));
    }

    fn begin(&mut self, slam: ObjectSlam) {
        self.slam = slam;
        self.outputs.reset(self.now(), &self.slam);
        self.status.worked(&Update::default(), &self.slam, Duration::ZERO);
    }

    /// The present of the data that the map is made of.
    fn now(&self) -> Stamp {
        let status = self.status.lock();
        status.present.unwrap_or_else(|| status.ros_time())
    }

    fn save(&mut self, given: &str) -> Result<String, String> {
        let path = self.path(given)?;
        let seen = SavedMap::of(self.slam.objects(), &self.parameters.node.map_frame);
        let count = seen.objects.len();
        let Some(waiting) = self.slam.waiting() else {
            (self.files.save)(&path, &seen)?;
            return Ok(format!("{count} objects saved in {}", path.display()));
        };
        // The two maps are in frames of their own: neither may be lost for the other.
        let local = path.with_file_name(LOCAL_MAP);
        (self.files.save)(&path, waiting.saved())?;
        (self.files.save)(&local, &SavedMap { frame_id: "local_map".into(), ..seen })?;
        Ok(format!(
            "the place in the loaded map was not recognised ({}): that map is saved in {} as it was, \
             and {count} objects seen since in {}",
            waiting.why(),
            path.display(),
            local.display()
        ))
    }

    fn load(&mut self, given: &str) -> Result<u32, String> {
        let path = self.path(given)?;
        let saved = (self.files.load)(&path)?;
        let count = u32::try_from(saved.objects.len()).unwrap_or(u32::MAX);
        // The robot has moved since it was started.
        self.begin_with(saved, None);
        Ok(count)
    }

    fn path(&self, given: &str) -> Result<PathBuf, String> {
        let path = if given.is_empty() { &self.parameters.node.map.file } else { given };
        if path.is_empty() {
            return Err("no path was given, and the parameter map.file is empty".into());
        }
        Ok(PathBuf::from(path))
    }
}

/// Beside the loaded map, as `replay` names it.
const LOCAL_MAP: &str = "local_map.json";
