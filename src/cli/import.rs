//! `import tum`: a folder of the TUM RGB-D form becomes a bag.

use super::{Failure, Outcome};
use crate::{
    geometry::Pose,
    io::{BagWriter, TumFolder, TumFrame, TumOptions},
    msg::{
        convert::{
            camera_info, compressed_depth_message, detection_array, header, odometry_message,
            png_depth, tf_message,
        },
        sensor_msgs::CompressedImage,
    },
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, OdometryMessage,
        StampedTransform,
    },
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

/// A folder in the form of the TUM RGB-D benchmark: associate.txt, camera.yaml, groundtruth.txt, bbox/.
#[derive(Debug, Parser)]
struct TumArgs {
    /// The folder.
    folder: PathBuf,
    /// The bag to write.
    #[arg(long, short, value_name = "BAG")]
    output: PathBuf,
    /// Calibration; by default camera.yaml of the folder.
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Poses that become odometry and TF; by default groundtruth.txt of the folder.
    #[arg(long, value_name = "FILE")]
    odometry: Option<PathBuf>,
    /// Overwrite an existing bag.
    #[arg(long)]
    force: bool,
}

const CAMERA_FRAME: &str = "camera_color_optical_frame";
const ODOM_FRAME: &str = "odom";

pub(super) fn run(args: &Args) -> Outcome {
    let Form::Tum(args) = &args.form;
    if args.output.exists() && !args.force {
        return Err(Failure::Usage(format!(
            "{} exists already; give --force to overwrite",
            args.output.display()
        )));
    }
    let options = TumOptions { camera: args.camera.clone(), odometry: args.odometry.clone() };
    let folder = TumFolder::open(&args.folder, &options)?;
    let mut bag = BagWriter::create(&args.output)?;
    for message in chronological(&folder) {
        write(&mut bag, &folder, &message)?;
    }
    bag.finish()?;
    for warning in &folder.warnings {
        eprintln!("warning: {warning}");
    }
    let boxes: usize =
        folder.frames.iter().filter_map(|f| Some(f.detections.as_ref()?.len())).sum();
    println!(
        "{}: {} RGB-D frames, {boxes} boxes, {} poses",
        args.output.display(),
        folder.frames.len(),
        folder.odometry.len()
    );
    Ok(())
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
    bag: &mut BagWriter,
    folder: &TumFolder,
    (stamp, part): &(Stamp, Part<'_>),
) -> anyhow::Result<()> {
    let stamp = *stamp;
    match part {
        Part::Odometry(pose) => {
            let transform = StampedTransform {
                stamp,
                frame_id: ODOM_FRAME.into(),
                child_frame_id: CAMERA_FRAME.into(),
                parent_from_child: **pose,
            };
            bag.write("/tf", &tf_message(&[transform]), stamp)?;
            bag.write("/odom", &odometry_message(&reading(stamp, pose)), stamp)?;
        }
        Part::Truth(pose) => {
            bag.write("/ground_truth/odom", &odometry_message(&reading(stamp, pose)), stamp)?;
        }
        Part::Color(frame) => write_color(bag, folder, frame)?,
        Part::Depth(frame) => write_depth(bag, folder, frame)?,
        Part::Boxes(frame) => write_boxes(bag, frame, stamp)?,
    }
    Ok(())
}

fn reading(stamp: Stamp, pose: &Pose) -> OdometryMessage {
    OdometryMessage {
        stamp,
        frame_id: ODOM_FRAME.into(),
        child_frame_id: CAMERA_FRAME.into(),
        odom_from_base: *pose,
        covariance: None,
    }
}

fn write_color(bag: &mut BagWriter, folder: &TumFolder, frame: &TumFrame) -> anyhow::Result<()> {
    let format = match frame.color.extension().and_then(|e| e.to_str()) {
        Some("jpg" | "jpeg") => "rgb8; jpeg compressed bgr8",
        Some("png") => "rgb8; png compressed bgr8",
        _ => anyhow::bail!("{}: colour images must be .jpg or .png", frame.color.display()),
    };
    let stamp = frame.color_stamp;
    let image = CompressedImage {
        header: header(stamp, CAMERA_FRAME),
        format: format.into(),
        data: read(&frame.color)?,
    };
    let info = CameraMessage {
        role: CameraRole::Color,
        stamp,
        frame_id: CAMERA_FRAME.into(),
        camera: folder.camera.clone(),
    };
    bag.write("/camera/color/camera_info", &camera_info(&info), stamp)?;
    bag.write("/camera/color/image_raw/compressed", &image, stamp)?;
    Ok(())
}

fn write_depth(bag: &mut BagWriter, folder: &TumFolder, frame: &TumFrame) -> anyhow::Result<()> {
    let image = png_depth(&read(&frame.depth)?, folder.depth_units_per_metre)
        .with_context(|| frame.depth.display().to_string())?;
    let depth = DepthMessage { stamp: frame.depth_stamp, frame_id: CAMERA_FRAME.into(), image };
    let topic = "/camera/aligned_depth_to_color/image_raw/compressedDepth";
    bag.write(topic, &compressed_depth_message(&depth)?, frame.depth_stamp)?;
    Ok(())
}

/// The boxes, and once more as truth with the object that each of them shows.
fn write_boxes(bag: &mut BagWriter, frame: &TumFrame, at: Stamp) -> anyhow::Result<()> {
    let message = DetectionsMessage {
        stamp: frame.color_stamp,
        frame_id: CAMERA_FRAME.into(),
        detections: frame.detections.clone().unwrap_or_default(),
    };
    let mut boxes = detection_array(&message);
    bag.write("/detections", &boxes, at)?;
    for (detection, instance) in boxes.detections.iter_mut().zip(&frame.instances) {
        detection.id = instance.to_string();
    }
    bag.write("/ground_truth/detections", &boxes, at)?;
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}
