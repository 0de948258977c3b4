//! An equivalent graph in GTSAM's iSAM2.

use crate::{
    environment::{python, run},
    times::Run,
    world::{HUBER, Keyframe, PRIOR_SIGMAS, SEEN_SIGMAS, STEP_SIGMAS},
};
use ellipsoid_slam::geometry::Pose;
use serde_json::{Value, json};
use std::{fs, path::Path, process::Command};

/// Drives through the world `repeats` times, with an update a keyframe.
///
/// # Errors
/// When there is no Python with GTSAM.
pub(crate) fn drive(world: &[Keyframe], repeats: usize) -> Result<Run, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.json");
    let keyframes: Value = world.iter().map(text).collect();
    let text = json!({
        "prior_sigmas": PRIOR_SIGMAS, "step_sigmas": STEP_SIGMAS, "seen_sigmas": SEEN_SIGMAS,
        "huber": HUBER, "keyframes": keyframes,
    });
    fs::write(&path, text.to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/object_graph/isam2.py");
    let answer = run(Command::new(python("tests/requirements.txt")?)
        .arg(script)
        .arg(&path)
        .arg(repeats.to_string()))?;
    let answer: Value = serde_json::from_str(&answer).map_err(|e| e.to_string())?;
    let number = |key: &str| answer[key].as_f64().ok_or(format!("no {key}"));
    let times = serde_json::from_value(answer["times"].clone()).map_err(|e| e.to_string())?;
    Ok(Run { times, cost: number("cost")?, batch_cost: number("batch_cost")? })
}

fn text(keyframe: &Keyframe) -> Value {
    let seen = keyframe.seen.iter().map(|seen| {
        let log_semi_axes = seen.measured.semi_axes.map(f64::ln);
        json!({
            "object": seen.object, "pose": numbers(&seen.measured.pose),
            "log_semi_axes": log_semi_axes.as_slice(),
        })
    });
    json!({ "step": numbers(&keyframe.step), "seen": seen.collect::<Value>() })
}

fn numbers(pose: &Pose) -> [f64; 7] {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
}
