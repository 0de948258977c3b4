//! `import tum`: a folder of the TUM RGB-D form becomes a bag.

use super::{
    Outcome,
    eval::read_ground_truth,
    recording::{
        CAMERA_FRAME, Names, ODOM_FRAME, Recording, refuse_existing, truth_path, write_truth,
    },
};
use crate::{
    eval::GroundTruth,
    geometry::Pose,
    io::{TumCamera, TumFolder, TumFrame, TumOptions},
    msg::convert::png_depth,
    pipeline::{CameraRole, DepthMessage, DetectionsMessage, OdometryMessage},
    time::Stamp,
};
use anyhow::Context;
use clap::{Parser, Subcommand};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Turn recordings of other forms into bags.
#[derive(Debug, Parser)]
pub(super) struct Args {
    #[command(subcommand)]
    form: Form,
}

#[derive(Debug, Subcommand)]
enum Form {
    Tum(TumArgs),
}

/// A folder of the TUM RGB-D benchmark as it is downloaded (rgb.txt, depth.txt, groundtruth.txt), or with associate.txt,
/// camera.yaml and boxes in bbox/.
#[derive(Debug, Parser)]
struct TumArgs {
    /// The folder.
    folder: PathBuf,
    /// The bag to write.
    #[arg(long, short, value_name = "BAG")]
    output: PathBuf,
    /// The benchmark's camera, or a file; by default camera.yaml of the folder, or the camera that its name says.
    #[arg(long, value_name = "fr1|fr2|fr3|FILE")]
    camera: Option<TumCamera>,
    /// Poses that become odometry and TF; by default groundtruth.txt of the folder.
    #[arg(long, value_name = "FILE")]
    odometry: Option<PathBuf>,
    /// Overwrite an existing bag.
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let Form::Tum(args) = &args.form;
    let truth = read_truth(&args.folder)?;
    // Even without a truth of its own: a bag must not lie beside the truth of another.
    refuse_existing(&[&args.output, &truth_path(&args.output)], args.force)?;
    let options = TumOptions { camera: args.camera.clone(), odometry: args.odometry.clone() };
    let folder = TumFolder::open(&args.folder, &options)?;
    let mut bag = Recording::create(&args.output, Names::default())?;
    let messages = chronological(&folder);
    if let (Some(truth), Some((stamp, _))) = (&truth, messages.first()) {
        bag.true_objects(*stamp, truth)?;
    }
    for message in messages {
        write(&mut bag, &folder, &message)?;
    }
    bag.finish()?;
    if let Some(truth) = &truth {
        write_truth(&args.output, truth)?;
    }
    for warning in &folder.warnings {
        eprintln!("warning: {warning}");
    }
    let boxes: usize =
        folder.frames.iter().filter_map(|f| Some(f.detections.as_ref()?.len())).sum();
    say!(
        "{}: {} RGB-D frames, {boxes} boxes, {} poses",
        args.output.display(),
        folder.frames.len(),
        folder.odometry.len()
    );
    if folder.frames.iter().all(|frame| frame.detections.is_none()) {
        say!(
            "it has no boxes: find them with `replay {} --model FILE.onnx`",
            args.output.display()
        );
    }
    Ok(())
}

/// The true objects, if the folder knows them.
fn read_truth(folder: &Path) -> anyhow::Result<Option<GroundTruth>> {
    let path = folder.join("objects.gt.json");
    if !path.exists() {
        return Ok(None);
    }
    read_ground_truth(&path).map(Some)
}

/// One message to write.
enum Part<'a> {
    Odometry(&'a Pose),
    Truth(&'a Pose),
    Color(&'a TumFrame),
    Depth(&'a TumFrame),
    Boxes(&'a TumFrame),
}

/// All messages in the order in which a robot would have recorded them.
fn chronological(folder: &TumFolder) -> Vec<(Stamp, Part<'_>)> {
    let mut parts: Vec<(Stamp, Part<'_>)> = Vec::new();
    parts.extend(folder.odometry.iter().map(|(stamp, pose)| (*stamp, Part::Odometry(pose))));
    let truth = folder.ground_truth.iter().flatten();
    parts.extend(truth.map(|(stamp, pose)| (*stamp, Part::Truth(pose))));
    for frame in &folder.frames {
        parts.push((frame.color_stamp, Part::Color(frame)));
        parts.push((frame.depth_stamp, Part::Depth(frame)));
        if frame.detections.is_some() {
            parts.push((frame.color_stamp.max(frame.depth_stamp), Part::Boxes(frame)));
        }
    }
    parts.sort_by_key(|(stamp, _)| *stamp);
    parts
}

fn write(
    bag: &mut Recording,
    folder: &TumFolder,
    (stamp, part): &(Stamp, Part<'_>),
) -> anyhow::Result<()> {
    let stamp = *stamp;
    match part {
        Part::Odometry(pose) => bag.odometry(&OdometryMessage {
            stamp,
            frame_id: ODOM_FRAME.into(),
            child_frame_id: CAMERA_FRAME.into(),
            odom_from_base: **pose,
            covariance: None,
        })?,
        Part::Truth(pose) => bag.true_pose(stamp, CAMERA_FRAME, pose)?,
        Part::Color(frame) => {
            bag.camera(stamp, CameraRole::Color, &folder.camera)?;
            bag.compressed_color(stamp, color_format(&frame.color)?, read(&frame.color)?)?;
        }
        Part::Depth(frame) => {
            let image = png_depth(&read(&frame.depth)?, folder.depth_units_per_metre)
                .with_context(|| frame.depth.display().to_string())?;
            bag.depth(&DepthMessage { stamp, frame_id: CAMERA_FRAME.into(), image }, false)?;
        }
        Part::Boxes(frame) => {
            let message = DetectionsMessage {
                stamp: frame.color_stamp,
                frame_id: CAMERA_FRAME.into(),
                detections: frame.detections.clone().unwrap_or_default(),
            };
            bag.detections(&message, frame.instances.iter().map(ToString::to_string), stamp)?;
        }
    }
    Ok(())
}

fn color_format(file: &Path) -> anyhow::Result<&'static str> {
    match file.extension().and_then(|e| e.to_str()) {
        Some("jpg" | "jpeg") => Ok("jpeg"),
        Some("png") => Ok("png"),
        _ => anyhow::bail!("{}: colour images must be .jpg or .png", file.display()),
    }
}

fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}
