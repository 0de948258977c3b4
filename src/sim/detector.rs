//! A 2D detector that looks at the true image of instances.

use super::{
    random::{Purpose, Random},
    settings::DetectorSettings,
};
use crate::geometry::Rect;

/// The visible part of an object in an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visible {
    /// The object.
    pub id: u32,
    /// Exact bounds of its visible pixels: centres of the outermost ones.
    pub rect: Rect,
    /// How many pixels it covers.
    pub pixels: usize,
}

/// A box as a detector would report it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedDetection {
    /// Inside the image.
    pub rect: Rect,
    /// Class names with probabilities, most probable first.
    pub hypotheses: Vec<(&'static str, f64)>,
    /// The object that was seen; nothing for a false positive. A real detector does not tell.
    pub object: Option<u32>,
}

/// The visible parts of all objects in an image of ids `width` pixels wide, by id; 0 is no object.
///
/// What is only one pixel wide or high has no box and is left out.
pub fn visible_parts(instances: &[u16], width: usize) -> Vec<Visible> {
    let count = instances.iter().max().map_or(0, |id| usize::from(*id) + 1);
    // Sides as left, above, right, below; number of pixels.
    let mut bounds = vec![([usize::MAX, usize::MAX, 0, 0], 0); count];
    for (v, row) in instances.chunks(width).enumerate() {
        for (u, id) in row.iter().enumerate().filter(|(_, id)| **id != 0) {
            let ([left, above, right, below], pixels) = &mut bounds[usize::from(*id)];
            (*left, *above) = ((*left).min(u), (*above).min(v));
            (*right, *below) = ((*right).max(u), (*below).max(v));
            *pixels += 1;
        }
    }
    let part = |(id, (sides, pixels)): (usize, ([usize; 4], usize))| {
        let [left, above, right, below] = sides.map(|x| x as f64);
        let rect = Rect::new(left, above, right, below)?;
        Some(Visible { id: id as u32, rect, pixels })
    };
    bounds.into_iter().enumerate().filter(|(_, (_, pixels))| *pixels > 0).filter_map(part).collect()
}

/// What an image shows of an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) part: Visible,
    /// The object's class.
    pub(super) label: &'static str,
    /// The same for all images that see the object from about the same place.
    pub(super) view: u64,
}

/// What the detector reports of an image of `size` = width, height.
pub(super) fn detections(
    looks: &[Look],
    size: (u32, u32),
    settings: &DetectorSettings,
    random: &mut Random,
) -> Vec<SimulatedDetection> {
    let mut found = Vec::new();
    for look in looks {
        if look.part.pixels >= settings.min_visible_pixels && !random.chance(settings.miss) {
            let mut lasting = Random::new(look.view, Purpose::Detector, look.part.id.into());
            if lasting.between(0.0, 1.0) < share_found(look.part.pixels, settings) {
                found.extend(detection(look, size, settings, (random, &mut lasting)));
            }
        }
    }
    let whole = settings.false_positives_per_frame.floor();
    let one_more = random.chance(settings.false_positives_per_frame - whole);
    for _ in 0..whole as usize + usize::from(one_more) {
        found.extend(false_positive(size, random));
    }
    found
}

/// The share of objects with so many visible pixels that the detector finds at all: detectors are blind to what is small, and stay so
/// as long as the view does.
fn share_found(pixels: usize, settings: &DetectorSettings) -> f64 {
    if settings.half_found_pixels == 0.0 {
        return 1.0;
    }
    let octaves = (pixels as f64 / settings.half_found_pixels).log2();
    1.0 / (1.0 + (-octaves).exp())
}

fn detection(
    look: &Look,
    (width, height): (u32, u32),
    settings: &DetectorSettings,
    (random, lasting): (&mut Random, &mut Random),
) -> Option<SimulatedDetection> {
    let Look { part, label, .. } = look;
    let exact = part.rect;
    let mut moved = |side: f64, extent: f64| {
        side + lasting.normal(settings.lasting_side_noise_ratio * extent)
            + random.normal(settings.side_noise_px.hypot(settings.side_noise_ratio * extent))
    };
    let rect = Rect::new(
        moved(exact.x_min, exact.width()),
        moved(exact.y_min, exact.height()),
        moved(exact.x_max, exact.width()),
        moved(exact.y_max, exact.height()),
    )?
    .clipped(width, height)?;
    let smallness = (-(part.pixels as f64) / SMALL_OBJECT_PIXELS).exp();
    let mean = settings.confidence - settings.small_object_penalty * smallness;
    let confidence = (mean + random.normal(settings.confidence_noise)).clamp(0.05, 1.0);
    let other = random.pick(similar_labels(label));
    let flickers = random.chance(settings.label_flicker);
    let (first, second) = if flickers { (other, *label) } else { (*label, other) };
    let mut hypotheses = vec![(first, confidence)];
    if confidence < 1.0 {
        hypotheses.push((second, confidence.min(0.6 * (1.0 - confidence))));
    }
    Some(SimulatedDetection { rect, hypotheses, object: Some(part.id) })
}

/// Objects with some more visible pixels lose no confidence.
const SMALL_OBJECT_PIXELS: f64 = 1500.0;

