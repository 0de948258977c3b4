//! What time it is for ROS: the system's, or `/clock` for a node with `use_sim_time`.

use super::{
    names::{parsed, type_name},
    node::NodeError,
    qos,
    status::Shared,
};
use crate::{
    config::Qos,
    msg::{Message, rosgraph_msgs::Clock},
    time::Stamp,
};
use ros2_client::{Node, Subscription};

/// Follows `/clock`, until it is cancelled.
pub(super) fn follow(
    node: &mut Node,
    status: Shared,
) -> Result<impl Future<Output = ()> + 'static, NodeError> {
    const TOPIC: &str = "/clock";
    let failed = |e| NodeError::create(TOPIC, e);
    let qos = qos::input(Qos::SensorData, 1);
    let topic = node.create_topic(&parsed(TOPIC)?, type_name(Clock::TYPE), &qos).map_err(failed)?;
    let clock: Subscription<Clock> = node.create_subscription(&topic, Some(qos)).map_err(failed)?;
    Ok(async move {
        status.lock().sim_time = Some(Stamp::default());
        loop {
            match clock.async_take().await {
                Ok((time, _)) => status.lock().sim_time = Some(time.clock.into()),
                Err(e) => tracing::debug!("{TOPIC}: {e}"),
            }
        }
    })
}
