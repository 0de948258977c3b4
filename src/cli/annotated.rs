//! Colour images of `result.mcap` with boxes and outlines drawn into them.

use crate::{
    msg::{
        convert::{compressed_color_message, header},
        sensor_msgs::CompressedImage,
    },
    pipeline::{Keyframe, ObjectSlam},
    publication::{View, draw_debug_image},
    report::Shown,
    time::Stamp,
};

/// The topic, as the live node's debug image would be compressed.
pub(super) const TOPIC: &str = "/ellipsoid_slam/debug_image/compressed";

const QUALITY: u8 = 70;
/// Time from one image to the next at the beginning (s).
const PERIOD_S: f64 = 1.0;
/// After so many images the time between them doubles: two hours bring 1,400.
const SAME_PERIOD: usize = 300;

/// Draws into some of the images.
#[derive(Debug)]
pub(super) struct Annotator {
    period_s: f64,
    drawn: usize,
    latest: Option<Stamp>,
}

impl Default for Annotator {
    fn default() -> Self {
        Self { period_s: PERIOD_S, drawn: 0, latest: None }
    }
}

impl Annotator {
    /// What is known of the image's keyframe drawn into it, if it is time for another one.
    pub(super) fn annotate(
        &mut self,
        mut shown: Shown,
        keyframe: &Keyframe,
        slam: &ObjectSlam,
    ) -> Option<CompressedImage> {
        let since = self.latest.map(|latest| keyframe.stamp.seconds_since(latest));
        if since.is_some_and(|since| (0.0..self.period_s).contains(&since)) {
            return None;
        }
        self.latest = Some(keyframe.stamp);
        self.drawn += 1;
        if self.drawn.is_multiple_of(SAME_PERIOD) {
            self.period_s *= 2.0;
        }
        let map_from_camera = keyframe.map_from_camera;
        let view = View { camera: keyframe.camera.clone(), map_from_camera };
        draw_debug_image(&mut shown.image, keyframe, slam.objects(), &view);
        let header = header(keyframe.stamp, &shown.frame_id);
        compressed_color_message(header, &shown.image, QUALITY).ok()
    }
}
