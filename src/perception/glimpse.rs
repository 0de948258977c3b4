//! What a box says where depth does not suffice for a measurement: a direction, and how far off something of its class
//! would be that looks so large.

use super::{
    Detection, Frame, PerceptionSettings, SupportPlane,
    estimator::Scenery,
    readings::{GRID, Readings, WALL_M},
    segmentation::SurfacePoint,
};
use crate::geometry::{Camera, Ellipsoid, Plane, Pose, Rect};
use nalgebra::{Matrix3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};

/// An object of which one frame shows hardly more than the direction. From several places, such views tell where it is.
#[derive(Clone, Debug)]
pub struct Glimpse {
    /// In the camera's optical frame; upright, z up, x away from the camera.
    pub ellipsoid: Ellipsoid,
    /// Covariance of `[rotation, translation, log semi-axes]`, a right perturbation in the object's frame: long towards the
    /// camera, and the farther the larger.
    pub covariance: SMatrix<f64, 9, 9>,
    /// The same without what the sides of the box say, if there are any to use: only the range is known then, and only where
    /// depth readings in the box tell it.
    pub depth_covariance: SMatrix<f64, 9, 9>,
    /// What is known of its size without looking at it.
    pub usual: UsualSize,
    /// How far the object may reach out of the left, upper, right and lower side of the box (px): zero, but where something
    /// nearer is beside the box, which hides the object's own end. Nothing where the image cuts it, and of what is not out of
    /// the depth camera's reach.
    pub hidden_px: [Option<f64>; 4],
    /// The floor in the camera's optical frame, where something of this class stands on it and was seen down to it, or nothing
    /// else than the sides of its box counts.
    pub floor: Option<Plane>,
}

impl Glimpse {
    /// Of what is within the depth camera's reach and could not be measured, something else is in the box or hides a part
    /// of it: its sides count for no more than where the object is.
    fn by_itself(self) -> Self {
        let is_seen_to_floor = self.hidden_px[LOWER].is_some_and(|px| px < SIDE_SIGMA_PX);
        Self {
            depth_covariance: self.covariance,
            hidden_px: [None; 4],
            floor: self.floor.filter(|_| is_seen_to_floor),
            ..self
        }
    }
}

/// How large an object is, going by its class.
#[derive(Clone, Copy, Debug)]
pub struct UsualSize {
    /// Along the axes of a glimpse: away from the camera, across, and up (m).
    pub semi_axes: Vector3<f64>,
    /// Covariance of their logarithms.
    pub covariance: Matrix3<f64>,
}

