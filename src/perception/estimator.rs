//! From one box of one frame to an ellipsoid: Liao et al. 2020, section IV, on one page.

use super::{
    ClassPrior, Classes, Detection, EllipsoidMeasurement, Frame, Glimpse, Probability, Refused,
    Side, SupportPlane, SupportSettings, SymmetryPlane, SymmetryType, WallSegment, WallSettings,
    claims::Claims,
    crop::Crop,
    edges::heading_of_edges,
    faces::Faces,
    find_support_planes, find_walls,
    fit::{fit_ellipsoid, fit_probability},
    footprint::{Heading, heading_of_faces, heading_of_rectangle},
    glimpse::glimpse,
    masks::Masks,
    segmentation::{Segment, SegmentationSettings, SurfacePoint, segment},
    stage::{Stage, StageObserver},
    symmetry::refine_symmetry,
    top::part_of_top,
};
use crate::geometry::{Ellipsoid, Outline};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

/// Settings of the single-frame estimation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PerceptionSettings {
    /// Support planes.
    pub support: SupportSettings,
    /// Walls.
    pub walls: WallSettings,
    /// Cutting out an object's points.
    pub segmentation: SegmentationSettings,
    /// Size and place from the points.
    pub fit: FitModel,
    /// Boxes of a lower score are not looked at.
    pub min_score: f64,
    /// Whether boxes without a measurement say where an object is, from several places.
    pub glimpses: bool,
    /// Boxes of an image that are looked at, the most probable ones.
    pub max_boxes: usize,
    /// Names of a box that count, the most probable ones.
    pub max_names: usize,
    /// What is known of each class.
    pub classes: Classes,
}

impl Default for PerceptionSettings {
    fn default() -> Self {
        Self {
            support: SupportSettings::default(),
            walls: WallSettings::default(),
            segmentation: SegmentationSettings::default(),
            fit: FitModel::default(),
            min_score: 0.1,
            glimpses: true,
            max_boxes: 100,
            max_names: 10,
            classes: Classes::default(),
        }
    }
}

/// How size and place follow from the completed points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FitModel {
    /// From where the object's faces are: extents without the bias of an ellipsoid laid through a cuboid.
    #[default]
    Faces,
    /// The paper's least squares of eq. (7).
    Quadric,
}

/// What one frame says.
#[derive(Clone, Debug)]
pub struct FrameEstimate {
    /// Support planes in the level frame, the one with most points first.
    pub planes: Vec<SupportPlane>,
    /// Walls in sight.
    pub walls: Vec<WallSegment>,
    /// For each detection, in order, a measurement or why not.
    pub objects: Vec<Result<EllipsoidMeasurement, Refused>>,
    /// For each detection without a measurement, what its box says by itself.
    pub glimpses: Vec<Option<Glimpse>>,
}

/// Estimates an ellipsoid for every box of a frame.
pub fn estimate_frame(
    frame: &Frame<'_>,
    detections: &[Detection],
    settings: &PerceptionSettings,
    observer: &mut dyn StageObserver,
) -> FrameEstimate {
    observer.enter(Some(Stage::SupportPlanes));
    let planes = find_support_planes(frame, &settings.support);
    observer.enter(Some(Stage::Walls));
    let walls = find_walls(frame, settings.segmentation.max_range_m, &settings.walls);
    let level_from_camera = frame.level_from_camera();
    let walls_in_level: Vec<WallSegment> =
        walls.iter().map(|wall| wall.transformed(&level_from_camera)).collect();
    let scenery = Scenery { planes: &planes, walls: &walls_in_level };
    let masks = Masks::new(frame, detections);
    let mut estimates: Vec<_> = detections
        .iter()
        .enumerate()
        .map(|(at, detection)| {
            let are_others = |p: &SurfacePoint| masks.forbid(at, p);
            estimate_object(frame, scenery, detection, settings, &are_others, observer)
        })
        .collect();
    let boxes = detections.iter().zip(&estimates);
    let claims =
        Claims::new(frame, boxes.map(|(d, e)| (d.rect, e.as_ref().ok().map(|e| &e.segment))));
    let are_others = |at: usize| {
        let (masks, claims) = (&masks, &claims);
        move |p: &SurfacePoint| masks.forbid(at, p) || claims.are_others(at, p)
    };
    for (at, detection) in detections.iter().enumerate().filter(|(at, _)| claims.contest(*at)) {
        estimates[at] =
            estimate_object(frame, scenery, detection, settings, &are_others(at), observer);
    }
    let seen = (scenery, detections);
    let (objects, glimpses) = (detections.iter().zip(estimates).enumerate())
        .map(|(at, of_box)| measured_or_glimpsed(frame, of_box, (seen, &are_others(at)), settings))
        .unzip();
    FrameEstimate { planes, walls, objects, glimpses }
}

