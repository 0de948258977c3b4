//! Where the image of a body ends.

use super::{Ellipsoid, Outline};
use nalgebra::{Matrix3, Vector3};

/// What touches the side of an image box is at least this far before the camera (m).
pub const NEAR_M: f64 = 0.05;

/// A side of an upright box in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageSide {
    /// Smallest `x/z`.
    Left,
    /// Smallest `y/z`.
    Upper,
    /// Largest `x/z`.
    Right,
    /// Largest `y/z`.
    Lower,
}

impl ImageSide {
    /// In the order of `x_min, y_min, x_max, y_max`.
    pub const ALL: [Self; 4] = [Self::Left, Self::Upper, Self::Right, Self::Lower];

    /// Coordinate axis and sign of the direction out of the box.
    fn outward(self) -> (usize, f64) {
        match self {
            Self::Left => (0, -1.0),
            Self::Upper => (1, -1.0),
            Self::Right => (0, 1.0),
            Self::Lower => (1, 1.0),
        }
    }
}

/// The side of the box round a body's image, and the point of the body that it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// `x/z` or `y/z` in the camera's frame.
    pub at: f64,
    /// The point that is touched, in the body's own frame (m).
    pub contact: Vector3<f64>,
    /// Derivative of `at` by that point, in the camera's frame (1/m).
    pub gradient: Vector3<f64>,
}

/// A convex body before a pinhole camera.
///
/// The side at `u` is the plane of all `x = u z`. It touches the body when the body's support function is zero along
/// `(1, 0, -u)`: an equation that is convex in `u` and whose derivative is the depth of the contact. For an ellipsoid
/// its solution is that of `C* = P Q* P^T` (Liao et al. 2020, eq. (3)), for a cuboid the outermost corner.
///
/// A body that reaches behind the camera ends nowhere on some sides, or nearer than [`NEAR_M`]. There a value takes
/// the place of the tangent that is linear in the body's motion, as large as that side can be and larger the farther
/// back the body reaches: a step that takes the camera into a body costs much, and derivatives are bounded and lead
/// out.
#[derive(Clone, Copy, Debug)]
pub struct Silhouette {
    outline: Outline,
    semi_axes: Vector3<f64>,
    center: Vector3<f64>,
    /// Rotation of `camera_from_body`.
    rotation: Matrix3<f64>,
}

impl Silhouette {
    /// Of a body in the camera's optical frame.
    pub fn new(body_in_camera: &Ellipsoid, outline: Outline) -> Self {
        Self {
            outline,
            semi_axes: body_in_camera.semi_axes,
            center: body_in_camera.center().coords,
            rotation: body_in_camera.pose.rotation.to_rotation_matrix().into_inner(),
        }
    }

    /// A side of the box round the body's image; `guess` is where it may be.
    pub fn tangent(&self, side: ImageSide, guess: f64) -> Tangent {
        let (axis, sign) = side.outward();
        // Left and upper sides are right and lower ones of the mirror image.
        let outermost = Edge {
            silhouette: self,
            axis,
            sign,
            own_outward: self.rotation.row(axis).transpose() * sign,
            own_forward: self.rotation.row(2).transpose(),
        };
        outermost.touch(sign * guess)
    }
}

/// The upper end of `m = sign * x/z` (or y) over the body.
struct Edge<'a> {
    silhouette: &'a Silhouette,
    axis: usize,
    sign: f64,
    own_outward: Vector3<f64>,
    own_forward: Vector3<f64>,
}

/// How the plane at `m` lies to the body.
#[derive(Clone, Copy)]
struct Probe {
    m: f64,
    /// How far the body reaches beyond the plane, along a vector longer than 1; it falls with the slope `depth`.
    gap: f64,
    contact: Vector3<f64>,
    /// Of the contact (m); it never grows with `m`.
    depth: f64,
}

impl Edge<'_> {
    fn probe(&self, m: f64) -> Probe {
        let body = self.silhouette;
        let direction = self.own_outward - self.own_forward * m;
        let support = body.outline.support(&direction, &body.semi_axes);
        Probe {
            m,
            gap: self.sign * body.center[self.axis] - m * body.center.z + support.reach,
            contact: support.contact,
            depth: body.center.z + self.own_forward.dot(&support.contact),
        }
    }

    fn touch(&self, guess: f64) -> Tangent {
        let found = self.newton(guess).or_else(|| self.newton(INNERMOST));
        found.unwrap_or_else(|| self.tangent(&self.probe(OUTERMOST), NEAR_M))
    }

    /// Newton's method: the gap is convex, so that after one step it comes to the solution from the inside. It ends
    /// where the contact is too near, which it stays farther out.
    fn newton(&self, guess: f64) -> Option<Tangent> {
        let mut probe = self.probe(guess);
        for _ in 0..MAX_STEPS {
            if probe.depth < NEAR_M {
                return None;
            }
            let step = probe.gap / probe.depth;
            if step.abs() < TOLERANCE * (1.0 + probe.m.abs()) {
                break;
            }
            probe = self.probe(probe.m + step);
        }
        Some(self.tangent(&probe, probe.depth))
    }

    /// The tangent where the gap, followed with this slope from the probe, is zero.
    fn tangent(&self, probe: &Probe, slope: f64) -> Tangent {
        let mut direction = Vector3::new(0.0, 0.0, -probe.m);
        direction[self.axis] = self.sign;
        Tangent {
            at: self.sign * (probe.m + probe.gap / slope),
            contact: probe.contact,
            gradient: direction * (self.sign / slope),
        }
    }
}

/// So far on the wrong side of the image that the contact is the body's farthest point.
const INNERMOST: f64 = -1000.0;
/// 84 degrees off the image's centre: no pinhole camera sees that far.
const OUTERMOST: f64 = 10.0;
/// Newton's method doubles the digits with every step: after a step like this it is exact.
const TOLERANCE: f64 = 1e-7;
const MAX_STEPS: usize = 60;
