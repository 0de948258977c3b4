//! How the camera is tilted on the base, learnt from the floor that the wheels stand on.

use crate::{geometry::Pose, perception::Floor, time::Stamp};
use nalgebra::{Cholesky, Matrix2, Point3, UnitQuaternion, Vector2, Vector3};

/// The tilt of the camera against what TF says, as a slow state: a random walk that each sight of the floor corrects.
///
/// A tilt is a rotation vector about the base's x axis (roll: positive leans to the right) and y axis (pitch: positive looks
/// lower), rad.
#[derive(Clone, Debug)]
pub(super) struct Mount {
    frame_id: String,
    tilt: Vector2<f64>,
    covariance: Matrix2<f64>,
    seen: Option<Seen>,
}

/// The latest floor.
#[derive(Clone, Copy, Debug)]
struct Seen {
    stamp: Stamp,
    /// How far it is under the base's origin (m).
    under_wheels_m: f64,
}

/// A tilt and how well it is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt {
    /// About the base's x and y axes (rad).
    pub(super) about: Vector2<f64>,
    /// Its covariance (rad^2).
    pub(super) covariance: Matrix2<f64>,
}

impl Tilt {
    /// A camera that is where TF has it: the base is the camera itself, as with a camera in a hand.
    pub(super) fn none() -> Self {
        Self { about: Vector2::zeros(), covariance: Matrix2::zeros() }
    }

    /// The camera on the base, turned by the tilt.
    pub(super) fn turned(&self, base_from_camera: &Pose) -> Pose {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(self.about.x, self.about.y, 0.0));
        Pose::from_parts(base_from_camera.translation, turn * base_from_camera.rotation)
    }
}

impl Mount {
    /// A camera of which TF alone is known.
    pub(super) fn new(frame_id: &str) -> Self {
        Self {
            frame_id: frame_id.to_owned(),
            tilt: Vector2::zeros(),
            covariance: Matrix2::from_diagonal_element(USUAL_RAD.powi(2)),
            seen: None,
        }
    }

    /// Whether it is the mount of this camera.
    pub(super) fn is_of(&self, frame_id: &str) -> bool {
        self.frame_id == frame_id
    }

    /// What is known of the mount, without what the base does over a bump.
    pub(super) fn slow(&self) -> Tilt {
        Tilt { about: self.tilt, covariance: self.covariance }
    }

    /// What is to be expected of one image, base and bumps included.
    pub(super) fn expected(&self) -> Tilt {
        let bump = Matrix2::from_diagonal_element(BUMP_RAD.powi(2));
        Tilt { about: self.tilt, covariance: self.covariance + bump }
    }

    /// How far the floor is under the base's origin (m): zero, or the height of an axle; nothing before it was seen.
    pub(super) fn floor_under_wheels_m(&self) -> Option<f64> {
        self.seen.map(|seen| seen.under_wheels_m)
    }

    /// Takes what the floor says of the image at `stamp`, whose level frame was made with what was expected, and gives the tilt
    /// in this image. `wheels` is the base's origin in the level frame.
    pub(super) fn correct(
        &mut self,
        stamp: Stamp,
        (floor, wheels): (&Floor, &Point3<f64>),
        base_from_level: &UnitQuaternion<f64>,
    ) -> Tilt {
        let expected = self.expected();
        let slopes = floor.slopes();
        // What turns the floor's normal upright, about the axes of the level frame and then those of the base.
        let about = base_from_level * Vector3::new(-slopes.y, slopes.x, 0.0);
        let to_base = base_from_level.to_rotation_matrix();
        let axes = to_base.matrix().fixed_view::<2, 2>(0, 0) * Matrix2::new(0.0, -1.0, 1.0, 0.0);
        let noise = axes * floor.slope_covariance * axes.transpose();
        let off = about.xy();
        let Some(root) = Cholesky::new(expected.covariance + noise) else { return expected };
        let information = root.inverse();
        // A ramp ahead, or a slope that is none: the mount did not change, and neither did the base.
        if off.dot(&(information * off)) > GATE {
            return expected;
        }
        let under_wheels_m = floor.plane.signed_distance(wheels);
        if let Some(last) = self.seen.replace(Seen { stamp, under_wheels_m }) {
            let seconds = stamp.seconds_since(last.stamp).clamp(0.0, LONGEST_GAP_S);
            self.covariance += Matrix2::identity() * (WANDERING_RAD.powi(2) * seconds);
        }
        let gain = self.covariance * information;
        self.tilt += gain * off;
        self.covariance -= gain * self.covariance;
        let quick = expected.covariance * information;
        Tilt {
            about: expected.about + quick * off,
            covariance: expected.covariance - quick * expected.covariance,
        }
    }
}

/// Standard deviation of a mount against its description (rad): a degree or so for what is screwed on by hand.
const USUAL_RAD: f64 = 0.02;
/// Standard deviation of the base against the floor, from one image to another (rad): braking, carpets, cables.
const BUMP_RAD: f64 = 0.006;
/// How far a mount gives way in a second (rad): a degree in an hour.
const WANDERING_RAD: f64 = 0.0003;
/// Nothing is said of how far it gives way while nobody looks for longer (s).
const LONGEST_GAP_S: f64 = 600.0;
/// Squared Mahalanobis distance beyond which a slope is none of the mount's: four standard deviations each way.
const GATE: f64 = 25.0;