/// A box without a measurement has a glimpse; if the measurement is vague, the glimpse says more.
fn measured_or_glimpsed(
    frame: &Frame<'_>,
    (detection, estimate): (&Detection, Result<Estimate<'_>, Refused>),
    (seen, are_others): ((Scenery<'_>, &[Detection]), Others<'_>),
    settings: &PerceptionSettings,
) -> (Result<EllipsoidMeasurement, Refused>, Option<Glimpse>) {
    let is_vague = estimate.as_ref().map_or(true, |estimate| estimate.is_vague);
    let wanted = settings.glimpses && is_vague;
    let glimpse = wanted.then(|| glimpse(frame, detection, seen, are_others, settings)).flatten();
    let measured = match estimate {
        Ok(_) if glimpse.is_some() => Err(Refused::TooLittleSeen { known: 0 }),
        estimate => estimate.map(|estimate| estimate.measurement),
    };
    (measured, glimpse)
}

/// Whether a reading is of another box's object.
type Others<'a> = &'a dyn Fn(&SurfacePoint) -> bool;

/// What is around the objects of a frame, in the level frame.
#[derive(Clone, Copy)]
pub(super) struct Scenery<'a> {
    pub(super) planes: &'a [SupportPlane],
    pub(super) walls: &'a [WallSegment],
}

/// A measurement and what it was made from.
struct Estimate<'a> {
    measurement: EllipsoidMeasurement,
    segment: Segment<'a>,
    /// Whether the points are of the object, but nobody knows of which part.
    is_vague: bool,
}

/// Estimates the ellipsoid of one detected object, without the points that are others'; or the reason why its box gives none.
fn estimate_object<'a>(
    frame: &Frame<'_>,
    scenery: Scenery<'a>,
    detection: &Detection,
    settings: &PerceptionSettings,
    are_others: Others<'_>,
    observer: &mut dyn StageObserver,
) -> Result<Estimate<'a>, Refused> {
    observer.enter(Some(Stage::Segmentation));
    let prior = settings.classes.prior(detection.label());
    let mut crop = Crop::new(frame, &detection.rect, &settings.segmentation)?;
    crop.points.retain(|p| !are_others(p));
    let around = (frame, scenery.planes);
    let whole = segment(around, &crop, &prior, &settings.segmentation);
    let of_class = (detection, &prior);
    let estimate = |segment: Segment<'a>, observer: &mut dyn StageObserver| {
        let segment = Segment { walls: scenery.walls, ..segment };
        estimate_segment(frame, segment, of_class, settings.fit, observer)
    };
    let whole = whole.and_then(|segment| estimate(segment, observer));
    let Err(why) = whole else { return whole };
    let top = part_of_top(around, &crop, &prior, &settings.segmentation);
    top.and_then(|top| estimate(top, observer).ok()).ok_or(why)
}

