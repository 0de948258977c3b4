//! A map against the true objects.

use super::{
    calibration::{Calibration, NormalisedError, part_errors},
    ground_truth::{GroundTruth, TrueObject},
    matching::{MATCH_DISTANCE_M, assignment},
    object_error::ObjectError,
};
use crate::geometry::{Ellipsoid, OrientedBox};
use nalgebra::{Point3, SMatrix};
use serde::Serialize;
use std::collections::BTreeSet;

/// True objects with fewer observations do not count: neither as found nor as missed.
pub const MIN_OBSERVATIONS: u64 = 5;

/// One object of the map under test.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedObject {
    /// Its identity.
    pub id: u64,
    /// Its class.
    pub label: String,
    /// In the frame of the ground truth.
    pub ellipsoid: Ellipsoid,
    /// Of `[rotation, translation, log semi-axes]`, a right perturbation in the object's frame.
    pub covariance: SMatrix<f64, 9, 9>,
}

/// A true object that was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Match {
    /// The true object.
    pub true_id: u64,
    /// Its class.
    pub true_label: String,
    /// The object of the map.
    pub id: u64,
    /// Its class.
    pub label: String,
    /// How far off it is.
    #[serde(flatten)]
    pub error: ObjectError,
    /// Its error in units of its covariance, over heading, centre and size; nothing if the covariance is singular.
    pub normalised: Option<NormalisedError>,
}

/// A true object that was not found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissedObject {
    /// Its identity.
    pub true_id: u64,
    /// Its class.
    pub true_label: String,
}

/// An object of the map that is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FalseObject {
    /// Its identity.
    pub id: u64,
    /// Its class.
    pub label: String,
    /// The true object that it shows once more, if it does.
    pub duplicate_of: Option<u64>,
}

/// How good a map is. Means are over the objects that were found and count.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectScores {
    /// True objects that count.
    pub true_objects: usize,
    /// Objects of the map that match none or one that counts.
    pub map_objects: usize,
    /// Found objects over objects of the map.
    pub precision: Option<f64>,
    /// Found objects over true ones.
    pub recall: Option<f64>,
    /// Objects of the map that show a true object once more.
    pub duplicates: usize,
    /// Found objects whose class is right over all found ones.
    pub label_agreement: Option<f64>,
    /// Mean distance between centres (m).
    pub translation_m: Option<f64>,
    /// Mean angle between main axes (deg).
    pub rotation_deg: Option<f64>,
    /// Found objects without a main axis, which the mean angle leaves out.
    pub rotation_left_out: usize,
    /// Mean of 1 - IoU of centred axis-aligned boxes.
    pub shape: Option<f64>,
    /// The same as the paper has it.
    pub paper_shape: Option<f64>,
    /// Mean IoU of oriented boxes in place.
    pub iou: Option<f64>,
    /// Heading alone.
    pub heading_calibration: Calibration,
    /// Centre alone.
    pub center_calibration: Calibration,
    /// Logarithms of the semi-axes alone.
    pub size_calibration: Calibration,
    /// All together.
    pub calibration: Calibration,
    /// In the order of the ground truth.
    pub matches: Vec<Match>,
    /// In the order of the ground truth.
    pub missed: Vec<MissedObject>,
    /// In the order of the map.
    pub false_objects: Vec<FalseObject>,
}

/// Compares a map with the truth, both in the same frame. Nearest centres of one class belong together, and of what is left
/// nearest centres: a book beside a cup is not the cup, though it may have been taken for a laptop.
pub fn evaluate(map: &[EstimatedObject], truth: &GroundTruth) -> ObjectScores {
    // Objects that do not count take part, so that what was made of them is not held against the map.
    let mut left: (Vec<usize>, Vec<usize>) =
        ((0..truth.objects.len()).collect(), (0..map.len()).collect());
    let mut pairs = Vec::new();
    let classes: BTreeSet<&str> = map.iter().map(|o| o.label.as_str()).collect();
    for class in classes.into_iter().map(Some).chain([None]) {
        let is_of = |label: &str| class.is_none_or(|class| class == label);
        let trues = left.0.iter().copied().filter(|t| is_of(&truth.objects[*t].label));
        let found = left.1.iter().copied().filter(|m| is_of(&map[*m].label));
        pairs.extend(nearest(&trues.collect::<Vec<_>>(), &found.collect::<Vec<_>>(), truth, map));
        left.0.retain(|t| !pairs.iter().any(|pair| pair.0 == *t));
        left.1.retain(|m| !pairs.iter().any(|pair| pair.1 == *m));
    }
    pairs.sort_unstable();
    scored(&map.iter().collect::<Vec<_>>(), truth, &pairs)
}

/// The assignment of some objects, as indices into all.
fn nearest(
    trues: &[usize],
    found: &[usize],
    truth: &GroundTruth,
    map: &[EstimatedObject],
) -> Vec<(usize, usize)> {
    let true_centers = trues.iter().map(|t| truth.objects[*t].pose.translation.vector.into());
    let centers = found.iter().map(|m| map[*m].ellipsoid.center());
    let (true_centers, centers): (Vec<Point3<f64>>, Vec<_>) =
        (true_centers.collect(), centers.collect());
    let pairs = assignment(&true_centers, &centers, MATCH_DISTANCE_M);
    pairs.into_iter().map(|(t, m)| (trues[t], found[m])).collect()
}

