//! What it costs to close one large loop.

use crate::{ours::Robot, world::round};
use cpu_time::ThreadTime;
use ellipsoid_slam::graph::{Noise, RelativePose};

/// How exactly the way is known that closes it: rotation (rad), translation (m).
const SIGMAS: [f64; 6] = [0.02, 0.02, 0.03, 0.1, 0.1, 0.05];
/// Iterations, and the share of the cost by which the last one may still lower it: as the map closes loops.
const CLOSURE: (usize, f64) = (15, 1e-4);

/// Drives once round a loop and closes it.
pub(crate) fn close(keyframes: usize) {
    let world = round(keyframes);
    let [start, .., end] = world.as_slice() else { return };
    let mut robot = Robot::new();
    robot.step(start);
    let first = robot.newest.unwrap();
    world[1..].iter().for_each(|keyframe| {
        robot.step(keyframe);
    });
    let (mut graph, last) = (robot.graph, robot.newest.unwrap());
    let step = start.at.inv_mul(&end.at);
    let open = (graph.pose(first) * step).inv_mul(&graph.pose(last)).translation.vector.norm();
    let noise = Noise::from_sigmas(SIGMAS).unwrap();
    graph.add_factor(RelativePose::new(first, last, &step, noise));
    let started = ThreadTime::now();
    let report = graph.optimize(CLOSURE.0, CLOSURE.1).unwrap();
    let took = started.elapsed().as_secs_f64() * 1e3;
    println!(
        "round: {} keyframes, a loop that is {open:.1} m open is closed in {took:.0} ms, {} iterations",
        world.len(),
        report.iterations
    );
}
