//! A robot that drives round a ring of objects, and what it measures.

use super::reference::Twin;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose, retract},
    graph::{
        EllipsoidId, EllipsoidObservation, FactorId, Kernel, Noise, PosePrior, RelativePose,
        SolverSettings,
    },
};
use nalgebra::{SMatrix, SVector, Translation3, UnitQuaternion, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Keyframes a lap; the second lap closes a loop with the objects of the first.
const LAP: usize = 14;
const KEYFRAMES: usize = 2 * LAP;
const OBJECTS: usize = 7;
const IN_VIEW: usize = 3;
const STEP_SIGMAS: [f64; 6] = [0.002, 0.002, 0.01, 0.02, 0.01, 0.005];
const SEEN_SIGMAS: [f64; 9] = [0.02, 0.02, 0.05, 0.03, 0.03, 0.03, 0.05, 0.05, 0.05];

/// How a world differs from the usual one.
#[derive(Clone, Copy)]
pub(super) struct Course {
    pub(super) seed: u64,
    pub(super) kernel: Kernel,
    /// One observation in so many is of something else.
    pub(super) outlier_every: usize,
    /// How far off new objects are put, in standard deviations of an observation.
    pub(super) initial_error: f64,
    pub(super) settings: SolverSettings,
}

impl Course {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            seed,
            kernel: Kernel::Huber(3.0),
            outlier_every: 20,
            initial_error: 0.0,
            settings: SolverSettings::default(),
        }
    }

    /// All keyframes, with an update after each.
    pub(super) fn driven(self) -> Drive {
        let mut drive = Drive::new(self);
        while drive.step() {
            drive.twin.graph.update().unwrap();
        }
        drive
    }
}

/// The course as far as it has been driven.
pub(super) struct Drive {
    pub(super) twin: Twin,
    /// The observations that are of something else.
    pub(super) outliers: Vec<FactorId>,
    pub(super) observations: Vec<FactorId>,
    course: Course,
    random: ChaCha8Rng,
    objects: Vec<Ellipsoid>,
    known: Vec<Option<EllipsoidId>>,
    keyframe: usize,
}

impl Drive {
    pub(super) fn new(course: Course) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(course.seed);
        let objects: Vec<Ellipsoid> = (0..OBJECTS)
            .map(|i| {
                let angle = TAU * (i as f64 + 0.3 * random.random::<f64>()) / OBJECTS as f64;
                let size = |random: &mut ChaCha8Rng| 0.2 + 0.4 * random.random::<f64>();
                let semi_axes =
                    Vector3::new(size(&mut random), size(&mut random), size(&mut random));
                Ellipsoid::new(on_ring(angle, 5.0, random.random::<f64>()), semi_axes)
            })
            .collect();
        Self {
            twin: Twin::new(course.settings),
            outliers: Vec::new(),
            observations: Vec::new(),
            course,
            random,
            known: vec![None; objects.len()],
            objects,
            keyframe: 0,
        }
    }

    /// Adds a keyframe and what is seen from it; `false` when the course is over.
    pub(super) fn step(&mut self) -> bool {
        if self.keyframe == KEYFRAMES {
            return false;
        }
        let angle = |keyframe: usize| TAU * keyframe as f64 / LAP as f64;
        let truth = on_ring(angle(self.keyframe), 3.0, 0.0);
        let id = match self.twin.poses.last().copied() {
            None => {
                let id = self.twin.add_pose(truth);
                let noise = Noise::from_sigmas([0.01; 6]).unwrap();
                self.twin.add(PosePrior::new(id, truth, noise));
                id
            }
            Some(last) => {
                let before = on_ring(angle(self.keyframe - 1), 3.0, 0.0);
                let error = Vector6::from(STEP_SIGMAS.map(|s| s * normal(&mut self.random)));
                let step = retract(&before.inv_mul(&truth), &error);
                let id = self.twin.add_pose(self.twin.graph.pose(last) * step);
                let noise = Noise::from_sigmas(STEP_SIGMAS).unwrap();
                self.twin.add(RelativePose::new(last, id, &step, noise));
                id
            }
        };
        let nearest = (self.keyframe * OBJECTS).div_ceil(LAP);
        for ahead in 0..IN_VIEW {
            self.observe(id, &truth, (nearest + ahead) % OBJECTS);
        }
        self.keyframe += 1;
        true
    }

    fn observe(&mut self, from: ellipsoid_slam::graph::PoseId, truth: &Pose, number: usize) {
        let is_outlier =
            self.observations.len() % self.course.outlier_every == self.course.outlier_every - 1;
        let seen = if is_outlier { (number + 1) % OBJECTS } else { number };
        let error = SEEN_SIGMAS.map(|s| s * normal(&mut self.random));
        let measured =
            self.objects[seen].transformed(&truth.inverse()).retract(&SVector::from(error));
        let id = self.known[number].unwrap_or_else(|| {
            let error = SEEN_SIGMAS.map(|s| self.course.initial_error * s);
            let initial = measured.transformed(&self.twin.graph.pose(from));
            self.twin.add_ellipsoid(initial.retract(&SVector::from(error)))
        });
        self.known[number] = Some(id);
        let covariance =
            SMatrix::from_diagonal(&SVector::<f64, 9>::from(SEEN_SIGMAS.map(|s| s * s)));
        let factor = EllipsoidObservation::new(from, id, measured, &covariance, Outline::Cuboid);
        let factor = self.twin.add(factor.unwrap().with_kernel(self.course.kernel));
        self.observations.push(factor);
        if is_outlier {
            self.outliers.push(factor);
        }
    }
}

/// On a ring around the origin (m), looking along it and turned by `yaw` (rad) from there.
fn on_ring(angle: f64, radius: f64, yaw: f64) -> Pose {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle + TAU / 4.0 + yaw);
    let at = Translation3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
    Pose::from_parts(at, turned)
}

/// A draw from the standard normal distribution: Box and Muller 1958.
pub(super) fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (random.random::<f64>().max(1e-12), random.random());
    (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
}
