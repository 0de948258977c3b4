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
    let reach = (magnification.ceil() as i32 - 1).clamp(0, 4);
    for v in 0..depth.height() as i32 {
        for u in 0..depth.width() as i32 {
            let Some(z) = depth.at(u, v) else { continue };
            let point: Point3<f64> = (depth_rays.at(u, v) * f64::from(z)).into();
            let there = camera_from_depth * point;
            let Some(pixel) = camera.project(&there) else { continue };
            let (x, y) = (pixel.x.round() as i32, pixel.y.round() as i32);
            for row in y.max(0)..=(y + reach).min(height - 1) {
                for column in x.max(0)..=(x + reach).min(width - 1) {
                    let cell = &mut metres[row as usize * width as usize + column as usize];
                    *cell = cell.min(there.z as f32);
                }
            }
        }
    }
    DepthImage::new(camera.width(), camera.height(), metres)
        .unwrap_or_else(|_| unreachable!("one value was made for each pixel"))
}
