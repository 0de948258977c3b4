//! What a detector that measures in space says of an object, as mapping takes it: for robots that send no depth.
//!
//! How exactly such a detector measures is stated here and nowhere else; covariances in its messages are not used, as those that are
//! filled in at all are rarely of the detector in question.

use super::Settings;
use crate::{
    geometry::{Ellipsoid, Pose},
    mapping::{Measured, Observation, ObservedBox},
    perception::Detection3d,
    time::Stamp,
};
use nalgebra::{Matrix3, Rotation3, SMatrix, Unit, UnitQuaternion, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};

/// The objects that a detector measured at one time.
#[derive(Clone, Debug)]
pub struct Detections3dMessage {
    /// When.
    pub stamp: Stamp,
    /// The objects, each in the frame that it names.
    pub detections: Vec<Detection3d>,
}

/// Standard deviations of what a detector measures in space, at a range from the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Detections3dSettings {
    /// Of the range of a centre (m),
    pub range_sigma_m: f64,
    /// and how it grows with the squared range (m/m^2).
    pub range_sigma_per_m2: f64,
    /// Of a centre across the ray (m),
    pub across_sigma_m: f64,
    /// and how it grows with the range.
    pub across_sigma_ratio: f64,
    /// Of an extent (m),
    pub size_sigma_m: f64,
    /// and as a share of it.
    pub size_sigma_ratio: f64,
    /// Of the heading of a box that is turned in its frame. The heading of one that is not turned is not known.
    pub heading_sigma_deg: f64,
}

impl Default for Detections3dSettings {
    fn default() -> Self {
        Self {
            range_sigma_m: 0.05,
            range_sigma_per_m2: 0.01,
            across_sigma_m: 0.02,
            across_sigma_ratio: 0.01,
            size_sigma_m: 0.03,
            size_sigma_ratio: 0.15,
            heading_sigma_deg: 15.0,
        }
    }
}

/// The observation of a detection whose frame is at a pose on the base; `up` points against gravity in the frame of the base.
pub(super) fn observation_in_space(
    detection: &Detection3d,
    base_from_frame: &Pose,
    up: &UnitVector3<f64>,
    settings: &Settings,
) -> Observation {
    let class = settings.perception.classes.prior(detection.label());
    let (pose, axes) = upright(&(base_from_frame * detection.frame_from_object), up);
    // Without extents the class says them, once for all measurements: here they count for next to nothing.
    let usual_m = class.size_m.unwrap_or([UNKNOWN_M; 3]);
    let extents_m = detection.extents_m.map_or(usual_m, |own| axes.map(|axis| own[axis]));
    let ellipsoid = Ellipsoid::new(pose, 0.5 * Vector3::from(extents_m));
    let covariance = settings.detections_3d.covariance(
        detection,
        &ellipsoid,
        &base_from_frame.translation.vector,
    );
    let measured = Measured {
        ellipsoid,
        covariance,
        faces: None,
        probability: detection.probability(),
        support: None,
        usual_m: class.size_m,
        glimpse: None,
    };
    Observation {
        labels: detection.hypotheses().to_vec(),
        track: None,
        outline: class.outline,
        moves: class.moves,
        rect: None,
        sides: ObservedBox { base_from_camera: *base_from_frame, sides: [None; 4] },
        measured: Some(measured),
    }
}

impl Detections3dSettings {
    /// Covariance of `[rotation, translation, log semi-axes]` in the object's own frame, of what is seen `from` a place; both are in
    /// the frame of the base.
    fn covariance(
        &self,
        detection: &Detection3d,
        ellipsoid: &Ellipsoid,
        from: &Vector3<f64>,
    ) -> SMatrix<f64, 9, 9> {
        let ray = ellipsoid.pose.rotation.inverse() * (ellipsoid.center().coords - from);
        let range_m = ray.norm();
        let along = ray / range_m.max(1e-6);
        let range_sigma = self.range_sigma_m + self.range_sigma_per_m2 * range_m * range_m;
        let across_sigma = self.across_sigma_m + self.across_sigma_ratio * range_m;
        let place = Matrix3::identity() * across_sigma.powi(2)
            + along * along.transpose() * (range_sigma.powi(2) - across_sigma.powi(2));
        let is_turned = detection.frame_from_object.rotation.angle() > NOT_TURNED_RAD;
        let has_heading = detection.extents_m.is_some() && is_turned;
        let heading =
            if has_heading { self.heading_sigma_deg.to_radians() } else { ANY_HEADING_RAD };
        let size = |i: usize| match detection.extents_m {
            Some(_) => {
                let own =
                    self.size_sigma_ratio.hypot(self.size_sigma_m / (2.0 * ellipsoid.semi_axes[i]));
                // The sides of a box along the axes of its frame are those of whatever is turned within it.
                if has_heading || i == 2 { own } else { own.hypot(UNTURNED_SIGMA) }
            }
            None => UNKNOWN_SIZE_SIGMA,
        };
        let mut covariance = SMatrix::<f64, 9, 9>::zeros();
        for (i, sigma) in [TILT_SIGMA_RAD, TILT_SIGMA_RAD, heading].into_iter().enumerate() {
            covariance[(i, i)] = sigma * sigma;
            covariance[(6 + i, 6 + i)] = size(i).powi(2);
        }
        covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&place);
        covariance
    }
}

/// A pose that is turned upright, and which of its axes are the new x, y and z. Boxes of camera frames have their height along y.
fn upright(pose: &Pose, up: &UnitVector3<f64>) -> (Pose, [usize; 3]) {
    let turned = pose.rotation.to_rotation_matrix();
    let axis = |i: usize| turned.matrix().column(i).into_owned();
    let steepness = |i: usize| axis(i).dot(up).abs();
    let z = (1..3).fold(0, |best, i| if steepness(i) > steepness(best) { i } else { best });
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let level = axis(x) - up.into_inner() * axis(x).dot(up);
    // It is nearer to level than to upright, so that something of it is.
    let ahead = Unit::try_new(level, 1e-6).unwrap_or_else(Vector3::x_axis).into_inner();
    let basis = [ahead, up.cross(&ahead), up.into_inner()];
    let rotation = Rotation3::from_basis_unchecked(&basis);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    (Pose::from_parts(pose.translation, rotation), [x, y, z])
}

/// Objects stand upright (rad).
const TILT_SIGMA_RAD: f64 = 0.02;
/// A heading that is not known at all (rad).
const ANY_HEADING_RAD: f64 = 1.0;
/// What is turned by less is along the axes of its frame since its detector does not know better (rad).
const NOT_TURNED_RAD: f64 = 1e-6;
/// Standard deviation of the logarithm of a level extent, besides, where the box is not turned with the object.
const UNTURNED_SIGMA: f64 = 0.2;
/// The same of an extent that nobody measured,
const UNKNOWN_SIZE_SIGMA: f64 = 1.0;
/// and what it is taken for where the class does not say it either (m).
const UNKNOWN_M: f64 = 0.3;
