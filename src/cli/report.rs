//! The files of a report.

use super::{report_truth::HeardTruth, timing::Stopwatch};
use crate::{
    eval::GroundTruth,
    geometry::Pose,
    io::{disk_problem, map_json, write_atomically_with},
    mapping::SavedMap,
    msg::convert::png,
    report::{Clock, MAX_OVERLAYS, Page, Recorded, Truth, plan},
    time::Stamp,
};
use anyhow::anyhow;
use serde_json::Value;
use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

const PAGE: &str = "report.html";
const PLAN: &str = "map.svg";

/// Everything that a report writes into a folder.
pub(super) fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let overlays = (0..MAX_OVERLAYS).map(|at| overlay_path(folder, at));
    [PAGE, PLAN].map(|name| folder.join(name)).into_iter().chain(overlays)
}

/// What the run says of itself at its end.
pub(super) struct Ended<'a> {
    pub(super) bag: &'a Path,
    pub(super) map: &'a SavedMap,
    /// After all optimisation.
    pub(super) trajectory: &'a [(Stamp, Pose)],
    pub(super) warnings: &'a [String],
    pub(super) summary: Value,
    pub(super) clock: Clock,
}

/// What is to be written of a run that has ended.
pub(super) struct Report {
    pub(super) recorded: Recorded,
    pub(super) truth: HeardTruth,
    /// Where the truth of a file stands, and what it says.
    pub(super) given: Option<(PathBuf, GroundTruth)>,
}

impl Report {
    /// Writes page, plan and pictures; each is whole or not there.
    pub(super) fn write(self, folder: &Path, ended: Ended<'_>) -> anyhow::Result<()> {
        let recorded = self.recorded;
        let truth = match self.given {
            Some((path, truth)) => Some((path.display().to_string(), truth)),
            None => self.truth.objects().map(|truth| ("the bag's topics".to_owned(), truth)),
        };
        let truth = truth.filter(|(_, truth)| truth.frame_id == ended.map.frame_id);
        let truth = truth.map(|(source, objects)| {
            let truth = Truth::new(&source, ended.map, &objects);
            truth.with_poses(ended.trajectory, self.truth.poses())
        });
        let map_json = map_json(ended.map)?;
        let page = Page {
            title: &ended.bag.file_name().unwrap_or_default().to_string_lossy(),
            map: ended.map,
            map_json: &map_json,
            warnings: ended.warnings,
            summary: ended.summary,
            truth,
            clock: &ended.clock,
        };
        let poses: Vec<Pose> = ended.trajectory.iter().map(|(_, pose)| *pose).collect();
        let plan = plan(ended.map, &poses, recorded.walls());
        // One that cannot be written is no reason to have none of the others.
        let mut written = vec![write(&folder.join(PAGE), |out| recorded.write_page(&page, out))];
        written.push(write(&folder.join(PLAN), |out| out.write_all(plan.as_bytes())));
        for at in 0..MAX_OVERLAYS {
            // Of an earlier replay into the same folder; fails where there are none.
            let _ = fs::remove_file(overlay_path(folder, at));
        }
        for (at, picture) in recorded.overlays(ended.map).enumerate() {
            let file = png(&picture)?;
            written.push(write(&overlay_path(folder, at), |out| out.write_all(&file)));
        }
        written.into_iter().collect()
    }
}

/// Where the picture with a number from 0 on is.
pub(super) fn overlay_path(folder: &Path, at: usize) -> PathBuf {
    folder.join(format!("overlay_{}.png", at + 1))
}

/// Those of many that become pictures: evenly from along the way, with the first and the last.
pub(super) fn overlays<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let count = MAX_OVERLAYS.min(all.len());
    (0..count).map(move |at| &all[at * (all.len() - 1) / (count - 1).max(1)])
}

fn write(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> anyhow::Result<()> {
    write_atomically_with(path, content)
        .map_err(|e| anyhow!("{} cannot be written: {}", path.display(), disk_problem(&e)))
}

/// The clock's readings of a run.
pub(super) fn clock(stopwatch: &Stopwatch, seconds: f64, peak_memory_mb: Option<f64>) -> Clock {
    let (t, ms) = stopwatch.profile(PLOTTED_KEYFRAMES);
    let stages = crate::perception::Stage::ALL.map(crate::perception::Stage::name).to_vec();
    let mean_ms = stopwatch.keyframe_time().map(|time| time.mean_ms);
    Clock { seconds, peak_memory_mb, mean_ms, stages, t, ms }
}

/// Bars of the plot of time a stage.
const PLOTTED_KEYFRAMES: usize = 150;
