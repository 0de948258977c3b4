//! The object's own points: box crop, support plane, Euclidean clustering.
//!
//! Liao et al. 2020, section IV-A, steps 1 to 4.

use super::{
    ClassPrior, Frame, Refused, WallSegment,
    background::without_wall,
    bounds::Bounds,
    crop::{Crop, margin_m},
    silhouette::BoxSide,
    support::{GridPoint, SupportPlane},
    top::reaches_upper_side,
};
use crate::geometry::Rect;
use nalgebra::{Point3, Unit, Vector3};
use serde::{Deserialize, Serialize};

/// How an object's points are cut out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SegmentationSettings {
    /// Fewest points of an object, the paper's eps3, counted at full image resolution.
    pub min_points: usize,
    /// Most points sampled in a box.
    pub max_points: usize,
    /// Detectors cut objects: how much further than the box its points may reach, as a share of its sides.
    pub box_margin: f64,
    /// A cluster with more than this share of its points outside the box is something in front or behind.
    pub max_outside_box: f64,
    /// Smallest intersection over union of the box and the cluster's extent in the image.
    pub min_box_overlap: f64,
    /// Farthest reading used (m).
    pub max_range_m: f64,
    /// Smallest height above the support plane, added to what depth noise asks for (m); the paper's eps2 is 0.05.
    pub support_margin_m: f64,
    /// Gap that separates two clusters, added to what sampling and depth noise ask for (m).
    pub cluster_gap_m: f64,
}

impl Default for SegmentationSettings {
    fn default() -> Self {
        Self {
            min_points: 100,
            max_points: 2500,
            box_margin: 0.12,
            max_outside_box: 0.15,
            min_box_overlap: 0.3,
            max_range_m: 6.0,
            support_margin_m: 0.004,
            cluster_gap_m: 0.02,
        }
    }
}

/// A measured point of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub(super) u: i32,
    pub(super) v: i32,
    /// In the level frame.
    pub(super) at: Point3<f64>,
    /// Standard deviation of the reading along the viewing ray (m).
    pub(super) sigma_m: f64,
    pub(super) normal: Option<Unit<Vector3<f64>>>,
}

impl SurfacePoint {
    /// What was measured at a pixel.
    pub(super) fn read(frame: &Frame<'_>, u: i32, v: i32) -> Option<Self> {
        let sigma_m = frame.sigma_m(frame.depth().at(u, v)?.into());
        frame.point_in_level(u, v).map(|at| Self { u, v, at, sigma_m, normal: None })
    }

    /// Standard deviation of the point's position along a direction (m): noise acts along the viewing ray.
    pub(super) fn noise_along_m(&self, direction: &Vector3<f64>) -> f64 {
        self.sigma_m * direction.dot(&self.at.coords).abs() / self.at.coords.norm().max(1e-6)
    }

    /// Whether its pixel lies in a box of the image.
    pub(super) fn is_in(&self, rect: &Rect) -> bool {
        rect.contains(f64::from(self.u), f64::from(self.v))
    }
}

/// An object's points and what they stand on.
#[derive(Clone, Debug)]
pub(super) struct Segment<'a> {
    pub(super) points: Vec<SurfacePoint>,
    pub(super) support: Option<&'a SupportPlane>,
    /// Walls in sight, in the level frame.
    pub(super) walls: &'a [WallSegment],
    /// The detector's box, inside the image.
    pub(super) rect: Rect,
    /// The image.
    pub(super) image: Rect,
    /// Intersection over union of the box and the points' extent in the image.
    pub(super) agreement: f64,
    /// Distance between neighbouring samples on a surface facing the camera (m).
    pub(super) spacing_m: f64,
    /// The same (px).
    pub(super) stride: f64,
    /// Whether the points are only some part of the top of what carries things.
    pub(super) is_part_of_top: bool,
}

