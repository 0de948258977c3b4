//! `map → odom`, steadily.

use super::{status::Shared, topic::send, transport::Publisher};
use crate::{config::Parameters, msg::tf2_msgs::TFMessage};
use std::time::Duration;
use tokio::{
    sync::watch,
    time::{MissedTickBehavior, interval},
};

/// Between two broadcasts.
const PERIOD: Duration = Duration::from_millis(50);

/// Broadcasts the newest correction with the stamp of the newest data, until it is cancelled.
///
/// What listens looks transforms up at the stamps of its own data: a correction that is as old as the last keyframe
/// would be refused as extrapolation (REP 105 has `map → odom` change slowly, so the old one holds on).
pub(super) async fn broadcast(
    publisher: Publisher<TFMessage>,
    correction: watch::Receiver<Option<TFMessage>>,
    status: Shared,
    parameters: watch::Receiver<Parameters>,
) {
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        if !parameters.borrow().node.publish_tf {
            continue;
        }
        let newest = correction.borrow().clone();
        let (Some(mut message), Some(stamp)) = (newest, status.lock().present) else { continue };
        for transform in &mut message.transforms {
            transform.header.stamp = stamp.into();
        }
        send(&publisher, message);
    }
}
