//! The page: what was recorded as data, and the programs that show it.

use super::{
    Recorded, Truth,
    crops::Crop,
    plan::hex,
    points::Points,
    recorded::{Step, numbers},
    rounded,
    series::{BoxSeries, Drift},
    sides::SideCounts,
    tracks::Track,
};
use crate::mapping::SavedMap;
use serde::Serialize;
use serde_json::Value;
use std::{
    collections::BTreeMap,
    io::{self, Write},
};

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

/// What the page's programs read, beside the map and the clock.
#[derive(Serialize)]
struct Data<'a> {
    title: &'a str,
    start: f64,
    colors: BTreeMap<&'a str, String>,
    summary: &'a Value,
    warnings: &'a [String],
    notes: Vec<String>,
    steps: &'a [Step],
    tracks: &'a BTreeMap<u64, Track>,
    crops: &'a BTreeMap<u64, Vec<Crop>>,
    sides: &'a BTreeMap<u64, SideCounts>,
    /// Time, the base after all optimisation, the base in odometry's frame.
    way: Vec<[f64; 7]>,
    odom: Option<[f64; 7]>,
    points: Points,
    walls: Vec<[[f64; 2]; 2]>,
    boxes: BoxSeries,
    drift: Drift,
    truth: &'a Option<Truth>,
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

    /// Writes the page, which is one file. It is never in memory as a whole.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_page(&self, page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
        let mut parts = HTML.split("<!-- here -->");
        let mut next_part = || parts.next().unwrap_or_default();
        write!(out, "{}<style>\n{STYLE}</style>\n{}", next_part(), next_part())?;
        // Each on a line of its own: without the clock's line, pages of one bag are the same.
        data_element(out, "map", |to| write_lines(page.map_json, to))?;
        data_element(out, "run", |to| Ok(serde_json::to_writer(to, &self.data(page))?))?;
        data_element(out, "clock", |to| Ok(serde_json::to_writer(to, page.clock)?))?;
        for script in SCRIPTS {
            write!(out, "<script>\n{script}</script>\n")?;
        }
        out.write_all(next_part().as_bytes())
    }

    fn data<'a>(&'a self, page: &'a Page<'_>) -> Data<'a> {
        let labels = page.map.objects.iter().map(|object| object.label.as_str());
        let boxes = self.steps.iter().flat_map(|step| step.labels());
        let truths = page.truth.iter().flat_map(Truth::labels);
        let way = self.way.iter().map(|(t, pose, then)| {
            let (now, odom) = (pose.translation.vector, then.odom_from_base.translation.vector);
            [*t, now.x, now.y, now.z, odom.x, odom.y, odom.z].map(rounded)
        });
        let walls = self.walls.iter().map(|ends| ends.map(|end| [end.x, end.y].map(rounded)));
        Data {
            title: page.title,
            start: self.start.as_secs(),
            colors: labels.chain(boxes).chain(truths).map(|label| (label, hex(label))).collect(),
            summary: &page.summary,
            warnings: page.warnings,
            notes: self.notes(),
            steps: &self.steps,
            tracks: &self.tracks,
            crops: &self.crops,
            sides: &self.sides,
            way: way.collect(),
            odom: self.odom_in_map(),
            points: Points::of(&self.points),
            walls: walls.collect(),
            boxes: BoxSeries::of(&self.counts),
            drift: Drift::of(self),
            truth: &page.truth,
        }
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
        if images.used == 0 && images.unusable == 0 {
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
            let count = images.unusable;
            notes.push(format!(
                "{count} colour images could not be used, the first because: {why}."
            ));
        }
        let shown = self.steps.len();
        if shown < keyframes {
            notes.push(format!(
                "The time slider has {shown} of {keyframes} keyframes: at most three a second, two where images have to be made smaller, and \
                 no more than this file has room for."
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
            self.points.points.len()
        ));
        notes
    }
}

/// A script element that holds data and no program.
fn data_element(
    out: &mut dyn Write,
    id: &str,
    write: impl FnOnce(&mut Inert<'_>) -> io::Result<()>,
) -> io::Result<()> {
    write!(out, "<script type=\"application/json\" id=\"{id}\">")?;
    write(&mut Inert(out))?;
    out.write_all(b"</script>\n")
}

/// JSON on one line: it breaks lines between its parts only.
fn write_lines(json: &str, to: &mut Inert<'_>) -> io::Result<()> {
    json.lines().try_for_each(|line| to.write_all(line.trim().as_bytes()))
}

/// Passes JSON on so that it ends no script element and begins no comment, whatever texts came with the bag.
struct Inert<'a>(&'a mut dyn Write);

impl Write for Inert<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for (at, part) in bytes.split(|byte| *byte == b'<').enumerate() {
            if at > 0 {
                self.0.write_all(b"\\u003c")?;
            }
            self.0.write_all(part)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
