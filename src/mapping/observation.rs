//! What a keyframe brings to the map.

use super::{BoxOutline, SlamSettings, View, WallSighting, odometry::Place};
use crate::{
    geometry::{Ellipsoid, FaceEvidence, Outline, Plane, Pose, Rect},
    graph::{BoxError, BoxObservation, BoxSide, EllipsoidId},
    perception::UsualSize,
    time::Stamp,
};
use nalgebra::{SMatrix, SVector};

/// Where the robot was and what it saw.
#[derive(Clone, Debug)]
pub struct Sighting<'a> {
    /// When.
    pub stamp: Stamp,
    /// Pose of the base, by odometry.
    pub odom_from_base: Pose,
    /// Its covariance as in `geometry_msgs/PoseWithCovariance`, where odometry says it.
    pub odometry_covariance: Option<Box<[f64; 36]>>,
    /// One for each box of the detector. None at all means that it looked and found nothing.
    pub observations: Vec<Observation>,
    /// Walls in sight.
    pub walls: Vec<WallSighting>,
    /// The image, which tells what should have been seen; without it nothing is ever missed.
    pub view: Option<View<'a>>,
}

/// What was seen of one object.
#[derive(Clone, Debug)]
pub struct Observation {
    /// The detector's labels with their probabilities, most probable first.
    pub labels: Vec<(String, f64)>,
    /// Identity given with the detection.
    pub track: Option<u64>,
    /// What fills the extents of objects of this class.
    pub outline: Outline,
    /// Whether objects of this class move by themselves.
    pub moves: bool,
    /// The detector's box (px), where there is a [`Sighting::view`].
    pub rect: Option<Rect>,
    /// The sides of that box.
    pub sides: ObservedBox,
    /// The ellipsoid of this one frame, if there is one.
    pub measured: Option<Measured>,
}

/// A detector's box in undistorted normalised image coordinates.
#[derive(Clone, Copy, Debug)]
pub struct ObservedBox {
    /// Where the camera is on the robot.
    pub base_from_camera: Pose,
    /// Left, upper, right, lower; nothing for a side that the border of the image cuts.
    pub sides: [Option<BoxSide>; 4],
}

impl ObservedBox {
    /// Whether any of its sides says something.
    pub(super) fn has_any(&self) -> bool {
        self.sides.iter().any(Option::is_some)
    }

    /// The factor that ties an object to its sides, if there are any.
    pub(super) fn factor(
        &self,
        place: &Place,
        (object, outline): (EllipsoidId, Outline),
        settings: &SlamSettings,
    ) -> Result<Option<BoxObservation>, BoxError> {
        if !self.has_any() {
            return Ok(None);
        }
        let outline = match settings.box_outline {
            BoxOutline::Class => outline,
            BoxOutline::Ellipsoid => Outline::Ellipsoid,
        };
        let camera = place.keyframe_from_base * self.base_from_camera;
        let pose = place.keyframe.pose;
        let factor = BoxObservation::new(pose, object, camera, outline, self.sides)?;
        Ok(Some(factor.with_kernel(settings.robust_kernel())))
    }
}

/// A single-frame ellipsoid.
#[derive(Clone, Debug)]
pub struct Measured {
    /// In the frame of the base.
    pub ellipsoid: Ellipsoid,
    /// Covariance of `[rotation, translation, log semi-axes]`, a right perturbation in the object's frame.
    pub covariance: SMatrix<f64, 9, 9>,
    /// What was seen of its faces -x, +x, -y, +y, -z, +z, from the ellipsoid's centre along its axes, without what its class
    /// says; nothing where only the covariance is known.
    pub faces: Option<[FaceEvidence; 6]>,
    /// `P_e` of the paper.
    pub probability: f64,
    /// The plane it stands on, in the frame of the base.
    pub support: Option<Plane>,
    /// Extents (m) that things of its class usually have: the longer horizontal one, the shorter one, the height.
    pub usual_m: Option<[f64; 3]>,
    /// What there is besides the box if it is hardly more than a direction: it counts for objects of which nothing better is
    /// known.
    pub glimpse: Option<Hints>,
}

/// What is known of an object besides its box where there is no measurement.
#[derive(Clone, Debug)]
pub struct Hints {
    /// Covariance of what depth says, as a measurement's.
    pub depth_covariance: SMatrix<f64, 9, 9>,
    /// What its class says.
    pub usual: UsualSize,
}

impl Measured {
    /// Doubts each horizontal axis on which this is much larger than the longer usual extent of its class (m): chairs
    /// that stand beside each other or one behind the other are measured as one now and then, and nothing says then
    /// which part of it is the object.
    #[must_use]
    pub fn doubting_its_size(mut self, usual_m: f64) -> Self {
        for i in 0..2 {
            let own = self.ellipsoid.semi_axes[i];
            if own > MUCH_LARGER * 0.5 * usual_m {
                let more = own - 0.5 * usual_m;
                self.covariance[(3 + i, 3 + i)] += more * more;
                self.covariance[(6 + i, 6 + i)] += (more / own).powi(2);
                let faces = self.faces.iter_mut().flat_map(|faces| &mut faces[2 * i..2 * i + 2]);
                faces.for_each(|face| *face = face.widened(2.0 * more));
            }
        }
        self
    }

    /// Whether it is a measurement: finite, with a covariance that is one.
    pub(super) fn is_usable(&self) -> bool {
        let Ellipsoid { pose, semi_axes } = &self.ellipsoid;
        let is_finite = pose.translation.vector.iter().chain(semi_axes).all(|x| x.is_finite());
        is_finite
            && semi_axes.iter().all(|s| *s > 0.0)
            && self.covariance.cholesky().is_some()
            && self.glimpse.as_ref().is_none_or(|h| h.depth_covariance.cholesky().is_some())
    }

    /// Height in the map of the plane that it stands on, below its centre (m).
    pub(super) fn support_height_m(&self, map_from_base: &Pose) -> Option<f64> {
        let plane = self.support?.transformed(map_from_base);
        let center = self.ellipsoid.transformed(map_from_base).center();
        Some(center.z - plane.signed_distance(&center) / plane.normal.z)
    }

    /// The same information for every component, `eps_z P_e` (1/rad^2, 1/m^2). Liao et al. 2020, eq. (11) and (14).
    pub(super) fn paper_covariance(&self, eps_z: f64) -> SMatrix<f64, 9, 9> {
        let information = eps_z * self.probability;
        let mut variances = SVector::<f64, 9>::repeat(1.0 / information);
        let log_axes = self.ellipsoid.semi_axes.map(|s| 1.0 / (information * s * s));
        variances.fixed_rows_mut::<3>(6).copy_from(&log_axes);
        SMatrix::from_diagonal(&variances)
    }
}

/// Hardly an object of a class is larger than the usual one by this factor: sizes differ by a quarter.
const MUCH_LARGER: f64 = 1.5;
