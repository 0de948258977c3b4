//! The report of a replay: what it listens to in the bag, and the files that come of it.

use super::{annotated::Annotator, report_truth::HeardTruth, timing::Stopwatch};
use crate::{
    eval::GroundTruth,
    geometry::Pose,
    io::{BagInput, Messages, color_message, disk_problem, map_json, write_atomically},
    mapping::SavedMap,
    msg::{
        convert::{header, png, point_cloud},
        sensor_msgs::{CompressedImage, PointCloud2},
    },
    pipeline::{ObjectSlam, Update},
    report::{Clock, Page, Recorded, Recorder, Truth, plan},
    time::Stamp,
};
use anyhow::anyhow;
use serde_json::Value;
use std::{
    fs,
    iter::Peekable,
    path::{Path, PathBuf},
};

/// Everything that a report writes.
pub(super) const FILES: [&str; 6] =
    ["report.html", "map.svg", "overlay_1.png", "overlay_2.png", "overlay_3.png", "overlay_4.png"];

/// Reads what only a report needs beside the inputs of the core, as far as these have come.
pub(super) struct Reporter<'a> {
    messages: Peekable<Messages<'a>>,
    rgb: Option<String>,
    recorder: Recorder,
    annotator: Annotator,
    truth: HeardTruth,
    /// Where it stands, and what it says.
    given: Option<(PathBuf, GroundTruth)>,
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

impl<'a> Reporter<'a> {
    pub(super) fn new(input: &'a BagInput, given: Option<(PathBuf, GroundTruth)>) -> Self {
        let rgb = input.roles().rgb.clone();
        let topics = rgb.iter().map(String::as_str).chain(HeardTruth::TOPICS);
        Self {
            messages: input.bag().messages().only(topics).peekable(),
            rgb,
            recorder: Recorder::default(),
            annotator: Annotator::default(),
            truth: HeardTruth::default(),
            given,
        }
    }

    /// Reads on until a time of recording.
    pub(super) fn read_until(&mut self, log_time: Stamp) {
        while let Some(message) = self.messages.next_if(|next| next.log_time <= log_time) {
            if self.rgb.as_deref() == Some(&*message.topic) {
                match color_message(&message) {
                    Ok(image) => self.recorder.hear_color(image),
                    Err(why) => tracing::debug!("a colour image cannot be read: {why}"),
                }
            } else {
                self.truth.hear(&message);
            }
        }
    }

    /// Takes note of what came of an input. Returns images with boxes and outlines drawn into them.
    pub(super) fn take(
        &mut self,
        update: &Update,
        slam: &ObjectSlam,
    ) -> Vec<(Stamp, CompressedImage)> {
        let shown = self.recorder.take(update, slam).into_iter();
        let annotated = shown.filter_map(|shown| {
            let keyframe = &update.keyframes[shown.keyframe];
            Some((keyframe.stamp, self.annotator.annotate(shown, keyframe, slam)?))
        });
        annotated.collect()
    }

    /// Nothing more will come.
    pub(super) fn finish(self, slam: &ObjectSlam) -> Report {
        let Self { recorder, truth, given, .. } = self;
        Report { recorded: recorder.finish(slam), truth, given }
    }
}

/// What is to be written of a run that has ended.
pub(super) struct Report {
    recorded: Recorded,
    truth: HeardTruth,
    given: Option<(PathBuf, GroundTruth)>,
}

impl Report {
    /// What was seen, if it has colours.
    pub(super) fn points(&self, stamp: Stamp, frame_id: &str) -> Option<PointCloud2> {
        let points = self.recorded.colored_points();
        (!points.is_empty()).then(|| point_cloud(header(stamp, frame_id), points))
    }

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
        let page = recorded.page(&Page {
            title: &ended.bag.file_name().unwrap_or_default().to_string_lossy(),
            map: ended.map,
            map_json: &map_json(ended.map)?,
            warnings: ended.warnings,
            summary: ended.summary,
            truth,
            clock: &ended.clock,
        })?;
        let poses: Vec<Pose> = ended.trajectory.iter().map(|(_, pose)| *pose).collect();
        let mut names = FILES.iter().map(|name| folder.join(name));
        let mut write = |bytes: &[u8]| match names.next() {
            Some(path) => write_atomically(&path, bytes)
                .map_err(|e| anyhow!("{} cannot be written: {}", path.display(), disk_problem(&e))),
            None => Ok(()),
        };
        write(page.as_bytes())?;
        write(plan(ended.map, &poses, recorded.walls()).as_bytes())?;
        for picture in recorded.overlays(ended.map) {
            write(&png(&picture)?)?;
        }
        // Of an earlier replay into the same folder; fails where there are none.
        names.for_each(|path| drop(fs::remove_file(path)));
        Ok(())
    }
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
