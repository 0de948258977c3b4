//! Outlines of the map's objects drawn into colour images.

use super::Recorded;
use crate::{mapping::SavedMap, msg::convert::RgbImage, publication::draw_objects};

impl Recorded {
    /// Colour images from along the way with the objects of the map where they are after all optimisation.
    pub fn overlays(&self, map: &SavedMap) -> Vec<RgbImage> {
        let drawn = self.overlays.iter().map(|overlay| {
            let mut image = overlay.image.clone();
            let objects = map.objects.iter();
            let bodies =
                objects.map(|object| (object.label.as_str(), object.ellipsoid, object.outline));
            draw_objects(&mut image, bodies, &overlay.view);
            image
        });
        drawn.collect()
    }

    /// Ends of the walls, seen from above (m).
    pub fn walls(&self) -> &[[nalgebra::Point2<f64>; 2]] {
        &self.walls
    }
}
