//! What of a run is shown beside the page: outlines drawn into colour images, walls.

use super::Recorded;
use crate::{mapping::SavedMap, msg::convert::RgbImage, publication::draw_saved_objects};
use nalgebra::Point2;

impl Recorded {
    /// Colour images from along the way with the objects of the map where they are after all optimisation. What does not decode is
    /// left out.
    pub fn overlays<'a>(&'a self, map: &'a SavedMap) -> impl Iterator<Item = RgbImage> + 'a {
        self.overlays.iter().filter_map(|overlay| {
            let mut image = overlay.image.decoded().ok()?;
            draw_saved_objects(&mut image, map, &overlay.view);
            Some(image)
        })
    }

    /// Ends of the walls, seen from above (m).
    pub fn walls(&self) -> &[[Point2<f64>; 2]] {
        &self.walls
    }
}
