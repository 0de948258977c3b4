//! Objects as a constellation has them: what is the same wherever it stands, and what moves with it.

use super::RelocalisationSettings;
use crate::geometry::{Ellipsoid, Pose, yaw_of};
use nalgebra::{Matrix2, Matrix3, SMatrix, Vector2, Vector3};
use std::{
    collections::BTreeMap,
    f64::consts::{FRAC_PI_2, PI, TAU},
};

/// An object to recognise a place by.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Probability of each label.
    pub labels: BTreeMap<String, f64>,
    /// Upright, in a frame with z against gravity.
    pub ellipsoid: Ellipsoid,
    /// Covariance of `[rotation, translation, log semi-axes]`, a right perturbation in the object's frame.
    pub covariance: SMatrix<f64, 9, 9>,
}

/// A rotation about the vertical and a translation: what is unknown where gravity is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub(super) yaw: f64,
    pub(super) shift: Vector3<f64>,
}

impl Placement {
    pub(super) fn rotation(&self) -> Matrix3<f64> {
        let (sin, cos) = self.yaw.sin_cos();
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    }

    pub(super) fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation() * point + self.shift
    }

    pub(super) fn pose(&self) -> Pose {
        Pose::new(self.shift, Vector3::z() * self.yaw)
    }

    pub(super) fn of_pose(pose: &Pose) -> Self {
        Self { yaw: yaw_of(pose), shift: pose.translation.vector }
    }
}

/// A landmark with its uncertainty in the axes of its frame, each part by itself.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) center: Vector3<f64>,
    /// Of the centre (m^2).
    pub(super) spread: Matrix3<f64>,
    yaw: f64,
    /// Of the heading (rad^2).
    yaw_variance: f64,
    log_size: Vector3<f64>,
    log_size_variance: Vector3<f64>,
}

impl Body {
    pub(super) fn new(landmark: &Landmark, settings: &RelocalisationSettings) -> Self {
        let Landmark { ellipsoid, covariance, .. } = landmark;
        let rotation = ellipsoid.pose.rotation.to_rotation_matrix().into_inner();
        let own = covariance.fixed_view::<3, 3>(3, 3).into_owned();
        let floor = Matrix3::from_diagonal_element(settings.position_sigma_m.powi(2));
        let size_floor = settings.size_sigma_ratio.powi(2);
        Self {
            center: ellipsoid.pose.translation.vector,
            spread: rotation * own * rotation.transpose() + floor,
            yaw: yaw_of(&ellipsoid.pose),
            yaw_variance: covariance[(2, 2)] + settings.heading_sigma_deg.to_radians().powi(2),
            log_size: ellipsoid.semi_axes.map(f64::ln),
            log_size_variance: Vector3::from_fn(|i, _| covariance[(6 + i, 6 + i)] + size_floor),
        }
    }

    /// Mean horizontal variance of the centre (m^2).
    pub(super) fn horizontal_variance(&self) -> f64 {
        0.5 * (self.spread[(0, 0)] + self.spread[(1, 1)])
    }
}

/// A body that was seen beside one of the map that it might be.
pub(super) struct Comparison {
    /// From the seen centre, placed, to the one in the map (m).
    pub(super) apart: Vector3<f64>,
    /// Covariance of `apart` (m^2).
    pub(super) spread: Matrix3<f64>,
    /// How much more the heading in the map is, after whichever naming of the axes fits best (rad).
    pub(super) turned: f64,
    /// Variance of `turned` (rad^2).
    pub(super) turned_variance: f64,
    /// Logarithm of how much likelier size, heading and height are for one and the same body than for two bodies of
    /// one class.
    pub(super) likeness: f64,
    /// Squared Mahalanobis distance of the sizes.
    size_mahalanobis: f64,
}

