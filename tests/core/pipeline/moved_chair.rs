//! A simulated robot comes back to where a chair was.

use ellipsoid_slam::{
    geometry::Pose,
    mapping::{MapObject, ObjectState},
    perception::{DepthImage, Detection},
    pipeline::{
        CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, ObjectSlam,
        OdometryMessage, Settings, StampedTransform,
    },
    sim::{SceneKind, SceneObject, SimulatedFrame, Simulation, SimulationSettings, TrajectoryKind},
};
use nalgebra::{Point3, distance};

/// One round of the desk, in whose middle somebody pulls the chair away from it.
fn simulation(seed: u64, moved_from_frame: usize) -> Simulation {
    let settings = SimulationSettings {
        scene: SceneKind::Desk,
        trajectory: TrajectoryKind::Orbit,
        seed,
        frames: 60,
        moved_from_frame,
        moved_by_m: 1.0,
        ..SimulationSettings::default()
    };
    Simulation::new(settings).unwrap()
}

fn fixed(simulation: &Simulation) -> [Input; 2] {
    let stamp = simulation.stamp(0);
    let transform = StampedTransform {
        stamp,
        frame_id: "base_link".into(),
        child_frame_id: "camera".into(),
        parent_from_child: *simulation.base_from_optical(),
    };
    let camera = CameraMessage {
        role: CameraRole::Color,
        stamp,
        frame_id: "camera".into(),
        camera: simulation.camera().clone(),
    };
    [Input::Transforms { is_static: true, transforms: vec![transform] }, Input::Camera(camera)]
}

/// What the robot gets of a frame; the boxes are left out where they are lost on the way.
fn inputs(
    simulation: &Simulation,
    frame: &SimulatedFrame,
    boxes: Option<Vec<Detection>>,
) -> Vec<Input> {
    let stamp = frame.stamp;
    let (width, height) = (simulation.camera().width(), simulation.camera().height());
    let mut inputs = vec![
        Input::Odometry(OdometryMessage {
            stamp,
            frame_id: "odom".into(),
            child_frame_id: "base_link".into(),
            odom_from_base: frame.odometry.odom_from_base,
            covariance: Some(Box::new(frame.odometry.covariance)),
        }),
        Input::Depth(DepthMessage {
            stamp,
            frame_id: "camera".into(),
            image: DepthImage::new(width, height, frame.depth_m.clone()).unwrap(),
        }),
    ];
    inputs.extend(boxes.map(|detections| {
        Input::Detections(DetectionsMessage { stamp, frame_id: "camera".into(), detections })
    }));
    inputs
}

fn detections(frame: &SimulatedFrame) -> Vec<Detection> {
    let of = |d: &ellipsoid_slam::sim::SimulatedDetection| {
        let hypotheses = d.hypotheses.iter().map(|(label, p)| ((*label).to_owned(), *p));
        Detection::new(d.rect, hypotheses.collect()).unwrap()
    };
    frame.detections.iter().map(of).collect()
}

fn chair(objects: &[SceneObject]) -> &SceneObject {
    objects.iter().find(|object| object.label == "chair").unwrap()
}

fn center(pose: &Pose) -> Point3<f64> {
    pose.translation.vector.into()
}

/// The object of the map at a place, if there is one.
fn at<'a>(slam: &'a ObjectSlam, place: &Point3<f64>) -> Option<&'a MapObject> {
    slam.objects().find(|o| distance(&o.ellipsoid().center(), place) < 0.5 && o.label() == "chair")
}

/// Whether a camera looks through a place: it is well inside the image, and what is seen there is farther off.
fn is_seen_empty(simulation: &Simulation, frame: &SimulatedFrame, place: &Point3<f64>) -> bool {
    let in_camera = frame.world_from_camera.inverse_transform_point(place);
    let camera = simulation.camera();
    let Some(pixel) = camera.project(&in_camera).filter(|_| in_camera.z > 0.5) else {
        return false;
    };
    let margin = 120.0;
    let (right, below) = (f64::from(camera.width()) - margin, f64::from(camera.height()) - margin);
    if pixel.x < margin || pixel.y < margin || pixel.x > right || pixel.y > below {
        return false;
    }
    let at = pixel.y as usize * camera.width() as usize + pixel.x as usize;
    f64::from(frame.depth_m[at]) > in_camera.z + 0.4
}

#[test]
fn a_chair_that_was_moved_is_gone_from_its_place_within_five_looks() {
    for seed in [41, 42] {
        let simulation = simulation(seed, 30);
        let before = center(&chair(&simulation.scene_before().objects).world_from_object);
        let after = center(&chair(&simulation.scene().objects).world_from_object);
        let mut slam = ObjectSlam::new(Settings::default());
        fixed(&simulation).into_iter().for_each(|input| drop(slam.handle(input, &mut ())));
        let (mut looks, mut known_as) = (0, None);
        for frame in simulation.frames() {
            if frame.index == 30 {
                known_as = at(&slam, &before).map(|object| object.id);
                assert!(known_as.is_some(), "seed {seed}: the chair was never found");
            }
            for input in inputs(&simulation, &frame, Some(detections(&frame))) {
                slam.handle(input, &mut ());
            }
            if frame.index >= 30 && at(&slam, &before).is_some() {
                looks += usize::from(is_seen_empty(&simulation, &frame, &before));
                assert!(looks < 5, "seed {seed}: still there after {looks} looks");
            }
        }
        assert!(at(&slam, &before).is_none(), "seed {seed}: nobody looked at its place");
        let moved = at(&slam, &after);
        println!("seed {seed}: gone after {looks} looks, now {:?}", moved.map(|object| object.id));
        if let Some(moved) = moved {
            assert_eq!(Some(moved.id), known_as, "seed {seed}: it keeps its identity");
        }
    }
}

#[test]
fn without_a_message_of_the_detector_nothing_is_missed_and_an_empty_one_says_that_it_looked() {
    let simulation = simulation(43, 30);
    let before = center(&chair(&simulation.scene_before().objects).world_from_object);
    for is_empty in [false, true] {
        let mut slam = ObjectSlam::new(Settings::default());
        fixed(&simulation).into_iter().for_each(|input| drop(slam.handle(input, &mut ())));
        let mut existence = 0.0;
        for frame in simulation.frames() {
            if frame.index == 30 {
                existence = at(&slam, &before).unwrap().existence();
            }
            // From here on the detector is silent, or sees nothing; the chair is not where it was.
            let silent = is_empty.then(Vec::new);
            let boxes = if frame.index < 30 { Some(detections(&frame)) } else { silent };
            for input in inputs(&simulation, &frame, boxes) {
                slam.handle(input, &mut ());
            }
        }
        slam.finish(&mut ());
        match at(&slam, &before) {
            Some(object) => {
                assert!(!is_empty, "an empty message says that the chair is not there");
                assert_eq!(object.existence(), existence);
                assert_eq!(object.state(), ObjectState::Confirmed);
            }
            None => assert!(is_empty, "no message says nothing"),
        }
    }
}