/// Estimates the ellipsoid of an object that was cut out.
fn estimate_segment<'a>(
    frame: &Frame<'_>,
    segment: Segment<'a>,
    (detection, prior): (&Detection, &ClassPrior),
    fit: FitModel,
    observer: &mut dyn StageObserver,
) -> Result<Estimate<'a>, Refused> {
    observer.enter(Some(Stage::Faces));
    let heading = heading(frame, &segment, prior);
    let (faces, symmetry) = completed_faces(frame, &segment, &heading, prior, observer)?;
    let known = faces.faces[..4].iter().filter(|f| f.side.is_known()).count();
    // Without a usual size there is nothing to guess from.
    let is_part = segment.is_part_of_top || segment.fills_box();
    let is_guess = prior.size_m.is_some_and(|size| is_part || !faces.is_sliver(size));
    if known == 0 && !is_guess || faces.lacks_its_top(prior) {
        return Err(Refused::TooLittleSeen { known });
    }
    observer.enter(Some(Stage::Fit));
    let completed = completed_points(&segment, &symmetry);
    let body = Ellipsoid::new(faces.pose(), faces.semi_axes_m());
    let in_level = match fit {
        FitModel::Faces => body,
        FitModel::Quadric => fit_ellipsoid(&completed, &body).ellipsoid,
    };
    let probability = Probability {
        detection: detection.probability(),
        symmetry: symmetry_probability(&symmetry, prior.symmetry),
        fit: fit_probability(&completed, &in_level, outline_of(fit, prior.outline)),
    };
    let silhouette = faces.silhouette(frame, &segment);
    // Leaves leave no reading beside them that would show their end, but the box ends there, and behind it is something else.
    let is_bounded = silhouette[0] && silhouette[2] && segment.spans_box();
    let place_sigma_m = faces.place_sigma_m(&segment, prior, is_bounded);
    let is_vague = place_sigma_m > 0.0 && !segment.is_part_of_top;
    let camera_from_level = frame.level_from_camera().inverse();
    let measurement = EllipsoidMeasurement {
        ellipsoid: in_level.transformed(&camera_from_level),
        covariance: faces.covariance(
            yaw_sigma(&heading, &faces, prior.outline),
            TILT_SIGMA_RAD,
            place_sigma_m,
        ),
        sides: faces.faces.map(|face| face.side),
        faces: faces.evidence(),
        silhouette,
        outline: prior.outline,
        probability,
        symmetry: symmetry
            .into_iter()
            .map(|s| SymmetryPlane { plane: s.plane.transformed(&camera_from_level), ..s })
            .collect(),
        support: segment.support.map(|s| s.plane.transformed(&camera_from_level)),
        points: segment.points.len(),
    };
    Ok(Estimate { measurement, segment, is_vague })
}

/// The six faces, and the mirror planes that told where some of them are. What is found out on the way (a mirror image, how far
/// the box reaches) says more of what is still hidden, so that it is guessed again.
fn completed_faces(
    frame: &Frame<'_>,
    segment: &Segment<'_>,
    heading: &Heading,
    prior: &ClassPrior,
    observer: &mut dyn StageObserver,
) -> Result<(Faces, Vec<SymmetryPlane>), Refused> {
    let seen = Faces::measure(frame, segment, heading.yaw, prior);
    let guessed = |known: &Faces| seen.knowing(known).guessed(frame, segment, prior);
    let mut faces = guessed(&seen);
    observer.enter(Some(Stage::Symmetry));
    let symmetry = complete_by_symmetry(frame, segment, prior.symmetry, &mut faces);
    if !symmetry.is_empty() {
        faces = guessed(&faces);
    }
    faces.stay_in_box(frame, segment, prior.outline)?;
    faces.reach_box(frame, segment, prior);
    if faces.faces.iter().any(|face| face.side == Side::Outline) {
        let mut again = guessed(&faces);
        if again.stay_in_box(frame, segment, prior.outline).is_ok() {
            faces = again;
        }
    }
    if !prior.outline.is_round() {
        faces.doubt_heading(heading.sigma);
    }
    faces.allow_for_handles(prior.outline);
    Ok((faces, symmetry))
}

fn outline_of(fit: FitModel, outline: Outline) -> Outline {
    match fit {
        FitModel::Faces => outline,
        FitModel::Quadric => Outline::Ellipsoid,
    }
}

/// The object's heading: from its vertical faces if it has them, otherwise from its footprint.
fn heading(frame: &Frame<'_>, segment: &Segment<'_>, prior: &ClassPrior) -> Heading {
    if prior.carries {
        let top = segment.widest(prior);
        return heading_of_edges(frame, &top, segment.stride as i32).unwrap_or_else(|| {
            let rectangle = heading_of_rectangle(&top);
            Heading { sigma: rectangle.sigma.hypot(UNSEEN_EDGES_RAD), ..rectangle }
        });
    }
    let has_faces = !prior.outline.is_round();
    let of_faces = if has_faces { heading_of_faces(&segment.points) } else { None };
    of_faces.unwrap_or_else(|| heading_of_rectangle(&segment.widest(prior)))
}

