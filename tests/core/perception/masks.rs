//! Masks of instances: what is inside is the object.

use ellipsoid_slam::{
    geometry::{Ellipsoid, OrientedBox, Rect, intersection_over_union, yaw_of},
    perception::{
        DepthImage, DepthNoise, Detection, Frame, FrameEstimate, Mask, MaskError,
        PerceptionSettings, Rays, estimate_frame,
    },
    sim::{
        SceneKind, SceneObject, SimulatedDetection, SimulatedFrame, Simulation, SimulationSettings,
        TrajectoryKind,
    },
};
use nalgebra::{UnitVector3, Vector3};

/// How far a mask is drawn off: as wide or as narrow as by so many pixels on each side.
type Wider = i64;

fn boxes(frame: &SimulatedFrame, width: i64, masked: Option<Wider>) -> Vec<Detection> {
    let of = |d: &SimulatedDetection| {
        let names = d.hypotheses.iter().map(|(name, p)| ((*name).to_owned(), *p));
        let mut detection = Detection::new(d.rect, names.collect()).unwrap();
        let height = frame.instances.len() as i64 / width;
        let id = |u: i64, v: i64| {
            let is_there = (0..width).contains(&u) && (0..height).contains(&v);
            is_there.then(|| u32::from(frame.instances[(v * width + u) as usize]))
        };
        detection.mask = masked.zip(d.object).and_then(|(wider, object)| {
            let around = |u: i64, v: i64| {
                let reach = wider.abs();
                let mut near = [(0, 0), (-reach, 0), (reach, 0), (0, -reach), (0, reach)]
                    .into_iter()
                    .filter_map(|(du, dv)| id(u + du, v + dv));
                if wider > 0 { near.any(|id| id == object) } else { near.all(|id| id == object) }
            };
            Mask::from_pixels(&d.rect, around).ok()
        });
        detection
    };
    frame.detections.iter().map(of).collect()
}

fn look(simulation: &Simulation, frame: &SimulatedFrame, boxes: &[Detection]) -> FrameEstimate {
    let camera = simulation.camera();
    let depth = DepthImage::new(camera.width(), camera.height(), frame.depth_m.clone()).unwrap();
    let up = UnitVector3::new_normalize(frame.world_from_camera.rotation.inverse() * Vector3::z());
    let rays = Rays::new(camera.clone());
    let view = Frame::new(&depth, &rays, &up, DepthNoise::default());
    estimate_frame(&view, boxes, &PerceptionSettings::default(), &mut ())
}

fn truth(object: &SceneObject) -> OrientedBox {
    OrientedBox { pose: object.world_from_object, half_extents: 0.5 * object.size }
}

fn iou(found: &Ellipsoid, frame: &SimulatedFrame, truth: &OrientedBox) -> f64 {
    let found = found.transformed(&frame.world_from_camera).relabelled_towards(yaw_of(&truth.pose));
    intersection_over_union(&(&found).into(), truth)
}

/// For each way to draw masks, the sum of the overlaps with the truth of all measurements in a room where things stand close together;
/// a box without a measurement has none.
fn overlaps(ways: [Option<Wider>; 4]) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for seed in [1, 2] {
        let settings = SimulationSettings {
            scene: SceneKind::Crowded,
            trajectory: TrajectoryKind::Forward,
            seed,
            ..Default::default()
        };
        let simulation = Simulation::new(settings).unwrap();
        for index in (0..simulation.frame_count()).step_by(10) {
            let frame = simulation.frame(index);
            for (sum, way) in sums.iter_mut().zip(ways) {
                let boxes = boxes(&frame, simulation.camera().width().into(), way);
                let found = look(&simulation, &frame, &boxes).objects;
                for (simulated, found) in frame.detections.iter().zip(found) {
                    if let (Some(object), Ok(found)) = (simulated.object, found) {
                        let object = &simulation.scene().objects[object as usize - 1];
                        *sum += iou(&found.ellipsoid, &frame, &truth(object));
                    }
                }
            }
        }
    }
    sums
}

/// Chairs before a table, books in a row: boxes overlap, masks do not.
#[test]
fn masks_help_where_boxes_overlap_and_inexact_ones_do_no_harm() {
    let [none, exact, wide, narrow] = overlaps([None, Some(0), Some(3), Some(-3)]);
    println!(
        "overlaps: {none:.2} by boxes, {exact:.2} by masks, {wide:.2} and {narrow:.2} by masks 3 px too wide and too narrow"
    );
    assert!(exact > 1.15 * none, "{exact} by masks, {none} by boxes");
    assert!(
        wide.min(narrow) > 0.98 * none,
        "{wide} and {narrow} by inexact masks, {none} by boxes"
    );
}

