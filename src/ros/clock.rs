//! What time it is for ROS: the system's, or `/clock` for a node with `use_sim_time`.

use super::{
    node::NotCreated,
    qos,
    status::Shared,
    transport::{Node, NotTaken, Subscription},
};
use crate::{config::Qos, msg::rosgraph_msgs::Clock, time::Stamp};

/// Follows `/clock`, until it is cancelled.
pub(super) fn follow(
    node: &mut Node,
    status: Shared,
) -> Result<impl Future<Output = ()> + 'static, NotCreated> {
    const TOPIC: &str = "/clock";
    let clock: Subscription<Clock> = node.subscription(TOPIC, &qos::input(Qos::SensorData, 1))?;
    Ok(async move {
        status.lock().sim_time = Some(Stamp::default());
        loop {
            match clock.take().await {
                Ok(time) => status.lock().sim_time = Some(time.clock.into()),
                Err(NotTaken::BadBytes(why)) => tracing::debug!("{TOPIC}: {why}"),
                Err(NotTaken::Failed(why)) => tracing::debug!("{TOPIC}: {why}"),
            }
        }
    })
}
