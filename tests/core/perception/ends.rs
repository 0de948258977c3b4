//! Where things end whose ends a depth camera sees badly: leaves, back rests, tops at a grazing angle.

use super::{estimate_all, estimate_box, in_world};
use crate::scene::{Scene, detection, looking, round_all, standing};
use ellipsoid_slam::{
    geometry::{Rect, yaw_of},
    perception::{
        DepthImage, DepthNoise, Detection, EllipsoidMeasurement, Frame, PerceptionSettings, Rays,
        Refused, estimate_frame,
    },
    sim::{
        SceneKind, SceneObject, SimulatedDetection, SimulatedFrame, Simulation, SimulationSettings,
        TrajectoryKind,
    },
};
use nalgebra::{UnitVector3, Vector3};

/// A drive through a furnished home, with all that a depth camera loses.
pub(super) fn home(seed: u64) -> Simulation {
    Simulation::new(SimulationSettings {
        scene: SceneKind::Home,
        trajectory: TrajectoryKind::Forward,
        seed,
        ..Default::default()
    })
    .unwrap()
}

/// What one of its frames says of a box.
pub(super) fn estimate(
    simulation: &Simulation,
    frame: &SimulatedFrame,
    detection: Detection,
) -> Result<EllipsoidMeasurement, Refused> {
    let camera = simulation.camera();
    let depth = DepthImage::new(camera.width(), camera.height(), frame.depth_m.clone()).unwrap();
    let up = UnitVector3::new_normalize(frame.world_from_camera.rotation.inverse() * Vector3::z());
    let rays = Rays::new(camera.clone());
    let view = Frame::new(&depth, &rays, &up, DepthNoise::default());
    estimate_frame(&view, &[detection], &PerceptionSettings::default(), &mut ()).objects.remove(0)
}

/// From the front one sees the seat and the front of the back rest, whose rear it hides: there the chair ends, although chairs are
/// usually deeper than this one.
#[test]
fn a_back_rest_is_as_thin_as_back_rests_are() {
    let mut scene = Scene::with_floor();
    // Faces the camera, 0.4 m deep, from 2.3 to 2.7 m.
    let seat = scene.add(standing(0.0, [2.49, 0.0, 0.45], [0.19, 0.22, 0.02]));
    let rest = scene.add(standing(0.0, [2.68, 0.0, 0.7], [0.02, 0.22, 0.23]));
    let legs = [(2.32, -0.2), (2.32, 0.2), (2.68, -0.2), (2.68, 0.2)];
    let legs = legs.map(|(x, y)| scene.add(standing(0.0, [x, y, 0.215], [0.02, 0.02, 0.215])));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.0], 0.0, 10.0), Some(1));
    let parts = [seat, rest].into_iter().chain(legs);
    let whole = round_all(parts.filter_map(|part| view.try_box_around(part)));
    let chair = estimate_box(&view, "chair", whole).unwrap();
    let e = in_world(&chair, &view, scene.thing(seat));
    let [near, far] = [e.center().x - e.semi_axes.x, e.center().x + e.semi_axes.x];
    assert!((near - 2.3).abs() < 0.03, "the seat begins at 2.3 m: {near}");
    assert!((far - 2.7).abs() < 0.03, "the back rest ends at 2.7 m: {far}");
}

/// A suitcase that is seen from its narrow side, its top at a grazing angle: readings reach as far along the top as the camera
/// happened to get any, which is not where the suitcase ends.
#[test]
fn the_last_reading_at_a_grazing_angle_is_no_end() {
    let simulation = home(71);
    let is_suitcase = |object: &&SceneObject| object.label == "suitcase";
    let suitcase = simulation.scene().objects.iter().find(is_suitcase).unwrap();
    // Seen at eleven degrees; from nearer by, the end of what gives readings is still taken for the end.
    for frame in [118, 119].map(|index| simulation.frame(index)) {
        let of_it = |d: &&SimulatedDetection| d.object == Some(suitcase.id);
        let rect = frame.detections.iter().find(of_it).unwrap().rect;
        let m = estimate(&simulation, &frame, detection("suitcase", rect)).unwrap();
        let yaw = yaw_of(&(frame.world_from_camera * m.ellipsoid.pose))
            - yaw_of(&suitcase.world_from_object);
        let axis = usize::from(yaw.sin().abs() > 0.5);
        let off = (2.0 * m.ellipsoid.semi_axes[axis] / suitcase.size.x).ln();
        let sigma = m.covariance[(6 + axis, 6 + axis)].sqrt();
        assert!(off.abs() < 3.0 * sigma, "{off} ± {sigma} in frame {}", frame.index);
    }
}

/// Plants have no reading beside their leaves, and still are what fills their boxes.
#[test]
fn a_plant_in_plain_sight_is_measured() {
    let (mut seen, mut measured) = (0, 0);
    for simulation in [1, 2, 3].map(home) {
        for frame in [6, 9, 12].map(|index| simulation.frame(index)) {
            let small = |id: u32| {
                let object = simulation.scene().objects.iter().find(|object| object.id == id);
                object.filter(|object| object.label == "potted plant" && object.size.z < 0.5)
            };
            let plants = frame.detections.iter().filter_map(|d| Some((d.rect, small(d.object?)?)));
            for (rect, plant) in plants.filter(|(rect, _)| rect.height() > 40.0) {
                let center = plant.world_from_object.translation.vector;
                let off_m = |m: &EllipsoidMeasurement| {
                    (frame.world_from_camera * m.ellipsoid.center() - center).coords.norm()
                };
                let estimate = estimate(&simulation, &frame, detection("potted plant", rect));
                seen += 1;
                measured += usize::from(estimate.is_ok_and(|m| off_m(&m) < 0.15));
            }
        }
    }
    assert!(seen >= 6, "{seen} are large enough");
    assert!(4 * measured >= 3 * seen, "{measured} of {seen}");
}

/// A thin stem before a wall: most of what one reads in their box is the wall.
#[test]
fn a_glimpse_is_not_of_the_wall_that_shows_through() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [4.5, 0.0, 1.5], [0.05, 5.0, 1.5]));
    let stem = scene.add(standing(0.0, [3.0, 0.0, 1.0], [0.008, 0.008, 0.15]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 0.0));
    let seen = view.box_around(stem);
    let leaves = Rect::new(seen.x_min - 16.0, seen.y_min, seen.x_max + 16.0, seen.y_max).unwrap();
    let estimate = estimate_all(&view, &[detection("potted plant", leaves)]);
    assert!(estimate.objects[0].is_err(), "{:?}", estimate.objects[0]);
    let glimpse = estimate.glimpses[0].as_ref().unwrap();
    let range_m = glimpse.ellipsoid.center().coords.norm();
    // A stem at 3 m, and half of how wide plants are.
    assert!((2.9..3.4).contains(&range_m), "{range_m} m");
}
