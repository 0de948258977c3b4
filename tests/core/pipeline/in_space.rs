//! A detector that measures in space, on a robot that sends no depth.

use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose, intersection_over_union, yaw_of},
    perception::Detection3d,
    pipeline::{
        Detections3dMessage, Dropped, Input, ObjectSlam, OdometryMessage, Settings,
        StampedTransform,
    },
    sim::{SceneKind, SceneObject, Simulation, SimulationSettings, TrajectoryKind},
    time::Stamp,
};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How a detector says what it measured.
#[derive(Clone, Copy, PartialEq)]
enum Says {
    /// A box that is turned with the object.
    Boxes,
    /// A box along the axes of the base, as yolo_ros does.
    UnturnedBoxes,
    /// The place alone, as depthai does.
    Places,
}

fn drive(seed: u64) -> Simulation {
    let settings = SimulationSettings {
        scene: SceneKind::Home,
        trajectory: TrajectoryKind::Loop,
        seed,
        frames: 150,
        ..Default::default()
    };
    Simulation::new(settings).unwrap()
}

/// A normal variate, near enough: twelve uniform ones (variance 1).
fn bell(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

/// What is in view within 5 m, with noise as the settings have it.
fn detection(
    object: &SceneObject,
    (world_from_base, base_from_camera): (&Pose, &Pose),
    says: Says,
    rng: &mut ChaCha8Rng,
) -> Option<Detection3d> {
    let camera_from_object =
        (world_from_base * base_from_camera).inverse() * object.world_from_object;
    let at = camera_from_object.translation.vector;
    let is_in_view =
        (0.5..5.0).contains(&at.z) && at.x.abs() < 0.6 * at.z && at.y.abs() < 0.45 * at.z;
    if !is_in_view {
        return None;
    }
    let range_m = at.norm();
    let noise = Vector3::from_fn(|_, _| (0.02 + 0.01 * range_m) * bell(rng));
    let along = at / range_m * ((0.05 + 0.01 * range_m * range_m) * bell(rng));
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.15 * bell(rng));
    let measured = Pose::from_parts(
        Translation3::from(at + noise + along),
        camera_from_object.rotation * turn,
    );
    let extents_m = object.size.map(|extent| extent * (0.1 * bell(rng)).exp());
    let (frame, pose, extents_m) = match says {
        Says::Boxes => ("camera", measured, Some(extents_m)),
        Says::Places => {
            ("camera", Pose::from_parts(measured.translation, UnitQuaternion::identity()), None)
        }
        Says::UnturnedBoxes => {
            let in_base = base_from_camera * measured;
            let turned = in_base.rotation.to_rotation_matrix();
            let around = turned.matrix().abs() * extents_m;
            (
                "base_link",
                Pose::from_parts(in_base.translation, UnitQuaternion::identity()),
                Some(around),
            )
        }
    };
    Some(Detection3d::new(frame.into(), pose, extents_m, vec![(object.label.into(), 0.8)]).unwrap())
}

fn odometry(simulation: &Simulation, index: usize) -> Input {
    let reading = &simulation.odometry()[index];
    Input::Odometry(OdometryMessage {
        stamp: simulation.stamp(index),
        frame_id: "odom".into(),
        child_frame_id: "base_link".into(),
        odom_from_base: reading.odom_from_base,
        covariance: Some(Box::new(reading.covariance)),
    })
}

fn camera_on_base(simulation: &Simulation) -> Input {
    let transform = StampedTransform {
        stamp: simulation.stamp(0),
        frame_id: "base_link".into(),
        child_frame_id: "camera".into(),
        parent_from_child: *simulation.base_from_optical(),
    };
    Input::Transforms { is_static: true, transforms: vec![transform] }
}

