//! What is looked at of a replay beside the core's inputs: colour images and the truth, for `result.mcap` and for the report.

use super::{
    annotated::{Annotated, Annotator},
    report::Report,
    report_truth::HeardTruth,
};
use crate::{
    eval::GroundTruth,
    io::{BagInput, Messages, color_message},
    pipeline::{Keyframe, ObjectSlam, Update},
    report::{Anchor, Cloud, ColorImages, Placed, Recorder},
    time::Stamp,
};
use std::{iter::Peekable, path::PathBuf, rc::Rc};

/// What of a replay is to be looked at.
pub(super) struct Looks {
    /// Images and points in `result.mcap`.
    pub(super) images: bool,
    /// The page and the pictures, with the truth of a file, if there is one.
    pub(super) report: Option<Option<(PathBuf, GroundTruth)>>,
}

/// Reads what only viewers need, as far as the core's inputs have come. What goes into `result.mcap` does not depend on
/// whether there is a report.
pub(super) struct Viewer<'a> {
    messages: Peekable<Messages<'a>>,
    rgb: Option<String>,
    images: ColorImages,
    annotator: Annotator,
    annotates: bool,
    cloud: Cloud,
    recorder: Option<Recorder>,
    truth: HeardTruth,
    given: Option<(PathBuf, GroundTruth)>,
    map_frame: String,
}

impl<'a> Viewer<'a> {
    /// Nothing where nothing is to be looked at.
    pub(super) fn new(input: &'a BagInput, looks: Looks, map_frame: &str) -> Option<Self> {
        if !looks.images && looks.report.is_none() {
            return None;
        }
        let rgb = input.roles().rgb.clone();
        let truths = looks.report.iter().flat_map(|_| HeardTruth::TOPICS);
        let topics = rgb.iter().map(String::as_str).chain(truths);
        Some(Self {
            messages: input.bag().messages().only(topics).peekable(),
            rgb,
            images: ColorImages::default(),
            annotator: Annotator::default(),
            annotates: looks.images,
            cloud: Cloud::default(),
            recorder: looks.report.is_some().then(Recorder::default),
            truth: HeardTruth::default(),
            given: looks.report.flatten(),
            map_frame: map_frame.to_owned(),
        })
    }

    /// Reads on until a time of recording.
    pub(super) fn read_until(&mut self, log_time: Stamp) {
        while let Some(message) = self.messages.next_if(|next| next.log_time <= log_time) {
            if self.rgb.as_deref() == Some(&*message.topic) {
                match color_message(&message) {
                    Ok(image) => self.images.hear(image),
                    Err(why) => tracing::debug!("a colour image cannot be read: {why}"),
                }
            } else {
                self.truth.hear(&message);
            }
        }
    }

    /// Takes note of what came of an input. Returns the images for `result.mcap`.
    pub(super) fn take(&mut self, update: &Update, slam: &ObjectSlam) -> Vec<Annotated> {
        if let Some(recorder) = &mut self.recorder {
            recorder.take(update);
        }
        let mut annotated = Vec::new();
        for keyframe in &update.keyframes {
            let pose = update.poses.iter().find(|pose| pose.stamp == keyframe.stamp);
            if let Some(pose) = pose {
                let base_from_camera = keyframe.base_from_camera;
                let anchor = Anchor { pose: *pose, base_from_camera };
                annotated.extend(self.keyframe(keyframe, &anchor, slam));
            }
            self.images.forget_until(keyframe.stamp);
        }
        annotated
    }

    fn keyframe(
        &mut self,
        keyframe: &Keyframe,
        anchor: &Anchor,
        slam: &ObjectSlam,
    ) -> Option<Annotated> {
        let images = &mut self.images;
        let takes = self.annotator.takes(keyframe.stamp);
        self.cloud.look(keyframe, anchor, images, takes);
        let annotated = if takes && self.annotates {
            Annotated::of(keyframe, slam, &self.map_frame, images)
        } else {
            None
        };
        annotated.iter().for_each(|image| self.annotator.took(image));
        if let Some(recorder) = &mut self.recorder {
            recorder.keyframe(keyframe, anchor, slam, images);
        }
        annotated
    }

    /// Nothing more will come. What was seen as points, for `result.mcap`, and the report.
    pub(super) fn finish(self, slam: &ObjectSlam) -> (Rc<Placed>, Option<Report>) {
        let points = Rc::new(self.cloud.finish(slam));
        let report = self.recorder.map(|recorder| {
            let recorded = recorder.finish(slam, points.clone(), self.images);
            Report { recorded, truth: self.truth, given: self.given }
        });
        (points, report)
    }
}