/// Compares a map whose objects come with the ids of the true objects that they show: however far off it is, such an
/// object counts as found. An id that comes twice is a false object the second time.
pub fn evaluate_identified(map: &[(u64, EstimatedObject)], truth: &GroundTruth) -> ObjectScores {
    let shown = |object: &TrueObject| map.iter().position(|(true_id, _)| *true_id == object.id);
    let pairs = truth.objects.iter().enumerate();
    let pairs: Vec<_> = pairs.filter_map(|(t, object)| Some((t, shown(object)?))).collect();
    scored(&map.iter().map(|(_, object)| object).collect::<Vec<_>>(), truth, &pairs)
}

/// Scores pairs of `(index of the true object, index in the map)`.
fn scored(map: &[&EstimatedObject], truth: &GroundTruth, pairs: &[(usize, usize)]) -> ObjectScores {
    let found: Vec<Pair<'_>> = pairs
        .iter()
        .map(|(t, m)| Pair { truth: &truth.objects[*t], estimate: map[*m] })
        .filter(|pair| counts(pair.truth))
        .collect();
    let is_found = |index: usize| pairs.iter().any(|(t, _)| *t == index);
    let missed = (truth.objects.iter().enumerate())
        .filter(|(index, object)| counts(object) && !is_found(*index))
        .map(|(_, o)| MissedObject { true_id: o.id, true_label: o.label.clone() })
        .collect();
    let is_used = |index: usize| pairs.iter().any(|(_, m)| *m == index);
    let false_objects = (map.iter().copied().enumerate())
        .filter(|(index, _)| !is_used(*index))
        .map(|(_, o)| FalseObject {
            id: o.id,
            label: o.label.clone(),
            duplicate_of: duplicated(o, &found),
        })
        .collect();
    scores(&found, missed, false_objects)
}

/// A true object and what the map has of it.
struct Pair<'a> {
    truth: &'a TrueObject,
    estimate: &'a EstimatedObject,
}

fn counts(object: &TrueObject) -> bool {
    object.observations >= MIN_OBSERVATIONS
}

/// Around a true box, the centre of an object that shows it once more may lie in this margin (m).
const DUPLICATE_MARGIN_M: f64 = 0.1;

/// The found object in whose box, grown by a margin, the centre of another one lies; the nearest of several.
fn duplicated(object: &EstimatedObject, found: &[Pair<'_>]) -> Option<u64> {
    let center = object.ellipsoid.center();
    let holds = |truth: &TrueObject| {
        let own = truth.pose.inverse_transform_point(&center).coords.abs();
        let reach = (truth.size * 0.5).add_scalar(DUPLICATE_MARGIN_M);
        own.iter().zip(reach.iter()).all(|(distance, reach)| distance <= reach)
    };
    let distance = |truth: &TrueObject| (truth.pose.translation.vector - center.coords).norm();
    let holding = found.iter().map(|pair| pair.truth).filter(|truth| holds(truth));
    holding.min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|truth| truth.id)
}

fn scores(
    found: &[Pair<'_>],
    missed: Vec<MissedObject>,
    false_objects: Vec<FalseObject>,
) -> ObjectScores {
    let parts: Vec<_> = found
        .iter()
        .map(|Pair { truth, estimate }| {
            part_errors(&estimate.ellipsoid, &estimate.covariance, &truth.oriented_box())
        })
        .collect();
    let matches: Vec<Match> = found
        .iter()
        .zip(&parts)
        .map(|(Pair { truth, estimate }, parts)| Match {
            true_id: truth.id,
            true_label: truth.label.clone(),
            id: estimate.id,
            label: estimate.label.clone(),
            error: ObjectError::new(&OrientedBox::from(&estimate.ellipsoid), &truth.oriented_box()),
            normalised: parts.map(|p| p.all),
        })
        .collect();
    let calibration = |part: &dyn Fn(usize) -> Option<NormalisedError>| {
        Calibration::new(&(0..parts.len()).filter_map(part).collect::<Vec<_>>())
    };
    let of = |value: fn(&ObjectError) -> f64| mean(matches.iter().map(|m| value(&m.error)));
    let (true_objects, map_objects) =
        (matches.len() + missed.len(), matches.len() + false_objects.len());
    let agreeing = matches.iter().filter(|m| m.label == m.true_label).count();
    ObjectScores {
        true_objects,
        map_objects,
        precision: ratio(matches.len(), map_objects),
        recall: ratio(matches.len(), true_objects),
        duplicates: false_objects.iter().filter(|o| o.duplicate_of.is_some()).count(),
        label_agreement: ratio(agreeing, matches.len()),
        translation_m: of(|e| e.translation_m),
        rotation_deg: mean(matches.iter().filter_map(|m| m.error.rotation_deg)),
        rotation_left_out: matches.iter().filter(|m| m.error.rotation_deg.is_none()).count(),
        shape: of(|e| e.shape),
        paper_shape: of(|e| e.paper_shape),
        iou: of(|e| e.iou),
        heading_calibration: calibration(&|i| parts[i]?.heading),
        center_calibration: calibration(&|i| Some(parts[i]?.center)),
        size_calibration: calibration(&|i| Some(parts[i]?.size)),
        calibration: calibration(&|i| Some(parts[i]?.all)),
        matches,
        missed,
        false_objects,
    }
}

fn ratio(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}
