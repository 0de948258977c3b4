//! Where the base goes, and how the camera sits on it.

use super::{
    random::{Purpose, Random},
    scene::Routes,
    settings::{MountSettings, SimulationSettings, TrajectoryKind},
};
use crate::geometry::Pose;
use nalgebra::{
    Isometry3, Matrix3, Point2, Rotation3, Translation3, UnitQuaternion, Vector2, Vector3,
};
use std::f64::consts::TAU;

/// Base poses, one a frame, and the camera on the base.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    /// `world_from_base`; the base's x axis points ahead and z up.
    pub(super) world_from_base: Vec<Pose>,
    /// The static transform of the camera's optical frame, as TF has it.
    pub(super) base_from_optical: Pose,
    /// Where the camera is.
    pub(super) true_base_from_optical: Pose,
}

const ORBIT_FRAMES: usize = 36;
/// Between two frames of a robot (m).
const ROBOT_STEP_M: f64 = 0.12;
/// Corners of a robot's way are rounded over about this distance (m).
const ROUNDING_M: f64 = 0.6;
/// Spacing of the points on which a way is rounded (m).
const GRAIN_M: f64 = 0.02;

impl Trajectory {
    /// The trajectory that the settings ask for.
    pub(super) fn new(settings: &SimulationSettings, routes: &Routes) -> Self {
        let mut random = Random::new(settings.visit_seed(), Purpose::Trajectory, 0);
        let mount = &settings.mount;
        let robot = base_from_optical(mount.robot_height_m, mount.robot_pitch_down_rad);
        let (world_from_base, base_from_optical) = match settings.trajectory {
            TrajectoryKind::Orbit => {
                let above = mount.orbit_height_m - routes.orbit_center.z;
                let pitch_down = above.atan2(routes.orbit_radius);
                let frames = if settings.frames == 0 { ORBIT_FRAMES } else { settings.frames };
                let camera = base_from_optical(mount.orbit_height_m, pitch_down);
                (orbit(&mut random, routes, mount, frames), camera)
            }
            TrajectoryKind::Forward => {
                (drive(&mut random, &routes.forward, false, settings.frames), robot)
            }
            TrajectoryKind::Loop => {
                (drive(&mut random, &routes.round, true, settings.frames), robot)
            }
        };
        let error = Vector3::new(mount.tf_roll_error_rad, mount.tf_pitch_error_rad, 0.0);
        let rotation = UnitQuaternion::from_scaled_axis(error) * base_from_optical.rotation;
        let true_base_from_optical = Isometry3::from_parts(base_from_optical.translation, rotation);
        Self { world_from_base, base_from_optical, true_base_from_optical }
    }
}

/// The optical frame (x right, y down, z ahead) at a height above the base, looking down by an angle.
fn base_from_optical(height_m: f64, pitch_down_rad: f64) -> Pose {
    let level = Rotation3::from_matrix_unchecked(Matrix3::new(
        0.0, 0.0, 1.0, //
        -1.0, 0.0, 0.0, //
        0.0, -1.0, 0.0,
    ));
    // About the base's y axis, which points left, a positive angle takes ahead to down.
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch_down_rad);
    let rotation = tilt * UnitQuaternion::from_rotation_matrix(&level);
    Isometry3::from_parts(Translation3::new(0.0, 0.0, height_m), rotation)
}

