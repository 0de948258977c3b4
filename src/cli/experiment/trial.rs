//! One row on one sequence of one seed.

use super::{
    metric::Metric,
    protocol::{Poses, Protocol},
    row::{Output, Row},
    sequence::Rendered,
};
use crate::{
    eval::{
        Calibration, EstimatedObject, GroundTruth, IdSwitches, MIN_OBSERVATIONS, ObjectError,
        ObjectScores, TrueObject, evaluate, evaluate_identified, evaluate_trajectory, pose_error,
    },
    geometry::{Ellipsoid, OrientedBox, Pose},
    mapping::{Association, MapObject, ObjectId},
    pipeline::{FramePose, ObjectSlam, Settings, Update},
    time::Stamp,
};
use std::collections::BTreeMap;

/// What came of a trial.
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    /// What could be measured.
    pub(super) metrics: BTreeMap<Metric, f64>,
    /// True objects that count and were found.
    pub(super) found: usize,
    /// True objects that count.
    pub(super) true_objects: usize,
    /// After one, two, … views of each object: [`CURVE_METRICS`], as means over the objects that count.
    pub(super) curve: Vec<[Option<f64>; 3]>,
    /// Object by object; nothing where single measurements are what counts.
    pub(super) objects: Option<ObjectScores>,
}

/// What curves show.
pub(super) const CURVE_METRICS: [Metric; 3] =
    [Metric::TranslationM, Metric::RotationDeg, Metric::Shape];
/// How many views a curve shows.
pub(super) const CURVE_VIEWS: usize = 40;

/// Runs the method on all messages of a sequence.
pub(super) fn run(
    rendered: &Rendered,
    protocol: &Protocol,
    row: &Row,
    settings: Settings,
) -> Trial {
    let mut record = Record::new(rendered.truth(protocol), *protocol);
    let mut slam = ObjectSlam::new(settings);
    for input in rendered.inputs(protocol) {
        let update = slam.handle(input, &mut ());
        record.take(&update, &slam);
    }
    let update = slam.finish(&mut ());
    record.take(&update, &slam);
    match row.output {
        Output::Map => record.of_map(&slam, rendered),
        Output::SingleFrames => record.of_single_frames(),
    }
}

/// What is written down while the method runs.
struct Record {
    truth: GroundTruth,
    protocol: Protocol,
    poses: Vec<FramePose>,
    /// True object and object of the map of each box that was joined, in the order of time. An identity that does not
    /// count yet is nobody's: it is left out.
    joined: Vec<(u64, u64)>,
    by_object: BTreeMap<u64, Views>,
}

/// The views of a true object.
#[derive(Default)]
struct Views {
    /// Errors of the single measurements.
    measured: Vec<ObjectError>,
    /// Error of the map after each view, once the object is in the map.
    mapped: Vec<Option<ObjectError>>,
}

impl Record {
    fn new(truth: GroundTruth, protocol: Protocol) -> Self {
        Self { truth, protocol, poses: Vec::new(), joined: Vec::new(), by_object: BTreeMap::new() }
    }

    fn take(&mut self, update: &Update, slam: &ObjectSlam) {
        self.poses.extend(&update.poses);
        for keyframe in &update.keyframes {
            for result in &keyframe.boxes {
                let Some(track) = result.detection.track else { continue };
                let counts = |id: &ObjectId| slam.objects().any(|object| object.id == *id);
                self.joined.extend(result.object.filter(counts).map(|id| (track, id.0)));
                let measured = result.measurement.as_ref().ok();
                let measured = measured.map(|m| m.ellipsoid.transformed(&keyframe.map_from_camera));
                let mapped = slam.objects().find(|object| object.track == Some(track));
                self.view(track, measured, mapped.map(MapObject::ellipsoid));
            }
        }
    }

    fn view(&mut self, track: u64, measured: Option<Ellipsoid>, mapped: Option<Ellipsoid>) {
        let Some(truth) = self.truth.objects.iter().find(|object| object.id == track) else {
            return;
        };
        let error = |estimate: Ellipsoid| error_of(&estimate, truth);
        let views = self.by_object.entry(track).or_default();
        views.measured.extend(measured.map(error));
        views.mapped.push(mapped.map(error));
    }

    fn counting(&self) -> impl Iterator<Item = &TrueObject> {
        self.truth.objects.iter().filter(|object| object.observations >= MIN_OBSERVATIONS)
    }

    fn of_single_frames(&self) -> Trial {
        let errors = self
            .counting()
            .filter_map(|object| ObjectError::median(&self.by_object.get(&object.id)?.measured));
        let errors: Vec<_> = errors.collect();
        let mut trial = Trial {
            found: errors.len(),
            true_objects: self.counting().count(),
            ..Trial::default()
        };
        trial.add_errors(&errors);
        trial
    }

