//! The object's own points: box crop, support plane, Euclidean clustering.
//!
//! Liao et al. 2020, section IV-A, steps 1 to 4.

use super::{
    ClassPrior, Frame, Refused, WallSegment,
    background::without_wall,
    bounds::Bounds,
    clustering::euclidean_clusters,
    normal::local_normal,
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

/// Cuts out the object in `rect`, from what are not others' points.
pub(super) fn segment<'a>(
    frame: &Frame<'_>,
    planes: &'a [SupportPlane],
    rect: &Rect,
    prior: &ClassPrior,
    settings: &SegmentationSettings,
    are_others: &dyn Fn(&SurfacePoint) -> bool,
) -> Result<Segment<'a>, Refused> {
    let mut crop = Crop::new(frame, rect, settings)?;
    crop.points.retain(|p| !are_others(p));
    let enough = (settings.min_points / (crop.stride * crop.stride) as usize).max(12);
    if crop.points.len() < enough {
        return Err(Refused::TooFewPoints { got: crop.points.len(), needed: enough });
    }
    let (own, others): (Vec<&SupportPlane>, Vec<&SupportPlane>) =
        planes.iter().partition(|plane| is_part_of_object(plane, &crop));
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
    add_normals(frame, &mut points, crop.stride);
    let stride = f64::from(crop.stride);
    let spacing_m = crop.spacing_m(&points);
    Ok(Segment {
        spacing_m,
        stride,
        points,
        support,
        walls: &[],
        rect: crop.rect,
        image: crop.image,
        agreement: overlap,
    })
}

/// Of one face both ends are found within so many standard deviations of the depth,
const SHEET_SIGMAS: f64 = 2.0;
/// its own relief aside (m).
const SHEET_M: f64 = 0.02;
/// Points that are this much of the width of a box apart reach from its left to its right.
const SPANNED: f64 = 0.6;
/// Boxes that end this near to the image's border are cut by it (px).
const BORDER_PX: f64 = 4.0;

/// The sampled pixels of a box.
struct Crop {
    points: Vec<SurfacePoint>,
    rect: Rect,
    image: Rect,
    stride: i32,
    focal_px: f64,
}

impl Crop {
    fn new(
        frame: &Frame<'_>,
        rect: &Rect,
        settings: &SegmentationSettings,
    ) -> Result<Self, Refused> {
        let (width, height) = (frame.depth().width(), frame.depth().height());
        let (mx, my) = (settings.box_margin * rect.width(), settings.box_margin * rect.height());
        let inside = Rect::new(rect.x_min - mx, rect.y_min - my, rect.x_max + mx, rect.y_max + my)
            .and_then(|r| r.clipped(width, height));
        let image = Rect::new(0.0, 0.0, f64::from(width) - 1.0, f64::from(height) - 1.0);
        let (Some(inside), Some(clipped), Some(image)) =
            (inside, rect.clipped(width, height), image)
        else {
            return Err(Refused::OutsideImage);
        };
        let stride = (clipped.area() / settings.max_points as f64).sqrt().ceil().max(1.0) as i32;
        let mut points = Vec::new();
        for v in (inside.y_min.ceil() as i32..=inside.y_max as i32).step_by(stride as usize) {
            for u in (inside.x_min.ceil() as i32..=inside.x_max as i32).step_by(stride as usize) {
                let Some(z) = frame.depth().at(u, v).map(f64::from) else { continue };
                if z <= settings.max_range_m
                    && !is_flying(frame, u, v)
                    && let Some(at) = frame.point_in_level(u, v)
                {
                    points.push(SurfacePoint { u, v, at, sigma_m: frame.sigma_m(z), normal: None });
                }
            }
        }
        Ok(Self { points, rect: clipped, image, stride, focal_px: frame.camera().focal().0 })
    }

    /// The points that lie on none of the planes. Noise lifts one in a hundred readings off its plane; these are few
    /// among many that lie on it, unlike the readings of something low that stands there.
    fn off_planes(
        &self,
        planes: &[&SupportPlane],
        settings: &SegmentationSettings,
    ) -> Vec<SurfacePoint> {
        let columns = (self.image.x_max as i32 / self.stride + 3) as usize;
        let cell = |p: &SurfacePoint| {
            (p.v / self.stride + 1) as usize * columns + (p.u / self.stride + 1) as usize
        };
        let rows = (self.image.y_max as i32 / self.stride + 3) as usize;
        let mut is_off = vec![false; columns * rows];
        let on = |p: &SurfacePoint, margins: f64| {
            planes.iter().any(|plane| lies_on(plane, p, margins, settings))
        };
        let off: Vec<SurfacePoint> = self.points.iter().filter(|p| !on(p, 1.0)).copied().collect();
        for p in &off {
            is_off[cell(p)] = true;
        }
        let company = |p: &SurfacePoint| {
            let at = cell(p);
            [at - columns, at, at + columns]
                .iter()
                .flat_map(|row| [row - 1, *row, row + 1])
                .filter(|i| is_off[*i])
                .count()
        };
        off.into_iter().filter(|p| company(p) >= COMPANY || !on(p, WEAK_MARGINS)).collect()
    }

    fn spacing_m(&self, points: &[SurfacePoint]) -> f64 {
        let range = points.iter().map(|p| p.at.coords.norm()).sum::<f64>() / points.len() as f64;
        f64::from(self.stride) * range / self.focal_px
    }

