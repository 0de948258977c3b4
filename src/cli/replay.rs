//! `replay`: a bag goes in, an object map comes out.

use super::{
    Failure, Outcome,
    detector::{self, DetectorArgs},
    eval::read_ground_truth,
    parameter_args::{ParameterArgs, RemapArgs},
    report::{Ended, clock},
    results::{Results, check_overwrite},
    streams::Streams,
    timing::{KeyframeTime, Stopwatch, now, peak_memory_mb},
    viewer::{Looks, Viewer},
};
use crate::{
    config::Parameters,
    geometry::yaw_of,
    io::{BagInput, Inputs, NO_ODOMETRY, load_saved_map},
    mapping::{Relocalised, SavedMap},
    msg::convert::FindBoxes,
    pipeline::{Calibration, Dropped, Input, ObjectSlam, Settings, StartPose, Update},
    time::Stamp,
    topics::Roles,
};
use anyhow::{Context, anyhow};
use clap::Parser;
use indicatif::ProgressBar;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Run on a bag: as fast as it can, deterministic.
#[derive(Clone, Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` or `.db3` file or a rosbag2 folder.
    pub(super) bag: PathBuf,
    #[command(flatten)]
    pub(super) parameters: ParameterArgs,
    #[command(flatten)]
    pub(super) detector: DetectorArgs,
    /// Continue a saved map: an earlier result's map.json. The file itself is only read.
    #[arg(long, value_name = "FILE")]
    pub(super) map: Option<PathBuf>,
    /// About where the base starts in that map (m, m, deg); without it the place is recognised by its objects.
    #[arg(long, value_name = "X,Y,YAW", requires = "map", allow_hyphen_values = true)]
    pub(super) start: Option<StartPose>,
    /// Folder for the results; by default the bag's name with `_result`, here.
    #[arg(long, short, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) remaps: RemapArgs,
    /// Overwrite an earlier result.
    #[arg(long)]
    pub(super) force: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    pub(super) json: bool,
    /// Write no report.html and no pictures; the images in result.mcap stay.
    #[arg(long)]
    pub(super) no_report: bool,
    /// Leave the images with boxes and outlines, and the coloured points, out of result.mcap.
    #[arg(long)]
    pub(super) no_images: bool,
    /// The true objects, for the report to compare with; otherwise what the bag has under /ground_truth/.
    #[arg(long, value_name = "FILE.gt.json", conflicts_with = "no_report")]
    pub(super) ground_truth: Option<PathBuf>,
}

/// `summary.json`.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    topics: Roles,
    warnings: Vec<String>,
    messages: u64,
    /// By topic, then by reason.
    skipped_messages: BTreeMap<String, BTreeMap<&'static str, u64>>,
    frames: usize,
    keyframes: usize,
    /// By reason.
    dropped: BTreeMap<&'static str, u64>,
    boxes: usize,
    /// By reason.
    refused_boxes: BTreeMap<&'static str, u64>,
    /// When and where the place in the saved map was recognised.
    relocalised: Option<Relocalisation>,
    /// What was learnt of the camera's mount and of the clocks.
    calibration: Calibration,
    /// Ends of the walls in the map, seen from above (m).
    walls: Vec<[[f64; 2]; 2]>,
    pub(super) objects: usize,
    keyframe_time: Option<KeyframeTime>,
    seconds: f64,
    peak_memory_mb: Option<f64>,
}

impl Summary {
    /// All but the clock's readings, which differ from one run to the next.
    fn without_clock(&self) -> serde_json::Result<serde_json::Value> {
        let mut value = serde_json::to_value(self)?;
        if let Some(fields) = value.as_object_mut() {
            fields.retain(|key, _| {
                !["keyframe_time", "seconds", "peak_memory_mb"].contains(&key.as_str())
            });
        }
        Ok(value)
    }
}

