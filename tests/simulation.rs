//! The simulator against independent geometry: what it calls truth has to be true.
#![expect(clippy::unwrap_used, reason = "a test that cannot unwrap has failed")]

use ellipsoid_slam::{
    geometry::{OrientedBox, intersection_volume},
    sim::{
        Mesh, SceneKind, SceneObject, SimulatedFrame, Simulation, SimulationSettings,
        TrajectoryKind, Visible,
    },
};
use nalgebra::{Point3, Vector3};
use parry3d::{
    math::{Pose, Vector},
    query::{PointQuery, intersection_test},
    shape::TriMesh,
};
use std::collections::BTreeMap;

const SCENES: [SceneKind; 3] = [SceneKind::Desk, SceneKind::Home, SceneKind::Office];
const TRAJECTORIES: [TrajectoryKind; 3] =
    [TrajectoryKind::Orbit, TrajectoryKind::Forward, TrajectoryKind::Loop];

fn settings(scene: SceneKind, trajectory: TrajectoryKind, seed: u64) -> SimulationSettings {
    SimulationSettings { scene, trajectory, seed, ..SimulationSettings::default() }
}

fn perfect(scene: SceneKind, trajectory: TrajectoryKind, seed: u64) -> Simulation {
    Simulation::new(settings(scene, trajectory, seed).perfect()).unwrap()
}

fn tri_mesh(mesh: &Mesh) -> TriMesh {
    let vertices =
        mesh.vertices().iter().map(|v| Vector::new(v.x as f32, v.y as f32, v.z as f32)).collect();
    TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap()
}

/// Every `stride`-th pixel of a frame that has a depth: its index and its point in the world frame.
fn points(
    simulation: &Simulation,
    frame: &SimulatedFrame,
    stride: usize,
) -> Vec<(usize, Point3<f64>)> {
    let width = simulation.camera().width() as usize;
    let ((fx, fy), (cx, cy)) = (simulation.camera().focal(), simulation.camera().principal());
    (0..frame.depth_m.len())
        .step_by(stride)
        .filter(|i| frame.depth_m[*i].is_finite())
        .map(|i| {
            let (u, v, z) = ((i % width) as f64, (i / width) as f64, f64::from(frame.depth_m[i]));
            let in_camera = Point3::new((u - cx) / fx * z, (v - cy) / fy * z, z);
            (i, frame.world_from_camera * in_camera)
        })
        .collect()
}

#[test]
fn noiseless_depth_lies_on_the_surfaces() {
    for scene in SCENES {
        let simulation = perfect(scene, TrajectoryKind::Forward, 3);
        let mut bodies = vec![tri_mesh(&simulation.scene().building)];
        bodies.extend(simulation.scene().objects.iter().map(|o| tri_mesh(&o.mesh)));
        for index in (0..simulation.frame_count()).step_by(17) {
            let frame = simulation.frame(index);
            let points = points(&simulation, &frame, 41);
            assert!(points.len() * 41 > 640 * 470, "a closed room has a depth everywhere");
            for (pixel, point) in points {
                let at = Vector::new(point.x as f32, point.y as f32, point.z as f32);
                let body = &bodies[usize::from(frame.instances[pixel])];
                let distance = body.distance_to_local_point(at, false);
                assert!(distance < 1e-3, "{scene:?} {index} {pixel}: {distance} m off");
            }
        }
    }
}

#[test]
fn the_floor_is_the_plane_at_height_zero() {
    let simulation = perfect(SceneKind::Desk, TrajectoryKind::Orbit, 2);
    let frame = simulation.frame(5);
    let is_building = |pixel: usize| frame.instances[pixel] == 0;
    let heights: Vec<f64> = points(&simulation, &frame, 1)
        .into_iter()
        // The lower half of the image sees no wall.
        .filter(|(pixel, _)| is_building(*pixel) && *pixel > 640 * 300)
        .map(|(_, point)| point.z)
        .collect();
    assert!(heights.len() > 10_000);
    assert!(
        heights.iter().all(|z| z.abs() < 1e-4),
        "{:?}",
        heights.iter().max_by(|a, b| a.total_cmp(b))
    );
}