fn false_positive((width, height): (u32, u32), random: &mut Random) -> Option<SimulatedDetection> {
    const LABELS: [&str; 6] = ["chair", "tv", "bottle", "book", "person", "potted plant"];
    let (x, y) = (random.between(0.0, f64::from(width)), random.between(0.0, f64::from(height)));
    let (half_x, half_y) = (random.between(10.0, 90.0), random.between(10.0, 90.0));
    let label = random.pick(&LABELS);
    let confidence = random.between(0.25, 0.6);
    let rect = Rect::new(x - half_x, y - half_y, x + half_x, y + half_y)?.clipped(width, height)?;
    Some(SimulatedDetection { rect, hypotheses: vec![(label, confidence)], object: None })
}

/// What a detector confuses a class with.
fn similar_labels(label: &str) -> &'static [&'static str] {
    match label {
        "tv" => &["laptop"],
        "laptop" => &["tv", "keyboard"],
        "keyboard" => &["laptop", "remote"],
        "mouse" => &["remote"],
        "cup" => &["bowl", "vase"],
        "bottle" => &["vase", "cup"],
        "book" => &["laptop"],
        "chair" => &["couch", "bench"],
        "couch" => &["bed", "chair"],
        "bed" => &["couch"],
        "refrigerator" => &["oven"],
        "potted plant" => &["vase"],
        "dining table" => &["bench", "bed"],
        "suitcase" => &["backpack"],
        _ => &["suitcase", "refrigerator"],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::SimulationSettings;

    fn part(rect: [f64; 4]) -> Look {
        let rect = Rect::new(rect[0], rect[1], rect[2], rect[3]).unwrap();
        Look { part: Visible { id: 7, rect, pixels: 5000 }, label: "cup", view: 1 }
    }

    #[test]
    fn what_is_missed_or_off_stays_so_while_the_view_does() {
        let settings = DetectorSettings {
            half_found_pixels: 5000.0,
            lasting_side_noise_ratio: 0.05,
            ..SimulationSettings::default().perfect().detector
        };
        let report = |view: u64, image: u64| {
            let looks = [Look { view, ..part([100.0, 200.0, 180.0, 280.0]) }];
            let mut random = Random::new(1, Purpose::Detector, image);
            detections(&looks, (640, 480), &settings, &mut random).pop().map(|d| d.rect)
        };
        const VIEWS: u64 = 400;
        let found = (0..VIEWS).filter_map(|view| {
            assert_eq!(report(view, 0), report(view, 1), "view {view}");
            report(view, 0)
        });
        let off: Vec<f64> = found.map(|rect| rect.x_min - 100.0).collect();
        // Three standard errors of 400 draws.
        assert!((off.len() as f64 / VIEWS as f64 - 0.5).abs() < 0.08, "{}", off.len());
        let sigma = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
        assert!((sigma - 4.0).abs() < 0.7, "{sigma}");
    }

    #[test]
    fn bounds_are_the_outermost_pixels() {
        let mut instances = vec![0; 10 * 6];
        for (u, v, id) in [(3, 1, 2), (5, 4, 2), (4, 2, 2), (9, 5, 1), (8, 0, 1), (0, 0, 3)] {
            instances[v * 10 + u] = id;
        }
        let parts = visible_parts(&instances, 10);
        let expected = [(1, [8.0, 0.0, 9.0, 5.0], 2), (2, [3.0, 1.0, 5.0, 4.0], 3)];
        assert_eq!(parts.len(), 2, "a single pixel has no box");
        for (part, (id, [x0, y0, x1, y1], pixels)) in parts.iter().zip(expected) {
            assert_eq!((part.id, part.pixels), (id, pixels));
            assert_eq!(Some(part.rect), Rect::new(x0, y0, x1, y1));
        }
    }

    #[test]
    fn a_perfect_detector_reports_exact_boxes() {
        let settings = SimulationSettings::default().perfect().detector;
        let visible = [part([10.0, 20.0, 60.0, 80.0])];
        let found =
            detections(&visible, (640, 480), &settings, &mut Random::new(1, Purpose::Detector, 0));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].rect, visible[0].part.rect);
        assert_eq!(found[0].hypotheses, [("cup", 1.0)]);
    }

    #[test]
    fn rates_and_noise_are_as_set() {
        let settings = DetectorSettings {
            miss: 0.2,
            label_flicker: 0.1,
            false_positives_per_frame: 1.5,
            ..DetectorSettings::default()
        };
        let visible = [part([100.0, 200.0, 180.0, 280.0])];
        const RUNS: u64 = 4000;
        let (mut seen, mut flickered, mut false_positives, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for run in 0..RUNS {
            let mut random = Random::new(1, Purpose::Detector, run);
            for found in detections(&visible, (640, 480), &settings, &mut random) {
                let is_true = found.object.is_some();
                seen += f64::from(is_true);
                flickered += f64::from(is_true && found.hypotheses[0].0 != "cup");
                false_positives += f64::from(!is_true);
                squares += if is_true { (found.rect.x_min - 100.0).powi(2) } else { 0.0 };
                let inside = found.rect.clipped(640, 480);
                assert_eq!(inside, Some(found.rect), "reaches beyond the image");
            }
        }
        let runs = RUNS as f64;
        // Four standard errors of 4,000 draws are below 0.035.
        assert!((seen / runs - 0.8).abs() < 0.03, "{seen}");
        assert!((flickered / seen - 0.1).abs() < 0.03, "{flickered}");
        assert!((false_positives / runs - 1.5).abs() < 0.04, "{false_positives}");
        let sigma = (squares / seen).sqrt();
        assert!((sigma - 1.0f64.hypot(0.8)).abs() < 0.06, "{sigma}");
    }
}