/// Where an object of the box's class is, going by how large it looks and by the depth in the middle of its box. What the
/// image cuts off follows from the usual proportions of its class; nothing where more than a half or more than one side of
/// it is cut off.
///
/// Something of a class without a usual size is out of the depth camera's reach of `max_range_m` where nothing in the middle
/// of the box is within it. Otherwise there is nothing: what hides a part of such an object is taken for it too easily.
///
/// Where nothing but a wall is read, nothing of a class that would stand before it is there: it is a picture of one.
///
/// What is `around` the objects and `detections` are all of the image, the latter with this one. Readings that `are_others` are of
/// what hides the object, or shows through it: they do not tell where it is.
pub(super) fn glimpse(
    frame: &Frame<'_>,
    detection: &Detection,
    (around, detections): (Scenery<'_>, &[Detection]),
    are_others: &dyn Fn(&SurfacePoint) -> bool,
    settings: &PerceptionSettings,
) -> Option<Glimpse> {
    let rect = &detection.rect;
    let max_range_m = settings.segmentation.max_range_m;
    let prior = settings.classes.prior(detection.label());
    let place = Surroundings {
        frame,
        rect: *rect,
        floor: floor(frame, around.planes).filter(|_| prior.on_floor),
        others: detections.iter().map(|other| other.rect).filter(|other| other != rect).collect(),
    };
    let Readings { ranges, of_object, before_m, is_flat } =
        Readings::new(frame, rect, around.walls, are_others);
    if is_flat && prior.size_m.is_some_and(|[_, short_m, _]| short_m > 2.0 * WALL_M) {
        return None;
    }
    let read = of_object.map(Range::read);
    match prior.size_m {
        Some(size_m) => {
            let seen = Apparent::new(frame, rect, &completed(rect, frame.camera(), size_m)?);
            let range = seen.range(read, before_m, size_m);
            let sigmas = [SIZE_SIGMA, PROPORTION_SIGMA];
            let glimpse = seen.glimpse(&place, (range, size_m, sigmas));
            let within = ranges.iter().filter(|range_m| **range_m <= max_range_m).count();
            let is_far = range.at_m > max_range_m;
            let is_beyond = within == 0 || is_far && MOSTLY * within < GRID * GRID;
            Some(if is_beyond { glimpse } else { glimpse.by_itself() })
        }
        None if ranges.iter().all(|range_m| *range_m > max_range_m) => {
            let seen = Apparent::new(frame, rect, &uncompleted(rect, frame.camera())?);
            let range = read.unwrap_or_else(|| {
                let at_m = BEYOND_REACH * max_range_m;
                Range { at_m, sigma_m: BEYOND_REACH_SIGMA * at_m, is_read: false }
            });
            let across = seen.width * range.at_m / SEEN_WIDTH;
            let middle = (across * seen.height * range.at_m).sqrt();
            let size_m = [across.max(middle), across.min(middle), middle];
            Some(seen.glimpse(&place, (range, size_m, UNKNOWN_SIGMAS)))
        }
        None => None,
    }
}

impl UsualSize {
    /// Extents (m), and standard deviations of the logarithms of the size and, besides, of each extent.
    fn new(extents_m: [f64; 3], [size, proportion]: [f64; 2]) -> Self {
        let own = Vector3::new(DEPTH_SIGMA.max(proportion), proportion, proportion);
        let own = Matrix3::from_diagonal(&own.map(|sigma| sigma * sigma));
        let covariance = Matrix3::repeat(size * size) + own;
        Self { semi_axes: 0.5 * Vector3::from(extents_m), covariance }
    }
}

/// How far off the object's middle is.
#[derive(Clone, Copy)]
struct Range {
    at_m: f64,
    sigma_m: f64,
    /// Whether depth readings tell it.
    is_read: bool,
}

impl Range {
    /// As depth readings tell it.
    fn read(at_m: f64) -> Self {
        Self { at_m, sigma_m: READING_SIGMA * at_m, is_read: true }
    }

    /// What depth says and nothing else, with a unit vector away from the camera in the object's frame.
    fn depth_covariance(&self, away: &Vector3<f64>) -> SMatrix<f64, 9, 9> {
        let mut covariance = SMatrix::from_diagonal(&SVector::from(UNKNOWN.map(|s| s * s)));
        if self.is_read {
            let known = UNKNOWN[3].powi(2) - self.sigma_m.powi(2);
            let mut place = covariance.fixed_view_mut::<3, 3>(3, 3);
            place -= known * away * away.transpose();
        }
        covariance
    }
}

/// A box as angles.
struct Apparent {
    /// Through the middle of the box, in the level frame.
    direction: Vector3<f64>,
    /// Extents at a range of 1 (m).
    width: f64,
    height: f64,
    /// Standard deviation of either side of the box, at a range of 1 (m).
    sigma: [f64; 2],
}

impl Apparent {
    /// `whole` is the box as it would be in a larger image.
    fn new(frame: &Frame<'_>, rect: &Rect, whole: &Rect) -> Self {
        let camera = frame.camera();
        let (fx, fy) = camera.focal();
        let (u, v) = whole.center();
        let ray = camera.ray(u, v);
        let (width, height) = (
            (camera.ray(whole.x_max, v) - camera.ray(whole.x_min, v)).x / ray.norm(),
            (camera.ray(u, whole.y_max) - camera.ray(u, whole.y_min)).y / ray.norm(),
        );
        let guessed = [(whole.width() - rect.width()) / fx, (whole.height() - rect.height()) / fy];
        let sigma = |side: usize, focal: f64, extent: f64| {
            (SIDE_SIGMA_PX / focal).hypot(SIDE_SIGMA_RATIO * extent).hypot(0.5 * guessed[side])
        };
        Self {
            direction: frame.level_from_camera() * ray / ray.norm(),
            width,
            height,
            sigma: [sigma(0, fx, width), sigma(1, fy, height)],
        }
    }

    /// Sine and cosine of how far the camera looks down at it.
    fn descent(&self) -> (f64, f64) {
        let sine = -self.direction.z;
        (sine.abs(), (1.0 - sine * sine).sqrt())
    }

    /// The range of the middle of an object of this size, in whose box this was `read` and which is not behind `before_m`.
    fn range(&self, read: Option<Range>, before_m: f64, [long, short, high]: [f64; 3]) -> Range {
        let (sine, cosine) = self.descent();
        let middle = (long * short).sqrt();
        // Of what is partly hidden, less shows: the side that asks for the shorter range is the more credible.
        let by_height = (high * cosine + middle * sine) / self.height;
        let by_width = SEEN_WIDTH * middle / self.width;
        let range = (by_height * by_width).sqrt().min(1.2 * by_height.min(by_width));
        let range = range.min(before_m);
        let disagreement = 0.5 * (by_height / by_width).ln().abs();
        let sigma = SIZE_SIGMA.hypot(disagreement) * range;
        // The depth in the box is the object's, unless it would have an absurd size there.
        let near = read.map(|near| Range::read(near.at_m + 0.5 * middle));
        near.filter(|near| (near.at_m / range).ln().abs() < 2.0 * SIZE_SIGMA).unwrap_or(Range {
            at_m: range,
            sigma_m: sigma,
            is_read: false,
        })
    }

    fn glimpse(
        &self,
        place: &Surroundings<'_>,
        (range, usual, usual_sigmas): (Range, [f64; 3], [f64; 2]),
    ) -> Glimpse {
        let Range { at_m: range_m, sigma_m: range_sigma_m, .. } = range;
        let (sine, cosine) = self.descent();
        let (width, height) = (self.width * range_m, self.height * range_m);
        let middle = (usual[0] * usual[1]).sqrt();
        let across = (width / SEEN_WIDTH).clamp(0.5 * usual[1], 1.5 * usual[0]);
        let (along, usually_across) =
            if across > middle { (usual[1], usual[0]) } else { (usual[0], usual[1]) };
        let up = ((height - along * sine) / cosine.max(0.1)).clamp(0.5 * usual[2], 2.0 * usual[2]);
        let semi_axes = 0.5 * Vector3::new(along, across, up);
        let yaw = self.direction.y.atan2(self.direction.x);
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let center = self.direction * range_m;
        let in_level =
            Ellipsoid::new(Pose::from_parts(Translation3::from(center), rotation), semi_axes);
        // In the object's frame.
        let away = rotation.inverse() * self.direction;
        let [sigma_x, sigma_y] = self.sigma.map(|sigma| sigma * range_m);
        let mut covariance = SMatrix::<f64, 9, 9>::zeros();
        let mut longer = SVector::<f64, 9>::zeros();
        longer.fixed_rows_mut::<3>(3).copy_from(&away);
        (longer[7], longer[8]) = (1.0 / range_m, 1.0 / range_m);
        covariance += range_sigma_m * range_sigma_m * longer * longer.transpose();
        let aside = [sigma_y * sigma_y, sigma_x * sigma_x, sigma_y * sigma_y];
        let hidden_px = place.hidden_px(range_m, 0.5 * usual[0]);
        let beside_px = hidden_px[0].unwrap_or(0.0).max(hidden_px[2].unwrap_or(0.0));
        // Of furniture that goes on behind something on one side, the middle is half as far off. Small things end there.
        let beside_px = if place.floor.is_some() { beside_px } else { 0.0 };
        let beside_m = 0.5 * beside_px * range_m / place.frame.camera().focal().0;
        let own = [
            TILT_SIGMA_RAD.powi(2),
            TILT_SIGMA_RAD.powi(2),
            HEADING_SIGMA_RAD.powi(2),
            aside[0],
            aside[1] + beside_m * beside_m,
            aside[2],
            DEPTH_SIGMA.powi(2),
            WIDTH_SIGMA.powi(2) + (sigma_x.hypot(beside_m) / semi_axes.y).powi(2),
            HEIGHT_SIGMA.powi(2)
                + (sigma_y / semi_axes.z).powi(2)
                + (DEPTH_SIGMA * along * sine / up).powi(2),
        ];
        own.iter().enumerate().for_each(|(i, variance)| covariance[(i, i)] += variance);
        let camera_from_level = place.frame.level_from_camera().inverse();
        Glimpse {
            ellipsoid: in_level.transformed(&camera_from_level),
            covariance,
            depth_covariance: range.depth_covariance(&away),
            usual: UsualSize::new([along, usually_across, usual[2]], usual_sigmas),
            hidden_px,
            floor: place.floor.map(|floor| floor.transformed(&camera_from_level)),
        }
    }
}

/// The floor that the wheels stand on, or without wheels the lowest level plane of an image, in the level frame. The height below
/// the camera counts and not the tilt: the floor is seen near the robot, and what is glimpsed is far off.
fn floor(frame: &Frame<'_>, planes: &[SupportPlane]) -> Option<Plane> {
    let below_m = planes.iter().map(|found| found.plane.offset / found.plane.normal.z);
    let below_m = frame.floor_below_m().or_else(|| below_m.max_by(f64::total_cmp))?;
    Some(Plane { normal: Vector3::z_axis(), offset: below_m })
}

/// A box and what is round it.
struct Surroundings<'a> {
    frame: &'a Frame<'a>,
    rect: Rect,
    /// In the level frame, if the object stands on it.
    floor: Option<Plane>,
    /// The image's other boxes.
    others: Vec<Rect>,
}

