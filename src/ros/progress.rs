//! What the node says when all works: what comes in, once; each new object; a line a minute.

use super::{
    status::{InputStatus, Status},
    subscriptions::Listening,
};
use crate::{
    mapping::{MapObject, ObjectChange, ObjectId},
    pipeline::{ObjectSlam, Update},
};
use std::time::{Duration, Instant};

/// What has been said so far.
#[derive(Debug, Default)]
pub(super) struct Progress {
    inputs_told: bool,
    minute: Option<Minute>,
}

/// Counts at the latest line.
#[derive(Debug)]
struct Minute {
    began: Instant,
    keyframes: u64,
    dropped: u64,
}

/// Rates are told when everything has come for so long.
const MEASURED: Duration = Duration::from_secs(1);
const MINUTE: Duration = Duration::from_secs(60);

impl Progress {
    /// Says what has not been said yet; `overflow` is how many depth images were dropped.
    pub(super) fn say(
        &mut self,
        (listening, overflow): (&[Listening], u64),
        status: &Status,
        now: Instant,
    ) {
        if !self.inputs_told {
            let rates = rates(listening, status);
            self.inputs_told = rates.is_some();
            rates.iter().for_each(|rates| tracing::info!("all inputs come: {rates}"));
        }
        let dropped = status.dropped.values().map(|(count, _)| count).sum::<u64>() + overflow;
        let current = Minute { began: now, keyframes: status.keyframes, dropped };
        let Some(before) = &self.minute else {
            self.minute = Some(current);
            return;
        };
        if now - before.began < MINUTE {
            return;
        }
        let images = current.keyframes - before.keyframes;
        if images > 0 {
            let (objects, dropped) = (status.objects, current.dropped - before.dropped);
            let longest_ms = 1e3 * status.longest_keyframe.as_secs_f64();
            tracing::info!(
                "{objects} objects; in the last minute {images} images with boxes, {dropped} messages dropped; \
                 the longest image took {longest_ms:.0} ms"
            );
        }
        self.minute = Some(current);
    }
}

/// How often each topic comes, once all that are needed have come for long enough.
fn rates(listening: &[Listening], status: &Status) -> Option<String> {
    let mut said = Vec::new();
    for input in listening {
        match status.inputs.get(&input.topic).and_then(measured) {
            Some(rate) => said.push(format!("{} {rate:.1} Hz", input.topic)),
            // Calibrations and static transforms may come only once.
            None if input.needed && !has_come(input, status) => return None,
            None => {}
        }
    }
    (!said.is_empty()).then(|| said.join(", "))
}

fn has_come(input: &Listening, status: &Status) -> bool {
    status
        .inputs
        .get(&input.topic)
        .is_some_and(|known| known.received == 1 && known.first.zip(known.latest).is_some())
}

/// Messages a second (Hz), where they have come for long enough.
fn measured(input: &InputStatus) -> Option<f64> {
    let passed = input.latest? - input.first?;
    (passed >= MEASURED).then(|| (input.received - 1) as f64 / passed.as_secs_f64())
}

/// Says which objects are new, and which are gone.
pub(super) fn announce(update: &Update, slam: &ObjectSlam) {
    for change in &update.changes {
        match change {
            ObjectChange::Confirmed(id) => {
                let object = slam.objects().find(|object| object.id == *id);
                object.iter().for_each(|object| tracing::info!("new: {}", described(object)));
            }
            ObjectChange::Removed(ObjectId(id)) => tracing::info!("object {id} is gone"),
            ObjectChange::Merged { .. } | ObjectChange::Split { .. } => {}
        }
    }
}

fn described(object: &MapObject) -> String {
    let (body, name) = (object.ellipsoid(), object.name());
    let (at, size) = (body.center(), 2.0 * body.semi_axes);
    format!(
        "{name} {} at ({:.2}, {:.2}, {:.2}), {:.2} x {:.2} x {:.2} m",
        object.id, at.x, at.y, at.z, size.x, size.y, size.z
    )
}
