//! Depth of one camera as another camera sees it.

use super::{DepthImage, DepthNoise, Rays};
use crate::geometry::{Camera, Pose};
use nalgebra::Point3;

/// Moves a depth image into the image of another camera.
///
/// Each reading becomes a point and is seen from there. Of the readings that fall on one pixel, those of the nearest
/// surface count, and the pixel gets their median: the nearest single reading would be too near by up to 1.5 standard
/// deviations where eight readings share a pixel. Pixels that no reading falls on have none.
pub fn register_depth(
    depth: &DepthImage,
    depth_rays: &Rays,
    camera: &Camera,
    camera_from_depth: &Pose,
    noise: &DepthNoise,
) -> DepthImage {
    let mut readings = Readings::new(depth, depth_rays, camera, camera_from_depth);
    let metres = (0..camera.width() as usize * camera.height() as usize)
        .map(|pixel| nearest_surface_m(readings.on(pixel), noise))
        .collect();
    DepthImage::new(camera.width(), camera.height(), metres)
        .unwrap_or_else(|_| unreachable!("one value was made for each pixel"))
}

/// Depths as the other camera sees them, pixel after pixel.
struct Readings {
    metres: Vec<f32>,
    /// Where the readings of each pixel begin, and where those of the last one end.
    begins: Vec<usize>,
}

impl Readings {
    fn new(
        depth: &DepthImage,
        depth_rays: &Rays,
        camera: &Camera,
        camera_from_depth: &Pose,
    ) -> Self {
        let (width, height) = (camera.width() as i32, camera.height() as i32);
        // A reading covers as many pixels as the focal lengths differ, or holes would open between readings.
        let magnification = camera.focal().0 / depth_rays.camera().focal().0;
        let half_px = 0.5 * magnification.clamp(1.0, 5.0) + TOUCHING_PX;
        let covered = |at: f64, size: i32| {
            ((at - half_px).ceil() as i32).max(0)..=((at + half_px).floor() as i32).min(size - 1)
        };
        let mut placed: Vec<(u32, f32)> = Vec::with_capacity(depth.metres().len());
        for v in 0..depth.height() as i32 {
            for u in 0..depth.width() as i32 {
                let Some(z) = depth.at(u, v) else { continue };
                let point: Point3<f64> = (depth_rays.at(u, v) * f64::from(z)).into();
                let there = camera_from_depth * point;
                let Some(pixel) = camera.project(&there) else { continue };
                for row in covered(pixel.y, height) {
                    let columns = covered(pixel.x, width);
                    placed.extend(columns.map(|u| ((row * width + u) as u32, there.z as f32)));
                }
            }
        }
        Self::sorted(&placed, width as usize * height as usize)
    }

    /// Counting sort by pixel.
    fn sorted(placed: &[(u32, f32)], pixels: usize) -> Self {
        let mut begins = vec![0; pixels + 1];
        for (pixel, _) in placed {
            begins[*pixel as usize + 1] += 1;
        }
        for pixel in 0..pixels {
            begins[pixel + 1] += begins[pixel];
        }
        let mut free = begins.clone();
        let mut metres = vec![0.0; placed.len()];
        for (pixel, z) in placed {
            let at = &mut free[*pixel as usize];
            metres[*at] = *z;
            *at += 1;
        }
        Self { metres, begins }
    }

    fn on(&mut self, pixel: usize) -> &mut [f32] {
        &mut self.metres[self.begins[pixel]..self.begins[pixel + 1]]
    }
}

/// Median depth (m) of the nearest surface that has more than a stray share of a pixel's readings; NaN without readings.
fn nearest_surface_m(readings: &mut [f32], noise: &DepthNoise) -> f32 {
    readings.sort_unstable_by(f32::total_cmp);
    let goes_on =
        |a: &f32, b: &f32| f64::from(b - a) <= SAME_SURFACE_SIGMAS * noise.sigma_m(f64::from(*a));
    let enough = readings.len() as f64 * MIN_SHARE;
    let mut surfaces = readings.chunk_by(goes_on);
    let nearest = surfaces.find(|surface| surface.len() as f64 >= enough);
    // Where readings are scattered over many depths, none of which has enough, the nearest reading of all is taken.
    let surface = nearest.unwrap_or(&readings[..readings.len().min(1)]);
    let middle = surface.len() / 2;
    match surface.len() {
        0 => f32::NAN,
        n if n % 2 == 1 => surface[middle],
        _ => 0.5 * (surface[middle - 1] + surface[middle]),
    }
}

/// Rounding must not open a gap between the squares of two readings (px).
const TOUCHING_PX: f64 = 1e-3;
/// A surface ends where the next reading is this far behind (standard deviations of depth).
const SAME_SURFACE_SIGMAS: f64 = 3.0;
/// Share of a pixel's readings that a surface needs. Where a near surface covers all of the pixel, and one behind it, which only
/// the depth camera sees, falls on it as well, each has a half; less is the border of a near thing, which must not grow by a pixel.
const MIN_SHARE: f64 = 0.33;
