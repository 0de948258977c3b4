//! A simulated sequence, rendered once and kept for every row.

use super::{
    plan::SEQUENCES,
    protocol::{Poses, Protocol, STRETCH},
};
use crate::{
    cli::{
        recording::{BASE_FRAME, CAMERA_FRAME, ODOM_FRAME},
        simulate::true_objects,
    },
    eval::GroundTruth,
    geometry::{Camera, Pose},
    perception::{DepthImage, Detection},
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage,
        StampedTransform,
    },
    sim::{
        DetectorKind, OdometryReading, OdometrySettings, SceneKind, SensorKind, SimulatedFrame,
        Simulation, SimulationSettings, TrajectoryKind,
    },
    time::Stamp,
};
use std::collections::BTreeMap;

/// A scene and a way through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sequence {
    /// How files and keys call it.
    pub(super) key: &'static str,
    /// How people call it.
    pub(super) name: &'static str,
    scene: SceneKind,
    trajectory: TrajectoryKind,
    drift: Drift,
    set_up: SetUp,
}

/// What the robot looks with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SetUp {
    /// As that of `simulate`.
    Usual,
    /// A level camera 0.22 m above the floor.
    Low,
    /// This depth camera, aligned to its colour camera.
    Sensor(SensorKind),
    /// A small network for a detector.
    SmallDetector,
    /// A camera that looks lower than TF says.
    Bumped,
}

impl SetUp {
    fn applied(self, mut settings: SimulationSettings) -> SimulationSettings {
        match self {
            Self::Usual => settings,
            Self::Low => {
                settings.mount.robot_height_m = 0.22;
                settings.mount.robot_pitch_down_rad = 0.0;
                settings
            }
            Self::Sensor(sensor) => {
                SimulationSettings { depth_camera: None, ..sensor.applied(settings) }
            }
            Self::SmallDetector => DetectorKind::YoloNano.applied(settings),
            Self::Bumped => {
                settings.mount.tf_pitch_error_rad = 1.5_f64.to_radians();
                settings
            }
        }
    }
}

/// How odometry drifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drift {
    /// As that of `simulate`.
    Usual,
    /// Mostly in heading: wheels that slip in turns, without a gyroscope.
    Heading,
}

impl Drift {
    fn settings(self) -> OdometrySettings {
        match self {
            Self::Usual => OdometrySettings::default(),
            Self::Heading => OdometrySettings {
                scale_noise_m_per_root_m: 0.005,
                slip_noise_m_per_root_m: 0.003,
                yaw_noise_rad_per_root_m: 0.03,
                yaw_noise_rad_per_root_rad: 0.03,
                ..OdometrySettings::default()
            },
        }
    }
}

/// The usual drive through the home with another robot.
const fn home_with(key: &'static str, name: &'static str, set_up: SetUp) -> Sequence {
    Sequence { key, name, set_up, ..HOME_FORWARD }
}

pub(super) const HOME_LOW: Sequence =
    home_with("home-low", "home, forward, a camera 0.22 m high", SetUp::Low);
pub(super) const HOME_D435: Sequence =
    home_with("home-d435", "home, forward, a D435", SetUp::Sensor(SensorKind::D435));
pub(super) const HOME_OAKD: Sequence =
    home_with("home-oakd", "home, forward, an OAK-D", SetUp::Sensor(SensorKind::OakD));
pub(super) const HOME_NANO: Sequence =
    home_with("home-nano", "home, forward, a small detector", SetUp::SmallDetector);
pub(super) const HOME_BUMPED: Sequence = home_with(
    "home-bumped",
    "home, forward, a camera that looks 1.5 degrees lower than TF says",
    SetUp::Bumped,
);