impl Comparison {
    pub(super) fn new(seen: &Body, known: &Body, placement: &Placement) -> Self {
        let rotation = placement.rotation();
        let spread = rotation * seen.spread * rotation.transpose() + known.spread;
        let apart = known.center - placement.place(&seen.center);
        let turned_variance = seen.yaw_variance + known.yaw_variance;
        let turn = known.yaw - seen.yaw - placement.yaw;
        // The same body, named anew: an even number of quarter turns keeps which axis is x, an odd one does not.
        let (turned, shape, swapped) = [false, true]
            .map(|swapped| {
                let offset = if swapped { FRAC_PI_2 } else { 0.0 };
                let turned = wrapped(turn - offset, PI);
                let size = likeness_of_size(seen, known, swapped);
                (turned, size + likeness_of_heading(turned, turned_variance), swapped)
            })
            .into_iter()
            .fold(
                (0.0, f64::MIN, false),
                |best, named| if named.1 > best.1 { named } else { best },
            );
        let height = same_rather_than_alike(apart.z, spread[(2, 2)], CLASS_HEIGHT_SIGMA_M);
        let (differences, variances) = size_differences(seen, known, swapped);
        let size_mahalanobis =
            differences.component_mul(&differences).component_div(&variances).sum();
        let likeness = shape + height;
        Self { apart, spread, turned, turned_variance, likeness, size_mahalanobis }
    }

    /// Whether all differences are such as errors are.
    pub(super) fn is_plausible(&self) -> bool {
        let place =
            self.spread.cholesky().map_or(f64::MAX, |c| self.apart.dot(&c.solve(&self.apart)));
        let is_blind = self.turned_variance.sqrt() > NO_HEADING_RAD;
        let heading = if is_blind { 0.0 } else { self.turned * self.turned / self.turned_variance };
        place + heading + self.size_mahalanobis < PLAUSIBLE
    }

    /// Logarithm of the density (1/m^2) with which the same body is seen so far off on the ground.
    pub(super) fn log_ground_density(&self, extra_variance: f64) -> f64 {
        let spread: Matrix2<f64> = self.spread.fixed_view::<2, 2>(0, 0).into_owned()
            + Matrix2::from_diagonal_element(extra_variance);
        let apart: Vector2<f64> = self.apart.xy();
        let determinant = spread.determinant();
        let adjugate =
            Matrix2::new(spread[(1, 1)], -spread[(0, 1)], -spread[(1, 0)], spread[(0, 0)]);
        let mahalanobis = (apart.transpose() * adjugate * apart)[0] / determinant;
        -0.5 * mahalanobis - (TAU * determinant.sqrt()).ln()
    }
}

/// How much likelier the sizes are for one body than for two of a class.
pub(super) fn likeness_of_size(seen: &Body, known: &Body, swapped: bool) -> f64 {
    let (differences, variances) = size_differences(seen, known, swapped);
    (0..3).map(|i| same_rather_than_alike(differences[i], variances[i], CLASS_SIZE_SIGMA)).sum()
}

/// By how much the logarithms of the sizes differ, and with which variances.
fn size_differences(seen: &Body, known: &Body, swapped: bool) -> (Vector3<f64>, Vector3<f64>) {
    let named = |v: &Vector3<f64>| if swapped { v.yxz() } else { *v };
    let differences = named(&known.log_size) - seen.log_size;
    (differences, named(&known.log_size_variance) + seen.log_size_variance)
}

/// Headings of other bodies are anywhere within half a turn.
fn likeness_of_heading(turned: f64, variance: f64) -> f64 {
    let density = (-0.5 * turned * turned / variance).exp() / (TAU * variance).sqrt();
    // What is not known cannot be unlikely: a heading that is everywhere is as good as another body's.
    let sigma = variance.sqrt();
    if sigma > NO_HEADING_RAD { 0.0 } else { (density * PI).max(f64::MIN_POSITIVE).ln() }
}

/// Logarithm of the density of a difference if both are the same, over that if they are two of a class.
fn same_rather_than_alike(difference: f64, variance: f64, class_sigma: f64) -> f64 {
    let wide = variance + 2.0 * class_sigma * class_sigma;
    0.5 * (wide / variance).ln() - 0.5 * difference * difference * (1.0 / variance - 1.0 / wide)
}

/// An angle to the nearest multiple of `period` (rad).
pub(super) fn wrapped(angle: f64, period: f64) -> f64 {
    angle - (angle / period).round() * period
}

/// How much sizes of a class differ from one object to another, as a share.
const CLASS_SIZE_SIGMA: f64 = 0.25;
/// How much the heights of a class's objects above the ground differ (m).
const CLASS_HEIGHT_SIGMA_M: f64 = 0.2;
/// A heading is of no use when it is less sure than this (rad).
const NO_HEADING_RAD: f64 = 0.6;
/// Chi-square of seven differences (place, heading, size) that errors exceed once in a thousand times.
const PLAUSIBLE: f64 = 24.3;
