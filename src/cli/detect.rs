//! `detect`: a bag goes in, the same bag with 2D boxes comes out.

use super::{
    Failure, Outcome,
    detector::{self, DetectorArgs, Loaded},
    parameter_args::{ParameterArgs, RemapArgs},
    recording::{DETECTIONS, refuse_existing},
    timing::now,
};
use crate::{
    io::{BagReader, BagWriter, FoundBoxes, RawMessage},
    msg::{
        Message,
        convert::{detection_array, yolo_detection_array},
        schema_text, vision_msgs, yolo_msgs,
    },
    topics::Roles,
};
use anyhow::{Context, anyhow};
use clap::Parser;
use indicatif::ProgressBar;
use std::{collections::BTreeSet, path::PathBuf, time::Duration};

/// Find 2D boxes in the colour images of a bag with an ONNX model, and write the bag with them: as `vision_msgs`, or as `yolo_msgs` where
/// the model gives masks.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` or `.db3` file or a rosbag2 folder.
    bag: PathBuf,
    #[command(flatten)]
    detector: DetectorArgs,
    #[command(flatten)]
    parameters: ParameterArgs,
    /// The bag to write; by default the bag's name with `_detected.mcap`, here.
    #[arg(long, short, value_name = "BAG")]
    output: Option<PathBuf>,
    #[command(flatten)]
    remaps: RemapArgs,
    /// Overwrite an existing bag.
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = args.bag.file_stem().unwrap_or_default().to_string_lossy();
        PathBuf::from(format!("{stem}_detected.mcap"))
    });
    refuse_existing(&[&output], args.force)?;
    let parameters = args.parameters.load()?;
    let settings = args.detector.over(&parameters.node.detector);
    let loaded = detector::load(&settings)?
        .ok_or_else(|| Failure::Usage("name a detector with --model FILE.onnx".into()))?;
    let bag = BagReader::open(&args.bag)?;
    let rgb = Roles::color_topic(bag.topics(), &args.remaps.over(&parameters))
        .with_context(|| args.bag.display().to_string())?;
    let mut detecting = Detecting::new(BagWriter::create(&output)?, rgb, loaded);
    let progress = ProgressBar::new(bag.message_count());
    let mut messages = bag.messages();
    for message in messages.by_ref() {
        detecting.take(&message)?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    for warning in bag.warnings().chain(messages.warnings()) {
        eprintln!("warning: {warning}");
    }
    detecting.finish(&output)
}

/// A bag that is being copied, with boxes for its images.
struct Detecting {
    bag: BagWriter,
    rgb: String,
    found: FoundBoxes,
    has_masks: bool,
    described: String,
    images: u64,
    boxes: usize,
    took: Duration,
    failed: Option<(u64, String)>,
    /// Topics that are not copied.
    left_out: BTreeSet<String>,
}

impl Detecting {
    fn new(bag: BagWriter, rgb: String, loaded: Loaded) -> Self {
        Self {
            bag,
            rgb,
            found: FoundBoxes::new(loaded.find),
            has_masks: loaded.has_masks,
            described: loaded.described,
            images: 0,
            boxes: 0,
            took: Duration::ZERO,
            failed: None,
            left_out: BTreeSet::new(),
        }
    }

    /// Copies a message, and follows an image by its boxes. Boxes of another detector would be taken for ours, and of
    /// types that are not known here nothing can be said in the new bag.
    fn take(&mut self, message: &RawMessage) -> anyhow::Result<()> {
        let RawMessage { topic, type_name, log_time, data } = message;
        let of_another = [vision_msgs::Detection2DArray::TYPE, yolo_msgs::DetectionArray::TYPE];
        if of_another.contains(&&**type_name) || schema_text(type_name).is_none() {
            self.left_out.insert(format!("{topic} ({type_name})"));
            return Ok(());
        }
        self.bag.write_raw(topic, type_name, data, *log_time)?;
        if **topic != *self.rgb {
            return Ok(());
        }
        let started = now();
        match self.found.of(message) {
            Ok((boxes, image_size)) => {
                self.took += now() - started;
                self.images += 1;
                self.boxes += boxes.detections.len();
                if self.has_masks {
                    // Boxes of `vision_msgs` have no room for masks.
                    let boxes = yolo_detection_array(&boxes, image_size);
                    self.bag.write(DETECTIONS, &boxes, *log_time)?;
                } else {
                    self.bag.write(DETECTIONS, &detection_array(&boxes), *log_time)?;
                }
            }
            Err(why) => self.failed.get_or_insert((0, why.to_string())).0 += 1,
        }
        Ok(())
    }

    fn finish(self, output: &std::path::Path) -> Outcome {
        if let Some((count, why)) = &self.failed {
            eprintln!("warning: {}: {count} x {why}", self.rgb);
        }
        if self.images == 0 {
            let why = self.failed.map_or("there are none".into(), |(_, why)| why);
            return Err(anyhow!("none of the images on {} can be used: {why}", self.rgb).into());
        }
        self.bag.finish()?;
        if !self.left_out.is_empty() {
            let topics: Vec<String> = self.left_out.into_iter().collect();
            say!("not copied: {}", topics.join(", "));
        }
        say!(
            "{}: {} boxes in {} images of {}, by {}; {:.0} ms an image",
            output.display(),
            self.boxes,
            self.images,
            self.rgb,
            self.described,
            1e3 * self.took.as_secs_f64() / self.images as f64,
        );
        Ok(())
    }
}
