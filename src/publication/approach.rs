//! Where a client can send a robot.

use crate::{
    config::GroundSettings,
    geometry::Pose,
    mapping::{ApproachSettings, MapObject, NoApproach, Queries, Surroundings},
    msg::{
        convert::{header, pose_message},
        ellipsoid_slam::{ApproachObjectRequest, ApproachObjectResponse},
        geometry_msgs::PoseStamped,
    },
    time::Stamp,
};
use nalgebra::{Point2, Point3};
use std::collections::BTreeSet;

/// What is known of where the robot is, and of what is round it.
#[derive(Clone, Debug, Default)]
pub struct Whereabouts {
    /// Its base in the map at the latest depth image.
    pub base: Option<Pose>,
    /// Walls, from where to where (m).
    pub walls: Vec<[Point2<f64>; 2]>,
}

/// The pose before the object that is asked for; `ApproachObject.srv` says which.
pub fn approach_object(
    request: &ApproachObjectRequest,
    objects: &[MapObject],
    whereabouts: &Whereabouts,
    ground: &GroundSettings,
    (stamp, frame_id): (Stamp, &str),
) -> ApproachObjectResponse {
    let found = approached(request, objects, whereabouts, ground);
    let (success, message, id, pose) = match found {
        Ok((object, pose)) => {
            let message = format!("before {} {}", object.name(), object.id);
            (true, message, object.id.0, pose_message(&pose))
        }
        Err(why) => (false, why, 0, Default::default()),
    };
    let pose = PoseStamped { header: header(stamp, frame_id), pose };
    ApproachObjectResponse { success, message, id, pose }
}

fn approached<'a>(
    request: &ApproachObjectRequest,
    objects: &'a [MapObject],
    Whereabouts { base, walls }: &Whereabouts,
    ground: &GroundSettings,
) -> Result<(&'a MapObject, Pose), String> {
    let Some(base) = base else {
        return Err("no image has been worked on yet: nobody knows where the robot is".into());
    };
    let given = request.distance;
    let settings = ApproachSettings {
        distance_m: if given == 0.0 { ground.approach_distance_m } else { given },
        robot_radius_m: ground.robot_radius_m,
        robot_height_m: ground.robot_height_m,
    };
    let surroundings = Surroundings { objects, walls, base };
    let mut why = None;
    let asked = asked_for(request, objects, &base.translation.vector.into())?;
    for object in asked.into_iter().take(MOST_TRIED) {
        match surroundings.approach(object, &settings) {
            Ok(pose) => return Ok((object, pose)),
            // Of the nearest one.
            Err(refused) => why = why.or(Some(refused)),
        }
    }
    Err(why.as_ref().map(NoApproach::to_string).unwrap_or_default())
}

/// The object of the id, or those of the label, nearest first.
fn asked_for<'a>(
    request: &ApproachObjectRequest,
    objects: &'a [MapObject],
    base: &Point3<f64>,
) -> Result<Vec<&'a MapObject>, String> {
    let (id, label) = (request.id, &request.label);
    if id == 0 && label.is_empty() {
        return Err("an id or a label is needed".into());
    }
    let is_asked = |object: &MapObject| match id {
        0 => object.is_called(label),
        id => object.id.0 == id,
    };
    let nearest = objects.nearest(base, None, usize::MAX);
    let found: Vec<_> = nearest.iter().map(|n| n.object).filter(|o| is_asked(o)).collect();
    match (found.is_empty(), id) {
        (false, _) => Ok(found),
        (true, 0) => {
            let names: BTreeSet<&str> = objects.iter().map(MapObject::name).collect();
            let names: Vec<&str> = names.into_iter().take(MOST_NAMES).collect();
            Err(format!("nothing is called `{label}`; there is {}", listed(&names)))
        }
        (true, id) => Err(format!("there is no object {id} in the map")),
    }
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "nothing in the map".into() } else { names.join(", ") }
}

/// Objects of a label that are tried, so that an answer comes soon whatever the map has.
const MOST_TRIED: usize = 20;
/// Names in a sentence: the answer has to fit into a packet.
const MOST_NAMES: usize = 10;
