//! How far an image shows objects from where the map has them, and what of that is the robot's pose, which shifts all of them alike.

use super::{ObjectMap, Observation, association::Decision, odometry::Place};
use nalgebra::{Matrix3, Point2, RowVector3, Vector2, Vector3};

/// What an image shows of an object that counts.
struct Shift {
    /// The number of the observation.
    of: usize,
    /// Where the object is, from the robot, on the ground of the map (m).
    at: Vector2<f64>,
    /// How far off it was seen (m), and the variance of either component (m^2).
    by: Vector2<f64>,
    variance: f64,
}

/// The shifts of an image's objects.
pub(super) struct Displacement {
    shifts: Vec<Shift>,
}

impl Displacement {
    /// Of the observations that are taken for objects that count.
    pub(super) fn new(
        map: &ObjectMap,
        observations: &[Observation],
        decisions: &[Decision],
        place: &Place,
    ) -> Self {
        let map_from_base = place.map_from_base(&map.graph);
        let eye: Point2<f64> = map_from_base.translation.vector.xy().into();
        let shift = |(of, (observation, decision)): (usize, (&Observation, &Decision))| {
            let Decision::Object(at) = decision else { return None };
            let object = &map.objects[*at];
            let measured = observation.measured.as_ref().filter(|m| m.glimpse.is_none())?;
            if !object.counts() || object.moves || object.is_glimpsed() {
                return None;
            }
            let known = object.estimate().center();
            let seen = measured.ellipsoid.transformed(&map_from_base).center();
            let variance = measured.covariance[(3, 3)].max(measured.covariance[(4, 4)]);
            Some(Shift { of, at: known.xy() - eye, by: (seen - known).xy(), variance })
        };
        Self { shifts: observations.iter().zip(decisions).enumerate().filter_map(shift).collect() }
    }

    /// How far off the robot's pose shows what observation `of` shows (m), going by the other objects: a shift and a turn about the
    /// robot, by least squares, reweighted as one of them may have been moved as well (Holland and Welsch 1977). Nothing
    /// where too few others are seen that agree.
    pub(super) fn of_pose(&self, of: usize) -> Option<(Vector2<f64>, f64)> {
        let own = self.shifts.iter().find(|shift| shift.of == of)?;
        let others: Vec<&Shift> = self.shifts.iter().filter(|shift| shift.of != of).collect();
        if others.len() < FEWEST {
            return None;
        }
        let mut motion = Vector3::zeros();
        let mut covariance = Matrix3::zeros();
        let mut agreeing = 0;
        for _ in 0..ITERATIONS {
            agreeing = 0;
            let mut information = Matrix3::from_diagonal(&PRIOR.map(|sigma| 1.0 / (sigma * sigma)));
            let mut gradient = Vector3::zeros();
            for other in &others {
                let rows = rows(&other.at);
                let variance = other.variance + OWN_SIGMA_M * OWN_SIGMA_M;
                let off = other.by - Vector2::from_fn(|i, _| (rows[i] * motion)[0]);
                let outlying = off.norm_squared() / (OUTLIER * variance);
                agreeing += usize::from(outlying < 1.0);
                let weight = 1.0 / (variance * (1.0 + outlying));
                for (i, row) in rows.iter().enumerate() {
                    information += weight * row.transpose() * row;
                    gradient += weight * row.transpose() * other.by[i];
                }
            }
            covariance = information.cholesky()?.inverse();
            motion = covariance * gradient;
        }
        if agreeing < FEWEST {
            return None;
        }
        let rows = rows(&own.at);
        let shift = Vector2::from_fn(|i, _| (rows[i] * motion)[0]);
        let variance = rows.map(|row| (row * covariance * row.transpose())[0]);
        Some((shift, variance[0].max(variance[1])))
    }
}

/// How a shift along x and y and a turn of the robot move what is at a place, from the robot.
fn rows(at: &Vector2<f64>) -> [RowVector3<f64>; 2] {
    [RowVector3::new(1.0, 0.0, -at.y), RowVector3::new(0.0, 1.0, at.x)]
}

/// So many others that agree tell how far the robot is off.
const FEWEST: usize = 2;
const ITERATIONS: usize = 4;
/// Before anything was seen (m, m, rad).
const PRIOR: Vector3<f64> = Vector3::new(1.0, 1.0, 0.05);
/// How well an object's place is known, and seen from one side, besides what a measurement says of itself (m).
const OWN_SIGMA_M: f64 = 0.02;
/// Squared residual from which one of the others loses half of its weight, in variances.
const OUTLIER: f64 = 9.0;
