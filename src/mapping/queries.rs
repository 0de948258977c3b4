//! What others ask the map: which objects are called so, are there, are near, are in view, and the shapes to plan with.
//!
//! Every object is looked at: a map of 10,000 answers in a fraction of a millisecond, so that an index does not pay.

use super::{MapObject, ObjectMap};
use crate::geometry::{
    Camera, ImageSide, NEAR_M, OrientedBox, Outline, Pose, Rect, Silhouette, polygon_distance,
};
use nalgebra::{Point2, Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// A part of the map.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// A box that stands anyhow.
    Box(OrientedBox),
    /// What stands on a polygon of the ground, which need not be convex, between two heights (m).
    Prism {
        /// Corners in order, either way round.
        corners: Vec<Point2<f64>>,
        /// From where to where.
        heights_m: [f64; 2],
    },
    /// All points up to a distance.
    Sphere {
        /// Its middle.
        center: Point3<f64>,
        /// Its radius (m).
        radius_m: f64,
    },
}

/// An object and a distance that was asked for.
#[derive(Clone, Copy, Debug)]
pub struct Distance<'a> {
    /// The object.
    pub object: &'a MapObject,
    /// How far (m); negative inside.
    pub distance_m: f64,
    /// Its standard deviation, by that of the object's position (m).
    pub sigma_m: f64,
}

impl Distance<'_> {
    /// Probability that the true distance is negative.
    pub fn probability_inside(&self) -> f64 {
        normal_cdf(-self.distance_m / self.sigma_m.max(f64::MIN_POSITIVE))
    }
}

/// An object in the image of a camera.
#[derive(Clone, Copy, Debug)]
pub struct InView<'a> {
    /// The object.
    pub object: &'a MapObject,
    /// Bounds of its outline (px), as far as they are in the image.
    pub rect: Rect,
    /// Share of its bounds that is in the image.
    pub share: f64,
    /// Of its centre, along the optical axis (m).
    pub depth_m: f64,
    /// Standard deviation of where its centre is in the image (px), the larger of the two directions.
    pub sigma_px: f64,
}

/// Objects that can be asked for: those of a map, or a copy of them.
pub trait Queries {
    /// All of them.
    fn all(&self) -> impl Iterator<Item = &MapObject>;

    /// Objects that are called so with at least this probability, most probable first.
    fn labelled(&self, label: &str, min_belief: f64) -> Vec<(&MapObject, f64)> {
        let belief = |object: &MapObject| object.labels().get(label).copied().unwrap_or(0.0);
        let all = self.all().map(|object| (object, belief(object)));
        let mut found: Vec<_> = all.filter(|(_, b)| *b > 0.0 && *b >= min_belief).collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found
    }

    /// Objects whose centre is in a region with at least this probability; the distance is that of the centre from the
    /// region's border, negative inside. Deepest inside first.
    fn within(&self, region: &Region, min_probability: f64) -> Vec<Distance<'_>> {
        let of = |object| {
            let center = MapObject::ellipsoid(object).center();
            let (distance_m, outwards) = region.signed_distance(&center);
            Distance { object, distance_m, sigma_m: sigma_along(object, &outwards) }
        };
        let all = self.all().map(of);
        sorted(all.filter(|found| found.probability_inside() >= min_probability).collect())
    }

    /// The objects nearest to a point, by the distance to their boxes; of one label, if one is given.
    fn nearest(&self, point: &Point3<f64>, label: Option<&str>, count: usize) -> Vec<Distance<'_>> {
        let is_asked = |object: &&MapObject| label.is_none_or(|label| object.label() == label);
        let of = |object: &'_ MapObject| -> (f64, f64) {
            let (distance_m, inwards) =
                box_distance(&OrientedBox::from(&object.ellipsoid()), point);
            (distance_m, sigma_along(object, &inwards))
        };
        let all = self.all().filter(is_asked).map(|object| {
            let (distance_m, sigma_m) = of(object);
            Distance { object, distance_m, sigma_m }
        });
        let mut found = sorted(all.collect());
        found.truncate(count);
        found
    }

    /// Objects in the image of a camera up to a range (m), nearest first. What hides them is not known here.
    fn in_view(
        &self,
        camera: &Camera,
        map_from_camera: &Pose,
        max_range_m: f64,
    ) -> Vec<InView<'_>> {
        let camera_from_map = map_from_camera.inverse();
        let all = self.all().filter_map(|o| in_view(o, camera, &camera_from_map));
        let mut found: Vec<InView<'_>> = all.filter(|seen| seen.depth_m <= max_range_m).collect();
        found.sort_by(|a, b| a.depth_m.total_cmp(&b.depth_m));
        found
    }
}

