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
        let exact_row = &exact.depth_m[v * width..][..width];
        let shadow = settings.shadow.then(|| shadow(exact_row, focal_px * settings.baseline_m));
        for (u, reading) in row.iter_mut().enumerate() {
            let index = v * width + u;
            if shadow.as_ref().is_some_and(|shadow| shadow[u]) {
                continue;
            }
            let mut random = PixelRandom::new(frame_key, index as u64);
            let near_edge = is_near_edge(&exact.depth_m, width, (u, v), settings);
            if drops_out(near_edge, exact.incidence_cosines[index], settings, &mut random) {
                continue;
            }
            let may_swallow = settings.dark_dropout > 0.0 && is_dark(&exact.rgb, index);
            if may_swallow && random.unit() < settings.dark_dropout {
                continue;
            }
            let depth_m = fattened_m(&exact.depth_m, width, (u, v), settings);
            let normal = match settings.correlation_px {
                0 => random.normal(),
                reach => field(frame_key, width, (u, v), reach),
            };
            *reading = noisy(depth_m, focal_px, settings, normal) as f32;
        }
    });
    readings
}

/// A reading of one exact depth, or NaN out of range.
fn noisy(depth_m: f64, focal_px: f64, settings: &DepthSettings, normal: f64) -> f64 {
    // Nguyen, Izadi and Lovell 2012, the axial noise of a Kinect.
    let sigma = settings.sigma_m + settings.sigma_growth_per_m * (depth_m - 0.4).powi(2);
    let mut reading = depth_m * (1.0 + settings.scale_error) + sigma * normal;
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

/// What the second camera, to the right by a baseline (m), times the focal length (px), does not see: each of its rays ends at the
/// nearest surface, and what lies left of its image has no partner.
fn shadow(row_m: &[f32], focal_baseline: f64) -> Vec<bool> {
    let mut leftmost = f64::MAX;
    let mut hidden = vec![false; row_m.len()];
    for (u, hidden) in hidden.iter_mut().enumerate().rev() {
        let disparity = focal_baseline / f64::from(row_m[u]);
        let there = u as f64 - if disparity.is_finite() { disparity } else { 0.0 };
        *hidden = there >= leftmost || there < 0.0;
        leftmost = leftmost.min(there);
    }
    hidden
}

/// The depth of the nearest surface within reach of the window that is matched (m), where that is another surface.
fn fattened_m(
    depth_m: &[f32],
    width: usize,
    (u, v): (usize, usize),
    settings: &DepthSettings,
) -> f64 {
    let (height, reach) = (depth_m.len() / width, settings.fattened_px);
    let own = f64::from(depth_m[v * width + u]);
    let columns = [u.saturating_sub(reach), u, (u + reach).min(width - 1)];
    let rows = [v.saturating_sub(reach), v, (v + reach).min(height - 1)];
    let around = rows.into_iter().flat_map(|v| columns.map(|u| f64::from(depth_m[v * width + u])));
    let nearest = around.fold(own, f64::min);
    if own - nearest > settings.edge_jump_ratio * own { nearest } else { own }
}

/// Noise of unit variance that is alike over `reach` pixels: random numbers at the corners of a grid, and between them their
/// bilinear mean.
fn field(frame_key: u64, width: usize, (u, v): (usize, usize), reach: usize) -> f64 {
    let columns = width / reach + 2;
    let (column, row) = (u / reach, v / reach);
    let share = |at: usize| (at % reach) as f64 / reach as f64;
    let (x, y) = (share(u), share(v));
    let weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
    let corner = |i: usize| {
        let at = (row + i / 2) * columns + column + i % 2;
        // Another stream than any pixel's own.
        PixelRandom::new(!frame_key, at as u64).normal()
    };
    let sum: f64 = weights.iter().enumerate().map(|(i, weight)| weight * corner(i)).sum();
    sum / weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt()
}

fn is_dark(rgb: &[u8], index: usize) -> bool {
    rgb[3 * index..][..3].iter().all(|channel| *channel < DARK)
}

/// Black surfaces are darker than this in all colours.
const DARK: u8 = 50;

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