impl Segment<'_> {
    /// Whether the image ends where this side of the box is.
    pub(super) fn is_cut_by_image(&self, side: BoxSide) -> bool {
        side.of(&self.image) - side.of(&self.rect) < BORDER_PX
    }

    /// Whether a point is where the image cuts the object.
    pub(super) fn is_at_image_border(&self, p: &SurfacePoint) -> bool {
        BoxSide::ALL.into_iter().any(|side| {
            let to_border = side.of(&self.image) - side.outwards(f64::from(p.u), f64::from(p.v));
            self.is_cut_by_image(side) && to_border < 2.0 * BORDER_PX + self.stride
        })
    }

    /// Whether the points reach from the left to the right side of the box.
    pub(super) fn spans_box(&self) -> bool {
        let columns = || self.points.iter().map(|p| f64::from(p.u));
        let width = columns().fold(f64::MIN, f64::max) - columns().fold(f64::MAX, f64::min);
        width > SPANNED * self.rect.width()
    }

    /// Whether the rectangle round the points is nearly the box: they are all that is to be seen of the object.
    pub(super) fn fills_box(&self) -> bool {
        self.agreement > FILLED
    }

    /// From the camera to the middle of the points; a unit vector.
    pub(super) fn direction(&self) -> Vector3<f64> {
        let sum = self.points.iter().map(|p| p.at.coords).sum::<Vector3<f64>>();
        sum / sum.norm().max(1e-9)
    }

    /// What is no deeper than this is one face and nothing else (m).
    pub(super) fn sheet_m(&self) -> f64 {
        let noise = self.points.iter().map(|p| p.sigma_m).sum::<f64>() / self.points.len() as f64;
        SHEET_SIGMAS * noise + SHEET_M
    }

    /// From the lowest to the highest point (m).
    pub(super) fn height_m(&self) -> f64 {
        let heights = || self.points.iter().map(|p| p.at.z);
        heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min)
    }
}

/// Cuts out the object that the box of a crop is about.
pub(super) fn segment<'a>(
    (frame, planes): (&Frame<'_>, &'a [SupportPlane]),
    crop: &Crop,
    prior: &ClassPrior,
    settings: &SegmentationSettings,
) -> Result<Segment<'a>, Refused> {
    let enough = crop.samples(settings.min_points);
    if crop.points.len() < enough {
        return Err(Refused::TooFewPoints { got: crop.points.len(), needed: enough });
    }
    let (own, others): (Vec<&SupportPlane>, Vec<&SupportPlane>) =
        planes.iter().partition(|plane| is_part_of_object(plane, crop));
    let top = (own.into_iter())
        .filter(|plane| prior.carries && reaches_upper_side(plane, &crop.rect))
        .max_by_key(|plane| plane.points);
    let stands_on_top = |p: &SurfacePoint| {
        top.is_some_and(|plane| plane.height_of(&p.at) > margin_m(plane, p, settings))
    };
    let mut free = crop.off_planes(&others, settings);
    free.retain(|p| !stands_on_top(p));
    let mut first = crop.main_cluster(&free, settings).ok_or(Refused::NoCluster)?;
    // In a corner there are two walls.
    for _ in 0..2 {
        if crop.share_outside(&first) <= settings.max_outside_box {
            break;
        }
        let Some(before_wall) = without_wall(&free, &crop.rect) else { break };
        free = before_wall;
        first = crop.main_cluster(&free, settings).ok_or(Refused::NoCluster)?;
    }
    let support = supporting_plane(&others, &first, prior);
    let above: Vec<SurfacePoint> = match support {
        Some(plane) => first
            .into_iter()
            .filter(|p| plane.height_of(&p.at) > margin_m(plane, p, settings))
            .collect(),
        None => first,
    };
    let mut points = crop.main_cluster(&above, settings).ok_or(Refused::NoCluster)?;
    let outside = crop.share_outside(&points);
    if outside > settings.max_outside_box {
        return Err(Refused::GoesOnOutsideBox { outside });
    }
    let overlap = crop.agreement(&points);
    if overlap < settings.min_box_overlap {
        return Err(Refused::FillsTooLittle { overlap });
    }
    // What a detector sees of an object it bounds: points farther out belong to the next thing.
    let bound = BoxSide::widened(&crop.rect);
    points.retain(|p| p.is_in(&bound));
    if points.len() < enough {
        return Err(Refused::TooFewPoints { got: points.len(), needed: enough });
    }
    Ok(crop.segment(frame, points, support))
}

/// Of one face both ends are found within so many standard deviations of the depth,
const SHEET_SIGMAS: f64 = 2.0;
/// its own relief aside (m).
const SHEET_M: f64 = 0.02;
/// Points that are this much of the width of a box apart reach from its left to its right.
const SPANNED: f64 = 0.6;
/// Of a box and the rectangle round all that is to be seen of the object, this share is common.
const FILLED: f64 = 0.7;
/// Boxes that end this near to the image's border are cut by it (px).
const BORDER_PX: f64 = 4.0;