/// Yaw of a round footprint means nothing: its uncertainty grows to "any" as the sides become equal.
fn yaw_sigma(heading: &Heading, faces: &Faces, outline: Outline) -> f64 {
    let (a, b) = (faces.extent_m(0), faces.extent_m(1));
    let elongation = (a - b).abs() / a.max(b);
    if outline.is_round() {
        // The tangent of an ellipse turns with its axes only as far as it is no circle, and only what was seen counts.
        let is_seen = faces.faces[..4].iter().all(|face| face.side.is_known());
        let telling = if is_seen { elongation } else { 0.0 };
        return (ROUND_SIGMA_RAD / telling.max(1e-3)).min(ANY_HEADING_RAD);
    }
    let unclear = if heading.of_faces { 0.0 } else { 0.3 * (1.0 - elongation / 0.1).max(0.0) };
    heading.sigma.hypot(unclear)
}

/// Looks for the mirror planes of the class and completes the faces they reveal.
fn complete_by_symmetry(
    frame: &Frame<'_>,
    segment: &Segment<'_>,
    symmetry: SymmetryType,
    faces: &mut Faces,
) -> Vec<SymmetryPlane> {
    // Whatever part of a level top is seen is symmetric in many planes.
    if symmetry == SymmetryType::None || segment.is_part_of_top {
        return Vec::new();
    }
    let mut found: Vec<(usize, SymmetryPlane)> = (0..2)
        // One face alone is its own mirror image.
        .filter(|axis| faces.seen_extent_m(*axis) > segment.sheet_m())
        .filter_map(|axis| {
            let angle = faces.yaw + axis as f64 * std::f64::consts::FRAC_PI_2;
            let extent = faces.extent_m(axis);
            let center = faces.center_m(axis);
            let both_known = faces.faces[2 * axis..2 * axis + 2].iter().all(|f| f.side.is_known());
            refine_symmetry(frame, &segment.points, angle, center, extent, both_known)
                .map(|plane| (axis, plane))
        })
        .collect();
    if symmetry == SymmetryType::Plane {
        found.sort_by(|a, b| {
            let worth = |s: &SymmetryPlane| s.evidence * (s.probability - 0.5);
            worth(&b.1).total_cmp(&worth(&a.1))
        });
        found.truncate(1);
    }
    for (axis, plane) in &found {
        faces.complete(*axis, -plane.plane.offset, plane.sigma_m);
    }
    found.into_iter().map(|(_, plane)| plane).collect()
}

/// `P_sym` of the planes together; without evidence neither good nor bad.
fn symmetry_probability(planes: &[SymmetryPlane], symmetry: SymmetryType) -> f64 {
    if planes.is_empty() || symmetry == SymmetryType::None {
        return UNKNOWN_SYMMETRY;
    }
    planes.iter().map(|s| s.probability).sum::<f64>() / planes.len() as f64
}

/// The measured points and their mirror images.
fn completed_points(segment: &Segment<'_>, symmetry: &[SymmetryPlane]) -> Vec<Point3<f64>> {
    let every = segment.points.len().div_ceil(MAX_FIT_POINTS).max(1);
    let mut points: Vec<Point3<f64>> = segment.points.iter().step_by(every).map(|p| p.at).collect();
    for s in symmetry {
        let mirrored: Vec<_> = points.iter().map(|p| s.plane.mirrored(p)).collect();
        points.extend(mirrored);
    }
    points
}

/// Classes without symmetry must not be more probable than symmetric ones.
const UNKNOWN_SYMMETRY: f64 = 0.5;
/// Heading of an outline without faces, times its elongation (rad).
const ROUND_SIGMA_RAD: f64 = 0.12;
/// Standard deviation of a heading that may be anything within a quarter turn (rad).
const ANY_HEADING_RAD: f64 = 0.5;
/// How far a rectangle round what was seen of a top may be turned against it, where none of its own edges was seen (rad).
const UNSEEN_EDGES_RAD: f64 = 0.3;
const MAX_FIT_POINTS: usize = 400;
/// Objects stand upright and gravity is known to about this much (rad).
const TILT_SIGMA_RAD: f64 = 0.02;
