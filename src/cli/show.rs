//! `show`: pictures of a result.

use super::{
    Outcome, annotated,
    report::{overlay_path, overlays},
};
use crate::{
    geometry::{Pose, pose_from_xyzw},
    io::{BagReader, RawMessage, load_saved_map, read_trajectory, write_atomically},
    msg::{
        cdr::decode,
        convert::{camera, compressed_color_image, png},
        geometry_msgs::PoseStamped,
        sensor_msgs::{CameraInfo, CompressedImage},
    },
    pipeline::CameraRole,
    publication::{View, draw_saved_objects},
    report::plan,
    time::Stamp,
};
use anyhow::Context;
use clap::Parser;
use nalgebra::Point2;
use serde::Deserialize;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Draw a result again: its map from above, to scale, with names and sizes as map.svg, and the outlines of its objects in
/// colour images as overlay_1.png and so on.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// The folder that replay wrote.
    result: PathBuf,
    /// Where the map goes, with the images beside it; by default into that folder.
    #[arg(long, short, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}

/// What of `summary.json` is drawn.
#[derive(Debug, Default, Deserialize)]
struct Summary {
    /// Those of earlier versions have none.
    #[serde(default)]
    walls: Vec<[[f64; 2]; 2]>,
}

/// Poses of the base after all optimisation, and as they were known at the time.
struct Ways {
    after: Vec<(Stamp, Pose)>,
    live: Vec<(Stamp, Pose)>,
}

pub(super) fn run(args: &Args) -> Outcome {
    // What was seen where the place in the saved map was not recognised: the trajectory is in its frame.
    let names = ["local_map.json", "map.json"].map(|name| args.result.join(name));
    let map_file = names.iter().find(|path| path.exists()).unwrap_or(&names[1]);
    let map = load_saved_map(map_file).with_context(|| map_file.display().to_string())?;
    let after = read_trajectory(&args.result.join("trajectory.tum"))?;
    let poses: Vec<Pose> = after.iter().map(|(_, pose)| *pose).collect();
    let path = args.output.clone().unwrap_or_else(|| args.result.join("map.svg"));
    write(&path, plan(&map, &poses, &walls(&args.result)?).as_bytes())?;
    let bag = args.result.join("result.mcap");
    if !bag.exists() {
        return Ok(());
    }
    let live = read_trajectory(&args.result.join("trajectory_live.tum"))?;
    let views = views(&BagReader::open(&bag)?, &Ways { after, live });
    let folder = path.parent().unwrap_or(Path::new(""));
    for (at, (file, view)) in views.iter().enumerate() {
        // What does not decode is left out.
        let Ok(mut image) = compressed_color_image(file) else { continue };
        draw_saved_objects(&mut image, &map, view);
        write(&overlay_path(folder, at), &png(&image).map_err(anyhow::Error::from)?)?;
    }
    Ok(())
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_atomically(path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
    say!("{}", path.display());
    Ok(())
}

fn walls(result: &Path) -> anyhow::Result<Vec<[Point2<f64>; 2]>> {
    let path = result.join("summary.json");
    let Ok(text) = fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let summary: Summary =
        serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    Ok(summary.walls.into_iter().map(|ends| ends.map(Point2::from)).collect())
}

/// Some images from along the way, and from where each was taken after all optimisation.
fn views(bag: &BagReader, ways: &Ways) -> Vec<(CompressedImage, View)> {
    let stamps: Vec<Stamp> =
        bag.messages().only([annotated::POSE]).map(|message| message.log_time).collect();
    let chosen: Vec<Stamp> = overlays(&stamps).copied().collect();
    let topics = [annotated::CAMERA, annotated::POSE, annotated::PLAIN];
    let mut parts: Vec<(Stamp, Vec<RawMessage>)> =
        chosen.into_iter().map(|stamp| (stamp, Vec::new())).collect();
    for message in bag.messages().only(topics) {
        let of = parts.iter_mut().find(|(stamp, _)| *stamp == message.log_time);
        if let Some((_, parts)) = of {
            parts.push(message);
        }
    }
    parts.iter().filter_map(|(stamp, parts)| view(*stamp, parts, ways)).collect()
}

fn view(stamp: Stamp, parts: &[RawMessage], ways: &Ways) -> Option<(CompressedImage, View)> {
    let on = |topic: &str| parts.iter().find(|message| &*message.topic == topic);
    let image = decode::<CompressedImage>(&on(annotated::PLAIN)?.data).ok()?;
    let info = decode::<CameraInfo>(&on(annotated::CAMERA)?.data).ok()?;
    let camera = camera(&info, CameraRole::Color, false).ok()?.camera;
    let then = decode::<PoseStamped>(&on(annotated::POSE)?.data).ok()?.pose;
    let (at, turn) = (then.position, then.orientation);
    let then = pose_from_xyzw([at.x, at.y, at.z], [turn.x, turn.y, turn.z, turn.w])?;
    let moved = nearest(&ways.after, stamp)? * nearest(&ways.live, stamp)?.inverse();
    Some((image, View { camera, map_from_camera: moved * then }))
}

fn nearest(way: &[(Stamp, Pose)], stamp: Stamp) -> Option<Pose> {
    let away = |at: &Stamp| at.seconds_since(stamp).abs();
    way.iter().min_by(|a, b| away(&a.0).total_cmp(&away(&b.0))).map(|(_, pose)| *pose)
}
