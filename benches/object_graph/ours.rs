//! The world in our graph.

use crate::{
    times::Run,
    world::{HUBER, Keyframe, PRIOR_SIGMAS, SEEN_SIGMAS, STEP_SIGMAS},
};
use cpu_time::ThreadTime;
use ellipsoid_slam::{
    geometry::{Outline, Pose},
    graph::{
        EllipsoidId, EllipsoidObservation, Graph, Kernel, Noise, PoseId, PosePrior, RelativePose,
        SolverSettings, UpdateReport,
    },
};
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;

/// Iterations of the batch optimum, and the share of the cost by which the last one may still lower it.
const BATCH: (usize, f64) = (50, 1e-9);

/// Drives through the world `repeats` times, with an update a keyframe; also says what the updates had to do.
///
/// The time of a keyframe is that of making its factors, the update and reading the newest pose. All runs do the same,
/// and the shortest counts.
pub(crate) fn drive(world: &[Keyframe], repeats: usize) -> (Run, String) {
    let mut times = vec![f64::INFINITY; world.len()];
    let (mut robot, mut reports) = (Robot::new(), Vec::new());
    for _ in 0..repeats {
        (robot, reports) = (Robot::new(), Vec::new());
        for (keyframe, least) in world.iter().zip(&mut times) {
            let start = ThreadTime::now();
            reports.push(robot.step(keyframe));
            *least = least.min(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    let cost = robot.graph.cost();
    let start = ThreadTime::now();
    let batch = robot.graph.optimize(BATCH.0, BATCH.1).unwrap();
    let each = start.elapsed().as_secs_f64() * 1e3 / batch.iterations as f64;
    let run = Run { times, cost, batch_cost: batch.final_cost };
    let everything = format!("everything at once: {} times {each:.0} ms", batch.iterations);
    (run, format!("{}; {everything}", effort(&reports)))
}

pub(crate) struct Robot {
    pub(crate) graph: Graph,
    pub(crate) newest: Option<PoseId>,
    objects: BTreeMap<usize, EllipsoidId>,
}

impl Robot {
    pub(crate) fn new() -> Self {
        let graph = Graph::new(SolverSettings::default());
        Self { graph, newest: None, objects: BTreeMap::new() }
    }

    pub(crate) fn step(&mut self, keyframe: &Keyframe) -> UpdateReport {
        let graph = &mut self.graph;
        let before = self.newest.map_or(Pose::identity(), |id| graph.pose(id));
        let initial = before * keyframe.step;
        let new = graph.add_pose(initial);
        match self.newest {
            None => {
                let noise = Noise::from_sigmas(PRIOR_SIGMAS).unwrap();
                graph.add_factor(PosePrior::new(new, initial, noise));
            }
            Some(last) => {
                let noise = Noise::from_sigmas(STEP_SIGMAS).unwrap();
                graph.add_factor(RelativePose::new(last, new, &keyframe.step, noise));
            }
        }
        let covariance = SMatrix::from_diagonal(&SVector::from(SEEN_SIGMAS.map(|s| s * s)));
        for seen in &keyframe.seen {
            let measured = seen.measured;
            let object = *self
                .objects
                .entry(seen.object)
                .or_insert_with(|| graph.add_ellipsoid(measured.transformed(&initial)));
            let factor =
                EllipsoidObservation::new(new, object, measured, &covariance, Outline::Cuboid);
            graph.add_factor(factor.unwrap().with_kernel(Kernel::Huber(HUBER)));
        }
        let report = graph.update().unwrap();
        std::hint::black_box(graph.pose(new));
        self.newest = Some(new);
        report
    }
}

fn effort(reports: &[UpdateReport]) -> String {
    let mean = |of: fn(&UpdateReport) -> usize| {
        reports.iter().map(of).sum::<usize>() as f64 / reports.len() as f64
    };
    format!(
        "variables a keyframe: {:.1} eliminated, {:.1} linearised anew, {:.1} changed; {} updates were damped",
        mean(|r| r.eliminated),
        mean(|r| r.relinearized),
        mean(|r| r.changed),
        reports.iter().filter(|r| r.damping > 0.0).count(),
    )
}
