//! Which objects a client asks for.

use crate::{
    geometry::{Camera, OrientedBox, Pose},
    mapping::{MapObject, ObjectId, Queries, Region},
    msg::{
        convert::header,
        ellipsoid_slam::{QueryObjectsRequest, QueryObjectsResponse},
        geometry_msgs::Point,
    },
    time::Stamp,
};
use nalgebra::{Point3, Translation3, UnitQuaternion};
use std::collections::BTreeSet;

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
pub fn query_objects(
    request: &QueryObjectsRequest,
    map: &(impl Queries + ?Sized),
    view: Option<&View>,
    (stamp, frame_id): (Stamp, &str),
) -> QueryObjectsResponse {
    let in_view = match (request.in_view, view) {
        (false, _) => None,
        (true, Some(view)) => Some(seen(map, view, request.max_range)),
        (true, None) => {
            return QueryObjectsResponse {
                message: "no image with boxes has been worked on yet: there is no view".into(),
                ..QueryObjectsResponse::default()
            };
        }
    };
    let in_region = request.in_region.then(|| inside(map, request));
    let is_in = |found: &Option<BTreeSet<ObjectId>>, object: &MapObject| {
        found.as_ref().is_none_or(|ids| ids.contains(&object.id))
    };
    let mut found: Vec<&MapObject> = if request.by_distance {
        let nearest = map.nearest(&point(&request.nearest_to), None, usize::MAX);
        nearest.into_iter().map(|found| found.object).collect()
    } else {
        map.all().collect()
    };
    found.retain(|object| {
        let labels = &request.labels;
        (labels.is_empty() || labels.iter().any(|label| object.is_called(label)))
            && object.existence() >= request.min_existence
            && is_in(&in_region, object)
            && is_in(&in_view, object)
    });
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

fn seen(map: &(impl Queries + ?Sized), view: &View, max_range_m: f64) -> BTreeSet<ObjectId> {
    let max_range_m = if max_range_m > 0.0 { max_range_m } else { f64::INFINITY };
    let seen = map.in_view(&view.camera, &view.map_from_camera, max_range_m);
    seen.into_iter().map(|seen| seen.object.id).collect()
}

fn inside(map: &(impl Queries + ?Sized), request: &QueryObjectsRequest) -> BTreeSet<ObjectId> {
    let (low, high) = (point(&request.region_min), point(&request.region_max));
    let middle = Translation3::from((low.coords + high.coords) / 2.0);
    let pose = Pose::from_parts(middle, UnitQuaternion::identity());
    let region = Region::Box(OrientedBox { pose, half_extents: (high - low) / 2.0 });
    // It is more probable than not that the centre is inside where its estimate is.
    map.within(&region, 0.5).into_iter().map(|found| found.object.id).collect()
}

fn point(wire: &Point) -> Point3<f64> {
    Point3::new(wire.x, wire.y, wire.z)
}
