//! `map → odom`, steadily.

use super::{outputs::send, status::Shared};
use crate::{
    config::Parameters,
    geometry::Pose,
    msg::{convert::tf_message, tf2_msgs::TFMessage},
    pipeline::StampedTransform,
};
use ros2_client::Publisher;
use std::time::Duration;
use tokio::{
    sync::watch,
    time::{MissedTickBehavior, interval},
};

/// Between two broadcasts.
const PERIOD: Duration = Duration::from_millis(50);

/// What odometry has to be corrected by.
#[derive(Clone, Debug)]
pub(super) struct Correction {
    /// The odometry's fixed frame.
    pub(super) odom_frame: String,
    /// `map_from_odom`.
    pub(super) map_from_odom: Pose,
}

/// Broadcasts the newest correction with the stamp of the newest data, until it is cancelled.
///
/// What listens looks transforms up at the stamps of its own data: a correction that is as old as the last keyframe
/// would be refused as extrapolation (REP 105 has `map → odom` change slowly, so the old one holds on).
pub(super) async fn broadcast(
    publisher: Publisher<TFMessage>,
    correction: watch::Receiver<Option<Correction>>,
    status: Shared,
    parameters: watch::Receiver<Parameters>,
) {
    let mut ticks = interval(PERIOD);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let (wanted, map_frame) = {
            let own = &parameters.borrow().node;
            (own.publish_tf, own.map_frame.clone())
        };
        if !wanted {
            continue;
        }
        let Some(Correction { odom_frame, map_from_odom }) = correction.borrow().clone() else {
            continue;
        };
        let Some(stamp) = status.lock().present else { continue };
        let transform = StampedTransform {
            stamp,
            frame_id: map_frame,
            child_frame_id: odom_frame,
            parent_from_child: map_from_odom,
        };
        send(&publisher, tf_message(&[transform]));
    }
}
