//! The object graph against GTSAM: the same problem has the same optimum.

use crate::environment::{python, run};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose, local, pose_from_xyzw, retract},
    graph::{
        EllipsoidId, EllipsoidObservation, Graph, Kernel, Noise, PoseId, PosePrior, RelativePose,
        SolverSettings,
    },
};
use nalgebra::{SMatrix, SVector, Translation3, UnitQuaternion, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::{f64::consts::TAU, fs, path::Path, process::Command};

/// Twice round a ring of objects: the second lap closes loops.
const LAP: usize = 16;
const OBJECTS: usize = 8;
const IN_VIEW: usize = 3;
const OUTLIER_EVERY: usize = 19;
const HUBER: f64 = 3.0;
const PRIOR_SIGMAS: [f64; 6] = [0.01; 6];
const STEP_SIGMAS: [f64; 6] = [0.002, 0.002, 0.02, 0.03, 0.02, 0.005];
const SEEN_SIGMAS: [f64; 9] = [0.02, 0.02, 0.05, 0.03, 0.04, 0.03, 0.05, 0.06, 0.05];

/// A graph, and the same as text.
struct Problem {
    graph: Graph,
    random: ChaCha8Rng,
    poses: Vec<PoseId>,
    ellipsoids: Vec<Option<EllipsoidId>>,
    truth: Vec<Ellipsoid>,
    text: Value,
    seen: usize,
}

impl Problem {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let truth = (0..OBJECTS).map(|i| {
            let size = Vector3::from_fn(|_, _| 0.2 + 0.3 * random.random::<f64>());
            let angle = TAU * i as f64 / OBJECTS as f64;
            Ellipsoid::new(on_ring(angle, 4.0, TAU * random.random::<f64>()), size)
        });
        let truth = truth.collect();
        let mut problem = Self {
            graph: Graph::new(SolverSettings::default()),
            random,
            poses: Vec::new(),
            ellipsoids: vec![None; OBJECTS],
            truth,
            text: json!({ "poses": [], "ellipsoids": [], "factors": [] }),
            seen: 0,
        };
        (0..2 * LAP).for_each(|keyframe| problem.drive(keyframe));
        problem
    }

    fn drive(&mut self, keyframe: usize) {
        let truth = |keyframe: usize| on_ring(TAU * keyframe as f64 / LAP as f64, 2.5, 0.0);
        let at = truth(keyframe);
        let id = match self.poses.last().copied() {
            None => {
                let id = self.add_pose(at);
                self.graph.add_factor(PosePrior::new(id, at, noise(PRIOR_SIGMAS)));
                let prior = json!({ "to": 0, "pose": numbers(&at), "sigmas": PRIOR_SIGMAS });
                self.note("prior", prior);
                id
            }
            Some(last) => {
                let error = Vector6::from(self.draw(STEP_SIGMAS));
                let step = retract(&truth(keyframe - 1).inv_mul(&at), &error);
                let id = self.add_pose(self.graph.pose(last) * step);
                self.graph.add_factor(RelativePose::new(last, id, &step, noise(STEP_SIGMAS)));
                let tie = json!({
                    "from": keyframe - 1, "to": keyframe, "pose": numbers(&step),
                    "sigmas": STEP_SIGMAS,
                });
                self.note("step", tie);
                id
            }
        };
        for ahead in 0..IN_VIEW {
            self.observe(id, &at, (keyframe * OBJECTS / LAP + ahead) % OBJECTS);
        }
        self.graph.update().unwrap();
    }

    fn observe(&mut self, from: PoseId, at: &Pose, number: usize) {
        self.seen += 1;
        let is_outlier = self.seen.is_multiple_of(OUTLIER_EVERY);
        let seen = if is_outlier { (number + 1) % OBJECTS } else { number };
        let error = SVector::from(self.draw(SEEN_SIGMAS));
        // Whoever measures may name the axes in another way.
        let measured = self.truth[seen].transformed(&at.inverse()).retract(&error);
        let measured = measured.quarter_turned(self.seen as i64);
        let id = self.ellipsoids[number].unwrap_or_else(|| {
            self.graph.add_ellipsoid(measured.transformed(&self.graph.pose(from)))
        });
        self.ellipsoids[number] = Some(id);
        let covariance = SMatrix::from_diagonal(&SVector::from(SEEN_SIGMAS.map(|s| s * s)));
        let (outline, name) = match number % 2 {
            0 => (Outline::Cuboid, "cuboid"),
            _ => (Outline::Ellipsoid, "ellipsoid"),
        };
        let factor = EllipsoidObservation::new(from, id, measured, &covariance, outline).unwrap();
        self.graph.add_factor(factor.with_kernel(Kernel::Huber(HUBER)));
        let text = json!({
            "from": self.poses.len() - 1, "to": number, "pose": numbers(&measured.pose),
            "semi_axes": measured.semi_axes.as_slice(), "sigmas": SEEN_SIGMAS, "outline": name,
            "huber": HUBER,
        });
        self.note("observation", text);
    }

    fn add_pose(&mut self, initial: Pose) -> PoseId {
        let id = self.graph.add_pose(initial);
        self.poses.push(id);
        id
    }

    fn note(&mut self, kind: &str, mut factor: Value) {
        factor["kind"] = json!(kind);
        self.text["factors"].as_array_mut().unwrap().push(factor);
    }

    /// The initial values are the incremental estimates.
    fn with_values(&mut self) -> &Value {
        let poses: Vec<_> = self.poses.iter().map(|id| numbers(&self.graph.pose(*id))).collect();
        let bodies = self.ellipsoids.iter().flatten().map(|id| {
            let body = self.graph.ellipsoid(*id);
            json!({ "pose": numbers(&body.pose), "semi_axes": body.semi_axes.as_slice() })
        });
        self.text["ellipsoids"] = bodies.collect();
        self.text["poses"] = json!(poses);
        &self.text
    }

    fn draw<const N: usize>(&mut self, sigmas: [f64; N]) -> [f64; N] {
        sigmas.map(|sigma| {
            // Box and Muller 1958.
            let (a, b): (f64, f64) = (self.random.random(), self.random.random());
            sigma * (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
        })
    }
}

fn noise(sigmas: [f64; 6]) -> Noise<6> {
    Noise::from_sigmas(sigmas).unwrap()
}

/// Looking along a ring around the origin (m), turned by `yaw` (rad).
fn on_ring(angle: f64, radius: f64, yaw: f64) -> Pose {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle + TAU / 4.0 + yaw);
    Pose::from_parts(
        Translation3::new(radius * angle.cos(), radius * angle.sin(), 0.3 * angle.sin()),
        turned,
    )
}

