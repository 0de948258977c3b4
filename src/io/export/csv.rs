//! A table, as RFC 4180 has it.

use super::outline_name;
use crate::{
    geometry::yaw_of,
    mapping::{SavedMap, SavedObject},
};

const HEADER: &str = "id,label,probability,existence,observations,first_seen,last_seen,x,y,z,qx,qy,qz,qw,yaw,\
    size_x,size_y,size_z,outline,support_height,sigma_x,sigma_y,sigma_z,name";

/// A header, then a line an object: stamps in seconds, positions and full sizes in metres, yaw in radians, standard
/// deviations of the position along the map's axes, and the name that people gave it. The height of what it stands on is empty
/// where it is not known, the name where it has none.
pub(super) fn table(map: &SavedMap) -> String {
    let lines = map.objects.iter().map(line);
    std::iter::once(HEADER.to_owned()).chain(lines).map(|line| line + "\r\n").collect()
}

fn line(object: &SavedObject) -> String {
    let (pose, size) = (object.ellipsoid.pose, 2.0 * object.ellipsoid.semi_axes);
    let (t, q) = (pose.translation.vector, pose.rotation);
    let axes = pose.rotation.to_rotation_matrix();
    let own = object.covariance.fixed_view::<3, 3>(3, 3);
    let variance = (axes.matrix() * own * axes.matrix().transpose()).diagonal();
    let probability = object.labels.get(&object.label).copied().unwrap_or(0.0);
    let support = object.support_height_m.map(|height| height.to_string()).unwrap_or_default();
    let numbers =
        |values: &[f64]| values.iter().map(ToString::to_string).collect::<Vec<String>>().join(",");
    let beliefs = numbers(&[probability, object.existence]);
    let seen = format!("{},{}", object.first_seen, object.last_seen);
    let place = numbers(&[t.x, t.y, t.z, q.i, q.j, q.k, q.w, yaw_of(&pose)]);
    [
        object.id.to_string(),
        quoted(&object.label),
        beliefs,
        object.observations.to_string(),
        seen,
        place,
        numbers(size.as_slice()),
        outline_name(object.outline).to_owned(),
        support,
        numbers(variance.map(f64::sqrt).as_slice()),
        object.name.as_deref().map(quoted).unwrap_or_default(),
    ]
    .join(",")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
