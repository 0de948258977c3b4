//! Whether errors are as large as the covariance says.

use super::{axes, object_error::rotation_error_deg};
use crate::geometry::{Ellipsoid, OrientedBox, Pose, local};
use nalgebra::{DMatrix, DVector, Matrix6, Rotation3, SMatrix, SVector, UnitQuaternion};
use serde::Serialize;

/// A squared error in units of its covariance (NEES); chi-square distributed if the covariance is right.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalisedError {
    /// The normalised squared error.
    pub nees: f64,
    /// Degrees of freedom.
    pub dimensions: usize,
}

/// Normalised errors of many objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Calibration {
    /// How many objects.
    pub objects: usize,
    /// Mean of the normalised squared error over its degrees of freedom; 1 if the covariance is right, more if it
    /// promises too much.
    pub mean_nees_per_dimension: Option<f64>,
    /// Fraction of the objects inside the region that is claimed to hold 50 %.
    pub within_50: Option<f64>,
    /// Likewise 90 %.
    pub within_90: Option<f64>,
    /// Likewise 99 %.
    pub within_99: Option<f64>,
}

/// Error of a robot's pose in the plane, heading and place, with a covariance of `[rotation, translation]`, a right
/// perturbation. Nothing where the covariance is singular.
pub fn pose_error(
    estimate: &Pose,
    covariance: &Matrix6<f64>,
    truth: &Pose,
) -> Option<NormalisedError> {
    normalised(&local(estimate, truth), covariance, &[2, 3, 4])
}

/// The parts of an object's error; a heading only where the true footprint has a main axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct PartErrors {
    pub(super) heading: Option<NormalisedError>,
    pub(super) center: NormalisedError,
    pub(super) size: NormalisedError,
    pub(super) all: NormalisedError,
}

/// Errors of an estimate with a covariance of `[rotation, translation, log semi-axes]`, a right perturbation.
///
/// Of all ways to name the true box's axes that keep it upright the one counts in which the error is smallest.
/// Nothing where the covariance is singular.
pub(super) fn part_errors(
    estimate: &Ellipsoid,
    covariance: &SMatrix<f64, 9, 9>,
    truth: &OrientedBox,
) -> Option<PartErrors> {
    let up = axes::up_axis(&OrientedBox::from(estimate));
    let has_heading = rotation_error_deg(&OrientedBox::from(estimate), truth).is_some();
    let (center, size) = ([3, 4, 5], [6, 7, 8]);
    let mut all: Vec<usize> = if has_heading { vec![up] } else { Vec::new() };
    all.extend(center.into_iter().chain(size));
    let of = |error: &SVector<f64, 9>, rows: &[usize]| normalised(error, covariance, rows);
    let errors = axes::namings().map(|naming| estimate.local(&renamed(truth, &naming)));
    let upright = errors.filter(|error| {
        // The rotation about the up axis is the heading; any other would lay the object on its side.
        let rotation = Rotation3::new(error.fixed_rows::<3>(0).into_owned());
        rotation.matrix()[(up, up)] > std::f64::consts::FRAC_1_SQRT_2
    });
    let scored = upright.filter_map(|error| Some((of(&error, &all)?, error)));
    let (all, error) = scored.min_by(|a, b| a.0.nees.total_cmp(&b.0.nees))?;
    let heading = if has_heading { Some(of(&error, &[up])?) } else { None };
    Some(PartErrors { heading, center: of(&error, &center)?, size: of(&error, &size)?, all })
}

fn renamed(truth: &OrientedBox, old_from_new: &nalgebra::Matrix3<f64>) -> Ellipsoid {
    let turn =
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*old_from_new));
    let rotation = truth.pose.rotation * turn;
    let semi_axes = old_from_new.transpose().abs() * truth.half_extents;
    Ellipsoid::new(Pose::from_parts(truth.pose.translation, rotation), semi_axes)
}

fn normalised<const N: usize>(
    error: &SVector<f64, N>,
    covariance: &SMatrix<f64, N, N>,
    rows: &[usize],
) -> Option<NormalisedError> {
    let dimensions = rows.len();
    let error = DVector::from_fn(dimensions, |i, _| error[rows[i]]);
    let covariance =
        DMatrix::from_fn(dimensions, dimensions, |i, j| covariance[(rows[i], rows[j])]);
    let nees = error.dot(&covariance.cholesky()?.solve(&error));
    nees.is_finite().then_some(NormalisedError { nees, dimensions })
}

impl Calibration {
    /// Over objects.
    pub fn new(errors: &[NormalisedError]) -> Self {
        let objects = errors.len();
        let mean = |value: &dyn Fn(&NormalisedError) -> f64| {
            (objects > 0).then(|| errors.iter().map(value).sum::<f64>() / objects as f64)
        };
        let within =
            |level: usize| mean(&|e| f64::from(u8::from(e.nees <= quantiles(e.dimensions)[level])));
        Self {
            objects,
            mean_nees_per_dimension: mean(&|e| e.nees / e.dimensions as f64),
            within_50: within(0),
            within_90: within(1),
            within_99: within(2),
        }
    }
}

/// Quantiles of the chi-square distribution at 50, 90 and 99 % (Abramowitz and Stegun 1964, table 26.8).
fn quantiles(dimensions: usize) -> [f64; 3] {
    const TABLE: [[f64; 3]; 7] = [
        [0.454936, 2.705543, 6.634897],
        [1.386294, 4.605170, 9.210340],
        [2.365974, 6.251389, 11.344867],
        [3.356694, 7.779440, 13.276704],
        [4.351460, 9.236357, 15.086272],
        [5.348121, 10.644641, 16.811894],
        [6.345811, 12.017037, 18.475307],
    ];
    TABLE[dimensions - 1]
}
