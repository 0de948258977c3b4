//! The truth that a bag carries under `/ground_truth/`. It is never input.

use crate::{
    eval::{GroundTruth, MIN_OBSERVATIONS, TrueObject},
    geometry::Pose,
    io::RawMessage,
    msg::{
        cdr::decode,
        convert::odometry,
        vision_msgs::{Detection2DArray, Detection3D, Detection3DArray},
    },
    time::Stamp,
};
use std::collections::BTreeMap;

const OBJECTS: &str = "/ground_truth/objects";
const ODOMETRY: &str = "/ground_truth/odom";
const DETECTIONS: &str = "/ground_truth/detections";

/// What was heard of it. Messages that cannot be read are passed over: a viewer's page must not keep a map from being made.
#[derive(Debug, Default)]
pub(super) struct HeardTruth {
    objects: Option<GroundTruth>,
    poses: Vec<(Stamp, Pose)>,
    /// Boxes that show an object, by its id.
    boxes: Option<BTreeMap<u64, u64>>,
}

impl HeardTruth {
    pub(super) const TOPICS: [&'static str; 3] = [OBJECTS, ODOMETRY, DETECTIONS];

    pub(super) fn hear(&mut self, message: &RawMessage) {
        match &*message.topic {
            OBJECTS => {
                if let Ok(array) = decode::<Detection3DArray>(&message.data) {
                    let objects = array.detections.iter().filter_map(true_object).collect();
                    self.objects = GroundTruth::new(array.header.frame_id, objects).ok();
                }
            }
            ODOMETRY => {
                let reading = decode(&message.data).ok().and_then(|wire| odometry(&wire).ok());
                self.poses.extend(reading.map(|reading| (reading.stamp, reading.odom_from_base)));
            }
            _ => {
                let array = decode::<Detection2DArray>(&message.data);
                let boxes = self.boxes.get_or_insert_default();
                for found in array.iter().flat_map(|array| &array.detections) {
                    if let Ok(id) = found.id.parse() {
                        *boxes.entry(id).or_default() += 1;
                    }
                }
            }
        }
    }

    /// The true objects. How often each could be seen is how many boxes show it; where no boxes say so, often enough.
    pub(super) fn objects(&self) -> Option<GroundTruth> {
        let mut truth = self.objects.clone()?;
        for object in &mut truth.objects {
            object.observations = match &self.boxes {
                Some(boxes) => boxes.get(&object.id).copied().unwrap_or_default(),
                None => MIN_OBSERVATIONS,
            };
        }
        Some(truth)
    }

    pub(super) fn poses(&self) -> &[(Stamp, Pose)] {
        &self.poses
    }
}

/// What the message says, if it can be an object.
fn true_object(found: &Detection3D) -> Option<TrueObject> {
    let (at, turn, size) =
        (&found.bbox.center.position, &found.bbox.center.orientation, &found.bbox.size);
    let label = found.results.first()?.hypothesis.class_id.clone();
    let position = [at.x, at.y, at.z];
    let orientation = [turn.x, turn.y, turn.z, turn.w];
    let id = found.id.parse().ok()?;
    TrueObject::new(id, label, position, orientation, [size.x, size.y, size.z]).ok()
}