impl Surroundings<'_> {
    /// How far an object at a range, whose longer horizontal half is `long_m`, may reach out of each side of its box (px).
    fn hidden_px(&self, range_m: f64, long_m: f64) -> [Option<f64>; 4] {
        let Self { frame, rect, .. } = self;
        let cut = cut_sides(rect, frame.camera(), PERHAPS_CUT_PX);
        let long_px = 2.0 * long_m * frame.camera().focal().0 / range_m;
        let large_px = rect.width().max(rect.height());
        let mut hidden = [0.0; 4];
        for (side, hidden) in hidden.iter_mut().enumerate() {
            let (nearer, open) = self.beside(side, range_m);
            // Of what the left or right border cuts, the image shows a part of the top and the bottom.
            let is_hidden = HIDING * nearer > GRID
                || side % 2 == 1 && (cut[0] || cut[2])
                || side == LOWER && 2 * open <= GRID && self.is_behind_a_box();
            // What is seen between two things may be the end of something long.
            let most = if side % 2 == 0 { large_px.max(long_px) } else { large_px };
            *hidden = if is_hidden { most } else { 0.0 };
        }
        if hidden[0] > 0.0 || hidden[2] > 0.0 {
            // A slit shows some part of the object's foot, which may be its near or its far end.
            let (u, _) = rect.center();
            let down = frame.level_from_camera() * frame.camera().ray(u, rect.y_max);
            let sine = (-down.z / down.norm()).max(0.0);
            let foot_px = frame.camera().focal().1 * long_m * sine / range_m;
            hidden[LOWER] = hidden[LOWER].max(foot_px);
        }
        std::array::from_fn(|side| (!cut[side]).then_some(hidden[side]))
    }

    /// At how many of some places along a side something nearer is beside it, and at how many there is nothing nearer.
    fn beside(&self, side: usize, range_m: f64) -> (usize, usize) {
        let (cx, cy) = self.rect.center();
        let half = [0.5 * self.rect.width(), 0.5 * self.rect.height()];
        let along = side % 2;
        let sign = if side < 2 { -1.0 } else { 1.0 };
        let is_nearer = |out: f64, across: f64| {
            let (du, dv) = if along == 0 { (out, across) } else { (across, out) };
            let seen =
                self.frame.point_in_level((cx + du).round() as i32, (cy + dv).round() as i32);
            seen.map(|p| p.coords.norm() < NEARER * range_m)
        };
        let (mut nearer, mut open) = (0, 0);
        for at in 0..GRID {
            let across = half[1 - along] * (2.0 * (at as f64 + 0.5) / GRID as f64 - 1.0);
            let seen = BESIDE_PX.map(|beside| is_nearer(sign * (half[along] + beside), across));
            nearer += usize::from(seen.contains(&Some(true)));
            open += usize::from(seen.contains(&Some(false)) && !seen.contains(&Some(true)));
        }
        (nearer, open)
    }

    /// Whether the lower side of a thing on the floor ends in the box of another one that reaches farther down, and so is
    /// nearer: where depth does not reach, only this tells that its foot is hidden.
    fn is_behind_a_box(&self) -> bool {
        let (u, foot) = (self.rect.center().0, self.rect.y_max);
        let hides = |other: &Rect| {
            (other.x_min..other.x_max).contains(&u)
                && other.y_min < foot + FOOT_PX
                && other.y_max > foot + FOOT_PX
        };
        self.floor.is_some() && self.others.iter().any(hides)
    }
}