fn numbers(pose: &Pose) -> [f64; 7] {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
}

fn pose(numbers: &Value) -> Pose {
    let at: [f64; 7] = serde_json::from_value(numbers.clone()).unwrap();
    pose_from_xyzw([at[0], at[1], at[2]], [at[3], at[4], at[5], at[6]]).unwrap()
}

#[test]
fn gtsam_finds_the_same_optimum() {
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/gtsam_optimum.py");
    for seed in 0..3 {
        let mut problem = Problem::new(seed);
        let path = folder.path().join("graph.json");
        fs::write(&path, problem.with_values().to_string()).unwrap();
        let answer =
            run(Command::new(python("tests/requirements.txt").unwrap()).arg(&script).arg(&path))
                .unwrap();
        let answer: Value = serde_json::from_str(&answer).unwrap();
        let number = |key: &str| answer[key].as_f64().unwrap();

        // The terms are the same before anybody has optimised them.
        let graph = &mut problem.graph;
        assert!((graph.cost() / number("initial_cost") - 1.0).abs() < 1e-9, "seed {seed}");
        graph.optimize(200, 1e-13).unwrap();
        let (ours, theirs) = (graph.cost(), number("cost"));
        assert!((ours / theirs - 1.0).abs() < 1e-6, "seed {seed}: {ours}, GTSAM {theirs}");
        for (id, wanted) in problem.poses.iter().zip(answer["poses"].as_array().unwrap()) {
            let away = local(&pose(wanted), &graph.pose(*id)).amax();
            assert!(away < AWAY, "seed {seed}: {id:?} is {away} from GTSAM's");
        }
        let bodies = answer["ellipsoids"].as_array().unwrap();
        for (id, wanted) in problem.ellipsoids.iter().flatten().zip(bodies) {
            let axes: [f64; 3] = serde_json::from_value(wanted["semi_axes"].clone()).unwrap();
            let wanted = Ellipsoid::new(pose(&wanted["pose"]), axes.into());
            let away = wanted.local(&graph.ellipsoid(*id)).amax();
            assert!(away < AWAY, "seed {seed}: {id:?} is {away} from GTSAM's");
        }
    }
}

/// Where the cost is within 1e-13 of its minimum, as a share, a variable is within 1e-5 sigma of its place (rad, m, 1).
const AWAY: f64 = 2e-6;
