//! Depth of one camera as another camera sees it.

use super::{DepthImage, Rays};
use crate::geometry::{Camera, Pose};
use nalgebra::Point3;

/// Moves a depth image into the image of another camera: each reading becomes a point, is seen from there, and the
/// nearest reading wins. Pixels that no reading falls on have none.
pub fn register_depth(
    depth: &DepthImage,
    depth_rays: &Rays,
    camera: &Camera,
    camera_from_depth: &Pose,
) -> DepthImage {
    let (width, height) = (camera.width() as i32, camera.height() as i32);
    let mut metres = vec![f32::NAN; width as usize * height as usize];
    // A reading covers as many pixels as the focal lengths differ, or holes would open between readings.
    let magnification = camera.focal().0 / depth_rays.camera().focal().0;
    let half_px = 0.5 * magnification.clamp(1.0, 5.0) + TOUCHING_PX;
    let covered = |at: f64, size: i32| {
        ((at - half_px).ceil() as i32).max(0)..=((at + half_px).floor() as i32).min(size - 1)
    };
    for v in 0..depth.height() as i32 {
        for u in 0..depth.width() as i32 {
            let Some(z) = depth.at(u, v) else { continue };
            let point: Point3<f64> = (depth_rays.at(u, v) * f64::from(z)).into();
            let there = camera_from_depth * point;
            let Some(pixel) = camera.project(&there) else { continue };
            for row in covered(pixel.y, height) {
                for column in covered(pixel.x, width) {
                    let cell = &mut metres[row as usize * width as usize + column as usize];
                    *cell = cell.min(there.z as f32);
                }
            }
        }
    }
    DepthImage::new(camera.width(), camera.height(), metres)
        .unwrap_or_else(|_| unreachable!("one value was made for each pixel"))
}

/// Rounding must not open a gap between the squares of two readings (px).
const TOUCHING_PX: f64 = 1e-3;
