//! What a depth camera cannot have seen of an object.

use super::{
    ClassPrior, Side,
    faces::{Face, Faces, TURNED_AWAY},
    segmentation::{Segment, SurfacePoint},
};
use crate::geometry::Outline;
use nalgebra::Vector3;

impl Faces {
    /// Depth cameras see nothing of handles and leaves: where something round ends is less sure than where its points do,
    /// and the sides of its boxes tell more.
    pub(super) fn allow_for_handles(&mut self, outline: Outline) {
        if outline.is_round() {
            let unseen_m = HANDLE_SHARE * self.extent_m(0).max(self.extent_m(1));
            for face in &mut self.faces[..4] {
                face.sigma_m = face.sigma_m.hypot(unseen_m);
            }
        }
    }

    /// Whether it is thinner along a horizontal axis than things of its usual size are: not all of the object.
    pub(super) fn is_sliver(&self, [_, short, _]: [f64; 3]) -> bool {
        (0..2).any(|axis| self.extent_m(axis) < SLIVER_SHARE * short)
    }

    /// Where none of the upright faces was seen, what was seen may be any part of the object, or something beside it,
    /// unless it fills its box from the left to the right (`is_bounded`). A part of a top may be any part of it. The standard
    /// deviation of where it is along either horizontal axis, besides that of its faces (m).
    pub(super) fn place_sigma_m(
        &self,
        segment: &Segment<'_>,
        prior: &ClassPrior,
        is_bounded: bool,
    ) -> f64 {
        let is_seen = |face: &Face| matches!(face.side, Side::Seen | Side::Mirrored);
        match prior.size_m {
            // Any part alike: the standard deviation of a uniform distribution.
            Some([long, ..]) if segment.is_part_of_top => long / 12.0_f64.sqrt(),
            Some([long, ..]) if !is_bounded && !self.faces[..4].iter().any(is_seen) => long,
            _ => 0.0,
        }
    }
}

/// From the front, a back rest looks like its front side: how far it goes on behind what was seen at the end of something
/// that stands on legs (m). Where a seat or an arm rest leads to that end, it was seen.
pub(super) fn unseen_back_m(
    segment: &Segment<'_>,
    rim: &[&SurfacePoint],
    outward: &Vector3<f64>,
    prior: &ClassPrior,
) -> f64 {
    let leads_there = |p: &&&SurfacePoint| p.normal.is_some_and(|n| n.dot(outward).abs() < ALONG);
    let leading = || rim.iter().filter(leads_there).count() as f64;
    let is_back = outward.z == 0.0 && outward.dot(&segment.direction()) > TURNED_AWAY;
    let has_rest = prior.legs && !prior.carries;
    if has_rest && is_back && leading() < LEADING_SHARE * rim.len() as f64 {
        BACK_REST_M
    } else {
        0.0
    }
}

/// Whether an end is hidden by nothing but the front of what is there: the back rest behind a seat.
pub(super) fn hides_itself(rim: &[&SurfacePoint], outward: &Vector3<f64>) -> bool {
    let normals = || rim.iter().filter_map(|p| p.normal);
    let fronts = normals().filter(|n| n.dot(outward) < -ACROSS).count();
    fronts as f64 > FRONT_SHARE * normals().count() as f64
}

/// Whether the surfaces that lead to an end on the far side are all seen at so grazing an angle that readings on them get lost.
pub(super) fn is_seen_grazing(rim: &[&SurfacePoint], outward: &Vector3<f64>) -> bool {
    let sum = rim.iter().map(|p| p.at.coords).sum::<Vector3<f64>>();
    let view = sum / sum.norm().max(1e-9);
    let is_back = outward.z == 0.0 && outward.dot(&view) > TURNED_AWAY;
    let aside = outward.cross(&Vector3::z());
    let facing = (-view.z).max(view.dot(&aside).abs());
    is_back && facing < GRAZING && !hides_itself(rim, outward)
}

/// Handles and leaves reach so much farther, as a share of the width: the handle of a cup a third.
const HANDLE_SHARE: f64 = 0.4;
/// Half of how thick back rests are, padded or not (m).
const BACK_REST_M: f64 = 0.02;
/// Cosine between a surface's normal and a direction along it.
const ALONG: f64 = 0.5;
/// The same of a surface across it.
const ACROSS: f64 = 0.8;
/// At the end of something that hides it, more than this share of the surface is its front.
const FRONT_SHARE: f64 = 0.5;
/// Cosine of the angle between the view and a normal below which depth cameras lose readings.
const GRAZING: f64 = 0.2;
/// A surface leads to an end that has at least this share of its points there.
const LEADING_SHARE: f64 = 0.25;
/// What is thinner than this share of the shorter usual extent is a sliver.
const SLIVER_SHARE: f64 = 0.25;