    fn of_map(&self, slam: &ObjectSlam, rendered: &Rendered) -> Trial {
        let scores = self.scores(slam);
        let errors: Vec<_> = scores.matches.iter().map(|m| m.error).collect();
        let mut trial = Trial {
            found: scores.matches.len(),
            true_objects: scores.true_objects,
            ..Trial::default()
        };
        trial.add_errors(&errors);
        let truth = rendered.true_poses();
        let ate = |poses: &[(Stamp, Pose)]| {
            evaluate_trajectory(poses, &truth).ok().map(|scores| scores.ate_m.rmse)
        };
        let optimised: Vec<_> =
            self.poses.iter().map(|pose| (pose.stamp, slam.map_from_base(pose))).collect();
        let (own, raw) = (ate(&optimised), ate(&rendered.odometry_poses(&self.protocol)));
        let drifts = raw.filter(|_| self.protocol.poses != Poses::True);
        trial.add([
            (Metric::Precision, scores.precision),
            (Metric::Duplicates, Some(scores.duplicates as f64)),
            (Metric::IdSwitchesPer200, IdSwitches::count(self.joined.iter().copied()).per_200()),
            (Metric::Within90, scores.calibration.within_90),
            (Metric::PoseWithin90, self.last_pose_within_90(slam, &truth)),
            (Metric::AteM, own),
            (Metric::OdometryAteM, raw),
            (Metric::AteShare, own.zip(drifts).map(|(own, raw)| own / raw)),
        ]);
        if self.protocol.association == Association::Given {
            trial.curve = self.curve();
        }
        trial.objects = Some(scores);
        trial
    }

    /// 1 if the region that is claimed to hold the robot's last place and heading with 90 % does, 0 otherwise; nothing where
    /// poses are given.
    fn last_pose_within_90(&self, slam: &ObjectSlam, truth: &[(Stamp, Pose)]) -> Option<f64> {
        let last = self.poses.last().filter(|_| self.protocol.poses != Poses::True)?;
        let (_, true_pose) = truth.iter().find(|(stamp, _)| *stamp == last.stamp)?;
        let error = pose_error(&slam.map_from_base(last), &slam.covariance(last)?, true_pose)?;
        Calibration::new(&[error]).within_90
    }

    fn scores(&self, slam: &ObjectSlam) -> ObjectScores {
        match self.protocol.association {
            Association::Automatic => {
                evaluate(&slam.objects().map(estimated).collect::<Vec<_>>(), &self.truth)
            }
            Association::Given => {
                let known = slam.objects().filter_map(|o| Some((o.track?, estimated(o))));
                evaluate_identified(&known.collect::<Vec<_>>(), &self.truth)
            }
        }
    }

    /// An object with fewer views keeps its last error, so that all points of a curve are about the same objects.
    fn curve(&self) -> Vec<[Option<f64>; 3]> {
        let objects: Vec<_> =
            self.counting().filter_map(|object| self.by_object.get(&object.id)).collect();
        let after = |views: usize| {
            let errors = objects.iter().filter_map(|object| {
                let last = object.mapped.len().checked_sub(1)?;
                object.mapped[last.min(views - 1)]
            });
            let errors: Vec<_> = errors.collect();
            CURVE_METRICS.map(|metric| mean_of(&errors, metric))
        };
        (1..=CURVE_VIEWS).map(after).collect()
    }
}

impl Trial {
    fn add_errors(&mut self, errors: &[ObjectError]) {
        let recall = (self.true_objects > 0).then(|| self.found as f64 / self.true_objects as f64);
        let of_object = [
            Metric::Shape,
            Metric::PaperShape,
            Metric::TranslationM,
            Metric::RotationDeg,
            Metric::Iou,
        ];
        self.add(of_object.map(|metric| (metric, mean_of(errors, metric))));
        self.add([(Metric::Recall, recall)]);
    }

    fn add<const N: usize>(&mut self, measured: [(Metric, Option<f64>); N]) {
        self.metrics
            .extend(measured.into_iter().filter_map(|(metric, value)| Some((metric, value?))));
    }
}

fn error_of(estimate: &Ellipsoid, truth: &TrueObject) -> ObjectError {
    ObjectError::new(&OrientedBox::from(estimate), &truth.oriented_box())
}

fn mean_of(errors: &[ObjectError], metric: Metric) -> Option<f64> {
    let value = |e: &ObjectError| match metric {
        Metric::Shape => Some(e.shape),
        Metric::PaperShape => Some(e.paper_shape),
        Metric::TranslationM => Some(e.translation_m),
        Metric::RotationDeg => e.rotation_deg,
        Metric::Iou => Some(e.iou),
        _ => None,
    };
    let values: Vec<f64> = errors.iter().filter_map(value).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn estimated(object: &MapObject) -> EstimatedObject {
    EstimatedObject {
        id: object.id.0,
        label: object.label().to_owned(),
        ellipsoid: object.ellipsoid(),
        covariance: object.covariance(),
    }
}
