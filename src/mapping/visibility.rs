//! What a camera should see of an object, and what the depth image shows there.

use crate::{
    geometry::{Camera, Ellipsoid, ImageSide, Outline, Pose, Rect, Silhouette},
    perception::{DepthImage, DepthNoise},
};
use nalgebra::{Point3, Vector3};

/// The image that a sighting was made in.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Where the camera is on the robot.
    pub base_from_camera: Pose,
    /// The camera of boxes and depth.
    pub camera: &'a Camera,
    /// What it measured.
    pub depth: &'a DepthImage,
    /// How well.
    pub noise: DepthNoise,
    /// Nothing farther off is expected to be detected (m).
    pub max_range_m: f64,
}

/// An object as it should look in an image.
#[derive(Clone, Debug)]
pub(super) struct Prospect {
    /// The box round what is not hidden, as far as it lies in the image (px).
    pub(super) rect: Rect,
    /// Whether so much of it is in the image, near and large enough that a detector should see it.
    is_in_view: bool,
    /// What the depth image shows along rays through it, as shares of those with a reading.
    hidden: f64,
    free: f64,
    /// Rays with a reading.
    readings: usize,
    /// Where in it rays end, in the map.
    ends: Vec<Point3<f64>>,
}

impl Prospect {
    /// Nothing where the object is behind the camera or outside the image.
    pub(super) fn new(
        view: &View<'_>,
        map_from_base: &Pose,
        object: &Ellipsoid,
        outline: Outline,
    ) -> Option<Self> {
        let camera_from_map = (map_from_base * view.base_from_camera).inverse();
        let body = object.transformed(&camera_from_map);
        let center = body.center();
        if center.z - body.semi_axes.norm() < MIN_DEPTH_M {
            return None;
        }
        let silhouette = Silhouette::new(&body, outline);
        let [left, upper, right, lower] =
            ImageSide::ALL.map(|side| silhouette.tangent(side, 0.0).at);
        let low = view.camera.project(&Point3::new(left, upper, 1.0))?;
        let high = view.camera.project(&Point3::new(right, lower, 1.0))?;
        let whole = Rect::new(low.x, low.y, high.x, high.y)?;
        let rect = whole.clipped(view.camera.width(), view.camera.height())?;
        let mut prospect = Self {
            rect,
            is_in_view: center.z < view.max_range_m
                && rect.area() > MIN_INSIDE * whole.area()
                && rect.width().min(rect.height()) > MIN_SIDE_PX,
            hidden: 0.0,
            free: 0.0,
            readings: 0,
            ends: Vec::new(),
        };
        prospect.look(view, &body, outline);
        let map_from_camera = camera_from_map.inverse();
        prospect.ends.iter_mut().for_each(|end| *end = map_from_camera * *end);
        Some(prospect)
    }

    /// Follows a grid of rays through the body.
    fn look(&mut self, view: &View<'_>, body: &Ellipsoid, outline: Outline) {
        let (mut hidden, mut free) = (0_usize, 0_usize);
        let mut visible: Option<[usize; 4]> = None;
        let step = |extent: f64, at: usize| extent * (at as f64 + 0.5) / RAYS as f64;
        for (i, j) in (0..RAYS).flat_map(|i| (0..RAYS).map(move |j| (i, j))) {
            let u = (self.rect.x_min + step(self.rect.width(), i)).round();
            let v = (self.rect.y_min + step(self.rect.height(), j)).round();
            let ray = view.camera.ray(u, v);
            let Some((near, far)) = crossing(body, outline, &ray) else { continue };
            let Some(depth) = view.depth.at(u as i32, v as i32).map(f64::from) else { continue };
            let tolerance = TOLERANCE_M + 3.0 * view.noise.sigma_m(depth);
            self.readings += 1;
            if depth > far + tolerance {
                free += 1;
            } else if depth >= near - tolerance {
                self.ends.push(Point3::from(ray * depth));
            }
            if depth < near - tolerance {
                hidden += 1;
            } else {
                let [left, upper, right, lower] = visible.unwrap_or([i, j, i, j]);
                visible = Some([left.min(i), upper.min(j), right.max(i), lower.max(j)]);
            }
        }
        self.cut(visible.filter(|_| hidden > 0));
        let share = |count: usize| count as f64 / self.readings.max(1) as f64;
        (self.hidden, self.free) = (share(hidden), share(free));
    }

