//! What was really there, where that is known.

use super::{recorded::Recorded, rounded};
use crate::{
    eval::{
        EstimatedObject, GroundTruth, ObjectScores, TrajectoryScores, evaluate, evaluate_trajectory,
    },
    geometry::Pose,
    mapping::SavedMap,
    time::Stamp,
};
use serde::Serialize;

/// The truth and how far the map is off, measured as `eval` does.
#[derive(Debug, Serialize)]
pub struct Truth {
    source: String,
    objects: Vec<TrueBody>,
    scores: ObjectScores,
    trajectory: Option<TrajectoryScores>,
    /// True positions of the base (m).
    way: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize)]
struct TrueBody {
    id: u64,
    label: String,
    position: [f64; 3],
    orientation: [f64; 4],
    size: [f64; 3],
}

impl Truth {
    /// Measures a map; `source` says where the truth is from.
    pub fn new(source: &str, map: &SavedMap, objects: &GroundTruth) -> Self {
        let bodies = objects.objects.iter().map(|object| {
            let turn = object.pose.rotation;
            TrueBody {
                id: object.id,
                label: object.label.clone(),
                position: object.pose.translation.vector.into(),
                orientation: [turn.i, turn.j, turn.k, turn.w],
                size: object.size.into(),
            }
        });
        Self {
            source: source.to_owned(),
            objects: bodies.collect(),
            scores: evaluate(&estimated(map), objects),
            trajectory: None,
            way: Vec::new(),
        }
    }

    /// Measures the poses of the base after all optimisation, too, where they have true ones.
    #[must_use]
    pub fn with_poses(self, poses: &[(Stamp, Pose)], true_poses: &[(Stamp, Pose)]) -> Self {
        let every = true_poses.len().div_ceil(Recorded::MAX_WAY).max(1);
        let way = true_poses.iter().step_by(every).map(|(_, pose)| {
            let at = pose.translation.vector;
            [at.x, at.y, at.z].map(rounded)
        });
        let trajectory = evaluate_trajectory(poses, true_poses).ok();
        Self { trajectory, way: way.collect(), ..self }
    }

    /// Of all its objects.
    pub(super) fn labels(&self) -> impl Iterator<Item = &str> {
        self.objects.iter().map(|object| object.label.as_str())
    }
}

/// The objects of a map as they are measured.
pub fn estimated(map: &SavedMap) -> Vec<EstimatedObject> {
    let objects = map.objects.iter().map(|object| EstimatedObject {
        id: object.id,
        label: object.label.clone(),
        ellipsoid: object.ellipsoid,
        covariance: object.covariance,
    });
    objects.collect()
}
