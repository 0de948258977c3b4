//! `simulate`: a bag of a made-up scene, with exact ground truth.

use super::{
    Failure, Outcome,
    recording::{
        BASE_FRAME, Names, ODOM_FRAME, Recording, refuse_existing, truth_path, write_truth,
    },
    results::MAP_FRAME,
    simulate_settings::{self, DetectorName, RobotName, SceneName, SensorName, TrajectoryName},
};
use crate::{
    eval::{self, TrueObject},
    geometry::interpolate,
    io::{trajectory_text, write_atomically},
    msg::convert::{RgbImage, jpeg},
    perception::{DepthImage, Detection, DetectionError, Mask},
    pipeline::{CameraRole, DepthMessage, DetectionsMessage, OdometryMessage, StampedTransform},
    sim::{
        GroundTruth, OdometryReading, RobotKind, SimulatedDetection, SimulatedFrame, Simulation,
    },
    time::Stamp,
};
use anyhow::Context;
use clap::Parser;
use indicatif::ProgressBar;
use std::path::PathBuf;

/// Write a bag of a simulated scene, and beside it its true objects as STEM.gt.json and its true poses as STEM.gt.tum.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// Where things stand.
    #[arg(long, value_enum, required_unless_present_any = ["settings", "print_settings"])]
    pub(super) scene: Option<SceneName>,
    /// How the camera moves.
    #[arg(long, value_enum, required_unless_present_any = ["settings", "print_settings"])]
    pub(super) trajectory: Option<TrajectoryName>,
    /// A robot: its topics and frames, its camera and where that is mounted.
    #[arg(long, value_enum)]
    pub(super) robot: Option<RobotName>,
    /// A depth camera, in place of the robot's.
    #[arg(long, value_enum)]
    pub(super) sensor: Option<SensorName>,
    /// A detector.
    #[arg(long, value_enum)]
    pub(super) detector: Option<DetectorName>,
    /// Draws poses, sizes and clutter, and all noise [default: 1].
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
    /// Another visit to the scene of the same seed: another way through it and other noise [default: 0].
    #[arg(long, value_name = "N")]
    pub(super) visit: Option<u64>,
    /// How many RGB-D frames [default: what suits the trajectory].
    #[arg(long, value_name = "N")]
    pub(super) frames: Option<usize>,
    /// Without any noise, miss, delay, drift or limit of range.
    #[arg(long)]
    pub(super) perfect: bool,
    /// A YAML file of settings; `simulate --print-settings` prints one.
    #[arg(long, value_name = "FILE")]
    pub(super) settings: Option<PathBuf>,
    /// Any setting by its name, laid over all others: detector.miss=0.2
    #[arg(long = "set", value_name = "GROUP.NAME=VALUE")]
    pub(super) assignments: Vec<String>,
    /// Print the effective settings as YAML and write nothing.
    #[arg(long)]
    print_settings: bool,
    /// The bag to write.
    #[arg(long, short, value_name = "BAG", required_unless_present = "print_settings")]
    output: Option<PathBuf>,
    /// Overwrite an existing bag and its ground truth.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    images: Images,
}

/// How images are written.
#[derive(Debug, clap::Args)]
struct Images {
    /// Write images without compression.
    #[arg(long)]
    raw: bool,
    /// Write no colour images; nothing but a viewer needs them.
    #[arg(long)]
    no_color: bool,
    /// Write boxes as yolo_msgs, each with the exact mask of what it shows.
    #[arg(long)]
    masks: bool,
    /// Quality of the colour images.
    #[arg(long, value_name = "PERCENT", default_value_t = 90, value_parser = clap::value_parser!(u8).range(1..=100))]
    jpeg_quality: u8,
}

