//! A bag from its beginning to its end.

use crate::{errors, map::MapRecord, run::Run, settings::SettingsArgument, slam::Slam};
use ellipsoid_slam::{
    io::BagInput,
    pipeline::Update,
    topics::{Remap, given_by},
};
use pyo3::{IntoPyObject, PyErr, PyResult, Python, pyfunction};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// The fields of `ellipsoid_slam.Replay` besides the run.
#[derive(Default, IntoPyObject)]
pub(crate) struct ReplayRecord {
    /// Messages read.
    messages: u64,
    /// RGB-D frames with a pose.
    frames: usize,
    /// Of these, with boxes.
    keyframes: usize,
    /// Messages and frames that were not used, by reason.
    dropped: BTreeMap<&'static str, u64>,
    /// Boxes that gave no ellipsoid, by reason.
    refused_boxes: BTreeMap<&'static str, u64>,
    /// A sentence each.
    warnings: Vec<String>,
}

/// Replays a bag; topics are as in `-r ROLE:=/TOPIC`.
#[pyfunction]
pub(crate) fn replay(
    py: Python<'_>,
    bag: PathBuf,
    settings: SettingsArgument,
    topics: Vec<String>,
    map: Option<MapRecord>,
    start: Option<[f64; 3]>,
) -> PyResult<(Slam, ReplayRecord)> {
    let parameters = settings.parameters()?;
    let mut remaps = given_by(&parameters.node.topics);
    for given in topics {
        remaps.push(given.parse::<Remap>().map_err(errors::settings)?);
    }
    let map = map.map(MapRecord::saved).transpose()?;
    let run = Run::new(parameters, map, start)?;
    py.detach(|| work(&bag, &remaps, run))
}

fn work(path: &Path, remaps: &[Remap], mut run: Run) -> PyResult<(Slam, ReplayRecord)> {
    let bag = BagInput::open(path, remaps).map_err(errors::bag)?;
    let mut record = ReplayRecord::default();
    let mut firsts = BTreeMap::new();
    let mut inputs = bag.inputs();
    for (at, input) in inputs.by_ref().enumerate() {
        record.take(&run.handle(input), &mut firsts);
        if at % ASK_EVERY == 0 {
            // Ctrl-C.
            Python::attach(|py| py.check_signals())?;
        }
    }
    record.take(&run.finish(), &mut firsts);
    record.messages = inputs.messages_read();
    let damage = bag.bag().warnings().chain(inputs.warnings()).map(ToString::to_string);
    record.warnings.extend(damage);
    let skipped = inputs.skipped();
    record.warnings.extend(skipped.iter().map(|(_, _, count, first)| format!("{count} x {first}")));
    let dropped =
        firsts.iter().map(|(reason, first)| format!("{} x {first}", record.dropped[reason]));
    let dropped: Vec<String> = dropped.collect();
    record.warnings.extend(dropped);
    if record.keyframes == 0 {
        return Err(nothing(path, &record));
    }
    Ok((Slam::of(run), record))
}

impl ReplayRecord {
    fn take(&mut self, update: &Update, firsts: &mut BTreeMap<&'static str, String>) {
        self.frames += update.poses.len();
        self.keyframes += update.keyframes.len();
        let boxes = update.keyframes.iter().flat_map(|keyframe| &keyframe.boxes);
        for refused in boxes.filter_map(|of| of.measurement.as_ref().err()) {
            *self.refused_boxes.entry(refused.reason()).or_default() += 1;
        }
        for dropped in &update.dropped {
            *self.dropped.entry(dropped.reason).or_default() += 1;
            firsts.entry(dropped.reason).or_insert_with(|| dropped.why.clone());
        }
    }
}

fn nothing(path: &Path, record: &ReplayRecord) -> PyErr {
    let why = if record.warnings.is_empty() {
        format!("{} depth images came without boxes", record.frames)
    } else {
        record.warnings.join("; ")
    };
    let path = path.display();
    errors::bag(format!("{path}: no depth image could be paired with boxes and a pose: {why}"))
}

/// After so many messages it is asked whether somebody interrupts: to ask may mean to wait for Python's other threads.
const ASK_EVERY: usize = 50;