#[test]
fn images_are_not_mirrored_or_upside_down() {
    for trajectory in [TrajectoryKind::Orbit, TrajectoryKind::Forward] {
        let simulation = perfect(SceneKind::Desk, trajectory, 4);
        let frame = simulation.frame(3);
        let heading = frame.world_from_base.rotation;
        let (ahead, left) = (heading * Vector3::x(), heading * Vector3::y());
        let ((_, fy), (cx, cy)) = (simulation.camera().focal(), simulation.camera().principal());
        let camera = frame.world_from_camera.translation.vector;
        let pitch = (frame.world_from_camera.rotation * Vector3::z()).z.asin();
        for (pixel, point) in points(&simulation, &frame, 997) {
            let offset = point.coords - camera;
            let (u, v) = ((pixel % 640) as f64, (pixel / 640) as f64);
            assert!(offset.dot(&ahead) > 0.0, "depth is ahead");
            assert_eq!(u < cx, offset.dot(&left) > 0.0, "the left of the image is to the left");
            let elevation = offset.z.atan2(offset.dot(&ahead));
            let expected = pitch - ((v - cy) / fy).atan();
            assert!((elevation - expected).abs() < 1e-4, "rows further down look further down");
        }
    }
}

#[test]
fn boxes_bound_exactly_the_visible_pixels() {
    let simulation = perfect(SceneKind::Desk, TrajectoryKind::Orbit, 1);
    for index in [0, 11, 23] {
        let frame = simulation.frame(index);
        let mut pixels: BTreeMap<u32, Vec<(f64, f64)>> = BTreeMap::new();
        for (i, id) in frame.instances.iter().enumerate().filter(|(_, id)| **id != 0) {
            let pixel = ((i % 640) as f64, (i / 640) as f64);
            pixels.entry(u32::from(*id)).or_default().push(pixel);
        }
        assert_eq!(pixels.len(), frame.visible.len());
        for (part, (id, pixels)) in frame.visible.iter().zip(&pixels) {
            assert_eq!((part.id, part.pixels), (*id, pixels.len()));
            assert_tight(part, pixels);
        }
        let enough = |part: &&Visible| part.pixels >= 120;
        let expected: Vec<_> =
            frame.visible.iter().filter(enough).map(|p| (Some(p.id), p.rect)).collect();
        let found: Vec<_> = frame.detections.iter().map(|d| (d.object, d.rect)).collect();
        assert_eq!(found, expected, "a perfect detector misses and invents nothing");
    }
}

fn assert_tight(part: &Visible, pixels: &[(f64, f64)]) {
    let rect = part.rect;
    let all = |test: &dyn Fn(&(f64, f64)) -> bool| pixels.iter().all(test);
    let any = |test: &dyn Fn(&(f64, f64)) -> bool| pixels.iter().any(test);
    assert!(all(&|(u, _)| rect.x_min <= *u && *u <= rect.x_max));
    assert!(all(&|(_, v)| rect.y_min <= *v && *v <= rect.y_max));
    assert!(any(&|(u, _)| *u == rect.x_min) && any(&|(u, _)| *u == rect.x_max));
    assert!(any(&|(_, v)| *v == rect.y_min) && any(&|(_, v)| *v == rect.y_max));
}

#[test]
fn true_boxes_are_tight_and_upright() {
    for scene in SCENES {
        for object in &perfect(scene, TrajectoryKind::Forward, 5).scene().objects {
            let own: Vec<Point3<f64>> = object
                .mesh
                .vertices()
                .iter()
                .map(|v| object.world_from_object.inverse_transform_point(v))
                .collect();
            for axis in 0..3 {
                let low = own.iter().map(|v| v[axis]).fold(f64::MAX, f64::min);
                let high = own.iter().map(|v| v[axis]).fold(f64::MIN, f64::max);
                let half = 0.5 * object.size[axis];
                assert!(
                    (low + half).abs() < 1e-9 && (high - half).abs() < 1e-9,
                    "{}",
                    object.label
                );
            }
            let up = object.world_from_object.rotation * Vector3::z();
            assert!((up - Vector3::z()).norm() < 1e-12, "{} is tilted", object.label);
            assert!(object.size.x >= object.size.y, "x is the longer side of {}", object.label);
        }
    }
}

