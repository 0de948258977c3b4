//! `/initialpose`: where somebody says that the robot is, as with RViz's "2D Pose Estimate".

use super::{
    node::NotCreated,
    qos,
    services::Orders,
    transport::{Node, NotTaken, Subscription},
    worker::Command,
};
use crate::{
    config::{Qos, RosArguments},
    geometry::{Pose, yaw_of},
    msg::{convert::pose_from_message, geometry_msgs::PoseWithCovarianceStamped},
};
use nalgebra::{Translation3, Vector3};

/// The topic, as AMCL and RViz have it.
pub(super) const INITIAL_POSE: &str = "/initialpose";

/// Listens, until it is cancelled. Where another program publishes `map -> odom`, the pose is its business.
pub(super) fn listen(
    node: &mut Node,
    arguments: &RosArguments,
    orders: Orders,
) -> Result<impl Future<Output = ()> + 'static, NotCreated> {
    let topic = arguments.resolve(INITIAL_POSE);
    let said: Subscription<PoseWithCovarianceStamped> =
        node.subscription(&topic, &qos::input(Qos::SensorData, 1))?;
    Ok(async move {
        loop {
            let message = match said.take().await {
                Ok(message) => message,
                Err(NotTaken::BadBytes(why)) => {
                    tracing::warn!("{topic}: {why}");
                    continue;
                }
                Err(NotTaken::Failed(why)) => {
                    tracing::debug!("{topic}: {why}");
                    continue;
                }
            };
            if !orders.parameters.borrow().node.publish_tf {
                continue;
            }
            match on_the_floor(&message, &orders.map_frame) {
                Ok(map_from_base) => orders.tell(Command::Place(map_from_base)),
                Err(why) => tracing::warn!("{topic}: {why}"),
            }
        }
    })
}

/// Place and heading; who points at a map says nothing of the rest.
fn on_the_floor(message: &PoseWithCovarianceStamped, map_frame: &str) -> Result<Pose, String> {
    let frame = message.header.frame_id.trim_start_matches('/');
    if frame != map_frame {
        return Err(format!("the pose is in `{frame}`, and has to be in `{map_frame}`"));
    }
    let Some(pose) = pose_from_message(&message.pose.pose) else {
        return Err("the pose is not finite, or its orientation has no length".into());
    };
    let mut floor = Pose::rotation(Vector3::z() * yaw_of(&pose));
    floor.translation = Translation3::new(pose.translation.x, pose.translation.y, 0.0);
    Ok(floor)
}
