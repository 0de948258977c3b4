//! What a structured-light camera makes of exact depth.

use super::{random::PixelRandom, render::Rendered, settings::DepthSettings};
use rayon::prelude::*;

/// Depth readings (m) for an image `width` pixels wide seen with `focal_px`; NaN where there is none.
///
/// Every pixel draws from its own stream, so the result does not depend on the number of threads.
pub(super) fn readings(
    exact: &Rendered,
    width: usize,
    focal_px: f64,
    settings: &DepthSettings,
    frame_key: u64,
) -> Vec<f32> {
    let mut readings = vec![f32::NAN; exact.depth_m.len()];
    readings.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
        for (u, reading) in row.iter_mut().enumerate() {
            let index = v * width + u;
            let mut random = PixelRandom::new(frame_key, index as u64);
            let near_edge = is_near_edge(&exact.depth_m, width, (u, v), settings);
            if drops_out(near_edge, exact.incidence_cosines[index], settings, &mut random) {
                continue;
            }
            let depth_m = f64::from(exact.depth_m[index]);
            *reading = noisy(depth_m, focal_px, settings, &mut random) as f32;
        }
    });
    readings
}

/// A reading of one exact depth, or NaN out of range.
fn noisy(depth_m: f64, focal_px: f64, settings: &DepthSettings, random: &mut PixelRandom) -> f64 {
    // Nguyen, Izadi and Lovell 2012, the axial noise of a Kinect.
    let sigma = settings.sigma_m + settings.sigma_growth_per_m * (depth_m - 0.4).powi(2);
    let mut reading = depth_m + sigma * random.normal();
    if settings.disparity_step_px > 0.0 {
        // Khoshelham and Elberink 2012: the camera measures disparity in steps of an eighth of a pixel.
        let disparity_per_step = focal_px * settings.baseline_m / settings.disparity_step_px;
        reading = disparity_per_step / (disparity_per_step / reading).round();
    }
    if (settings.min_range_m..=settings.max_range_m).contains(&reading) {
        reading
    } else {
        f64::NAN
    }
}

fn drops_out(
    is_near_edge: bool,
    incidence_cosine: f32,
    settings: &DepthSettings,
    random: &mut PixelRandom,
) -> bool {
    if is_near_edge && random.unit() < settings.edge_dropout {
        return true;
    }
    let angle = f64::from(incidence_cosine.min(1.0)).acos();
    if angle <= settings.grazing_from_rad {
        return false;
    }
    let ramp = (settings.grazing_to_rad - settings.grazing_from_rad).max(1e-9);
    random.unit() < (angle - settings.grazing_from_rad) / ramp
}

/// Whether the depth jumps between this pixel and one above, below, left or right of it.
fn is_near_edge(
    depth_m: &[f32],
    width: usize,
    (u, v): (usize, usize),
    settings: &DepthSettings,
) -> bool {
    if settings.edge_dropout == 0.0 {
        return false;
    }
    let height = depth_m.len() / width;
    let here = depth_m[v * width + u];
    let jump = settings.edge_jump_ratio as f32 * here;
    (1..=settings.edge_radius_px).any(|r| {
        let (left, right) = (u.saturating_sub(r), (u + r).min(width - 1));
        let (above, below) = (v.saturating_sub(r), (v + r).min(height - 1));
        [(left, v), (right, v), (u, above), (u, below)]
            .iter()
            .any(|(u, v)| (depth_m[v * width + u] - here).abs() > jump)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall that faces the camera at `depth_m`.
    fn wall(depth_m: f32, incidence_cosine: f32) -> Rendered {
        const PIXELS: usize = 100 * 100;
        Rendered {
            depth_m: vec![depth_m; PIXELS],
            instances: vec![0; PIXELS],
            incidence_cosines: vec![incidence_cosine; PIXELS],
            rgb: vec![0; 3 * PIXELS],
        }
    }

    #[test]
    fn noise_grows_with_depth_as_published() {
        let settings = DepthSettings { disparity_step_px: 0.0, ..DepthSettings::default() };
        for depth_m in [0.8_f32, 2.0, 4.0] {
            let readings = readings(&wall(depth_m, 1.0), 100, 525.0, &settings, 1);
            let squares: f64 = readings.iter().map(|z| f64::from(z - depth_m).powi(2)).sum();
            let got = (squares / readings.len() as f64).sqrt();
            let expected = 0.0012 + 0.0019 * (f64::from(depth_m) - 0.4).powi(2);
            // The standard deviation of 10,000 draws is good to 0.7 %; four times that.
            assert!(
                (got / expected - 1.0).abs() < 0.03,
                "{got} instead of {expected} at {depth_m}"
            );
        }
    }

    #[test]
    fn disparity_comes_in_steps() {
        let settings = DepthSettings::default();
        for reading in readings(&wall(3.0, 1.0), 100, 525.0, &settings, 1) {
            let steps =
                525.0 * settings.baseline_m / f64::from(reading) / settings.disparity_step_px;
            assert!((steps - steps.round()).abs() < 1e-3, "{steps} steps");
        }
    }

    #[test]
    fn readings_are_missing_out_of_range_at_grazing_angles_and_at_edges() {
        let settings = DepthSettings::default();
        let missing = |exact: &Rendered| {
            let readings = readings(exact, 100, 525.0, &settings, 1);
            readings.iter().filter(|z| z.is_nan()).count() as f64 / readings.len() as f64
        };
        assert_eq!(missing(&wall(0.3, 1.0)), 1.0);
        assert_eq!(missing(&wall(5.5, 1.0)), 1.0);
        assert_eq!(missing(&wall(2.0, 1.0)), 0.0);
        assert_eq!(missing(&wall(2.0, 0.02)), 1.0);
        let mut step = wall(2.0, 1.0);
        for row in step.depth_m.chunks_mut(100) {
            row[50..].fill(2.5);
        }
        // Half of the four columns beside the step.
        assert!((missing(&step) - 0.02).abs() < 0.004, "{}", missing(&step));
    }
}