fn rect() -> Rect {
    Rect::new(10.0, 20.0, 50.0, 80.0).unwrap()
}

#[test]
fn an_outline_bounds_what_is_inside() {
    // Of a triangle, half of the box.
    let mask = Mask::from_outline(&rect(), &[[10.0, 20.0], [50.0, 20.0], [10.0, 80.0]]).unwrap();
    for (u, v, is_inside) in [
        (12.0, 22.0, true),
        (48.0, 78.0, false),
        (30.0, 49.0, true),
        (30.0, 52.0, false),
        (500.0, 30.0, false),
        (f64::NAN, 30.0, false),
    ] {
        assert_eq!(mask.contains(u, v), is_inside, "{u}, {v}");
    }
    // A bow tie, whose middle is a point; what is twice inside is outside.
    let tie = [[10.0, 20.0], [50.0, 80.0], [50.0, 20.0], [10.0, 80.0]];
    let tie = Mask::from_outline(&rect(), &tie).unwrap();
    assert!(tie.contains(12.0, 50.0) && tie.contains(48.0, 50.0));
    assert!(!tie.contains(30.0, 25.0) && !tie.contains(30.0, 75.0));
}

#[test]
fn what_is_no_mask_is_refused_in_words() {
    let square = |from: f64, to: f64| vec![[from, from], [to, from], [to, to], [from, to]];
    let of = |corners: &[[f64; 2]]| Mask::from_outline(&rect(), corners).unwrap_err();
    assert_eq!(of(&[]), MaskError::Points(0));
    assert_eq!(of(&[[10.0, 20.0], [50.0, 80.0]]), MaskError::Points(2));
    assert_eq!(of(&vec![[10.0, 20.0]; 1_000_000]), MaskError::Points(1_000_000));
    assert_eq!(of(&[[10.0, 20.0], [f64::NAN, 20.0], [10.0, 80.0]]), MaskError::NotFinite);
    assert_eq!(of(&[[10.0, 20.0], [f64::INFINITY, 20.0], [10.0, 80.0]]), MaskError::NotFinite);
    assert_eq!(of(&square(200.0, 300.0)), MaskError::Empty);
    assert_eq!(of(&square(30.0, 30.0)), MaskError::Empty);
    let MaskError::NotOfBox { share } = of(&square(9.0, 26.0)) else { panic!() };
    assert!(share < 0.2, "{share}");
    assert_eq!(Mask::from_pixels(&rect(), |_, _| false), Err(MaskError::Empty));
    // Larger than any image, in numbers and in memory.
    let huge = Mask::from_outline(&rect(), &square(-1e300, 1e300)).unwrap();
    assert!(huge.contains(30.0, 50.0));
    let endless = Rect::new(-1e9, -1e9, 1e9, 1e9).unwrap();
    let endless = Mask::from_pixels(&endless, |_, _| true).map(|mask| mask.bytes());
    assert!(endless.is_ok_and(|bytes| bytes <= 8192), "no mask takes more than 8 kB");
    // All lines cross all rows: nothing takes long.
    let zigzag: Vec<_> = (0..20_000)
        .map(|i| [10.0 + f64::from(i) / 500.0, if i % 2 == 0 { 0.0 } else { 90.0 }])
        .collect();
    drop(Mask::from_outline(&rect(), &zigzag));
}

#[test]
fn an_outline_of_parts_with_a_hole_is_read_again() {
    let is_inside = |u: i64, v: i64| {
        let ring = (12..=30).contains(&u)
            && (25..=70).contains(&v)
            && !((18..=22).contains(&u) && (40..=50).contains(&v));
        let corner = (40..=48).contains(&u) && (60..=78).contains(&v);
        // Two that touch at a corner.
        let touching = (31..=35).contains(&u) && (71..=75).contains(&v);
        ring || corner || touching
    };
    let mask = Mask::from_pixels(&rect(), is_inside).unwrap();
    assert!(mask.contains(15.0, 45.0) && !mask.contains(20.0, 45.0) && mask.contains(44.0, 70.0));
    assert_eq!(Mask::from_outline(&rect(), &mask.outline()), Ok(mask.clone()));
    // Corners and no pixel between: 4 of each of the four borders, which begin and end at the same, and ways between them.
    assert!(mask.outline().len() < 30, "{:?}", mask.outline());
}
