//! How far the camera may be from where odometry, TF and stamps have it, and what that does to what it sees.

use super::{mount::Tilt, stamp_offset::Offset};
use crate::geometry::{Ellipsoid, skew};
use nalgebra::{Matrix3, Point3, SMatrix, Vector3, Vector6};
use serde::Serialize;

/// The uncertainty of the camera's placement at one image, apart from drift of odometry, which is the graph's.
///
/// Two causes, both proportional to something of the moment: a tilt moves what is seen by its range, and an offset of stamps by the
/// robot's speed and rate of turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Place of the camera in the frame of the base (m).
    pub(super) camera_at: Point3<f64>,
    /// Of the camera about the base's axes.
    pub(super) tilt: Tilt,
    /// How far the base goes in one standard deviation of the stamps' offset: `[rotation, translation]` in its own frame.
    pub(super) jitter: Vector6<f64>,
}

impl Placement {
    /// Covariance (m^2) of a point of the base's frame as the camera sees it.
    pub(super) fn displacement(&self, point: &Point3<f64>) -> Matrix3<f64> {
        let lever = skew(point - self.camera_at).fixed_view::<3, 2>(0, 0).into_owned();
        let moved = self.turn().cross(&point.coords) + self.jitter.fixed_rows::<3>(3);
        lever * self.tilt.covariance * lever.transpose() + moved * moved.transpose()
    }

    /// Standard deviation of a heading (rad).
    pub(super) fn heading_sigma(&self) -> f64 {
        self.jitter[2].abs()
    }

    /// Standard deviations of a direction from the camera, to the side and upwards (rad).
    pub(super) fn direction_sigmas(&self) -> [f64; 2] {
        let tilt = self.tilt.covariance.diagonal().max().sqrt();
        [self.heading_sigma(), tilt.hypot(self.turn().xy().norm())]
    }

    /// The covariance of `[rotation, translation, log semi-axes]` in an ellipsoid's own frame, with what displaces the
    /// ellipsoid, which is in the frame of the base.
    pub(super) fn widened(
        &self,
        covariance: &SMatrix<f64, 9, 9>,
        ellipsoid: &Ellipsoid,
    ) -> SMatrix<f64, 9, 9> {
        let own = ellipsoid.pose.rotation.inverse().to_rotation_matrix();
        let turned = own * self.turn();
        let displaced = own * self.displacement(&ellipsoid.center()) * own.inverse();
        let mut widened = *covariance;
        let mut rotation = widened.fixed_view_mut::<3, 3>(0, 0);
        rotation += turned * turned.transpose();
        let mut translation = widened.fixed_view_mut::<3, 3>(3, 3);
        translation += displaced;
        widened
    }

    fn turn(&self) -> Vector3<f64> {
        self.jitter.fixed_rows::<3>(0).into_owned()
    }
}

/// What was learnt of the camera's mount and of the clocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Calibration {
    /// How far the camera leans to the right of where TF has it (rad): a turn about the base's x axis.
    pub roll_rad: f64,
    /// How much lower it looks than TF says (rad): a turn about the base's y axis.
    pub pitch_rad: f64,
    /// Standard deviations of both (rad).
    pub tilt_sigma_rad: [f64; 2],
    /// Odometry stamped so much later than an image belongs to it (s).
    pub stamp_offset_s: f64,
    /// Standard deviation of that (s).
    pub stamp_sigma_s: f64,
}

impl Calibration {
    pub(super) fn new(mount: Option<Tilt>, offset: Offset) -> Self {
        let tilt = mount.unwrap_or_else(Tilt::none);
        Self {
            roll_rad: tilt.about.x,
            pitch_rad: tilt.about.y,
            tilt_sigma_rad: tilt.covariance.diagonal().map(f64::sqrt).into(),
            stamp_offset_s: offset.seconds,
            stamp_sigma_s: offset.sigma_s,
        }
    }

    /// A sentence for each thing that is clearly not as TF and stamps say.
    pub fn sentences(&self) -> Vec<String> {
        let degrees = |rad: f64| format!("{:.1} degrees", rad.abs().to_degrees());
        let is_clear =
            |rad: f64, sigma: f64| rad.abs() > WORTH_SAYING_RAD.max(CLEAR_SIGMAS * sigma);
        let mut said = Vec::new();
        if is_clear(self.pitch_rad, self.tilt_sigma_rad[1]) {
            let way = if self.pitch_rad > 0.0 { "lower" } else { "higher" };
            said.push(format!("the camera looks {} {way} than TF says", degrees(self.pitch_rad)));
        }
        if is_clear(self.roll_rad, self.tilt_sigma_rad[0]) {
            let way = if self.roll_rad > 0.0 { "right" } else { "left" };
            let leans = degrees(self.roll_rad);
            said.push(format!("the camera leans {leans} more to the {way} than TF says"));
        }
        let offset_s = self.stamp_offset_s;
        if offset_s.abs() > WORTH_SAYING_S.max(CLEAR_SIGMAS * self.stamp_sigma_s) {
            let (ms, way) =
                (1e3 * offset_s.abs(), if offset_s > 0.0 { "later" } else { "earlier" });
            said.push(format!(
                "odometry is stamped {ms:.0} ms {way} than images of the same moment"
            ));
        }
        said
    }
}

/// Less is as good as mounts and clocks usually are (rad, s),
const WORTH_SAYING_RAD: f64 = 0.005;
const WORTH_SAYING_S: f64 = 0.01;
/// and has to be so many standard deviations from nothing.
const CLEAR_SIGMAS: f64 = 3.0;
