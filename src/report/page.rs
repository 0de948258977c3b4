//! The page: what was recorded as data, and the programs that show it.

use super::{
    Recorded, Truth,
    plan::hex,
    recorded::numbers,
    rounded,
    series::{BoxSeries, Drift},
};
use crate::mapping::SavedMap;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The clock's readings: all of a page that differs from one run to the next.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Clock {
    /// Of the whole run.
    pub seconds: f64,
    /// Largest resident memory, where the system says (MB).
    pub peak_memory_mb: Option<f64>,
    /// Mean time of a keyframe (ms).
    pub mean_ms: Option<f64>,
    /// Names of the stages.
    pub stages: Vec<&'static str>,
    /// Since the first keyframe (s).
    pub t: Vec<f64>,
    /// Of each stage at each time (ms).
    pub ms: Vec<Vec<f64>>,
}

/// What is said on a page beside what was recorded.
#[derive(Debug)]
pub struct Page<'a> {
    /// What was replayed, in a word.
    pub title: &'a str,
    /// The objects that it shows.
    pub map: &'a SavedMap,
    /// The same as they stand in the map's file.
    pub map_json: &'a str,
    /// What went wrong, a sentence each.
    pub warnings: &'a [String],
    /// Counts of the run.
    pub summary: Value,
    /// What was really there.
    pub truth: Option<Truth>,
    /// The clock's readings.
    pub clock: &'a Clock,
}

const HTML: &str = include_str!("web/page.html");
const STYLE: &str = include_str!("web/style.css");
const SCRIPTS: [&str; 7] = [
    include_str!("web/three.js"),
    include_str!("web/data.js"),
    include_str!("web/shapes.js"),
    include_str!("web/view.js"),
    include_str!("web/panels.js"),
    include_str!("web/plots.js"),
    include_str!("web/main.js"),
];

impl Recorded {
    /// Poses of a way on the page, at most.
    pub(super) const MAX_WAY: usize = 3_000;

    /// The page as one file.
    ///
    /// # Errors
    /// When a number cannot be written.
    pub fn page(&self, page: &Page<'_>) -> serde_json::Result<String> {
        let clock = serde_json::to_string(page.clock)?;
        let run = serde_json::to_string(&self.data(page)?)?;
        let mut text = String::with_capacity(run.len() + 1_000_000);
        let mut parts = HTML.split("<!-- here -->");
        text.push_str(parts.next().unwrap_or_default());
        text.push_str(&format!("<style>\n{STYLE}</style>\n"));
        text.push_str(parts.next().unwrap_or_default());
        // Each on a line of its own: without the clock's line, pages of one bag are the same.
        for (id, data) in [("map", page.map_json), ("run", &run), ("clock", &clock)] {
            let data = inert(data);
            text.push_str(&format!(
                "<script type=\"application/json\" id=\"{id}\">{data}</script>\n"
            ));
        }
        for script in SCRIPTS {
            text.push_str(&format!("<script>\n{script}</script>\n"));
        }
        text.push_str(parts.next().unwrap_or_default());
        Ok(text)
    }

    fn data(&self, page: &Page<'_>) -> serde_json::Result<Value> {
        let labels = page.map.objects.iter().map(|object| object.label.as_str());
        let boxes = self.steps.iter().flat_map(|step| step.labels());
        let truths = page.truth.iter().flat_map(Truth::labels);
        let colors: BTreeMap<&str, String> =
            labels.chain(boxes).chain(truths).map(|label| (label, hex(label))).collect();
        let way: Vec<[f64; 7]> = (self.way.iter())
            .map(|(t, pose, then)| {
                let (now, odom) = (pose.translation.vector, then.odom_from_base.translation.vector);
                [*t, now.x, now.y, now.z, odom.x, odom.y, odom.z].map(rounded)
            })
            .collect();
        Ok(json!({
            "title": page.title,
            "frame_id": page.map.frame_id,
            "start": self.start.as_secs(),
            "colors": colors,
            "summary": page.summary,
            "warnings": page.warnings,
            "notes": self.notes(),
            "steps": serde_json::to_value(&self.steps)?,
            "tracks": serde_json::to_value(&self.tracks)?,
            "crops": serde_json::to_value(&self.crops)?,
            "sides": serde_json::to_value(&self.sides)?,
            "way": way,
            "odom": self.odom_in_map(),
            "points": serde_json::to_value(&self.points)?,
            "walls": self.walls.iter().map(|ends| ends.map(|end| [end.x, end.y].map(rounded)))
                .collect::<Vec<_>>(),
            "boxes": serde_json::to_value(BoxSeries::of(&self.counts))?,
            "drift": serde_json::to_value(Drift::of(self))?,
            "truth": serde_json::to_value(&page.truth)?,
        }))
    }

    /// Odometry's frame where odometry begins where the base does after all optimisation: `map_from_odom`.
    fn odom_in_map(&self) -> Option<[f64; 7]> {
        let (_, pose, then) = self.way.first()?;
        Some(numbers(&(pose * then.odom_from_base.inverse())))
    }

    /// What is missing or thinned out, a sentence each.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let (keyframes, images) = (self.counts.len(), &self.images);
        if images.used == 0 && images.undecodable == 0 {
            notes.push(
                "There are no colour images: the bag has none, or none near a depth image.".into(),
            );
        } else if images.absent > 0 {
            notes.push(format!(
                "{} keyframes have no colour image near their stamp.",
                images.absent
            ));
        }
        if let Some(why) = &images.why {
            let count = images.undecodable;
            notes.push(format!(
                "{count} colour images could not be used, the first because: {why}."
            ));
        }
        if self.every_step > 1 {
            let (every, shown) = (self.every_step, self.steps.len());
            notes.push(format!(
                "To keep this file small, the time slider has one of {every} keyframes: {shown} of {keyframes}."
            ));
        }
        if self.most_crops < 8 {
            notes.push(format!(
                "To keep this file small, an object has at most {} crops.",
                self.most_crops
            ));
        }
        if self.coarseness > 1.0 {
            notes.push(format!(
                "To keep this file small, changes of objects below {:.0} mm are not shown.",
                4.0 * self.coarseness
            ));
        }
        notes.push(format!(
            "Points are one a voxel of {:.0} mm: {} of all that was measured.",
            1e3 * self.points.voxel_m,
            self.points.count
        ));
        notes
    }
}

/// Data on one line that ends no script element and begins no comment, whatever texts came with the bag. JSON breaks
/// lines between its parts only.
fn inert(json: &str) -> String {
    json.lines().map(str::trim).collect::<String>().replace('<', "\\u003c")
}