/// Where the run's own frame is in the saved map.
#[derive(Clone, Debug, Serialize)]
struct Relocalisation {
    stamp: f64,
    /// How many objects were recognised.
    objects: usize,
    /// Of the frame that odometry started in (m).
    position: [f64; 3],
    /// Of that frame (deg).
    yaw_deg: f64,
    false_probability: f64,
}

impl Relocalisation {
    fn new(found: &Relocalised, stamp: Stamp) -> Self {
        Self {
            stamp: stamp.as_secs(),
            objects: found.matches.len(),
            position: found.map_from_seen.translation.vector.into(),
            yaw_deg: yaw_of(&found.map_from_seen).to_degrees(),
            false_probability: found.false_probability,
        }
    }
}

pub(super) fn run(args: &Args) -> Outcome {
    let folder = output_folder(args);
    check_overwrite(&folder, args.force)?;
    let summary = replay(args, &folder)?;
    if args.json {
        say!("{}", serde_json::to_string_pretty(&summary)?);
    } else {
        print_summary(&summary, &folder);
    }
    Ok(())
}

pub(super) fn output_folder(args: &Args) -> PathBuf {
    args.output.clone().unwrap_or_else(|| {
        let stem = args.bag.file_stem().unwrap_or_default().to_string_lossy();
        PathBuf::from(format!("{stem}_result"))
    })
}

fn load_map(path: &Path) -> anyhow::Result<SavedMap> {
    // Who gives a link means what it points to.
    let file = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    load_saved_map(&file).with_context(|| path.display().to_string())
}

/// An empty map, or the one that is continued.
fn begin(args: &Args, settings: Settings) -> Result<ObjectSlam, Failure> {
    let Some(path) = &args.map else { return Ok(ObjectSlam::new(settings)) };
    let start = args.start.and_then(|start| start.map_from_base());
    Ok(ObjectSlam::continuing(settings, load_map(path)?, start))
}

/// The bag, and the detector that finds its boxes where they are not to be those in it.
fn open(args: &Args, parameters: &Parameters) -> Result<(BagInput, Option<FindBoxes>), Failure> {
    let detector = detector::load(&args.detector.over(&parameters.node.detector))?;
    let remaps = args.remaps.over(parameters);
    let input = match detector {
        Some(_) => BagInput::open_for_detector(&args.bag, &remaps)?,
        None => BagInput::open(&args.bag, &remaps)?,
    };
    Ok((input, detector.map(|loaded| loaded.find)))
}

fn inputs(input: &BagInput, find: Option<FindBoxes>) -> Inputs<'_> {
    match find {
        Some(find) => input.inputs().detecting(input, find),
        None => input.inputs(),
    }
}

/// What looks on, with the truth of a file where there is one.
fn viewer<'a>(
    args: &Args,
    input: &'a BagInput,
    map_frame: &str,
) -> Result<Option<Viewer<'a>>, Failure> {
    let given =
        args.ground_truth.as_deref().map(|path| Ok((path.to_owned(), read_ground_truth(path)?)));
    let given: Option<_> = given.transpose().map_err(Failure::Failed)?;
    let looks = Looks { images: !args.no_images, report: (!args.no_report).then_some(given) };
    Ok(Viewer::new(input, looks, map_frame))
}