/// Which of the left, upper, right and lower side of a box the image cuts.
fn cut_sides(rect: &Rect, camera: &Camera, border_px: f64) -> [bool; 4] {
    let (right, bottom) = (f64::from(camera.width()) - 1.0, f64::from(camera.height()) - 1.0);
    let distances = [rect.x_min, rect.y_min, right - rect.x_max, bottom - rect.y_max];
    distances.map(|distance| distance <= border_px)
}

/// A box of which nobody knows how it would be in a larger image: nothing where the image cuts the left or the right side or
/// both others, or where it is small, as one does not know how much of the object it shows.
fn uncompleted(rect: &Rect, camera: &Camera) -> Option<Rect> {
    let [left, upper, right, lower] = cut_sides(rect, camera, BORDER_PX);
    let is_small = rect.width().min(rect.height()) < MIN_EXTENT_PX;
    let is_unclear = is_small || left || right || (upper && lower);
    (!is_unclear).then_some(*rect)
}

/// A box as it would be in a larger image: where this one cuts off one side of it, it has the proportions of its class.
fn completed(rect: &Rect, camera: &Camera, size_m: [f64; 3]) -> Option<Rect> {
    let cut = cut_sides(rect, camera, BORDER_PX);
    let Rect { x_min, y_min, x_max, y_max } = *rect;
    let tall = |[long, short, high]: [f64; 3]| high / (SEEN_WIDTH * (long * short).sqrt());
    let by_width = || tall(size_m) * rect.width();
    let by_height = || rect.height() / tall(size_m);
    let whole = match cut {
        [false, false, false, false] => Some(*rect),
        [true, false, false, false] => {
            Rect::new(x_min.min(x_max - by_height()), y_min, x_max, y_max)
        }
        [false, true, false, false] => {
            Rect::new(x_min, y_min.min(y_max - by_width()), x_max, y_max)
        }
        [false, false, true, false] => {
            Rect::new(x_min, y_min, x_max.max(x_min + by_height()), y_max)
        }
        [false, false, false, true] => {
            Rect::new(x_min, y_min, x_max, y_max.max(y_min + by_width()))
        }
        _ => None,
    };
    whole.filter(|whole| whole.area() < 2.0 * rect.area())
}