    /// Leaves of the box only the cells of the grid from the first to the last.
    fn cut(&mut self, cells: Option<[usize; 4]>) {
        let Some([left, upper, right, lower]) = cells else { return };
        let Rect { x_min, y_min, .. } = self.rect;
        let (width, height) = (self.rect.width() / RAYS as f64, self.rect.height() / RAYS as f64);
        let at = |start: f64, size: f64, cell: usize| start + size * cell as f64;
        let cut = Rect::new(
            at(x_min, width, left),
            at(y_min, height, upper),
            at(x_min, width, right + 1),
            at(y_min, height, lower + 1),
        );
        self.rect = cut.unwrap_or(self.rect);
    }

    /// Whether a detector should have found it.
    pub(super) fn is_visible(&self) -> bool {
        self.is_in_view && self.readings >= MIN_READINGS && self.hidden < MAX_HIDDEN
    }

    /// Share of the rays that meet nothing before it which end in it: few for a chair, most for a cabinet.
    pub(super) fn filled(&self) -> f64 {
        let open = 1.0 - self.hidden;
        if open > 0.0 { 1.0 - self.free / open } else { 1.0 }
    }

    /// Share of what stands in its place that belongs to these bodies in the map.
    pub(super) fn share_of(&self, bodies: &[Ellipsoid]) -> f64 {
        let is_in = |end: &&Point3<f64>| {
            bodies.iter().any(|body| {
                let at = body.pose.inverse_transform_point(*end).coords.abs();
                at.iter().zip(&body.semi_axes).all(|(at, reach)| *at <= reach + TOLERANCE_M)
            })
        };
        self.ends.iter().filter(is_in).count() as f64 / self.ends.len().max(1) as f64
    }
}

/// Depths at which a ray, whose z is 1, enters and leaves the upper part of a body. What a body stands on touches it
/// from below, and estimates are a little off: so the margins are left out.
fn crossing(body: &Ellipsoid, outline: Outline, ray: &Vector3<f64>) -> Option<(f64, f64)> {
    let half = body.semi_axes;
    let raised = (FOOT * half.z).max(0.5 * MIN_FOOT_M).min(0.5 * half.z);
    let inner = Vector3::new(INNER * half.x, INNER * half.y, half.z - raised);
    let middle = Vector3::new(0.0, 0.0, raised);
    let eye = body.pose.inverse_transform_point(&Point3::origin()).coords - middle;
    let direction = body.pose.inverse_transform_vector(ray);
    let (near, far) = if outline == Outline::Ellipsoid {
        let (e, d) = (eye.component_div(&inner), direction.component_div(&inner));
        let (a, b, c) = (d.norm_squared(), e.dot(&d), e.norm_squared() - 1.0);
        let root = (b * b - a * c).sqrt();
        ((-b - root) / a, (-b + root) / a)
    } else {
        (0..3).fold((0.0_f64, f64::MAX), |(near, far), i| {
            let ends = [-inner[i], inner[i]].map(|end| (end - eye[i]) / direction[i]);
            (near.max(ends[0].min(ends[1])), far.min(ends[0].max(ends[1])))
        })
    };
    // Also false for the roots of negative numbers.
    (near < far).then_some((near, far))
}

/// A body that reaches nearer than this has no box (m).
const MIN_DEPTH_M: f64 = 0.1;
/// Share of its box that has to be in the image for an object to be expected.
const MIN_INSIDE: f64 = 0.7;
/// The smallest boxes that detectors find (px).
const MIN_SIDE_PX: f64 = 12.0;
/// Rays along each side of the box.
const RAYS: usize = 9;
const MIN_READINGS: usize = 15;
/// An object of which more is hidden need not be detected.
const MAX_HIDDEN: f64 = 0.3;
/// Besides the noise, how far the object's surface may be off (m).
const TOLERANCE_M: f64 = 0.03;
/// Share of a body's width that rays are looked at in.
const INNER: f64 = 0.9;
/// Share of half its height that is left out below, but at least this (m).
const FOOT: f64 = 0.15;
const MIN_FOOT_M: f64 = 0.04;
