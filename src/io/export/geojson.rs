//! Footprints, as RFC 7946 has them but for the coordinates: metres in the map's frame, not degrees.

use super::outline_name;
use crate::{
    geometry::OrientedBox,
    mapping::{SavedMap, SavedObject, footprint_of},
};
use nalgebra::Point2;
use serde_json::{Value, json};

pub(super) fn footprints(map: &SavedMap) -> String {
    let features: Vec<Value> = map.objects.iter().map(feature).collect();
    let all = json!({
        "type": "FeatureCollection",
        "name": map.frame_id,
        "coordinate_frame": format!("{}, metres, x and y of a frame with z up", map.frame_id),
        "features": features,
    });
    format!("{all:#}\n")
}

fn feature(object: &SavedObject) -> Value {
    let (center, size) = (object.ellipsoid.center(), 2.0 * object.ellipsoid.semi_axes);
    let mut ring: Vec<Point2<f64>> =
        footprint_of(&OrientedBox::from(&object.ellipsoid), object.outline);
    ring.extend(ring.first().copied());
    let ring: Vec<[f64; 2]> = ring.iter().map(|corner| [corner.x, corner.y]).collect();
    json!({
        "type": "Feature",
        "id": object.id,
        "geometry": { "type": "Polygon", "coordinates": [ring] },
        "properties": {
            "label": object.label,
            "name": object.name,
            "existence": object.existence,
            "observations": object.observations,
            "center_z": center.z,
            "size": [size.x, size.y, size.z],
            "outline": outline_name(object.outline),
            "support_height": object.support_height_m,
        },
    })
}