/// Standard deviation of a side of a detector's box (px), and as a share of the box.
const SIDE_SIGMA_PX: f64 = 3.0;
const SIDE_SIGMA_RATIO: f64 = 0.06;
/// What an object shows of its width from any side, as a share of the mean of its two horizontal extents.
const SEEN_WIDTH: f64 = 1.15;
/// Standard deviation of the logarithm of how large objects of a class are.
const SIZE_SIGMA: f64 = 0.4;
/// Standard deviation of the logarithms of its extents besides.
const PROPORTION_SIGMA: f64 = 0.25;
/// Both for a class without a usual size.
const UNKNOWN_SIGMAS: [f64; 2] = [0.6, 0.5];
/// Where something out of the depth camera's reach is, as a share of that reach, and its standard deviation as a share of that.
const BEYOND_REACH: f64 = 1.4;
const BEYOND_REACH_SIGMA: f64 = 0.35;
/// Of the left, upper, right and lower side.
const LOWER: usize = 3;
/// Lower sides that differ by less say not what is nearer (px).
const FOOT_PX: f64 = 2.0;
/// Depth is looked at so far beside a box (px): what is nearer than this share of the object's range
const BESIDE_PX: [f64; 3] = [3.0, 7.0, 11.0];
const NEARER: f64 = 0.8;
/// along one in so many of a side hides where the object ends.
const HIDING: usize = 3;
/// Standard deviation of the object's range where depth readings tell it, as a share of it.
const READING_SIGMA: f64 = 0.15;
/// Standard deviations of the logarithms of extents: away from the camera, where nothing was seen, across, and upwards.
const DEPTH_SIGMA: f64 = 0.5;
const WIDTH_SIGMA: f64 = 0.25;
const HEIGHT_SIGMA: f64 = 0.15;
/// A heading that is not known at all (rad).
const HEADING_SIGMA_RAD: f64 = 1.0;
/// What nothing is known of (rad, m, 1).
const UNKNOWN: [f64; 9] = [10.0, 10.0, 10.0, 100.0, 100.0, 100.0, 10.0, 10.0, 10.0];
const TILT_SIGMA_RAD: f64 = 0.02;
/// Of a smaller box nobody knows how large it is.
const MIN_EXTENT_PX: f64 = 8.0;
const BORDER_PX: f64 = 5.0;
/// A side as near to the border of the image as this may be cut: detectors draw sides of cut objects a little inside.
const PERHAPS_CUT_PX: f64 = 12.0;
/// What should be out of reach by its size is where less than one in so many readings is within it.
const MOSTLY: usize = 4;
