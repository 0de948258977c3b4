//! Objects of which only some part shows: behind other things, or at the border of the image.

use super::{
    ends::{estimate, home},
    estimate_box, in_world,
};
use crate::scene::{Scene, detection, looking, round_all, standing};
use ellipsoid_slam::{
    perception::{EllipsoidMeasurement, Refused},
    sim::SimulatedDetection,
};
use nalgebra::Vector3;

/// A table, 1.5 m by 0.8 m and 0.74 m high, of which one sees between two boards what is left in a slit: some of the top, a leg,
/// a seat that is pushed under it, and the wall behind.
fn behind_boards(label: &str) -> (Result<EllipsoidMeasurement, Refused>, Scene, usize) {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [4.6, 0.0, 1.25], [0.05, 4.0, 1.25]));
    for y in [-1.1, 1.0] {
        scene.add(standing(0.0, [1.8, y, 0.6], [0.02, 0.9, 0.6]));
    }
    scene.add(standing(0.0, [2.3, 0.0, 0.45], [0.2, 0.3, 0.02]));
    let leg = scene.add(standing(0.0, [3.3, 0.05, 0.35], [0.03, 0.03, 0.35]));
    let top = scene.add(standing(0.0, [2.9, 0.3, 0.72], [0.4, 0.75, 0.02]));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.05], 0.0, 8.0), Some(2));
    let shown = round_all([top, leg].into_iter().filter_map(|part| view.try_box_around(part)));
    let seen = estimate_box(&view, label, shown);
    let seen = seen
        .map(|m| EllipsoidMeasurement { ellipsoid: in_world(&m, &view, scene.thing(top)), ..m });
    (seen, scene, top)
}

#[test]
fn a_part_of_its_top_is_enough_of_a_table() {
    let (table, scene, top) = behind_boards("dining table");
    let table = table.unwrap();
    let off = table.ellipsoid.center().coords - scene.thing(top).pose.translation.vector;
    let height_m = table.ellipsoid.center().z + table.ellipsoid.semi_axes.z;
    assert!((height_m - 0.74).abs() < 0.02, "its top is at 0.74 m: {height_m}");
    // The part that shows may be any part of it, and its own covariance says so.
    let sigma_m = Vector3::from_fn(|i, _| table.covariance[(3 + i, 3 + i)].sqrt());
    assert!(sigma_m.x > 0.3 && sigma_m.y > 0.3, "{sigma_m}");
    assert!(off.x.abs() < 2.0 * sigma_m.x && off.y.abs() < 2.0 * sigma_m.y, "{off} ± {sigma_m}");
}

#[test]
fn what_carries_nothing_is_no_part_of_a_top() {
    assert!(behind_boards("refrigerator").0.is_err());
}

/// The near end of a chair at the left border of the image, which cuts off all but a sliver; but nothing else is in its box.
#[test]
fn a_sliver_that_fills_its_box_is_of_the_object() {
    let simulation = home(107);
    let of_chair = |d: &&SimulatedDetection| d.object == Some(13);
    let chair = simulation.scene().objects.iter().find(|object| object.id == 13).unwrap();
    for frame in [2, 3].map(|index| simulation.frame(index)) {
        let rect = frame.detections.iter().find(of_chair).unwrap().rect;
        let m = estimate(&simulation, &frame, detection("chair", rect)).unwrap();
        let center = frame.world_from_camera * m.ellipsoid.center();
        let off_m = (center.coords - chair.world_from_object.translation.vector).xy().norm();
        let sigma_m = m.covariance[(3, 3)].sqrt();
        assert!(rect.x_min < 4.0 && off_m < 0.4, "{off_m} m off in frame {}", frame.index);
        assert!(sigma_m > 0.3, "nobody knows of which part it is: {sigma_m} m");
    }
}
