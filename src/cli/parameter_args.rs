//! Arguments that say what the parameters are.

use crate::{
    config::{Parameters, parameters_from_yaml},
    pipeline::CameraPose,
    topics::{Remap, given_by},
};
use anyhow::{Context, anyhow};
use std::{fs, path::PathBuf};

/// A parameter file, and single parameters above it.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct ParameterArgs {
    /// A parameter file; `ellipsoid_slam config` prints one.
    #[arg(long, value_name = "FILE")]
    pub(super) config: Option<PathBuf>,
    /// Set one parameter, such as `sync.slop_s=0.03`; it counts more than the file.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Where the camera is on the base (m, deg), for a bag whose /tf does not say; all angles 0: it looks ahead.
    #[arg(long, value_name = "X,Y,Z,ROLL,PITCH,YAW", allow_hyphen_values = true)]
    pub(super) camera_pose: Option<CameraPose>,
}

/// Topics that are named.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct RemapArgs {
    /// Use a topic for a role: rgb, depth, camera_info, depth_camera_info, odometry, detections. It counts more than the
    /// section `topics` of a parameter file.
    #[arg(short = 'r', long = "remap", value_name = "ROLE:=/TOPIC")]
    remaps: Vec<Remap>,
}

impl RemapArgs {
    /// What is named by the parameters and above them.
    pub(super) fn over(&self, parameters: &Parameters) -> Vec<Remap> {
        let mut all = given_by(&parameters.node.topics);
        all.extend(self.remaps.iter().cloned());
        all
    }
}

impl ParameterArgs {
    /// What file and arguments say, on top of the defaults.
    pub(super) fn load(&self) -> anyhow::Result<Parameters> {
        let mut parameters = match &self.config {
            None => Parameters::default(),
            Some(path) => {
                let text = fs::read_to_string(path)
                    .with_context(|| format!("cannot read the configuration {}", path.display()))?;
                parameters_from_yaml(&text).with_context(|| path.display().to_string())?
            }
        };
        for given in &self.set {
            let (key, value) = given
                .split_once('=')
                .filter(|(key, value)| !key.is_empty() && !value.is_empty())
                .ok_or_else(|| anyhow!("`--set {given}` is not of the form key=value"))?;
            parameters.set_text(key, value).with_context(|| format!("--set {given}"))?;
        }
        if let Some(pose) = self.camera_pose {
            parameters.slam.sync.camera_pose = pose;
        }
        Ok(parameters)
    }
}