pub(super) fn run(args: &Args) -> Outcome {
    let settings = simulate_settings::effective(args)?;
    let yaml = simulate_settings::to_yaml(&settings)?;
    let simulation = Simulation::new(settings).map_err(|e| Failure::Usage(e.to_string()))?;
    let Some(output) = args.output.as_ref().filter(|_| !args.print_settings) else {
        say!("{}", yaml.trim_end());
        return Ok(());
    };
    let poses_path = output.with_extension("gt.tum");
    refuse_existing(&[output, &truth_path(output), &poses_path], args.force)?;
    let names = args.robot.map_or_else(Names::default, |robot| RobotKind::from(robot).into());
    let names = if args.images.masks { names.with_masks() } else { names };
    let mut bag = Recording::create(output, names)?;
    let written = write(&mut bag, &simulation, (&args.images, names.camera_frame))?;
    bag.finish()?;
    write_truth(output, &written.truth)?;
    let poses = simulation.world_from_base().iter().enumerate();
    let poses: Vec<_> = poses.map(|(i, pose)| (simulation.stamp(i), *pose)).collect();
    write_atomically(&poses_path, trajectory_text(&poses).as_bytes())
        .with_context(|| format!("cannot write {}", poses_path.display()))?;
    say!(
        "{}: {} RGB-D frames, {} boxes; {} of {} objects were seen: {}",
        output.display(),
        simulation.frame_count(),
        written.boxes,
        written.truth.objects.iter().filter(|o| o.observations > 0).count(),
        written.truth.objects.len(),
        truth_path(output).display(),
    );
    Ok(())
}

/// What a bag has.
struct Written {
    truth: eval::GroundTruth,
    boxes: usize,
}

fn write(
    bag: &mut Recording,
    simulation: &Simulation,
    images: (&Images, &str),
) -> anyhow::Result<Written> {
    let camera_frame = images.1;
    let start = simulation.stamp(0);
    bag.static_transform(&StampedTransform {
        stamp: start,
        frame_id: BASE_FRAME.into(),
        child_frame_id: camera_frame.into(),
        parent_from_child: *simulation.base_from_optical(),
    })?;
    let mut truth = simulation.ground_truth();
    bag.true_objects(start, &true_objects(&truth))?;
    let progress = ProgressBar::new(simulation.frame_count() as u64);
    let (mut boxes, mut late) = (0, Vec::<SimulatedFrame>::new());
    let mut previous: Option<(Stamp, OdometryReading)> = None;
    for frame in simulation.frames() {
        truth.observe(&frame);
        boxes += frame.detections.len();
        let reading = (frame.stamp, frame.odometry.clone());
        for (stamp, between) in readings_since(previous.as_ref(), &reading) {
            write_due_boxes(bag, (&mut late, camera_frame), stamp)?;
            let stamped = stamp.shifted(simulation.settings().odometry.stamped_late_s);
            bag.odometry(&odometry(stamped, &between))?;
        }
        previous = Some(reading);
        bag.true_pose(frame.stamp, BASE_FRAME, &frame.world_from_base)?;
        late.push(write_images(bag, simulation, images, frame)?);
        progress.inc(1);
    }
    write_due_boxes(bag, (&mut late, camera_frame), Stamp::from_nanos(i64::MAX))?;
    progress.finish_and_clear();
    Ok(Written { truth: true_objects(&truth), boxes })
}

/// The odometry's readings after `previous` up to and with `latest`, at about [`ODOMETRY_RATE_HZ`].
///
/// The covariance grows evenly between two frames, as a random walk's does.
fn readings_since(
    previous: Option<&(Stamp, OdometryReading)>,
    latest: &(Stamp, OdometryReading),
) -> Vec<(Stamp, OdometryReading)> {
    let Some((from, before)) = previous else { return vec![latest.clone()] };
    let seconds = latest.0.seconds_since(*from);
    let count = (seconds * ODOMETRY_RATE_HZ).round().max(1.0) as usize;
    let between = (1..count).map(|i| {
        let fraction = i as f64 / count as f64;
        let mix = |k: usize| {
            before.covariance[k] + fraction * (latest.1.covariance[k] - before.covariance[k])
        };
        let pose = interpolate(&before.odom_from_base, &latest.1.odom_from_base, fraction);
        let reading =
            OdometryReading { odom_from_base: pose, covariance: std::array::from_fn(mix) };
        (from.shifted(fraction * seconds), reading)
    });
    between.chain([latest.clone()]).collect()
}