#[test]
fn a_plant_has_the_smallest_of_all_upright_boxes() {
    let scenes = [1, 2, 3].map(|seed| perfect(SceneKind::Home, TrajectoryKind::Forward, seed));
    let objects = scenes.iter().flat_map(|simulation| &simulation.scene().objects);
    let mut plants = 0;
    for plant in objects.filter(|object| object.label == "potted plant") {
        for degrees in 0..90 {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let [x, y] = [[cos, sin], [-sin, cos]].map(|[x, y]| {
                let along = plant.mesh.vertices().iter().map(|v| x * v.x + y * v.y);
                let (low, high) =
                    along.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
                high - low
            });
            // Within half a degree.
            assert!(x * y > 0.98 * plant.size.x * plant.size.y, "{degrees} degrees: {x} by {y} m");
        }
        plants += 1;
    }
    assert_eq!(plants, 6);
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let settings = SimulationSettings { frames: 4, ..SimulationSettings::default() };
    let frame = |settings: &SimulationSettings, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let frame = pool.install(|| Simulation::new(settings.clone()).unwrap().frame(2));
        let depth_bits: Vec<u32> = frame.depth_m.iter().map(|z| z.to_bits()).collect();
        (depth_bits, frame.rgb, frame.detections, frame.odometry)
    };
    let first = frame(&settings, 1);
    assert!(first == frame(&settings, 3), "differs between one and three threads");
    let other = frame(&SimulationSettings { seed: 2, ..settings }, 1);
    assert!(first.0 != other.0 && first.1 != other.1 && first.3 != other.3);
}

#[test]
fn an_orbit_sees_every_object_of_the_desk() {
    for seed in 1..=3 {
        let simulation =
            Simulation::new(settings(SceneKind::Desk, TrajectoryKind::Orbit, seed)).unwrap();
        let mut truth = simulation.ground_truth();
        for frame in simulation.frames() {
            truth.observe(&frame);
        }
        for label in ["tv", "laptop", "keyboard", "mouse", "cup", "book", "bottle", "chair"] {
            assert!(truth.objects.iter().any(|o| o.label == label), "seed {seed} has no {label}");
        }
        for object in &truth.objects {
            let (label, n) = (object.label, object.observations);
            assert!(n >= 5, "seed {seed}: {label} seen {n} times");
        }
    }
}

#[test]
fn a_robot_sees_the_large_objects_on_its_way() {
    let cases: [(SceneKind, TrajectoryKind, &[&str]); 6] = [
        (SceneKind::Desk, TrajectoryKind::Forward, &["tv", "keyboard", "chair", "dining table"]),
        (SceneKind::Desk, TrajectoryKind::Loop, &["tv", "laptop", "chair", "dining table"]),
        (SceneKind::Home, TrajectoryKind::Forward, &["tv", "couch", "bed", "refrigerator"]),
        (SceneKind::Home, TrajectoryKind::Loop, &["tv", "couch", "bed", "potted plant"]),
        (SceneKind::Office, TrajectoryKind::Forward, &["tv", "laptop", "chair", "refrigerator"]),
        (SceneKind::Office, TrajectoryKind::Loop, &["tv", "laptop", "chair", "suitcase"]),
    ];
    for (scene, trajectory, labels) in cases {
        let simulation = perfect(scene, trajectory, 1);
        let mut truth = simulation.ground_truth();
        // Every third frame is enough to count to five.
        for index in (0..simulation.frame_count()).step_by(3) {
            truth.observe(&simulation.frame(index));
        }
        for label in labels {
            let of_label = truth.objects.iter().filter(|o| o.label == *label);
            let most = of_label.map(|o| o.observations).max();
            assert!(most >= Some(5), "{scene:?} {trajectory:?}: {label} seen {most:?} times");
        }
    }
}