/// Replays the bag and writes the results.
pub(super) fn replay(args: &Args, folder: &Path) -> Result<Summary, Failure> {
    let started = now();
    let parameters = args.parameters.load()?;
    let (input, find) = open(args, &parameters)?;
    let mut slam = begin(args, parameters.slam.clone())?;
    let viewer = viewer(args, &input, &parameters.node.map_frame)?;
    let mut run = Run::new(Results::create(folder, &parameters.node)?, viewer, !args.no_images);
    let progress = ProgressBar::new(input.message_count());
    let mut inputs = inputs(&input, find);
    while let Some(message) = inputs.next() {
        run.hear(&message, inputs.log_time());
        let update = slam.handle(message, &mut run.stopwatch);
        run.take(&update, &slam);
        progress.set_position(inputs.messages_read());
    }
    let update = slam.finish(&mut run.stopwatch);
    run.take(&update, &slam);
    progress.finish_and_clear();

    let mut warnings: Vec<String> = input.bag().warnings().map(ToString::to_string).collect();
    warnings.extend(inputs.warnings().iter().map(ToString::to_string));
    let mut skipped_messages: BTreeMap<String, BTreeMap<&'static str, u64>> = BTreeMap::new();
    for (topic, reason, count, first) in inputs.skipped().iter() {
        warnings.push(format!("{count} x {first}"));
        skipped_messages.entry(topic.to_owned()).or_default().insert(reason, count);
    }
    warnings.extend(run.streams.warnings(inputs.log_time()));
    warnings.extend(run.calibration.sentences());
    warnings.extend(run.dropped.values().map(|d| format!("{} x {}", d.count, d.first)));
    if let (Some(waiting), Some(path)) = (slam.waiting(), &args.map) {
        warnings.push(format!(
            "the place in {} was not recognised: {}; map.json is that map as it was, and what was seen is in \
             local_map.json, in a frame of its own like the trajectory",
            path.display(),
            waiting.why()
        ));
    }
    if run.keyframes == 0 {
        return Err(nothing_to_work_on(&args.bag, input.roles(), &run, warnings).into());
    }
    let summary = Summary {
        topics: input.roles().clone(),
        warnings,
        messages: inputs.messages_read(),
        skipped_messages,
        frames: run.frames,
        keyframes: run.keyframes,
        dropped: run.dropped.iter().map(|(reason, d)| (*reason, d.count)).collect(),
        boxes: run.boxes,
        refused_boxes: run.refused.clone(),
        relocalised: run.relocalised.clone(),
        calibration: run.calibration,
        walls: slam.map().wall_ends().map(|ends| ends.map(|end| [end.x, end.y])).collect(),
        objects: slam.objects().count(),
        keyframe_time: run.stopwatch.keyframe_time(),
        seconds: (now() - started).as_secs_f64(),
        peak_memory_mb: peak_memory_mb(),
    };
    run.finish(&slam, &summary, &args.bag, folder)?;
    Ok(summary)
}

/// What a replay counts on its way.
struct Run<'a> {
    results: Results,
    viewer: Option<Viewer<'a>>,
    /// Whether images and points belong to the results.
    images: bool,
    streams: Streams,
    stopwatch: Stopwatch,
    frames: usize,
    keyframes: usize,
    boxes: usize,
    dropped: BTreeMap<&'static str, Counted>,
    refused: BTreeMap<&'static str, u64>,
    relocalised: Option<Relocalisation>,
    calibration: Calibration,
}

struct Counted {
    count: u64,
    first: String,
}

impl<'a> Run<'a> {
    fn new(results: Results, viewer: Option<Viewer<'a>>, images: bool) -> Self {
        Self {
            results,
            viewer,
            images,
            streams: Streams::default(),
            stopwatch: Stopwatch::default(),
            frames: 0,
            keyframes: 0,
            boxes: 0,
            dropped: BTreeMap::new(),
            refused: BTreeMap::new(),
            relocalised: None,
            calibration: Calibration::default(),
        }
    }

    fn hear(&mut self, input: &Input, log_time: Stamp) {
        if let Some(viewer) = &mut self.viewer {
            viewer.read_until(log_time);
        }
        self.streams.hear(input, log_time);
        self.results.pass_on(input);
    }