/// What a robot's odometry usually has.
const ODOMETRY_RATE_HZ: f64 = 30.0;

fn odometry(stamp: Stamp, reading: &OdometryReading) -> OdometryMessage {
    OdometryMessage {
        stamp,
        frame_id: ODOM_FRAME.into(),
        child_frame_id: BASE_FRAME.into(),
        odom_from_base: reading.odom_from_base,
        covariance: Some(Box::new(reading.covariance)),
    }
}

/// Writes calibration, colour and depth; the frame comes back without them, for its boxes.
fn write_images(
    bag: &mut Recording,
    simulation: &Simulation,
    (images, camera_frame): (&Images, &str),
    mut frame: SimulatedFrame,
) -> anyhow::Result<SimulatedFrame> {
    let camera = simulation.camera();
    let size = (camera.width(), camera.height());
    bag.camera(frame.stamp, CameraRole::Color, camera)?;
    let rgb = std::mem::take(&mut frame.rgb);
    if images.raw && !images.no_color {
        bag.raw_color(frame.stamp, size, rgb)?;
    } else if !images.no_color {
        let image = RgbImage { width: size.0, height: size.1, data: rgb };
        bag.compressed_color(frame.stamp, "jpeg", jpeg(&image, images.jpeg_quality)?)?;
    }
    let depth_m = std::mem::take(&mut frame.depth_m);
    let depth_camera = simulation.depth_camera();
    if depth_camera != camera {
        bag.camera(frame.stamp, CameraRole::Depth, depth_camera)?;
    }
    let image = DepthImage::new(depth_camera.width(), depth_camera.height(), depth_m)?;
    let depth = DepthMessage { stamp: frame.stamp, frame_id: camera_frame.into(), image };
    bag.depth(&depth, images.raw)?;
    if !images.masks {
        frame.instances.clear();
    }
    Ok(frame)
}

/// Writes the boxes that have come by `now`, in the order of their arrival.
fn write_due_boxes(
    bag: &mut Recording,
    (late, camera_frame): (&mut Vec<SimulatedFrame>, &str),
    now: Stamp,
) -> anyhow::Result<()> {
    late.sort_by_key(|frame| frame.detections_arrive);
    let due = late.partition_point(|frame| frame.detections_arrive <= now);
    let width = bag.image_width();
    for frame in late.drain(..due) {
        let detections = frame.detections.iter().map(|d| {
            let hypotheses = d.hypotheses.iter().map(|(label, p)| ((*label).to_owned(), *p));
            let mut detection = Detection::new(d.rect, hypotheses.collect())?;
            detection.mask = mask(&frame.instances, width, d);
            Ok(detection)
        });
        let message = DetectionsMessage {
            stamp: frame.stamp,
            frame_id: camera_frame.into(),
            detections: detections.collect::<Result<_, DetectionError>>()?,
        };
        let ids = frame.detections.iter().map(|d| d.object.map_or(-1, i64::from).to_string());
        bag.detections(&message, ids, frame.detections_arrive)?;
    }
    Ok(())
}

/// What a box shows, if it is known who is at each pixel of the image.
fn mask(instances: &[u16], width: u32, found: &SimulatedDetection) -> Option<Mask> {
    let (object, width) = (found.object?, i64::from(width));
    let is_object = |u: i64, v: i64| {
        let at = usize::try_from(v * width + u).ok().filter(|_| (0..width).contains(&u));
        at.and_then(|at| instances.get(at)).is_some_and(|id| u32::from(*id) == object)
    };
    Mask::from_pixels(&found.rect, is_object).ok()
}

/// The true objects as files and metrics have them.
pub(super) fn true_objects(truth: &GroundTruth) -> eval::GroundTruth {
    let objects = truth.objects.iter().map(|object| TrueObject {
        id: object.id.into(),
        label: object.label.to_owned(),
        pose: object.world_from_object,
        size: object.size,
        observations: object.observations as u64,
    });
    eval::GroundTruth { frame_id: MAP_FRAME.into(), objects: objects.collect() }
}