impl Queries for ObjectMap {
    fn all(&self) -> impl Iterator<Item = &MapObject> {
        self.confirmed()
    }
}

impl Queries for [MapObject] {
    fn all(&self) -> impl Iterator<Item = &MapObject> {
        self.iter()
    }
}

impl MapObject {
    /// The box round the object, each face so many standard deviations farther out than estimated. It is upright, and
    /// what the heading may be off is in the faces, too.
    pub fn oriented_box(&self, sigmas: f64) -> OrientedBox {
        let (ellipsoid, covariance) = (self.ellipsoid(), self.covariance());
        let half = ellipsoid.semi_axes;
        let turn = (sigmas * covariance[(2, 2)].sqrt()).min(0.25 * TAU).sin();
        let grown = Vector3::from_fn(|axis, _| {
            let (t, s) = (3 + axis, 6 + axis);
            // Either face is at the centre plus or minus the semi-axis; the less sure one counts.
            let variance = covariance[(t, t)]
                + half[axis].powi(2) * covariance[(s, s)]
                + 2.0 * half[axis] * covariance[(t, s)].abs();
            let across = if axis < 2 { half[1 - axis] * turn } else { 0.0 };
            half[axis] + sigmas * variance.max(0.0).sqrt() + across
        });
        OrientedBox { pose: ellipsoid.pose, half_extents: grown }
    }

    /// What the object covers of the ground, so many standard deviations wider than estimated: the corners of a convex
    /// polygon round its outline, counter-clockwise seen from above.
    pub fn footprint(&self, sigmas: f64) -> Vec<Point2<f64>> {
        footprint_of(&self.oriented_box(sigmas), self.outline)
    }
}

/// What a body in an upright box covers of the ground: the corners of a convex polygon round its outline, counter-clockwise
/// seen from above.
pub fn footprint_of(body: &OrientedBox, outline: Outline) -> Vec<Point2<f64>> {
    let half = body.half_extents;
    let is_cornered = matches!(outline, Outline::Cuboid);
    let sides = if is_cornered { 4 } else { ROUND_SIDES };
    // Tangents of the outline in directions all round, and where neighbours meet.
    let tangent = |k: usize| {
        let angle = TAU * k as f64 / sides as f64;
        let direction = Vector3::new(angle.cos(), angle.sin(), 0.0);
        (direction.xy(), outline.support(&direction, &half).reach)
    };
    let corner = |k: usize| {
        let ((a, reach_a), (b, reach_b)) = (tangent(k), tangent((k + 1) % sides));
        let cross = a.perp(&b);
        let at = Vector2::new(reach_a * b.y - reach_b * a.y, a.x * reach_b - b.x * reach_a);
        let at = at / cross;
        (body.pose * Point3::new(at.x, at.y, 0.0)).xy()
    };
    (0..sides).map(corner).collect()
}

