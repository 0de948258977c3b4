//! What of a run is shown beside the page: outlines drawn into colour images, coloured points, walls.

use super::Recorded;
use crate::{mapping::SavedMap, msg::convert::RgbImage, publication::draw_objects};
use nalgebra::{Point2, Point3};

impl Recorded {
    /// Colour images from along the way with the objects of the map where they are after all optimisation.
    pub fn overlays<'a>(&'a self, map: &'a SavedMap) -> impl Iterator<Item = RgbImage> + 'a {
        self.overlays.iter().map(|overlay| {
            let mut image = overlay.image.clone();
            let objects = map.objects.iter();
            let bodies =
                objects.map(|object| (object.label.as_str(), object.ellipsoid, object.outline));
            draw_objects(&mut image, bodies, &overlay.view);
            image
        })
    }

    /// Points of what was seen in the map, with red, green and blue; none where there are no colours.
    pub fn colored_points(&self) -> &[(Point3<f64>, [u8; 3])] {
        if self.points.has_color { &self.points.points } else { &[] }
    }

    /// Ends of the walls, seen from above (m).
    pub fn walls(&self) -> &[[Point2<f64>; 2]] {
        &self.walls
    }
}
