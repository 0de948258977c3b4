//! Objects of which only some part shows: behind other things, or at the border of the image.

use super::{
    ends::{estimate, home},
    estimate_box, in_world, measure,
};
use crate::scene::{Scene, View, camera, detection, looking, round_all, standing};
use ellipsoid_slam::{
    geometry::Rect,
    perception::{EllipsoidMeasurement, Refused},
    sim::SimulatedDetection,
};
use nalgebra::{Point3, Vector3};

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

/// The height of a measurement's upper face and its standard deviation (m).
fn top_of(m: &EllipsoidMeasurement, view: &View) -> (f64, f64) {
    let body = m.ellipsoid.transformed(&view.world_from_camera);
    let c = &m.covariance;
    let variance = |sign: f64| {
        let half_m = body.semi_axes.z;
        c[(5, 5)] + c[(8, 8)] * half_m * half_m + sign * 2.0 * c[(5, 8)] * half_m
    };
    (body.center().z + body.semi_axes.z, variance(1.0).sqrt())
}

/// A chair of which a suitcase hides all but two legs and a part of the seat. What is seen ends at the height of the seat.
#[test]
fn a_seat_beside_a_suitcase_is_not_the_top_of_a_chair() {
    let chair = |is_hidden: bool| {
        let mut scene = Scene::with_floor();
        scene.add(standing(0.0, [5.5, 0.0, 1.25], [0.05, 4.0, 1.25]));
        let mut parts = vec![scene.add(standing(0.0, [3.6, 0.0, 0.44], [0.22, 0.22, 0.02]))];
        for (x, y) in [(-0.2, 0.2), (-0.2, -0.2), (0.2, 0.2), (0.2, -0.2)] {
            parts.push(scene.add(standing(0.0, [3.6 + x, y, 0.21], [0.02, 0.02, 0.21])));
        }
        parts.push(scene.add(standing(0.0, [3.6, -0.2, 0.67], [0.22, 0.02, 0.21])));
        if is_hidden {
            scene.add(standing(0.0, [2.9, -0.21, 0.5], [0.12, 0.22, 0.5]));
        }
        let view = scene.seen_with(&looking([0.0, 0.0, 0.22], 0.0, 0.0), Some(3));
        let shown = round_all(parts.into_iter().filter_map(|part| view.try_box_around(part)));
        top_of(&estimate_box(&view, "chair", shown).unwrap(), &view)
    };
    let (seen_m, sigma_m) = chair(false);
    assert!((seen_m - 0.88).abs() < 0.03 && sigma_m < 0.05, "in full sight: {seen_m} ± {sigma_m}");
    let (hidden_m, sigma_m) = chair(true);
    assert!((hidden_m - 0.88).abs() < 2.0 * sigma_m, "beside a suitcase: {hidden_m} ± {sigma_m}");
}

/// A bed, 2 m long and 0.5 m high, seen from low down; its headboard at the far end is out of depth's range, but not out of the
/// detector's. A cuboid whose near end reached up to the side of that box would be 0.69 m high.
#[test]
fn what_is_higher_may_be_at_the_far_end() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [12.0, 0.0, 1.25], [0.05, 9.0, 1.25]));
    let bed = scene.add(standing(0.0, [3.5, 0.0, 0.25], [1.0, 0.75, 0.25]));
    let eye = looking([0.0, 0.0, 0.22], 0.0, 0.0);
    let view = scene.seen_with(&eye, Some(4));
    let headboard = eye.inverse_transform_point(&Point3::new(4.5, 0.0, 0.95));
    let upper = camera().project(&headboard).unwrap().y;
    let rect = view.box_around(bed);
    assert!(upper < rect.y_min - 20.0, "the headboard is above the rest: {upper}, {rect:?}");
    let bed = estimate_box(&view, "bed", Rect { y_min: upper, ..rect }).unwrap();
    let (top_m, sigma_m) = top_of(&bed, &view);
    assert!((top_m - 0.95).abs() < 2.0 * sigma_m, "{top_m} ± {sigma_m}");
    assert!(top_m > 0.7 && sigma_m < 0.15, "{top_m} ± {sigma_m}");
}

/// A cabinet, 1.5 m wide, of which all but a hand's breadth is behind a wall. Nobody knows how large cabinets are.
#[test]
fn a_sliver_of_a_cabinet_says_little_of_how_wide_it_is() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [5.5, 0.0, 1.25], [0.05, 4.0, 1.25]));
    let cabinet = scene.add(standing(0.0, [4.6, 0.0, 0.25], [0.2, 0.75, 0.25]));
    scene.add(standing(0.0, [2.0, -0.75, 1.25], [0.05, 1.02, 1.25]));
    let view = scene.seen_with(&looking([0.0, 0.0, 0.5], 0.0, 0.0), Some(5));
    let m = measure(&view, "cabinet", cabinet);
    let body = in_world(&m, &view, scene.thing(cabinet));
    let width_m = 2.0 * body.semi_axes.y;
    let turned = usize::from((body.semi_axes.y - m.ellipsoid.semi_axes.x).abs() < 1e-9);
    let sigma_m = width_m * m.covariance[(7 - turned, 7 - turned)].sqrt();
    assert!(width_m < 1.0, "most of it is hidden: {width_m}");
    // It is 0.5 m high, and things that high are often a metre wide.
    assert!(sigma_m > 0.2, "{width_m} ± {sigma_m}");
}