impl Region {
    /// Distance of a point from the border (m), negative inside, and the direction in which it grows.
    fn signed_distance(&self, point: &Point3<f64>) -> (f64, Vector3<f64>) {
        match self {
            Self::Box(body) => box_distance(body, point),
            Self::Sphere { center, radius_m } => {
                let apart = point - center;
                let distance = apart.norm();
                let outwards = if distance > 0.0 { apart / distance } else { Vector3::x() };
                (distance - radius_m, outwards)
            }
            Self::Prism { corners, heights_m: [low, high] } => {
                let (across, outwards) = polygon_distance(corners, &point.xy());
                let below = (low - point.z, -Vector3::z());
                let above = (point.z - high, Vector3::z());
                let upright = if below.0 > above.0 { below } else { above };
                let level = (across, outwards.push(0.0));
                if across > 0.0 && upright.0 > 0.0 {
                    let apart = level.1 * level.0 + upright.1 * upright.0;
                    return (apart.norm(), apart / apart.norm());
                }
                if level.0 > upright.0 { level } else { upright }
            }
        }
    }
}

/// Distance of a point from a box's surface, negative inside, and the direction in which it grows.
fn box_distance(body: &OrientedBox, point: &Point3<f64>) -> (f64, Vector3<f64>) {
    let own = body.pose.inverse_transform_point(point).coords;
    let beyond = own.abs() - body.half_extents;
    let outside = beyond.map(|b| b.max(0.0));
    let distance = outside.norm();
    let (distance, direction) = if distance > 0.0 {
        (distance, outside / distance)
    } else {
        let axis = beyond.imax();
        (beyond[axis], Vector3::from_fn(|i, _| f64::from(u8::from(i == axis))))
    };
    let signed = direction.zip_map(&own, |d, x| if x < 0.0 { -d } else { d });
    (distance, body.pose.rotation * signed)
}

/// Standard deviation of an object's centre along a direction of the map (m).
fn sigma_along(object: &MapObject, direction: &Vector3<f64>) -> f64 {
    let own = object.ellipsoid().pose.rotation.inverse_transform_vector(direction);
    let covariance = object.covariance().fixed_view::<3, 3>(3, 3).into_owned();
    own.dot(&(covariance * own)).max(0.0).sqrt()
}

fn in_view<'a>(
    object: &'a MapObject,
    camera: &Camera,
    camera_from_map: &Pose,
) -> Option<InView<'a>> {
    let body = object.ellipsoid().transformed(camera_from_map);
    let depth_m = body.center().z;
    if depth_m - body.semi_axes.norm() < NEAR_M {
        return None;
    }
    let silhouette = Silhouette::new(&body, object.outline);
    let [left, upper, right, lower] = ImageSide::ALL.map(|side| silhouette.tangent(side, 0.0).at);
    let low = camera.project(&Point3::new(left, upper, 1.0))?;
    let high = camera.project(&Point3::new(right, lower, 1.0))?;
    let whole = Rect::new(low.x, low.y, high.x, high.y)?;
    let rect = whole.clipped(camera.width(), camera.height())?;
    let camera_from_object = body.pose.rotation.to_rotation_matrix().into_inner();
    let own = object.covariance().fixed_view::<3, 3>(3, 3).into_owned();
    let spread = camera_from_object * own * camera_from_object.transpose();
    let across = spread[(0, 0)].max(spread[(1, 1)]).max(0.0).sqrt();
    let sigma_px = camera.focal().0.max(camera.focal().1) * across / depth_m;
    Some(InView { object, rect, share: rect.area() / whole.area(), depth_m, sigma_px })
}

fn sorted(mut found: Vec<Distance<'_>>) -> Vec<Distance<'_>> {
    found.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.object.id.cmp(&b.object.id)));
    found
}

/// Distribution function of the standard normal, by a logistic curve that is off by less than 0.01 (Bowling et al.
/// 2009).
fn normal_cdf(x: f64) -> f64 {
    1.0 / (1.0 + (-(0.07056 * x.powi(3) + 1.5976 * x)).exp())
}

/// Sides of the polygon round something that is round.
const ROUND_SIDES: usize = 16;