/// An object's own seat, mattress or top is a horizontal plane too: one that ends where the box ends, with more of
/// the object below it.
fn is_part_of_object(plane: &SupportPlane, crop: &Crop) -> bool {
    // Another table of the same height may be part of the plane: what counts is how it goes on round the box.
    let inside = count_in(plane, &crop.rect, 0.1);
    let near = count_in(plane, &crop.rect, OWN_PLANE_RING);
    if inside < MIN_OWN_PLANE || (inside as f64) < OWN_PLANE_SHARE * near as f64 {
        return false;
    }
    // A keyboard's top is a plane 3 cm above the next one.
    let is_below = |p: &&SurfacePoint| {
        plane.height_of(&p.at) < -(OWN_PLANE_STEP_M + 3.0 * p.noise_along_m(&plane.plane.normal))
    };
    10 * crop.points.iter().filter(is_below).count() > crop.points.len()
}

/// Points of a plane in a box that is widened by a share of its sides.
fn count_in(plane: &SupportPlane, rect: &Rect, share: f64) -> usize {
    let (mx, my) = (share * rect.width(), share * rect.height());
    let is_in = |p: &&GridPoint| {
        let (u, v) = (f64::from(p.u), f64::from(p.v));
        u > rect.x_min - mx && u < rect.x_max + mx && v > rect.y_min - my && v < rect.y_max + my
    };
    plane.inliers.iter().filter(is_in).count()
}

const OWN_PLANE_SHARE: f64 = 0.7;
/// How far round the box its plane must have ended, as a share of its sides.
const OWN_PLANE_RING: f64 = 0.4;
const MIN_OWN_PLANE: usize = 6;
/// What lies this much lower, noise aside, is not the same plane (m).
const OWN_PLANE_STEP_M: f64 = 0.01;

/// The highest plane that the cluster stands on: below its centre, next to it, and with nothing of it underneath. What has
/// legs does not stand where they would be stumps: those are the seats of the chairs before a table.
fn supporting_plane<'a>(
    planes: &[&'a SupportPlane],
    cluster: &[SurfacePoint],
    prior: &ClassPrior,
) -> Option<&'a SupportPlane> {
    let center = cluster.iter().map(|p| p.at.coords).sum::<Vector3<f64>>() / cluster.len() as f64;
    let mut below: Vec<&SupportPlane> =
        planes.iter().copied().filter(|plane| plane.height_of(&center.into()) > 0.0).collect();
    below.sort_by(|a, b| a.height_of(&center.into()).total_cmp(&b.height_of(&center.into())));
    let floor = below.last().copied()?;
    // The floor reaches everywhere; a table top only as far as it was seen.
    below.into_iter().find(|plane| {
        std::ptr::eq(*plane, floor)
            || (nothing_underneath(plane, cluster)
                && is_next_to(plane, cluster)
                && !would_be_stumps(plane, cluster, prior))
    })
}

/// Whether something on legs would be much lower than its class if it stood on the plane.
fn would_be_stumps(plane: &SupportPlane, cluster: &[SurfacePoint], prior: &ClassPrior) -> bool {
    let top_m = || cluster.iter().map(|p| plane.height_of(&p.at)).fold(0.0, f64::max);
    let usual_m = prior.size_m.filter(|_| prior.legs).map(|[_, _, height]| height);
    usual_m.is_some_and(|usual_m| top_m() < STUMPS_SHARE * usual_m)
}

/// Whether the cluster's lowest points are on the plane: the book beside a monitor is higher than the monitor's foot.
fn nothing_underneath(plane: &SupportPlane, cluster: &[SurfacePoint]) -> bool {
    let depth =
        |p: &SurfacePoint| -plane.height_of(&p.at) - UNDERNEATH_M - 2.0 * (p.sigma_m + plane.rms_m);
    let underneath = cluster.iter().filter(|p| depth(p) > 0.0).count();
    underneath <= 2 + cluster.len() / 200
}

fn is_next_to(plane: &SupportPlane, cluster: &[SurfacePoint]) -> bool {
    let bounds = Bounds::of(cluster.iter().map(|p| p.at));
    plane.inliers.iter().any(|p| bounds.distance_on_ground_m(&p.at) < NEXT_TO_M)
}

/// Things on legs are at least this share of their usual height.
const STUMPS_SHARE: f64 = 0.6;
/// Points this far below a plane are not on it (m).
const UNDERNEATH_M: f64 = 0.008;
/// A plane seen this near to an object goes on under it (m).
const NEXT_TO_M: f64 = 0.15;
