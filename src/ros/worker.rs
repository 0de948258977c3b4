//! The one thread that owns the core.

use super::{
    broadcast::Correction,
    inbox::{Inbox, Work},
    outputs::Outputs,
    status::{Shared, now},
};
use crate::{
    perception::StageObserver,
    pipeline::{ObjectSlam, Settings, Update},
};
use std::sync::Arc;
use tokio::sync::{oneshot, watch};

/// What a service asks of the worker.
pub(super) enum Command {
    /// Forget everything.
    Reset(oneshot::Sender<()>),
    /// Stop or go on working on messages.
    Pause(bool, oneshot::Sender<()>),
}

/// The core with what surrounds it on its thread.
pub(super) struct Worker {
    pub(super) slam: ObjectSlam,
    pub(super) settings: Settings,
    pub(super) outputs: Outputs,
    pub(super) inbox: Arc<Inbox>,
    pub(super) status: Shared,
    pub(super) correction: watch::Sender<Option<Correction>>,
    pub(super) paused: bool,
}

impl Worker {
    /// Works until the inbox is closed and empty.
    pub(super) fn run(mut self) {
        while let Some(work) = self.inbox.take() {
            match work {
                Work::Input(_) if self.paused => (),
                Work::Input(input) => {
                    let started = now();
                    let update = self.slam.handle(input, &mut Unobserved);
                    self.outputs.publish(&update, &self.slam);
                    self.note(&update);
                    let objects = self.slam.objects().count();
                    self.status.worked(&update, objects, now() - started);
                }
                Work::Command(command) => self.obey(command),
            }
        }
    }

    fn note(&self, update: &Update) {
        if let Some(pose) = update.poses.last() {
            let (odom_frame, _) = self.slam.frames();
            self.correction.send_replace(Some(Correction {
                odom_frame: odom_frame.to_owned(),
                map_from_odom: pose.map_from_base * pose.odom_from_base.inverse(),
            }));
        }
    }

    fn obey(&mut self, command: Command) {
        // Who asked may have gone away: that is no concern of the map.
        match command {
            Command::Reset(done) => {
                self.slam = ObjectSlam::new(self.settings.clone());
                self.correction.send_replace(None);
                let _ = done.send(());
            }
            Command::Pause(paused, done) => {
                self.paused = paused;
                self.status.lock().paused = paused;
                let _ = done.send(());
            }
        }
    }
}

/// Nobody times the stages here: diagnostics have the time of whole keyframes.
struct Unobserved;

impl StageObserver for Unobserved {
    fn enter(&mut self, _: Option<crate::perception::Stage>) {}
}
