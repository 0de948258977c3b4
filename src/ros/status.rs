//! What the node knows of itself, for diagnostics.

use super::lifecycle::State;
use crate::{
    msg::{SkipCount, Skipped, convert::ConvertError},
    pipeline::{Calibration, ObjectSlam, Update},
    time::Stamp,
};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant, SystemTime},
};

/// Shared between all parts of the node.
#[derive(Clone, Debug, Default)]
pub(super) struct Shared(Arc<Mutex<Status>>);

/// What has happened so far.
#[derive(Debug, Default)]
pub(super) struct Status {
    /// By topic.
    pub(super) inputs: BTreeMap<String, InputStatus>,
    /// Messages and parts of messages that could not be used.
    pub(super) skipped: SkipCount,
    /// What the core dropped: by reason, how often and the latest sentence.
    pub(super) dropped: BTreeMap<&'static str, (u64, String)>,
    /// Keyframes so far.
    pub(super) keyframes: u64,
    /// Depth images with a pose so far.
    pub(super) frames: u64,
    /// Objects in the map.
    pub(super) objects: usize,
    /// What was learnt of the camera's mount and of the clocks.
    pub(super) calibration: Calibration,
    /// Why the place in the loaded map is not recognised yet.
    pub(super) unrecognised: Option<String>,
    /// How long the worker took for the latest keyframe, and the longest since it was asked for.
    pub(super) keyframe_time: Duration,
    pub(super) longest_keyframe: Duration,
    /// Stamp of the latest reading of odometry or image: the data's present.
    pub(super) present: Option<Stamp>,
    /// Nothing is worked on.
    pub(super) paused: bool,
    /// Of the node as its manager knows it.
    pub(super) state: State,
    /// What `/clock` says, for a node that follows it.
    pub(super) sim_time: Option<Stamp>,
    /// The latest time that the data's time went back.
    pub(super) jump: Option<Jump>,
}

/// The data's time went back.
#[derive(Clone, Debug)]
pub(super) struct Jump {
    pub(super) count: u64,
    pub(super) topic: String,
    back_s: f64,
}

/// One input topic.
#[derive(Clone, Debug, Default)]
pub(super) struct InputStatus {
    pub(super) received: u64,
    pub(super) first: Option<Instant>,
    pub(super) latest: Option<Instant>,
    pub(super) stamp: Option<Stamp>,
}

impl Shared {
    pub(super) fn lock(&self) -> MutexGuard<'_, Status> {
        // Counters stay counters, whoever panicked while it held the lock.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The present of the data that the map is made of.
    pub(super) fn present(&self) -> Stamp {
        let status = self.lock();
        status.present.unwrap_or_else(|| status.ros_time())
    }

    /// A message came.
    pub(super) fn received(&self, topic: &str, stamp: Option<Stamp>, is_present: bool) {
        let mut status = self.lock();
        if is_present && let Some(stamp) = stamp {
            status.move_present(topic, stamp);
        }
        let input = status.inputs.entry(topic.to_owned()).or_default();
        input.received += 1;
        input.latest = Some(now());
        input.first = input.first.or(input.latest);
        input.stamp = stamp;
    }

    /// A message, or a part of one, could not be used.
    pub(super) fn skipped(&self, topic: &str, why: ConvertError) {
        let skipped = Skipped { topic: topic.to_owned(), why };
        let mut status = self.lock();
        status.skipped.add(skipped);
    }

    /// The worker has worked.
    pub(super) fn worked(&self, update: &Update, slam: &ObjectSlam, took: Duration) {
        let mut status = self.lock();
        status.objects = slam.objects().count();
        status.unrecognised = slam.waiting().map(|waiting| waiting.why().to_string());
        if update.relocalised.is_some() {
            tracing::info!("the place in the loaded map is recognised");
        }
        status.frames += update.poses.len() as u64;
        status.keyframes += (update.keyframes.len() + update.keyframes_3d.len()) as u64;
        if let Some(keyframe) = update.keyframes.last() {
            status.calibration = keyframe.calibration;
            status.keyframe_time = took;
            status.longest_keyframe = status.longest_keyframe.max(took);
        }
        for dropped in &update.dropped {
            let entry = status.dropped.entry(dropped.reason).or_default();
            entry.0 += 1;
            entry.1.clone_from(&dropped.why);
        }
    }
}

impl Status {
    /// What time it is for ROS.
    pub(super) fn ros_time(&self) -> Stamp {
        self.sim_time.unwrap_or_else(system_time)
    }

    fn move_present(&mut self, topic: &str, stamp: Stamp) {
        let back_s = self.present.map_or(0.0, |present| present.seconds_since(stamp));
        if back_s >= JUMP_S {
            let count = self.jump.as_ref().map_or(0, |jump| jump.count) + 1;
            self.jump = Some(Jump { count, topic: topic.to_owned(), back_s });
        }
        self.present = Some(stamp);
    }
}

impl Jump {
    pub(super) fn what(&self) -> String {
        format!(
            "the stamps of {} went back by {:.1} s: what waited for its partners was dropped, the map is kept",
            self.topic, self.back_s
        )
    }
}

/// Stamps of two topics may differ by the time that an image takes; more is a restart.
const JUMP_S: f64 = 1.0;

#[expect(clippy::disallowed_methods, reason = "a shell reads the clock; the core does not")]
pub(super) fn system_time() -> Stamp {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    Stamp::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

/// The node is a shell: it may read the clock.
#[expect(clippy::disallowed_methods, reason = "a shell measures time; the core does not")]
pub(super) fn now() -> Instant {
    Instant::now()
}