pub(super) const DESK_ORBIT: Sequence = Sequence {
    key: "desk-orbit",
    name: "desk, orbit",
    scene: SceneKind::Desk,
    trajectory: TrajectoryKind::Orbit,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const DESK_FORWARD: Sequence = Sequence {
    key: "desk-forward",
    name: "desk, forward",
    scene: SceneKind::Desk,
    trajectory: TrajectoryKind::Forward,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const HOME_ORBIT: Sequence = Sequence {
    key: "home-orbit",
    name: "home, orbit",
    scene: SceneKind::Home,
    trajectory: TrajectoryKind::Orbit,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const HOME_FORWARD: Sequence = Sequence {
    key: "home-forward",
    name: "home, forward",
    scene: SceneKind::Home,
    trajectory: TrajectoryKind::Forward,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};

pub(super) const OFFICE_FORWARD: Sequence = Sequence {
    key: "office-forward",
    name: "office, forward",
    scene: SceneKind::Office,
    trajectory: TrajectoryKind::Forward,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const CROWDED_ORBIT: Sequence = Sequence {
    key: "crowded-orbit",
    name: "crowded, orbit",
    scene: SceneKind::Crowded,
    trajectory: TrajectoryKind::Orbit,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const CROWDED_FORWARD: Sequence = Sequence {
    key: "crowded-forward",
    name: "crowded, forward",
    scene: SceneKind::Crowded,
    trajectory: TrajectoryKind::Forward,
    drift: Drift::Usual,
    set_up: SetUp::Usual,
};
pub(super) const HOME_LOOP: Sequence = Sequence {
    key: "home-loop",
    name: "home, loop",
    scene: SceneKind::Home,
    trajectory: TrajectoryKind::Loop,
    drift: Drift::Heading,
    set_up: SetUp::Usual,
};
pub(super) const OFFICE_LOOP: Sequence = Sequence {
    key: "office-loop",
    name: "office, loop",
    scene: SceneKind::Office,
    trajectory: TrajectoryKind::Loop,
    drift: Drift::Heading,
    set_up: SetUp::Usual,
};

/// The sequence of a key.
pub(super) fn sequence(key: &str) -> Result<Sequence, String> {
    let keys = || SEQUENCES.map(|sequence| sequence.key).join(", ");
    let found = SEQUENCES.into_iter().find(|sequence| sequence.key == key);
    found.ok_or_else(|| format!("there is no such sequence; there are {}", keys()))
}

/// All images of a sequence with their boxes, poses and truth.
pub(super) struct Rendered {
    camera: Camera,
    base_from_camera: Pose,
    frames: Vec<RenderedFrame>,
    /// Objects in sight are counted in every frame, whether the detector found them or not.
    truth: GroundTruth,
}

/// What a trial needs of a frame.
struct RenderedFrame {
    stamp: Stamp,
    depth: DepthImage,
    detections: Vec<Detection>,
    world_from_base: Pose,
    odometry: OdometryReading,
    /// With [`STRETCH`].
    stretched: OdometryReading,
}

impl Sequence {
    /// Renders the sequence that a seed draws, with as many frames as asked for or as suit the trajectory.
    pub(super) fn rendered(&self, seed: u64, frames: Option<usize>) -> anyhow::Result<Rendered> {
        let usual = SimulationSettings {
            scene: self.scene,
            trajectory: self.trajectory,
            seed,
            frames: frames.unwrap_or(0),
            odometry: self.drift.settings(),
            ..SimulationSettings::default()
        };
        let mut settings = self.set_up.applied(usual);
        let simulation = Simulation::new(settings.clone())?;
        settings.odometry.scale_bias = STRETCH;
        let stretched = Simulation::new(settings)?;
        let mut truth = simulation.ground_truth();
        let mut frames = Vec::with_capacity(simulation.frame_count());
        // One after the other: each is rendered on all cores, and its colours are dropped before the next.
        for frame in simulation.frames() {
            truth.observe(&frame);
            let stretched = stretched.odometry()[frame.index].clone();
            frames.push(kept(frame, stretched, simulation.camera())?);
        }
        Ok(Rendered {
            camera: simulation.camera().clone(),
            base_from_camera: *simulation.base_from_optical(),
            frames,
            truth: true_objects(&truth),
        })
    }
}

fn kept(
    frame: SimulatedFrame,
    stretched: OdometryReading,
    camera: &Camera,
) -> anyhow::Result<RenderedFrame> {
    let detections = frame.detections.iter().map(|d| {
        let hypotheses = d.hypotheses.iter().map(|(label, p)| ((*label).to_owned(), *p));
        let mut detection = Detection::new(d.rect, hypotheses.collect())?;
        detection.track = d.object.map(u64::from);
        Ok(detection)
    });
    Ok(RenderedFrame {
        stamp: frame.stamp,
        detections: detections.collect::<anyhow::Result<_>>()?,
        depth: DepthImage::new(camera.width(), camera.height(), frame.depth_m)?,
        world_from_base: frame.world_from_base,
        odometry: frame.odometry,
        stretched,
    })
}

impl Rendered {
    /// True poses of the base.
    pub(super) fn true_poses(&self) -> Vec<(Stamp, Pose)> {
        self.frames.iter().map(|frame| (frame.stamp, frame.world_from_base)).collect()
    }

    /// Poses of the base as the protocol's odometry has them.
    pub(super) fn odometry_poses(&self, protocol: &Protocol) -> Vec<(Stamp, Pose)> {
        let pose = |frame| odometry(frame, protocol.poses).odom_from_base;
        self.frames.iter().map(|frame| (frame.stamp, pose(frame))).collect()
    }

    /// The true objects with the observations that a protocol counts: where boxes are picked, those that are left.
    pub(super) fn truth(&self, protocol: &Protocol) -> GroundTruth {
        let mut truth = self.truth.clone();
        if protocol.boxes.picks() {
            let mut picked: BTreeMap<u64, u64> = BTreeMap::new();
            let detections = self.frames.iter().flat_map(|frame| self.picked(frame, protocol));
            for track in detections.filter_map(|d| d.track) {
                *picked.entry(track).or_default() += 1;
            }
            for object in &mut truth.objects {
                object.observations = picked.get(&object.id).copied().unwrap_or(0);
            }
        }
        truth
    }

    /// The messages of the sequence as the protocol has them, each made when it is asked for.
    pub(super) fn inputs<'a>(
        &'a self,
        protocol: &'a Protocol,
    ) -> impl Iterator<Item = Input> + use<'a> {
        let start = self.frames.first().map(|frame| frame.stamp).unwrap_or_default();
        let fixed = [
            Input::Transforms {
                is_static: true,
                transforms: vec![StampedTransform {
                    stamp: start,
                    frame_id: BASE_FRAME.into(),
                    child_frame_id: CAMERA_FRAME.into(),
                    parent_from_child: self.base_from_camera,
                }],
            },
            Input::Camera(CameraMessage {
                role: CameraRole::Color,
                stamp: start,
                frame_id: CAMERA_FRAME.into(),
                camera: self.camera.clone(),
            }),
        ];
        let of_frame = |frame| self.frame_inputs(frame, protocol);
        fixed.into_iter().chain(self.frames.iter().flat_map(of_frame))
    }

    fn frame_inputs(&self, frame: &RenderedFrame, protocol: &Protocol) -> [Input; 3] {
        let stamp = frame.stamp;
        [
            Input::Odometry(odometry(frame, protocol.poses)),
            Input::Depth(DepthMessage {
                stamp,
                frame_id: CAMERA_FRAME.into(),
                image: frame.depth.clone(),
            }),
            Input::Detections(DetectionsMessage {
                stamp,
                frame_id: CAMERA_FRAME.into(),
                detections: self.picked(frame, protocol).cloned().collect(),
            }),
        ]
    }

    fn picked<'a>(
        &'a self,
        frame: &'a RenderedFrame,
        protocol: &'a Protocol,
    ) -> impl Iterator<Item = &'a Detection> {
        frame.detections.iter().filter(|d| protocol.boxes.keeps(d, &self.camera))
    }
}

fn odometry(frame: &RenderedFrame, poses: Poses) -> OdometryMessage {
    let of = |reading: &OdometryReading| (reading.odom_from_base, reading.covariance);
    let (odom_from_base, covariance) = match poses {
        Poses::True => (frame.world_from_base, EXACT),
        Poses::Drifting => of(&frame.odometry),
        Poses::Stretched => of(&frame.stretched),
    };
    OdometryMessage {
        stamp: frame.stamp,
        frame_id: ODOM_FRAME.into(),
        child_frame_id: BASE_FRAME.into(),
        odom_from_base,
        covariance: Some(Box::new(covariance)),
    }
}

/// The covariance of a true pose (m^2, rad^2): all zeros would mean that it was not filled in.
const EXACT: [f64; 36] = {
    let mut covariance = [0.0; 36];
    let mut axis = 0;
    while axis < 6 {
        covariance[7 * axis] = 1e-9;
        axis += 1;
    }
    covariance
};
