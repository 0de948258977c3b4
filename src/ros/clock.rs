//! What time it is for ROS: the system's, or `/clock` for a node with `use_sim_time`.

use super::{node::NodeError, qos, status::Shared, topic::Ends};
use crate::{config::Qos, msg::rosgraph_msgs::Clock, time::Stamp};
use ros2_client::Subscription;

/// Follows `/clock`, until it is cancelled.
pub(super) fn follow(
    mut ends: Ends<'_>,
    status: Shared,
) -> Result<impl Future<Output = ()> + 'static, NodeError> {
    const TOPIC: &str = "/clock";
    let clock: Subscription<Clock> = ends.subscription(TOPIC, qos::input(Qos::SensorData, 1))?;
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