    fn take(&mut self, update: &Update, slam: &ObjectSlam) {
        self.results.take(update, slam);
        if let Some(viewer) = &mut self.viewer {
            viewer.take(update, slam).iter().for_each(|image| self.results.annotated(image));
        }
        self.frames += update.poses.len();
        for keyframe in &update.keyframes {
            self.keyframes += 1;
            self.calibration = keyframe.calibration;
            self.boxes += keyframe.boxes.len();
            for refused in keyframe.boxes.iter().filter_map(|b| b.measurement.as_ref().err()) {
                *self.refused.entry(refused.reason()).or_default() += 1;
            }
            self.stopwatch.end_keyframe(keyframe.stamp);
        }
        for keyframe in &update.keyframes_3d {
            self.keyframes += 1;
            self.boxes += keyframe.found.len();
            self.stopwatch.end_keyframe(keyframe.stamp);
        }
        if let (Some(found), Some(at)) = (&update.relocalised, self.results.latest()) {
            self.relocalised = Some(Relocalisation::new(found, at));
        }
        for Dropped { reason, why, .. } in &update.dropped {
            let entry =
                self.dropped.entry(reason).or_insert(Counted { count: 0, first: why.clone() });
            entry.count += 1;
        }
    }

    /// Writes the results, and then what shows them.
    fn finish(
        self,
        slam: &ObjectSlam,
        summary: &Summary,
        bag: &Path,
        folder: &Path,
    ) -> anyhow::Result<()> {
        let mut json = serde_json::to_string_pretty(summary)?;
        json.push('\n');
        let mut results = self.results;
        let viewed = self.viewer.map(|viewer| viewer.finish(slam));
        if let Some((points, _)) = viewed.as_ref().filter(|_| self.images) {
            results.points(points);
        }
        let finished = results.finish(slam, &self.stopwatch.csv(), &json)?;
        let Some((_, Some(report))) = viewed else { return finished.complete };
        let ended = Ended {
            bag,
            map: &finished.map,
            trajectory: &finished.trajectory,
            warnings: &summary.warnings,
            summary: summary.without_clock()?,
            clock: clock(&self.stopwatch, summary.seconds, summary.peak_memory_mb),
        };
        let reported = report.write(folder, ended);
        finished.complete.and(reported)
    }
}

/// What to do where odometry is of a base on which nothing places the camera.
const NO_TRANSFORM: &str = "record /tf and /tf_static, or say where the camera is on the base with \
    `--camera-pose X,Y,Z,ROLL,PITCH,YAW`";

fn nothing_to_work_on(
    bag: &Path,
    roles: &Roles,
    run: &Run<'_>,
    mut warnings: Vec<String>,
) -> anyhow::Error {
    if run.dropped.contains_key("no_transform") {
        let hint = if roles.odometry.is_some() { NO_TRANSFORM } else { NO_ODOMETRY };
        warnings.push(hint.to_owned());
    }
    let why = if warnings.is_empty() {
        format!("{} depth images came without boxes", run.frames)
    } else {
        warnings.join("; ")
    };
    let what = match roles.detections_3d {
        None => "no depth image could be paired with boxes and a pose",
        Some(_) => "no detections in space could be paired with a pose",
    };
    anyhow!("{}: {what}: {why}", bag.display())
}

fn print_summary(summary: &Summary, folder: &Path) {
    for warning in &summary.warnings {
        eprintln!("warning: {warning}");
    }
    let in_space = summary.topics.detections_3d.is_some();
    let frames = if in_space { "messages of detections in space" } else { "RGB-D frames" };
    say!(
        "{} objects from {} keyframes of {} {frames} ({} of {} boxes gave an ellipsoid)",
        summary.objects,
        summary.keyframes,
        summary.frames,
        summary.boxes as u64 - summary.refused_boxes.values().sum::<u64>(),
        summary.boxes,
    );
    if let Some(time) = summary.keyframe_time {
        say!(
            "a keyframe took {:.1} ms on average (median {:.1}, p99 {:.1}); {:.1} s in all; {:.0} MB of memory at the peak",
            time.mean_ms,
            time.median_ms,
            time.p99_ms,
            summary.seconds,
            summary.peak_memory_mb.unwrap_or(f64::NAN),
        );
    }
    say!("results are in {}", folder.display());
}
