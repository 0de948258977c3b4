//! What `simulate` is to simulate, from a file, flags and single assignments.

use super::{Failure, simulate::Args};
use crate::sim::{
    DetectorKind, RobotKind, SceneKind, SensorKind, SimulationSettings, TrajectoryKind,
};
use anyhow::Context;
use serde_json::Value;
use std::fs;

/// [`SceneKind`] on the command line.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum SceneName {
    /// A desk in the middle of a room, a chair in front of it.
    Desk,
    /// A living room and a bedroom.
    Home,
    /// Two rooms with desks and a corridor.
    Office,
    /// Chairs round a table, books in a row, two monitors side by side.
    Crowded,
}

/// [`TrajectoryKind`] on the command line.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum TrajectoryName {
    /// Once round the main table at standing height, looking at it.
    Orbit,
    /// A robot drives through the scene with gentle turns.
    Forward,
    /// A robot drives round and comes back to where it started.
    Loop,
}

/// [`RobotKind`] on the command line.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum RobotName {
    /// A TurtleBot 4: an OAK-D, level and 0.22 m above the floor.
    Turtlebot4,
    /// A base with a RealSense D435 on a mast.
    Realsense,
    /// A base with a Kinect.
    Kinect,
}

/// [`SensorKind`] on the command line.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum SensorName {
    /// A Kinect, with the shadow of its projector.
    Kinect,
    /// A RealSense D435.
    D435,
    /// An OAK-D.
    Oakd,
}

/// [`DetectorKind`] on the command line.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum DetectorName {
    /// Exact boxes of all that shows.
    Ideal,
    /// A small network: blind to small things, boxes off by 4 %, and both for as long as the view stays.
    YoloNano,
}

impl From<DetectorName> for DetectorKind {
    fn from(name: DetectorName) -> Self {
        match name {
            DetectorName::Ideal => Self::Ideal,
            DetectorName::YoloNano => Self::YoloNano,
        }
    }
}

impl From<RobotName> for RobotKind {
    fn from(name: RobotName) -> Self {
        match name {
            RobotName::Turtlebot4 => Self::Turtlebot4,
            RobotName::Realsense => Self::Realsense,
            RobotName::Kinect => Self::Kinect,
        }
    }
}

impl From<SensorName> for SensorKind {
    fn from(name: SensorName) -> Self {
        match name {
            SensorName::Kinect => Self::Kinect,
            SensorName::D435 => Self::D435,
            SensorName::Oakd => Self::OakD,
        }
    }
}

impl From<SceneName> for SceneKind {
    fn from(name: SceneName) -> Self {
        match name {
            SceneName::Desk => Self::Desk,
            SceneName::Home => Self::Home,
            SceneName::Office => Self::Office,
            SceneName::Crowded => Self::Crowded,
        }
    }
}

impl From<TrajectoryName> for TrajectoryKind {
    fn from(name: TrajectoryName) -> Self {
        match name {
            TrajectoryName::Orbit => Self::Orbit,
            TrajectoryName::Forward => Self::Forward,
            TrajectoryName::Loop => Self::Loop,
        }
    }
}

/// The file's settings, with a robot and a sensor in place, changed by the flags, then made perfect if asked for, then changed by the assignments.
pub(super) fn effective(args: &Args) -> Result<SimulationSettings, Failure> {
    let mut settings = SimulationSettings::default();
    if let Some(path) = &args.settings {
        let text =
            fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        settings = serde_saphyr::from_str(&text).map_err(|e| {
            let why = e.to_string();
            let first = why.lines().next().unwrap_or_default();
            Failure::Usage(format!("{}: {first}", path.display()))
        })?;
    }
    if let Some(robot) = args.robot {
        settings = RobotKind::from(robot).applied(settings);
    }
    if let Some(sensor) = args.sensor {
        settings = SensorKind::from(sensor).applied(settings);
    }
    if let Some(detector) = args.detector {
        settings = DetectorKind::from(detector).applied(settings);
    }
    settings.scene = args.scene.map_or(settings.scene, Into::into);
    settings.trajectory = args.trajectory.map_or(settings.trajectory, Into::into);
    settings.seed = args.seed.unwrap_or(settings.seed);
    settings.visit = args.visit.unwrap_or(settings.visit);
    settings.frames = args.frames.unwrap_or(settings.frames);
    if args.perfect {
        settings = settings.perfect();
    }
    let mut all = serde_json::to_value(&settings)?;
    for assignment in &args.assignments {
        assign(&mut all, assignment).map_err(Failure::Usage)?;
    }
    serde_json::from_value(all).map_err(|e| Failure::Usage(format!("--set: {e}")))
}

/// The settings as `--settings` reads them.
pub(super) fn to_yaml(settings: &SimulationSettings) -> anyhow::Result<String> {
    Ok(serde_saphyr::to_string(settings)?)
}

/// Sets one value by its path, `group.name=value`.
fn assign(all: &mut Value, assignment: &str) -> Result<(), String> {
    let (path, text) = assignment
        .split_once('=')
        .ok_or_else(|| format!("--set {assignment}: expected GROUP.NAME=VALUE"))?;
    let slot = path.split('.').try_fold(all, |value, key| value.get_mut(key));
    let Some(slot) = slot.filter(|slot| !slot.is_object()) else {
        return Err(format!("--set {path}: there is no such setting; see --print-settings"));
    };
    *slot = serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned()));
    Ok(())
}