    /// The cluster that the box is about: many points near the box's centre, few that go on outside it.
    ///
    /// The paper takes the cluster nearest to the 3D point at the box's centre; that point is missing or on the
    /// wall behind for chairs with open backs, plants and dark screens, so every point votes.
    fn main_cluster(
        &self,
        points: &[SurfacePoint],
        settings: &SegmentationSettings,
    ) -> Option<Vec<SurfacePoint>> {
        if points.is_empty() {
            return None;
        }
        let sigma = points.iter().map(|p| p.sigma_m).sum::<f64>() / points.len() as f64;
        let gap = settings.cluster_gap_m + 2.0 * self.spacing_m(points) + 2.0 * sigma;
        let positions: Vec<Point3<f64>> = points.iter().map(|p| p.at).collect();
        let clusters = euclidean_clusters(&positions, gap);
        // Of equal votes the larger cluster, which comes first, wins.
        let mut best: Option<(f64, Vec<usize>)> = None;
        for cluster in clusters {
            let votes = self.votes(points, &cluster);
            if best.as_ref().is_none_or(|(most, _)| votes > *most) {
                best = Some((votes, cluster));
            }
        }
        let (_, best) = best?;
        Some(best.into_iter().map(|i| points[i]).collect())
    }

    fn share_outside(&self, points: &[SurfacePoint]) -> f64 {
        points.iter().filter(|p| !p.is_in(&self.rect)).count() as f64 / points.len() as f64
    }

    /// Intersection over union of the box and the rectangle around the points.
    fn agreement(&self, points: &[SurfacePoint]) -> f64 {
        let (mut low, mut high) = ((i32::MAX, i32::MAX), (i32::MIN, i32::MIN));
        for p in points {
            low = (low.0.min(p.u), low.1.min(p.v));
            high = (high.0.max(p.u), high.1.max(p.v));
        }
        let around = Rect::new(low.0.into(), low.1.into(), high.0.into(), high.1.into());
        around.map_or(0.0, |around| self.rect.overlap(&around))
    }

    fn votes(&self, points: &[SurfacePoint], cluster: &[usize]) -> f64 {
        let (cx, cy) = self.rect.center();
        let (mut inside, mut outside) = (0.0, 0.0);
        for p in cluster.iter().map(|i| &points[*i]) {
            let dx = (f64::from(p.u) - cx) / (0.5 * self.rect.width());
            let dy = (f64::from(p.v) - cy) / (0.5 * self.rect.height());
            if dx.abs() <= 1.0 && dy.abs() <= 1.0 {
                inside += (-2.0 * (dx * dx + dy * dy)).exp();
            } else {
                outside += 1.0;
            }
        }
        let share_outside = outside / cluster.len() as f64;
        inside * (1.0 - share_outside)
    }
}

/// A reading between a near and a far surface is an average of both. A surface seen at a grazing angle changes fast
/// too, but it goes on at the same rate.
fn is_flying(frame: &Frame<'_>, u: i32, v: i32) -> bool {
    let depth = frame.depth();
    let Some(z) = depth.at(u, v).map(f64::from) else { return true };
    let jump = 0.02 + 4.0 * frame.sigma_m(z);
    let between = |du: i32, dv: i32| {
        let at = |steps: i32| depth.at(u + steps * du, v + steps * dv).map(f64::from);
        let (Some(before), Some(after)) = (at(-1), at(1)) else {
            return at(-1).is_none() && at(1).is_none();
        };
        let (a, b) = (before - z, after - z);
        let goes_on =
            |one: f64, two: Option<f64>| two.is_some_and(|two| (z - 2.0 * one + two).abs() < jump);
        a.abs().min(b.abs()) > jump
            && a * b < 0.0
            && !goes_on(before, at(-2))
            && !goes_on(after, at(2))
    };
    between(2, 0) || between(0, 2)
}

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

/// How near to a plane a point counts as part of it (m).
fn margin_m(plane: &SupportPlane, point: &SurfacePoint, settings: &SegmentationSettings) -> f64 {
    settings.support_margin_m + 2.0 * plane.rms_m + 2.5 * point.noise_along_m(&plane.plane.normal)
}

/// Whether a point belongs to a plane: near it, and where the plane was seen.
fn lies_on(
    plane: &SupportPlane,
    point: &SurfacePoint,
    margins: f64,
    settings: &SegmentationSettings,
) -> bool {
    if plane.height_of(&point.at).abs() > margins * margin_m(plane, point, settings) {
        return false;
    }
    // Inliers are in the order of the image's rows.
    let rows = |v: i32| plane.inliers.partition_point(|p| p.v < v);
    let window = &plane.inliers[rows(point.v - NEAR_PX)..rows(point.v + NEAR_PX + 1)];
    window.iter().any(|p| (p.u - point.u).abs() <= NEAR_PX)
}

const NEAR_PX: i32 = 10;
/// Up to so many margins from a plane a point may be one that noise has lifted off,
const WEAK_MARGINS: f64 = 2.0;
/// unless so many of the nine samples round it, itself included, are off the plane.
const COMPANY: usize = 4;

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

fn add_normals(frame: &Frame<'_>, points: &mut [SurfacePoint], stride: i32) {
    let (focal, _) = frame.camera().focal();
    for p in points {
        let range = p.at.coords.norm();
        let wanted = 0.015_f64.max(5.0 * p.sigma_m) * focal / range;
        let step = (wanted as i32).clamp(2, 16).max(stride);
        p.normal = local_normal(frame, p.u, p.v, step);
    }
}
