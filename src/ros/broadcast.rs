//! `map → odom` and the objects' frames, steadily.

use super::{lifecycle::State, status::Shared, topic::send, transport::Publisher};
use crate::{config::Parameters, msg::tf2_msgs::TFMessage};
use std::time::Duration;
use tokio::{
    sync::watch,
    time::{MissedTickBehavior, interval},
};

/// What is broadcast.
#[derive(Clone, Debug, Default)]
pub(super) struct Broadcast {
    /// `map → odom`.
    pub(super) correction: Option<TFMessage>,
    /// A frame for each object.
    pub(super) objects: TFMessage,
}

/// Between two broadcasts.
const PERIOD: Duration = Duration::from_millis(50);
/// Objects whose frames come with each broadcast: those of more objects come more seldom.
const OBJECTS_AT_ONCE: usize = 50;

/// Broadcasts the newest correction with the stamp of the newest data, while the node is active, until it is cancelled.
///
/// What listens looks transforms up at the stamps of its own data: a correction that is as old as the last keyframe
/// would be refused as extrapolation (REP 105 has `map → odom` change slowly, so the old one holds on).
pub(super) async fn broadcast(
    publisher: Publisher<TFMessage>,
    newest: watch::Receiver<Broadcast>,
    status: Shared,
    parameters: watch::Receiver<Parameters>,
) {
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut next = 0;
    loop {
        ticks.tick().await;
        let (publish_tf, object_frames) = {
            let node = &parameters.borrow().node;
            (node.publish_tf, node.publish.object_frames)
        };
        let mut message = TFMessage::default();
        {
            let newest = newest.borrow();
            if publish_tf && let Some(correction) = &newest.correction {
                message.transforms.extend_from_slice(&correction.transforms);
            }
            let objects = &newest.objects.transforms;
            if object_frames && !objects.is_empty() {
                let count = objects.len().min(OBJECTS_AT_ONCE);
                let turn = objects.iter().cycle().skip(next % objects.len()).take(count);
                message.transforms.extend(turn.cloned());
                next = (next + count) % objects.len();
            }
        }
        let (state, present) = {
            let status = status.lock();
            (status.state, status.present)
        };
        let Some(stamp) = present.filter(|_| state == State::Active) else { continue };
        for transform in &mut message.transforms {
            transform.header.stamp = stamp.into();
        }
        if !message.transforms.is_empty() {
            send(&publisher, message);
        }
    }
}