fn planar(position: Point2<f64>, yaw: f64) -> Pose {
    Isometry3::from_parts(
        Translation3::new(position.x, position.y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
    )
}

/// Once round the centre, looking at it; the radius and the heading waver smoothly.
fn orbit(random: &mut Random, routes: &Routes, mount: &MountSettings, frames: usize) -> Vec<Pose> {
    let start = random.between(0.0, TAU);
    let direction = random.pick(&[-1.0, 1.0]);
    let (radius_wave, heading_wave) = (Wave::new(random), Wave::new(random));
    let center = routes.orbit_center.xy();
    (0..frames)
        .map(|i| {
            let turn = TAU * i as f64 / frames as f64;
            let angle = start + direction * turn;
            let radius = routes.orbit_radius * (1.0 + 0.06 * radius_wave.at(turn));
            let outwards = Vector2::new(angle.cos(), angle.sin());
            let yaw = angle + 0.5 * TAU + 0.05 * heading_wave.at(turn);
            let sway_m = mount.hand_sway_m;
            let sway = Isometry3::new(
                Vector3::from_fn(|_, _| random.normal(sway_m)),
                Vector3::from_fn(|_, _| random.normal(mount.hand_sway_rad)),
            );
            planar(center + outwards * radius, yaw) * sway
        })
        .collect()
}

/// A smooth function of an angle with values between -1 and 1.
struct Wave([f64; 2]);

impl Wave {
    fn new(random: &mut Random) -> Self {
        Self([random.between(0.0, TAU), random.between(0.0, TAU)])
    }

    fn at(&self, angle: f64) -> f64 {
        0.6 * (2.0 * angle + self.0[0]).sin() + 0.4 * (3.0 * angle + self.0[1]).sin()
    }
}

/// Along waypoints with rounded corners, heading where it goes; a closed way ends where it began.
fn drive(
    random: &mut Random,
    waypoints: &[Point2<f64>],
    is_closed: bool,
    frames: usize,
) -> Vec<Pose> {
    const WAYPOINT_JITTER_M: f64 = 0.06;
    let mut corners: Vec<Point2<f64>> = waypoints
        .iter()
        .map(|p| {
            let jitter = Vector2::from_fn(|_, _| random.between(-1.0, 1.0));
            p + jitter * WAYPOINT_JITTER_M
        })
        .collect();
    if is_closed {
        corners.extend(corners.first().copied());
    }
    let mut way = rounded(&rounded(&resampled(&corners), is_closed), is_closed);
    if is_closed {
        way.extend(way.first().copied());
    }
    if way.len() < 2 {
        return Vec::new();
    }
    let length = (way.len() - 1) as f64 * GRAIN_M;
    let frames = if frames == 0 { (length / ROBOT_STEP_M).ceil() as usize + 1 } else { frames };
    let last = (way.len() - 1) as f64;
    (0..frames)
        .map(|i| {
            let at = last * i as f64 / (frames.max(2) - 1) as f64;
            let index = (at as usize).min(way.len() - 2);
            let position = way[index] + (way[index + 1] - way[index]) * (at - index as f64);
            planar(position, heading(&way, at.round() as usize, is_closed))
        })
        .collect()
}

/// Points [`GRAIN_M`] apart on a polyline; its very end may be left out.
fn resampled(corners: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut points = Vec::new();
    let mut carried = 0.0;
    for pair in corners.windows(2) {
        let side = pair[1] - pair[0];
        let length = side.norm();
        let mut at = carried;
        while at < length {
            points.push(pair[0] + side * (at / length));
            at += GRAIN_M;
        }
        carried = at - length;
    }
    points
}

/// The moving average of a way; an open one keeps its ends.
fn rounded(way: &[Point2<f64>], is_closed: bool) -> Vec<Point2<f64>> {
    let (count, reach) = (way.len(), (0.5 * ROUNDING_M / GRAIN_M) as usize);
    (0..count)
        .map(|i| {
            let reach = if is_closed { reach } else { reach.min(i).min(count - 1 - i) };
            let sum: Vector2<f64> =
                (0..=2 * reach).map(|k| way[(i + count + k - reach) % count].coords).sum();
            Point2::from(sum / (2 * reach + 1) as f64)
        })
        .collect()
}

/// Direction of travel over the next and the last few centimetres.
fn heading(way: &[Point2<f64>], index: usize, is_closed: bool) -> f64 {
    const REACH: usize = 4;
    let last = way.len() - 1;
    let (behind, ahead) = if is_closed {
        // The last point is the first again, so the way has `last` distinct points.
        ((index + last - REACH % last) % last, (index + REACH) % last)
    } else {
        (index.saturating_sub(REACH), (index + REACH).min(last))
    };
    let along = way[ahead] - way[behind];
    along.y.atan2(along.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::yaw_of;
    use nalgebra::Point3;

    #[test]
    fn the_optical_frame_looks_ahead_and_down() {
        let base_from_optical = base_from_optical(1.0, 0.3);
        let right = base_from_optical.rotation * Vector3::x();
        let down = base_from_optical.rotation * Vector3::y();
        let ahead = base_from_optical.rotation * Vector3::z();
        assert!((right - Vector3::new(0.0, -1.0, 0.0)).norm() < 1e-12, "x is to the right");
        assert!(down.z < -0.9, "y is down, got {down}");
        let expected = Vector3::new(0.3f64.cos(), 0.0, -0.3f64.sin());
        assert!((ahead - expected).norm() < 1e-12, "z is ahead and pitched down, got {ahead}");
    }

    #[test]
    fn an_orbit_looks_at_its_center() {
        let routes = Routes {
            orbit_center: Point3::new(1.0, -2.0, 0.7),
            orbit_radius: 1.8,
            ..Routes::default()
        };
        let settings = SimulationSettings::default();
        let trajectory = Trajectory::new(&settings, &routes);
        assert_eq!(trajectory.world_from_base.len(), ORBIT_FRAMES);
        for world_from_base in &trajectory.world_from_base {
            let world_from_camera = world_from_base * trajectory.base_from_optical;
            let center = world_from_camera.inverse_transform_point(&routes.orbit_center);
            // The heading wavers by 0.05 rad, the radius by 6 %.
            assert!(center.z > 1.5 && center.x.abs() < 0.15 && center.y.abs() < 0.15, "{center}");
            assert_eq!(world_from_base.translation.vector.z, 0.0, "the base is planar");
        }
    }

    #[test]
    fn a_robot_turns_gently_and_a_loop_closes() {
        let corners =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)].map(|(x, y)| Point2::new(x, y));
        for is_closed in [false, true] {
            let poses = drive(&mut Random::new(1, Purpose::Trajectory, 0), &corners, is_closed, 0);
            for pair in poses.windows(2) {
                let step = pair[0].inverse() * pair[1];
                assert!(step.rotation.angle() < 0.45, "turns by {} rad", step.rotation.angle());
                assert!(step.translation.vector.norm() < 0.15);
                // It goes where it looks.
                assert!(step.translation.vector.x > 0.9 * step.translation.vector.norm());
            }
            let (first, last) = (poses[0], poses[poses.len() - 1]);
            let gap = (first.translation.vector - last.translation.vector).norm();
            if is_closed {
                assert!(gap < 1e-9 && (yaw_of(&first) - yaw_of(&last)).abs() < 1e-9);
            } else {
                assert!(gap > 2.0);
            }
        }
    }
}
