//! Which objects a client asks for.

use crate::{
    geometry::{Camera, Pose},
    mapping::MapObject,
    msg::{
        convert::header,
        ellipsoid_slam::{QueryObjectsRequest, QueryObjectsResponse},
        geometry_msgs::Point,
    },
    time::Stamp,
};
use nalgebra::{Point3, distance};

/// Ids in an answer, at most: `QueryObjects.srv` says so.
const MOST_IDS: usize = 100;

/// Where a camera is and what it sees.
#[derive(Clone, Debug)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Its pose in the map.
    pub map_from_camera: Pose,
}

/// The objects for which everything holds that is asked for; `QueryObjects.srv` says what.
pub fn query_objects<'a>(
    request: &QueryObjectsRequest,
    objects: impl IntoIterator<Item = &'a MapObject>,
    view: Option<&View>,
    (stamp, frame_id): (Stamp, &str),
) -> QueryObjectsResponse {
    if request.in_view && view.is_none() {
        return QueryObjectsResponse {
            message: "no image with boxes has been worked on yet: there is no view".into(),
            ..QueryObjectsResponse::default()
        };
    }
    let mut found: Vec<&MapObject> = objects
        .into_iter()
        .filter(|object| {
            let center = object.ellipsoid().center();
            let labels = &request.labels;
            (labels.is_empty() || labels.iter().any(|label| label == object.label()))
                && object.existence() >= request.min_existence
                && (!request.in_region || is_in_region(&center, request))
                && (!request.in_view
                    || view.is_some_and(|view| view.sees(&center, request.max_range)))
        })
        .collect();
    if request.by_distance {
        let to = point(&request.nearest_to);
        // Stable: objects equally far away stay in the order in which they were seen.
        found.sort_by(|a, b| {
            let away = |object: &MapObject| distance(&object.ellipsoid().center(), &to);
            away(a).total_cmp(&away(b))
        });
    }
    if request.max_count > 0 {
        found.truncate(request.max_count as usize);
    }
    let matching = found.len();
    let message = if matching > MOST_IDS {
        format!("these are {MOST_IDS} of {matching} objects")
    } else {
        String::new()
    };
    let ids = found.iter().take(MOST_IDS).map(|object| object.id.0).collect();
    QueryObjectsResponse { success: true, message, header: header(stamp, frame_id), ids }
}

impl View {
    fn sees(&self, center: &Point3<f64>, max_range: f64) -> bool {
        let seen = self.map_from_camera.inverse_transform_point(center);
        let near = max_range <= 0.0 || seen.coords.norm() <= max_range;
        let inside = |at: f64, size: u32| at >= 0.0 && at < f64::from(size);
        near && self.camera.project(&seen).is_some_and(|pixel| {
            inside(pixel.x, self.camera.width()) && inside(pixel.y, self.camera.height())
        })
    }
}

fn is_in_region(center: &Point3<f64>, request: &QueryObjectsRequest) -> bool {
    let (low, high) = (point(&request.region_min), point(&request.region_max));
    (0..3).all(|axis| center[axis] >= low[axis] && center[axis] <= high[axis])
}

fn point(wire: &Point) -> Point3<f64> {
    Point3::new(wire.x, wire.y, wire.z)
}
