//! The one thread that owns the core.

use super::{
    jobs::{Jobs, Next},
    lifecycle::State,
    outputs::{Known, Outputs},
    perceiver::Job,
    progress::announce,
    status::{Shared, now},
};
use crate::{
    config::Parameters,
    geometry::Pose,
    mapping::{Edit, ObjectId, SavedMap},
    pipeline::{MapsToSave, ObjectSlam, Perceived, Update},
};
use std::{sync::Arc, time::Duration};
use tokio::sync::{oneshot, watch};

/// What was done, or why not.
pub(super) type Answer = oneshot::Sender<Result<String, String>>;

/// What a service asks of the worker.
pub(super) enum Command {
    /// Forget everything.
    Reset(Answer),
    /// Be in another state: unconfigured, inactive or active.
    Enter(State, Answer),
    /// Stop or go on working on images.
    Pause(bool, Answer),
    /// What there is to save.
    Maps(oneshot::Sender<MapsToSave>),
    /// Put a map in place of this one.
    Begin(SavedMap, Answer),
    /// Somebody says where the base is in the loaded map.
    Place(Pose),
    /// Change an object.
    Edit(Edit, oneshot::Sender<Result<ObjectId, String>>),
    /// Parameters changed.
    Settings(Box<Parameters>),
}

/// Maps of files. Handed in, because files are the shell's business; what goes wrong is said in a sentence. Both may take as
/// long as a disk does, and are called on threads that may wait.
#[derive(Clone)]
pub struct MapFiles {
    /// Reads the map of a name; of an empty one, that of the parameter `map.file`.
    pub load: LoadMap,
    /// Writes maps under a name; what was done.
    pub save: SaveMaps,
}

/// Reads the map of a name.
pub type LoadMap = Arc<dyn Fn(&str) -> Result<SavedMap, String> + Send + Sync>;
/// Writes maps under a name.
pub type SaveMaps = Arc<dyn Fn(&str, &MapsToSave) -> Result<String, String> + Send + Sync>;

/// The core with what surrounds it on its thread.
pub(super) struct Worker {
    pub(super) slam: ObjectSlam,
    pub(super) parameters: Parameters,
    pub(super) outputs: Outputs,
    pub(super) jobs: Arc<Jobs>,
    pub(super) status: Shared,
    /// Which the node has, or had when it was told to end.
    pub(super) state: State,
    /// The map that the node begins with.
    pub(super) at_start: Option<SavedMap>,
    pub(super) save: SaveMaps,
    /// What services tell of the map.
    pub(super) known: watch::Sender<Arc<Known>>,
}

impl Worker {
    /// Works until nothing more is perceived; saves the map then, if a parameter says so.
    pub(super) fn run(mut self) {
        if let Some(saved) = self.at_start.take() {
            let start = self.parameters.node.map.start_pose.map_from_base();
            self.begin_with(saved, start);
        }
        while let Some(next) = self.jobs.take() {
            match next {
                Next::Obey(command) => self.obey(command),
                Next::Work(Job::Hear(input)) => self.outputs.hear(&input),
                Next::Work(Job::Join(perceived, took)) => self.join(perceived, took),
            }
        }
        let update = self.slam.finish(&mut ());
        // Whoever ends the node may not wait for long: the map is worth more than the last messages.
        if let Err(why) = self.save_at_end() {
            tracing::error!("{why}");
        }
        self.outputs.publish(&update, &self.slam);
        self.outputs.finish(&self.slam);
    }

    fn join(&mut self, perceived: Perceived, perceiving: Duration) {
        // An image may still have been in work when the node was deactivated.
        if self.state != State::Active {
            return;
        }
        let started = now();
        let update = self.slam.join(perceived, &mut ());
        announce(&update, &self.slam);
        self.outputs.publish(&update, &self.slam);
        self.status.worked(&update, &self.slam, perceiving + (now() - started));
        if !(update.keyframes.is_empty() && update.keyframes_3d.is_empty()) {
            self.tell();
        } else if !update.poses.is_empty() {
            let base = self.outputs.base(&self.slam);
            self.known.send_modify(|known| Arc::make_mut(known).whereabouts.base = base);
        }
    }

    /// Saves the map of a run that ends, if a parameter says so. An unconfigured node has none: that of the run before, which
    /// is saved, must not be overwritten.
    fn save_at_end(&self) -> Result<(), String> {
        if self.state == State::Unconfigured || !self.parameters.node.map.save_on_shutdown {
            return Ok(());
        }
        let done = (self.save)("", &self.slam.maps(&self.parameters.node.map_frame))
            .map_err(|why| format!("the map was not saved: {why}"))?;
        tracing::info!("{done}");
        Ok(())
    }

    fn obey(&mut self, command: Command) {
        let (answer, outcome) = match command {
            Command::Reset(answer) => (answer, self.reset()),
            Command::Enter(state, answer) => (answer, self.enter(state)),
            Command::Pause(paused, answer) => {
                self.status.lock().paused = paused;
                let said = if paused { "paused" } else { "going on" };
                (answer, Ok(said.into()))
            }
            Command::Maps(answer) => {
                let _ = answer.send(self.slam.maps(&self.parameters.node.map_frame));
                return;
            }
            Command::Begin(saved, answer) => {
                // The robot has moved since it was started.
                self.begin_with(saved, None);
                (answer, Ok(String::new()))
            }
            Command::Edit(edit, answer) => {
                let _ = answer.send(self.edit(&edit));
                return;
            }
            Command::Place(map_from_base) => {
                self.place(&map_from_base);
                return;
            }
            Command::Settings(parameters) => {
                self.outputs.change_settings(&parameters.node);
                self.slam.change_settings(parameters.slam.clone());
                self.parameters = *parameters;
                return;
            }
        };
        // Who asked may have gone away: that is no concern of the map.
        let _ = answer.send(outcome);
    }

    fn place(&mut self, map_from_base: &Pose) {
        let seen_from_base = self.outputs.base(&self.slam);
        let [x, y, _]: [f64; 3] = map_from_base.translation.vector.into();
        if !self.slam.place(map_from_base, seen_from_base) {
            tracing::warn!(
                "an initial pose is of use only where a map is loaded whose place is not recognised yet"
            );
            return;
        }
        tracing::info!("the place in the loaded map is looked for about ({x:.2}, {y:.2})");
        self.outputs.edited(self.status.present(), &self.slam);
        self.tell();
    }

    fn edit(&mut self, edit: &Edit) -> Result<ObjectId, String> {
        let now = self.status.present();
        let id = self.slam.edit(edit, now).map_err(|why| why.to_string())?;
        tracing::info!("object {id} {edit}");
        self.outputs.edited(now, &self.slam);
        self.status.worked(&Update::default(), &self.slam, Duration::ZERO);
        self.tell();
        Ok(id)
    }

    /// Lets services know the map as it is now.
    fn tell(&self) {
        self.known.send_replace(Arc::new(self.outputs.known(&self.slam)));
    }

    /// A node that is cleaned up ends a run: where its map cannot be saved, it stays as it is.
    fn enter(&mut self, state: State) -> Result<String, String> {
        if state == State::Unconfigured {
            self.save_at_end()?;
            self.reset()?;
        }
        self.state = state;
        self.status.lock().state = state;
        Ok(state.label().into())
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
        self.outputs.reset(self.status.present(), &self.slam);
        self.tell();
        self.status.worked(&Update::default(), &self.slam, Duration::ZERO);
    }
}
