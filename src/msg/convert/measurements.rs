//! What one image says, as others want it.

use super::{objects::rows, pose_covariance, pose_message};
use crate::{
    msg::{
        ellipsoid_slam::{self as own, EllipsoidMeasurementArray, LabelBelief},
        geometry_msgs::{PoseWithCovariance, Vector3},
        rtabmap_msgs::{LandmarkDetection, LandmarkDetections},
        std_msgs::Header,
    },
    perception::Side,
    pipeline::{BoxResult, Keyframe},
};

/// The measurements of an image; `header` has the camera's frame.
pub fn measurement_array(keyframe: &Keyframe, header: Header) -> EllipsoidMeasurementArray {
    let measurements = keyframe.boxes.iter().filter_map(measurement).collect();
    let support_heights = keyframe.support_heights_m.clone();
    EllipsoidMeasurementArray { header, measurements, support_heights }
}

/// The objects that were seen, as landmarks for RTAB-Map; `header` has the camera's frame. Only what has a place in the
/// map has an identity.
pub fn landmark_detections(keyframe: &Keyframe, header: Header) -> LandmarkDetections {
    let landmarks = keyframe.boxes.iter().filter_map(|found| {
        let (measured, object) = (found.measurement.as_ref().ok()?, found.object?);
        let own = measured.covariance.fixed_view::<6, 6>(0, 0).into_owned();
        Some(LandmarkDetection {
            header: header.clone(),
            landmark_frame_id: format!("object_{object}"),
            // Above zero, as RTAB-Map asks for.
            id: (object.0 % (1 << 31)).max(1) as i32,
            size: 0.0,
            pose: PoseWithCovariance {
                pose: pose_message(&measured.ellipsoid.pose),
                covariance: pose_covariance(&measured.ellipsoid.pose, &own),
            },
        })
    });
    LandmarkDetections { landmarks: landmarks.collect(), header: header.clone() }
}

fn measurement(found: &BoxResult) -> Option<own::EllipsoidMeasurement> {
    let measured = found.measurement.as_ref().ok()?;
    let labels = found.detection.hypotheses().iter().cloned();
    let [x, y, z]: [f64; 3] = measured.ellipsoid.semi_axes.into();
    Some(own::EllipsoidMeasurement {
        object_id: found.object.map_or(0, |id| id.0),
        labels: labels.map(|(label, probability)| LabelBelief { label, probability }).collect(),
        pose: pose_message(&measured.ellipsoid.pose),
        semi_axes: Vector3 { x, y, z },
        covariance: rows(&measured.covariance),
        sides: measured.sides.map(side),
        detection_probability: measured.probability.detection,
        symmetry_probability: measured.probability.symmetry,
        fit_probability: measured.probability.fit,
    })
}

fn side(side: Side) -> u8 {
    match side {
        Side::Seen => own::EllipsoidMeasurement::SEEN,
        Side::Support => own::EllipsoidMeasurement::SUPPORT,
        Side::Mirrored => own::EllipsoidMeasurement::MIRRORED,
        Side::Outline => own::EllipsoidMeasurement::OUTLINE,
        Side::Cut => own::EllipsoidMeasurement::CUT,
        Side::Hidden => own::EllipsoidMeasurement::HIDDEN,
    }
}
