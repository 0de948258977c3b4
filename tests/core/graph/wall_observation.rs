//! Walls that are seen, by examples worked out by hand.

use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::Wall,
    graph::{
        Factor, Graph, Noise, PosePrior, RightAngle, SolverSettings,
        Variable::{Pose as Place, Wall as Side},
        VariableIds, WallObservation,
    },
};
use nalgebra::{Point2, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// 3 m ahead of a robot that looks along x, and a metre to its left.
fn ahead() -> (Point3<f64>, Vector3<f64>) {
    (Point3::new(3.0, 1.0, 0.5), -Vector3::x())
}

#[test]
fn a_robot_nearer_than_it_should_be_sees_a_negative_error() {
    let mut ids = VariableIds::default();
    let tied = (ids.next_pose(), ids.next_wall());
    let factor = WallObservation::new(tied, ahead(), [0.1, 0.5]).unwrap();
    let wall = Side(Wall { point: Point2::new(3.0, -2.0), heading: PI });
    let residual = |yaw, x| {
        let pose = upright_pose(yaw, Vector3::new(x, 0.0, 0.0));
        factor.residual(&[Place(pose), wall])
    };
    assert!(residual(0.0, 0.0).norm() < 1e-12);
    // What is seen lies 0.2 m behind the wall.
    assert!((residual(0.0, 0.2)[1] - -0.4).abs() < 1e-12);
    // Turned to the left, what is seen is turned, too; its middle, a metre to the left, goes a little nearer.
    let turned = residual(0.2, 0.0);
    assert!((turned[0] - 0.2_f64.sin() / 0.1).abs() < 1e-12);
    assert!((turned[1] - (3.0 - 3.0 * 0.2_f64.cos() + 0.2_f64.sin()) / 0.5).abs() < 1e-12);
    // A wall that is seen from its other side is no small error.
    let other_side = Side(Wall { point: Point2::new(3.0, -2.0), heading: 0.3 });
    assert!(factor.residual(&[Place(upright_pose(0.0, Vector3::zeros())), other_side])[0] > 2.0);
}

#[test]
fn two_walls_say_where_the_robot_is_and_how_it_is_turned() {
    let mut graph = Graph::new(SolverSettings::default());
    let noise = |sigma| Noise::from_sigmas([sigma; 6]).unwrap();
    let origin = upright_pose(0.0, Vector3::zeros());
    let first = graph.add_pose(origin);
    graph.add_factor(PosePrior::new(first, origin, noise(1e-4)));
    // It has driven 1 m and turned by 0.5 rad; odometry does not know.
    let truth = upright_pose(0.5, Vector3::new(1.0, 0.4, 0.0));
    let wrong = upright_pose(0.3, Vector3::new(0.7, 0.6, 0.0));
    let second = graph.add_pose(wrong);
    graph.add_factor(PosePrior::new(second, wrong, noise(1.0)));
    for (point, heading) in [([4.0, 0.0], PI), ([0.0, 3.0], -FRAC_PI_2)] {
        let wall = Wall { point: point.into(), heading };
        let id = graph.add_wall(wall.turned(0.1));
        for (pose, at) in [(first, origin), (second, truth)] {
            let center = at.inverse() * Point3::new(point[0], point[1], 0.0);
            let normal = wall.normal();
            let normal = at.inverse() * Vector3::new(normal.x, normal.y, 0.0);
            let seen = (center, normal);
            graph.add_factor(WallObservation::new((pose, id), seen, [0.001, 0.001]).unwrap());
        }
    }
    graph.update().unwrap();
    graph.optimize(20, 1e-9).unwrap();
    let found = graph.pose(second);
    assert!((found.translation.vector - truth.translation.vector).norm() < 1e-3, "{found}");
    assert!(found.rotation.angle_to(&truth.rotation) < 1e-3, "{found}");
}

#[test]
fn a_right_angle_makes_one_walls_heading_the_others() {
    let mut graph = Graph::new(SolverSettings::default());
    let origin = upright_pose(0.0, Vector3::zeros());
    let pose = graph.add_pose(origin);
    graph.add_factor(PosePrior::new(pose, origin, Noise::from_sigmas([1e-4; 6]).unwrap()));
    let sure = graph.add_wall(Wall { point: Point2::new(3.0, 0.0), heading: PI });
    graph.add_factor(WallObservation::new((pose, sure), ahead(), [1e-3, 1e-3]).unwrap());
    // To the left, seen from afar: 10 degrees off.
    let vague = graph.add_wall(Wall { point: Point2::new(0.0, 3.0), heading: -FRAC_PI_2 });
    let (sin, cos) = 0.17_f64.sin_cos();
    let seen = (Point3::new(0.0, 3.0, 0.0), Vector3::new(sin, -cos, 0.0));
    graph.add_factor(WallObservation::new((pose, vague), seen, [0.5, 0.01]).unwrap());
    graph.add_factor(RightAngle::new(sure, vague, 1, 0.005).unwrap());
    graph.update().unwrap();
    graph.optimize(20, 1e-9).unwrap();
    let heading = graph.wall(vague).heading;
    assert!((heading + FRAC_PI_2).cos() > 0.99999, "{heading}");
}
