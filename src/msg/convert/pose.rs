//! Odometry and transforms.

use super::{ConvertError, frame, header};
use crate::{
    geometry::Pose,
    msg::{geometry_msgs as geometry, nav_msgs::Odometry, tf2_msgs::TFMessage},
    pipeline::{OdometryMessage, StampedTransform},
};
use nalgebra::{Matrix6, Translation3, UnitQuaternion, Vector3};

/// A reading of the odometry. A covariance that is all zero or not finite was not filled in.
///
/// # Errors
/// When the pose is not finite, its quaternion has no length, or a frame's name is too long.
pub fn odometry(message: &Odometry) -> Result<OdometryMessage, ConvertError> {
    let (frame_id, child_frame_id) =
        (frame(&message.header.frame_id)?, frame(&message.child_frame_id)?);
    let geometry::Pose { position: p, orientation } = message.pose.pose;
    let Some(odom_from_base) = pose([p.x, p.y, p.z], orientation) else {
        return Err(ConvertError::BadPose { parent: frame_id, child: child_frame_id });
    };
    let mut covariance = [0.0; 36];
    covariance.copy_from_slice(message.pose.covariance.as_flattened());
    let given = covariance.iter().any(|c| *c != 0.0) && covariance.iter().all(|c| c.is_finite());
    Ok(OdometryMessage {
        stamp: message.header.stamp.into(),
        frame_id,
        child_frame_id,
        odom_from_base,
        covariance: given.then(|| Box::new(covariance)),
    })
}

/// The transforms of a message, and why some of them were left out.
pub fn transforms(message: &TFMessage) -> (Vec<StampedTransform>, Vec<ConvertError>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    for wire in &message.transforms {
        match transform(wire) {
            Ok(transform) => good.push(transform),
            Err(why) => bad.push(why),
        }
    }
    (good, bad)
}

fn transform(wire: &geometry::TransformStamped) -> Result<StampedTransform, ConvertError> {
    let (parent, child) = (frame(&wire.header.frame_id)?, frame(&wire.child_frame_id)?);
    let t = wire.transform.translation;
    match pose([t.x, t.y, t.z], wire.transform.rotation) {
        Some(parent_from_child) => Ok(StampedTransform {
            stamp: wire.header.stamp.into(),
            frame_id: parent,
            child_frame_id: child,
            parent_from_child,
        }),
        None => Err(ConvertError::BadPose { parent, child }),
    }
}

/// A reading of the odometry as the wire knows it, without velocities.
pub fn odometry_message(reading: &OdometryMessage) -> Odometry {
    let mut covariance = [[0.0; 6]; 6];
    if let Some(given) = &reading.covariance {
        covariance.as_flattened_mut().copy_from_slice(given.as_slice());
    }
    Odometry {
        header: header(reading.stamp, &reading.frame_id),
        child_frame_id: reading.child_frame_id.clone(),
        pose: geometry::PoseWithCovariance {
            pose: pose_message(&reading.odom_from_base),
            covariance,
        },
        twist: geometry::TwistWithCovariance::default(),
    }
}

/// A message for `/tf` or `/tf_static`.
pub fn tf_message(transforms: &[StampedTransform]) -> TFMessage {
    TFMessage { transforms: transforms.iter().map(transform_message).collect() }
}

/// A transform as the wire knows it.
pub fn transform_message(transform: &StampedTransform) -> geometry::TransformStamped {
    let geometry::Pose { position: p, orientation } = pose_message(&transform.parent_from_child);
    geometry::TransformStamped {
        header: header(transform.stamp, &transform.frame_id),
        child_frame_id: transform.child_frame_id.clone(),
        transform: geometry::Transform {
            translation: geometry::Vector3 { x: p.x, y: p.y, z: p.z },
            rotation: orientation,
        },
    }
}

/// A pose as the wire knows it.
pub fn pose_message(pose: &Pose) -> geometry::Pose {
    let (t, q) = (pose.translation.vector, pose.rotation);
    geometry::Pose {
        position: geometry::Point { x: t.x, y: t.y, z: t.z },
        orientation: geometry::Quaternion { x: q.i, y: q.j, z: q.k, w: q.w },
    }
}

/// The covariance of `geometry_msgs/PoseWithCovariance` (translation, then rotation, about fixed axes) from that of
/// `[rotation, translation]`, a right perturbation of `pose`.
pub fn pose_covariance(pose: &Pose, own: &Matrix6<f64>) -> [[f64; 6]; 6] {
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    let turn = |row: usize, column: usize| {
        rotation * own.fixed_view::<3, 3>(row, column) * rotation.transpose()
    };
    let blocks = [[turn(3, 3), turn(3, 0)], [turn(0, 3), turn(0, 0)]];
    std::array::from_fn(|i| std::array::from_fn(|j| blocks[i / 3][j / 3][(i % 3, j % 3)]))
}

/// A pose from the wire; nothing where a number is not finite or the quaternion has no length.
pub fn pose_from_message(message: &geometry::Pose) -> Option<Pose> {
    let p = message.position;
    pose([p.x, p.y, p.z], message.orientation)
}

/// A pose from its parts; the quaternion may have any length but zero.
pub(super) fn pose(position: [f64; 3], q: geometry::Quaternion) -> Option<Pose> {
    let quaternion = nalgebra::Quaternion::new(q.w, q.x, q.y, q.z);
    let finite = position.iter().all(|v| v.is_finite()) && quaternion.norm().is_finite();
    let rotation = UnitQuaternion::try_new(quaternion, MIN_NORM).filter(|_| finite)?;
    Some(Pose::from_parts(Translation3::from(Vector3::from(position)), rotation))
}

/// A quaternion shorter than this was never filled in.
const MIN_NORM: f64 = 1e-6;