#[test]
fn objects_stand_on_something_and_not_in_each_other() {
    for scene in SCENES {
        for seed in 1..=12 {
            let simulation = perfect(scene, TrajectoryKind::Forward, seed);
            let objects = &simulation.scene().objects;
            let meshes: Vec<TriMesh> = objects.iter().map(|o| tri_mesh(&o.mesh)).collect();
            let building = tri_mesh(&simulation.scene().building);
            for (i, object) in objects.iter().enumerate() {
                let context = format!("{scene:?}, seed {seed}: {} {}", object.label, object.id);
                let support = support_height(object, objects);
                assert!((bottom(object) - support).abs() < 1e-9, "{context} floats or sinks");
                // A millimetre higher, what stands on something does not touch it.
                let lifted = Pose::from_translation(Vector::new(
                    0.0,
                    0.0,
                    if bottom(object) > 0.01 { 1e-3 } else { 0.0 },
                ));
                let above_floor = Pose::from_translation(Vector::new(0.0, 0.0, 1e-3));
                let in_wall =
                    intersection_test(&above_floor, &meshes[i], &Pose::IDENTITY, &building);
                assert!(!in_wall.unwrap().intersecting, "{context} sticks in a wall");
                for (j, other) in objects.iter().enumerate().filter(|(j, _)| *j != i) {
                    if bottom(object) < bottom(other) {
                        continue;
                    }
                    let touches =
                        intersection_test(&lifted, &meshes[i], &Pose::IDENTITY, &meshes[j]);
                    assert!(
                        !touches.unwrap().intersecting,
                        "{context} sticks in {} {}",
                        other.label,
                        other.id
                    );
                    // One mesh inside another does not touch it. Below a table top there is room.
                    let tables = [object, other].iter().any(|o| o.label == "dining table");
                    let common = intersection_volume(&shrunk(object), &shrunk(other));
                    assert!(tables || common == 0.0, "{context} overlaps {}", other.label);
                }
            }
        }
    }
}

fn shrunk(object: &SceneObject) -> OrientedBox {
    let tight = object.oriented_box();
    OrientedBox { half_extents: tight.half_extents - Vector3::repeat(1e-6), ..tight }
}

fn bottom(object: &SceneObject) -> f64 {
    object.world_from_object.translation.vector.z - 0.5 * object.size.z
}

/// Top of the highest object below the centre of this one, or the floor.
fn support_height(object: &SceneObject, objects: &[SceneObject]) -> f64 {
    let center = Point3::from(object.world_from_object.translation.vector);
    objects
        .iter()
        .filter(|other| other.id != object.id)
        .filter(|other| {
            let own = other.world_from_object.inverse_transform_point(&center);
            own.x.abs() < 0.5 * other.size.x && own.y.abs() < 0.5 * other.size.y
        })
        .map(|other| bottom(other) + other.size.z)
        .filter(|top| *top <= bottom(object) + 1e-9)
        .fold(0.0, f64::max)
}

#[test]
fn nobody_walks_through_furniture() {
    const ROBOT_RADIUS_M: f64 = 0.2;
    for scene in SCENES {
        for trajectory in TRAJECTORIES {
            for seed in 1..=12 {
                let simulation = perfect(scene, trajectory, seed);
                for pose in simulation.world_from_base() {
                    let at = Point3::from(pose.translation.vector);
                    for object in &simulation.scene().objects {
                        let own = object.world_from_object.inverse_transform_point(&at);
                        let outside_x = (own.x.abs() - 0.5 * object.size.x).max(0.0);
                        let outside_y = (own.y.abs() - 0.5 * object.size.y).max(0.0);
                        let distance = outside_x.hypot(outside_y);
                        let label = object.label;
                        assert!(
                            distance > ROBOT_RADIUS_M,
                            "{scene:?} {trajectory:?} seed {seed}: {distance} m from {label} at {at}"
                        );
                    }
                    let building = tri_mesh(&simulation.scene().building);
                    let body = Vector::new(at.x as f32, at.y as f32, 1.0);
                    let distance = building.distance_to_local_point(body, false);
                    assert!(
                        f64::from(distance) > ROBOT_RADIUS_M,
                        "{scene:?} {trajectory:?} seed {seed}: {distance} m from a wall at {at}"
                    );
                }
            }
        }
    }
}

#[test]
#[expect(clippy::disallowed_methods, reason = "this test reports speed, it does not judge it")]
fn frames_a_second() {
    for scene in SCENES {
        let simulation = Simulation::new(settings(scene, TrajectoryKind::Forward, 1)).unwrap();
        let start = std::time::Instant::now();
        const FRAMES: usize = 8;
        for index in 0..FRAMES {
            simulation.frame(index * simulation.frame_count() / FRAMES);
        }
        let rate = FRAMES as f64 / start.elapsed().as_secs_f64();
        println!("{scene:?}: {rate:.1} frames/s, every sensor included");
    }
}
