//! How far an estimated box is from the true one: Liao et al. 2020, table 2, and more.

use super::axes::{footprint, main_axis};
use crate::geometry::{OrientedBox, Pose, intersection_over_union};
use nalgebra::Vector3;
use serde::Serialize;

/// A footprint whose sides differ by less than this fraction has no main axis.
pub const ROUND_FOOTPRINT: f64 = 0.1;

/// The measures of one object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ObjectError {
    /// Distance between the centres (m).
    pub translation_m: f64,
    /// Angle between the main axes seen from above, between 0 and 90 (deg); nothing for a round footprint.
    pub rotation_deg: Option<f64>,
    /// 1 - IoU of the boxes' axis-aligned boxes, both moved to the origin.
    pub shape: f64,
    /// The same with the axis-aligned box of the estimated ellipsoid, as the paper has it.
    pub paper_shape: f64,
    /// IoU of the oriented boxes where they stand.
    pub iou: f64,
}

impl ObjectError {
    /// Of an estimate whose half extents are the ellipsoid's semi-axes.
    pub fn new(estimate: &OrientedBox, truth: &OrientedBox) -> Self {
        let between = estimate.pose.translation.vector - truth.pose.translation.vector;
        let true_reach = box_reach(&truth.pose, &truth.half_extents);
        let ellipsoid = ellipsoid_reach(&estimate.pose, &estimate.half_extents);
        Self {
            translation_m: between.norm(),
            rotation_deg: rotation_error_deg(estimate, truth),
            shape: shape_error(estimate, truth),
            paper_shape: 1.0 - concentric_iou(&ellipsoid, &true_reach),
            iou: intersection_over_union(estimate, truth),
        }
    }
}

impl ObjectError {
    /// The median of each measure over several estimates of one object; nothing without an estimate.
    pub fn median(errors: &[Self]) -> Option<Self> {
        let of = |value: &dyn Fn(&Self) -> Option<f64>| {
            let mut values: Vec<f64> = errors.iter().filter_map(value).collect();
            values.sort_by(f64::total_cmp);
            let (low, high) = (values.len().checked_sub(1)? / 2, values.len() / 2);
            Some(0.5 * (values[low] + values[high]))
        };
        Some(Self {
            translation_m: of(&|e| Some(e.translation_m))?,
            rotation_deg: of(&|e| e.rotation_deg),
            shape: of(&|e| Some(e.shape))?,
            paper_shape: of(&|e| Some(e.paper_shape))?,
            iou: of(&|e| Some(e.iou))?,
        })
    }
}

/// Angle between the longer sides of two footprints, modulo 180 degrees (deg); nothing where the true footprint is
/// round.
pub fn rotation_error_deg(estimate: &OrientedBox, truth: &OrientedBox) -> Option<f64> {
    let (longer, shorter) = footprint(truth);
    if longer - shorter < ROUND_FOOTPRINT * longer {
        return None;
    }
    let (a, b) = (main_axis(estimate), main_axis(truth));
    let (sine, cosine) = (a.perp(&b).abs(), a.dot(&b).abs());
    Some(sine.atan2(cosine).to_degrees())
}

/// 1 - IoU of the axis-aligned boxes around two boxes that are moved to the origin.
pub fn shape_error(estimate: &OrientedBox, truth: &OrientedBox) -> f64 {
    let reach = |body: &OrientedBox| box_reach(&body.pose, &body.half_extents);
    1.0 - concentric_iou(&reach(estimate), &reach(truth))
}

/// Half extents of the axis-aligned box around a box.
fn box_reach(pose: &Pose, half_extents: &Vector3<f64>) -> Vector3<f64> {
    pose.rotation.to_rotation_matrix().into_inner().abs() * half_extents
}

/// Half extents of the axis-aligned box around an ellipsoid.
fn ellipsoid_reach(pose: &Pose, semi_axes: &Vector3<f64>) -> Vector3<f64> {
    let axes = pose.rotation.to_rotation_matrix().into_inner()
        * nalgebra::Matrix3::from_diagonal(semi_axes);
    Vector3::from_fn(|row, _| axes.row(row).norm())
}

fn concentric_iou(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let common = a.inf(b).product();
    common / (a.product() + b.product() - common)
}