/// Errors of the places (m), overlaps with the truth, and how many objects there are to find.
#[derive(Default)]
struct Found {
    off_m: Vec<f64>,
    size_errors: Vec<f64>,
    overlaps: Vec<f64>,
    there: usize,
    in_map: usize,
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn mapped(says: Says) -> Found {
    let mut found = Found::default();
    for seed in [1, 2, 3] {
        let (simulation, mut rng) = (drive(seed), ChaCha8Rng::seed_from_u64(seed));
        let objects = &simulation.scene().objects;
        let mut slam = ObjectSlam::new(Settings::default());
        slam.handle(camera_on_base(&simulation), &mut ());
        let mut seen = vec![0; objects.len()];
        for (index, world_from_base) in simulation.world_from_base().iter().enumerate() {
            let place = (world_from_base, simulation.base_from_optical());
            let all = objects.iter().zip(&mut seen).filter_map(|(object, seen)| {
                let detection = detection(object, place, says, &mut rng)?;
                *seen += 1;
                Some(detection)
            });
            let message =
                Detections3dMessage { stamp: simulation.stamp(index), detections: all.collect() };
            slam.handle(Input::Detections3d(message), &mut ());
            let update = slam.handle(odometry(&simulation, index), &mut ());
            assert!(update.dropped.is_empty(), "{:?}", update.dropped);
        }
        slam.finish(&mut ());
        found.in_map += slam.objects().count();
        for (object, _) in objects.iter().zip(seen).filter(|(_, seen)| *seen > 8) {
            let center = object.world_from_object.translation.vector;
            let off_m = |e: &Ellipsoid| (e.center().coords - center).norm();
            let alike = slam.objects().filter(|o| o.label() == object.label).map(|o| o.ellipsoid());
            let nearest = alike.min_by(|a, b| off_m(a).total_cmp(&off_m(b)));
            found.there += 1;
            let Some(nearest) = nearest.filter(|e| off_m(e) < 0.4) else { continue };
            let own = nearest.relabelled_towards(yaw_of(&object.world_from_object));
            found.off_m.push(off_m(&own));
            let extents =
                own.semi_axes.zip_map(&object.size, |own, size| (2.0 * own / size).ln().abs());
            found.size_errors.push(extents.mean());
            let truth = ellipsoid_slam::geometry::OrientedBox {
                pose: object.world_from_object,
                half_extents: 0.5 * object.size,
            };
            found.overlaps.push(intersection_over_union(&(&own).into(), &truth));
        }
    }
    found
}

/// How many of the objects that were seen are in the map, and how good they are.
#[test]
fn a_map_comes_of_detections_in_space_alone() {
    for (says, name, least_off_m, least_size) in [
        (Says::Boxes, "boxes", 0.08, 0.1),
        (Says::UnturnedBoxes, "boxes along the base's axes", 0.1, 0.4),
        (Says::Places, "places", 0.1, 0.5),
    ] {
        let found = mapped(says);
        let (off_m, size) = (median(&found.off_m), median(&found.size_errors));
        println!(
            "{name}: {} of {} objects are in the map of {}, {off_m:.3} m off, extents {:.0} % off, overlap {:.2}",
            found.off_m.len(),
            found.there,
            found.in_map,
            100.0 * size,
            median(&found.overlaps)
        );
        assert!(
            10 * found.off_m.len() >= 9 * found.there,
            "{name}: {} of {}",
            found.off_m.len(),
            found.there
        );
        assert!(off_m < least_off_m && size < least_size, "{name}: {off_m} m, {size}");
    }
}

/// What two messages bring, one of them from a frame that nothing connects; and what was dropped.
fn with_frame(frame: &str, again: bool) -> (Vec<Dropped>, usize) {
    let simulation = drive(1);
    let mut slam = ObjectSlam::new(Settings::default());
    let mut dropped = Vec::new();
    let mut handle = |input| {
        let update = slam.handle(input, &mut ());
        dropped.extend(update.dropped);
        update.keyframes_3d.iter().map(|keyframe| keyframe.found.len()).sum::<usize>()
    };
    let mut found = handle(camera_on_base(&simulation));
    let place = Pose::from_parts(Translation3::new(0.0, 0.0, 2.0), UnitQuaternion::identity());
    let cup = |frame: &str| {
        Detection3d::new(frame.into(), place, None, vec![("cup".into(), 0.9)]).unwrap()
    };
    for index in 0..30 {
        let detections = vec![cup("camera"), cup(frame)];
        let stamp = simulation.stamp(if again && index == 20 { 18 } else { index });
        found += handle(Input::Detections3d(Detections3dMessage { stamp, detections }));
        found += handle(odometry(&simulation, index));
    }
    let update = slam.finish(&mut ());
    dropped.extend(update.dropped);
    found += update.keyframes_3d.iter().map(|keyframe| keyframe.found.len()).sum::<usize>();
    (dropped, found)
}

#[test]
fn detections_of_an_unknown_frame_are_dropped_in_words_and_the_others_stay() {
    let (dropped, found) = with_frame("camera", false);
    assert_eq!((dropped.len(), found), (0, 60), "{dropped:?}");
    let (dropped, found) = with_frame("moon", false);
    assert_eq!((dropped.len(), found), (30, 30), "{dropped:?}");
    assert_eq!(dropped[0].reason, "no_transform");
    assert!(dropped[0].why.contains("\"moon\" to \"base_link\""), "{}", dropped[0].why);
}

#[test]
fn detections_that_come_late_are_dropped() {
    let (dropped, found) = with_frame("camera", true);
    assert_eq!((dropped.len(), found), (1, 58), "{dropped:?}");
    assert_eq!(dropped[0].reason, "stamp_goes_back");
}

#[test]
fn boxes_of_any_frame_stand_upright() {
    // 2 m ahead of a camera 1 m above the ground that looks 20 degrees down; 0.5 m wide, 1.6 m high, 0.4 m deep in its frame.
    let simulation = drive(1);
    let base_from_camera = {
        let (sin, cos) = 20_f64.to_radians().sin_cos();
        let axes = [
            Vector3::new(0.0, -1.0, 0.0),
            Vector3::new(-sin, 0.0, -cos),
            Vector3::new(cos, 0.0, -sin),
        ];
        let turned = nalgebra::Rotation3::from_basis_unchecked(&axes);
        Pose::from_parts(
            Translation3::new(0.0, 0.0, 1.0),
            UnitQuaternion::from_rotation_matrix(&turned),
        )
    };
    let mut slam = ObjectSlam::new(Settings::default());
    let transform = StampedTransform {
        stamp: Stamp::default(),
        frame_id: "base_link".into(),
        child_frame_id: "camera".into(),
        parent_from_child: base_from_camera,
    };
    slam.handle(Input::Transforms { is_static: true, transforms: vec![transform] }, &mut ());
    let place = Pose::from_parts(Translation3::new(0.0, 0.0, 2.0), UnitQuaternion::identity());
    for index in 0..12 {
        let stamp = simulation.stamp(index);
        let extents = Some(Vector3::new(0.5, 1.6, 0.4));
        let one =
            Detection3d::new("camera".into(), place, extents, vec![("refrigerator".into(), 0.9)]);
        let message = Detections3dMessage { stamp, detections: vec![one.unwrap()] };
        let reading = OdometryMessage {
            stamp,
            frame_id: "odom".into(),
            child_frame_id: "base_link".into(),
            odom_from_base: Pose::translation(0.0, 0.0, 0.0),
            covariance: None,
        };
        slam.handle(Input::Odometry(reading), &mut ());
        slam.handle(Input::Detections3d(message), &mut ());
    }
    slam.finish(&mut ());
    let [fridge] = slam.objects().collect::<Vec<_>>()[..] else { panic!("one object") };
    let e = fridge.ellipsoid();
    let expected = base_from_camera * Point3::new(0.0, 0.0, 2.0);
    assert!((e.center() - expected).norm() < 0.05, "{e:?}");
    assert!((e.pose.rotation * Vector3::z()).z > 0.999, "{e:?}");
    assert!((2.0 * e.semi_axes.z - 1.6).abs() < 0.15, "its height is along the camera's y: {e:?}");
}
