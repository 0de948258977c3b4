//! The sampled pixels of a box, and which of them are one thing.

use super::{
    Frame, Refused, SegmentationSettings,
    clustering::euclidean_clusters,
    normal::local_normal,
    segmentation::{Segment, SurfacePoint},
    support::SupportPlane,
};
use crate::geometry::Rect;
use nalgebra::Point3;

/// The sampled pixels of a box.
pub(super) struct Crop {
    pub(super) points: Vec<SurfacePoint>,
    pub(super) rect: Rect,
    image: Rect,
    stride: i32,
    focal_px: f64,
}

impl Crop {
    pub(super) fn new(
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
                    && let Some(point) = SurfacePoint::read(frame, u, v)
                {
                    points.push(point);
                }
            }
        }
        Ok(Self { points, rect: clipped, image, stride, focal_px: frame.camera().focal().0 })
    }

    /// The points that lie on none of the planes. Noise lifts one in a hundred readings off its plane; these are few
    /// among many that lie on it, unlike the readings of something low that stands there.
    pub(super) fn off_planes(
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

    /// The segment that these points are.
    pub(super) fn segment<'a>(
        &self,
        frame: &Frame<'_>,
        mut points: Vec<SurfacePoint>,
        support: Option<&'a SupportPlane>,
    ) -> Segment<'a> {
        add_normals(frame, &mut points, self.stride);
        Segment {
            spacing_m: self.spacing_m(&points),
            stride: f64::from(self.stride),
            agreement: self.agreement(&points),
            points,
            support,
            walls: &[],
            rect: self.rect,
            image: self.image,
            is_part_of_top: false,
        }
    }

    /// How many samples stand for so many pixels, and at least what tells anything.
    pub(super) fn samples(&self, pixels: usize) -> usize {
        (pixels / (self.stride * self.stride) as usize).max(MIN_SAMPLES)
    }

    fn spacing_m(&self, points: &[SurfacePoint]) -> f64 {
        let range = points.iter().map(|p| p.at.coords.norm()).sum::<f64>() / points.len() as f64;
        f64::from(self.stride) * range / self.focal_px
    }

    /// The cluster that the box is about: many points near the box's centre, few that go on outside it.
    ///
    /// The paper takes the cluster nearest to the 3D point at the box's centre; that point is missing or on the
    /// wall behind for chairs with open backs, plants and dark screens, so every point votes.
    pub(super) fn main_cluster(
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

    pub(super) fn share_outside(&self, points: &[SurfacePoint]) -> f64 {
        points.iter().filter(|p| !p.is_in(&self.rect)).count() as f64 / points.len() as f64
    }

    /// Intersection over union of the box and the rectangle around the points.
    pub(super) fn agreement(&self, points: &[SurfacePoint]) -> f64 {
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

/// How near to a plane a point counts as part of it (m).
pub(super) fn margin_m(
    plane: &SupportPlane,
    point: &SurfacePoint,
    settings: &SegmentationSettings,
) -> f64 {
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

fn add_normals(frame: &Frame<'_>, points: &mut [SurfacePoint], stride: i32) {
    let (focal, _) = frame.camera().focal();
    for p in points {
        let range = p.at.coords.norm();
        let wanted = 0.015_f64.max(5.0 * p.sigma_m) * focal / range;
        let step = (wanted as i32).clamp(2, 16).max(stride);
        p.normal = local_normal(frame, p.u, p.v, step);
    }
}

/// Fewer samples tell nothing.
const MIN_SAMPLES: usize = 12;
