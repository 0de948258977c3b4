//! What a box says where depth does not suffice.

use super::{estimate_all, estimate_with};
use crate::scene::{Scene, View, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Rect},
    perception::{
        DepthImage, DepthNoise, Detection, Frame, FrameEstimate, Glimpse, PerceptionSettings, Rays,
        Refused, estimate_frame,
    },
};
use nalgebra::Vector3;

fn without_readings() -> DepthImage {
    let (width, height) = (camera().width(), camera().height());
    DepthImage::new(width, height, vec![0.0; (width * height) as usize]).unwrap()
}

/// What a depth camera that reaches so far sees of it.
fn within(view: &View, reach_m: f32) -> DepthImage {
    let (width, height) = (camera().width(), camera().height());
    let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u as i32, v as i32)));
    let reading = |(u, v)| view.depth.at(u, v).filter(|depth| *depth < reach_m).unwrap_or(0.0);
    DepthImage::new(width, height, pixels.map(reading).collect()).unwrap()
}

fn look(view: &View, label: &str, thing: usize) -> FrameEstimate {
    let settings = PerceptionSettings::default();
    estimate_with(view, label, view.box_around(thing), &view.up_in_camera(), &settings)
}

/// A refrigerator of the usual size, farther off than depth is used.
fn far_refrigerator() -> (Scene, usize) {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.0, [8.0, 2.0, 0.85], [0.325, 0.35, 0.85]));
    (scene, thing)
}

#[test]
fn something_far_away_is_where_a_thing_of_its_class_would_look_so_large() {
    let (scene, thing) = far_refrigerator();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let seen = look(&view, "refrigerator", thing);
    assert!(matches!(seen.objects[0], Err(Refused::TooFewPoints { .. })), "{:?}", seen.objects[0]);
    let glimpse = seen.glimpses[0].as_ref().unwrap();
    let truth = scene.thing(thing);
    let body = glimpse.ellipsoid.transformed(&view.world_from_camera);
    let eye = view.world_from_camera.translation.vector;
    let (ray, off) = (truth.pose.translation.vector - eye, body.center().coords - eye);
    // The direction is good to half a degree, the range is a guess.
    assert!(ray.angle(&off) < 0.01, "{}", ray.angle(&off));
    assert!((off.norm() / ray.norm() - 1.0).abs() < 0.25, "{} m", off.norm());
    assert!((body.semi_axes.z - 0.85).abs() < 0.2, "{}", body.semi_axes);
    // It knows what it does not know: the range. x points away from the camera.
    let away = body.pose.rotation * Vector3::x();
    assert!(away.angle(&Vector3::new(ray.x, ray.y, 0.0)) < 0.01);
    let sigma = |i: usize| glimpse.covariance[(i, i)].sqrt();
    assert!(sigma(3) > 1.0 && sigma(4) < 0.3 && sigma(5) < 0.7, "{}", glimpse.covariance);
    // Were it farther off, it would be larger.
    assert!(glimpse.covariance[(3, 8)] > 0.5 * sigma(3) * sigma(8));
}

#[test]
fn depth_in_the_box_tells_the_range() {
    let mut scene = Scene::with_floor();
    // Six books side by side: their points are one cluster that goes on outside each box.
    let books: Vec<usize> = (0..6)
        .map(|i| {
            let y = 0.17 * f64::from(i) - 0.4;
            scene.add(standing(0.0, [3.0, y, 0.77], [0.12, 0.085, 0.02]))
        })
        .collect();
    scene.add(standing(0.0, [3.2, 0.0, 0.73], [0.5, 0.9, 0.02]));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.2], 0.0, 10.0), Some(1));
    let seen = look(&view, "book", books[2]);
    assert!(seen.objects[0].is_err());
    let glimpse = seen.glimpses[0].as_ref().unwrap();
    let body = glimpse.ellipsoid.transformed(&view.world_from_camera);
    let off = body.center().coords - scene.thing(books[2]).pose.translation.vector;
    assert!(off.norm() < 0.15, "{off}");
    assert!(glimpse.covariance[(3, 3)].sqrt() < 0.6);
}

#[test]
fn what_the_image_cuts_off_has_the_proportions_of_its_class() {
    let (scene, thing) = far_refrigerator();
    // The left border of the image is `beyond` (rad) to the left of its middle, of which either half is 0.043 wide.
    let at_border = |beyond: f64| {
        let yaw = 2.0_f64.atan2(8.0) + beyond - (319.5_f64 / 525.0).atan();
        let view = scene.seen_from(&looking([0.0, 0.0, 1.0], yaw, 5.0));
        let seen = look(&view, "refrigerator", thing);
        let glimpse = seen.glimpses[0].clone();
        glimpse.map(|glimpse| (glimpse.ellipsoid.transformed(&view.world_from_camera), glimpse))
    };
    let (whole, whole_glimpse) = at_border(0.08).unwrap();
    let (cut, cut_glimpse) = at_border(0.015).unwrap();
    let bearing = |body: &Ellipsoid| body.center().y.atan2(body.center().x) - 0.25_f64.atan();
    assert!(bearing(&whole).abs() < 0.006, "{}", bearing(&whole));
    // The middle of what is left is 0.014 to the right.
    assert!(bearing(&cut).abs() < 0.009, "{}", bearing(&cut));
    assert!(cut_glimpse.covariance[(4, 4)] > 1.5 * whole_glimpse.covariance[(4, 4)]);
    assert!(at_border(-0.02).is_none(), "more than a half is cut off");
}

#[test]
fn without_depth_the_sides_of_the_box_are_all_there_is() {
    let (scene, thing) = far_refrigerator();
    let mut view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let of = |view: &View, label: &str| look(view, label, thing).glimpses[0].clone();
    let range_variance = |glimpse: &Glimpse| {
        let in_camera = glimpse.ellipsoid.center().coords;
        let away = glimpse.ellipsoid.pose.rotation.inverse() * (in_camera / in_camera.norm());
        let place = glimpse.depth_covariance.fixed_view::<3, 3>(3, 3).into_owned();
        let aside = away.cross(&Vector3::z());
        let aside = aside / aside.norm();
        [(away.transpose() * place * away)[0], (aside.transpose() * place * aside)[0]]
    };
    // Depth at 8 m is too coarse for a measurement, and still says the range.
    let [away, aside] = range_variance(&of(&view, "refrigerator").unwrap());
    assert!(away.sqrt() < 1.5 && aside.sqrt() > 50.0, "{away} {aside}");
    view.depth = without_readings();
    let glimpse = of(&view, "refrigerator").unwrap();
    let [away, aside] = range_variance(&glimpse);
    assert!(away.sqrt() > 50.0 && aside.sqrt() > 50.0, "{away} {aside}");
    assert_eq!(glimpse.hidden_px, [Some(0.0); 4]);
    // Its class says how large it is, more or less.
    assert!((glimpse.usual.semi_axes.z - 0.85).abs() < 1e-9);
    let size_sigma = glimpse.usual.covariance[(2, 2)].sqrt();
    assert!((0.3..0.6).contains(&size_sigma), "{size_sigma}");
}

#[test]
fn what_is_nearer_beside_a_box_hides_where_the_object_ends() {
    let (mut scene, thing) = far_refrigerator();
    let pose = looking([0.0, 0.0, 1.0], 0.1, 5.0);
    let whole = scene.seen_from(&pose).box_around(thing);
    // A couch half way to it hides its lower half.
    scene.add(standing(0.245, [4.0, 1.0, 0.45], [0.4, 1.5, 0.45]));
    let view = scene.seen_from(&pose);
    let upper = Rect::new(whole.x_min, whole.y_min, whole.x_max, whole.center().1).unwrap();
    let seen = estimate_with(
        &view,
        "refrigerator",
        upper,
        &view.up_in_camera(),
        &PerceptionSettings::default(),
    );
    let hidden = seen.glimpses[0].as_ref().unwrap().hidden_px;
    assert_eq!(hidden[..3], [Some(0.0); 3]);
    assert!(hidden[3].unwrap() >= upper.height(), "{hidden:?}");
}

#[test]
fn what_stands_on_the_floor_brings_it_along() {
    let (scene, thing) = far_refrigerator();
    let mut view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    view.depth = within(&view, 4.0);
    let floor = |label: &str| look(&view, label, thing).glimpses[0].clone().unwrap().floor;
    let in_world = floor("refrigerator").unwrap().transformed(&view.world_from_camera);
    // Where it stands, twice as far off as the floor was seen.
    let foot = scene.thing(thing).pose.translation.vector - Vector3::z() * 0.85;
    assert!(in_world.signed_distance(&foot.into()).abs() < 0.01, "{in_world:?}");
    assert_eq!(floor("tv"), None, "televisions stand on something");
}

#[test]
fn a_slit_shows_some_part_of_the_foot() {
    let (mut scene, thing) = far_refrigerator();
    let yaw = 0.25_f64.atan();
    // Two walls half way, a tenth of a metre apart.
    for side in [-1.0, 1.0] {
        let (ahead, aside) = (4.0, 0.6 * side);
        let (sin, cos) = yaw.sin_cos();
        let center = [ahead * cos - aside * sin, ahead * sin + aside * cos, 1.0];
        scene.add(standing(yaw, center, [0.05, 0.55, 1.0]));
    }
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], yaw, 5.0));
    let hidden = |label: &str| {
        look(&view, label, thing).glimpses[0].clone().unwrap().hidden_px.map(|px| px.unwrap())
    };
    let [left, upper, right, lower] = hidden("refrigerator");
    // 0.7 m are 45 px at 8.2 m; the box is higher than that.
    assert!(left.min(right) > 80.0 && upper == 0.0, "{left} {upper} {right}");
    // Half of that, seen from 1 m above the floor: 525 * 0.35 * (1 / 8.2) / 8.2.
    assert!((2.0..3.5).contains(&lower), "{lower} px");
    // A couch that ends in the slit may reach 1.9 m to either side, and from its near to its far end.
    let [couch_left, .., couch_lower] = hidden("couch");
    assert!(couch_left > left && couch_lower > 2.0 * lower, "{couch_left} {couch_lower}");
}

#[test]
fn out_of_reach_a_box_that_reaches_farther_down_hides_the_foot() {
    let (scene, thing) = far_refrigerator();
    let mut view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    view.depth = within(&view, 4.0);
    let whole = view.box_around(thing);
    let upper = Rect::new(whole.x_min, whole.y_min, whole.x_max, whole.center().1).unwrap();
    let (u, v) = whole.center();
    let couch = Rect::new(u - 90.0, v, u + 120.0, whole.y_max + 30.0).unwrap();
    let lower = |boxes: &[Detection]| {
        estimate_all(&view, boxes).glimpses[0].as_ref().unwrap().hidden_px[3].unwrap()
    };
    let refrigerator = detection("refrigerator", upper);
    assert_eq!(lower(std::slice::from_ref(&refrigerator)), 0.0);
    let before_it = lower(&[refrigerator.clone(), detection("couch", couch)]);
    assert!(before_it >= upper.height(), "{before_it} px");
    let behind_it = Rect::new(u - 90.0, whole.y_min, u + 120.0, upper.y_max - 10.0).unwrap();
    assert_eq!(lower(&[refrigerator, detection("couch", behind_it)]), 0.0);
}

#[test]
fn something_of_no_usual_size_is_out_of_reach_where_nothing_is_within() {
    let (scene, thing) = far_refrigerator();
    let mut view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let read = look(&view, "cabinet", thing).glimpses[0].clone().unwrap();
    assert!((read.ellipsoid.center().coords.norm() - 8.2).abs() < 0.5);
    view.depth = without_readings();
    let glimpse = look(&view, "cabinet", thing).glimpses[0].clone().unwrap();
    let range = glimpse.ellipsoid.center().coords.norm();
    let away = glimpse.covariance[(3, 3)].sqrt();
    assert!(range > 5.0 && away > 2.0, "{range} m, {away} m");
    assert!(glimpse.usual.covariance[(2, 2)].sqrt() > 0.7);
    // Of what the border cuts nobody knows how much is left, where no proportions are known.
    let cut = Rect::new(0.0, 60.0, 40.0, 200.0).unwrap();
    let settings = PerceptionSettings::default();
    let seen = |label| estimate_with(&view, label, cut, &view.up_in_camera(), &settings);
    assert!(seen("cabinet").glimpses[0].is_none() && seen("refrigerator").glimpses[0].is_some());
    // Within reach, what is in the box may be what hides it.
    let mut near = Scene::with_floor();
    let wall = near.add(standing(0.0, [3.0, 0.0, 1.0], [0.05, 3.0, 1.0]));
    let view = near.seen_from(&looking([0.0, 0.0, 1.0], 0.0, 5.0));
    let part = view.box_around(wall).center();
    let part = Rect::new(part.0 - 40.0, part.1 - 40.0, part.0 + 40.0, part.1 + 40.0).unwrap();
    let seen = estimate_with(&view, "cabinet", part, &view.up_in_camera(), &settings);
    assert!(seen.objects[0].is_err() && seen.glimpses[0].is_none());
}

#[test]
fn what_is_measured_is_not_glimpsed() {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.3, [2.5, 0.0, 0.4], [0.3, 0.2, 0.4]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 20.0));
    let seen = look(&view, "cabinet", thing);
    assert!(seen.objects[0].is_ok() && seen.glimpses[0].is_none());
    let off = PerceptionSettings { glimpses: false, ..PerceptionSettings::default() };
    let (scene, thing) = far_refrigerator();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let rect = view.box_around(thing);
    let seen = estimate_with(&view, "refrigerator", rect, &view.up_in_camera(), &off);
    assert!(seen.glimpses[0].is_none(), "it was asked not to");
}

#[test]
fn what_stands_before_a_thing_is_not_the_thing() {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.0, [3.0, 0.0, 0.8], [0.3, 0.35, 0.8]));
    let suitcase = scene.add(standing(0.0, [2.0, 0.0, 0.6], [0.1, 0.2, 0.6]));
    let view = scene.seen_with(&looking([0.0, 0.0, 0.95], 0.0, 8.0), Some(3));
    let detections = [
        detection("refrigerator", view.box_around(thing)),
        detection("suitcase", view.box_around(suitcase)),
    ];
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, &view.up_in_camera(), DepthNoise::default());
    let off = |detections: &[Detection]| {
        let settings = PerceptionSettings::default();
        let seen = estimate_frame(&frame, detections, &settings, &mut ());
        let body = match (&seen.objects[0], &seen.glimpses[0]) {
            (Ok(measured), _) => measured.ellipsoid,
            (Err(_), glimpse) => glimpse.as_ref().unwrap().ellipsoid,
        };
        let center = body.transformed(&view.world_from_camera).center();
        (center.coords - Vector3::new(3.0, 0.0, 0.8)).xy().norm()
    };
    // By itself, it is taken for what stands in the middle of its box.
    let (alone, beside) = (off(&detections[..1]), off(&detections));
    assert!(beside < 0.3 && beside < alone, "{beside} m, without the suitcase's box {alone} m");
}

/// A screen 7 m off, out of reach, of which a cabinet hides more than the lower half. The readings there have an owner.
#[test]
fn what_is_measured_in_another_box_tells_no_range() {
    let mut scene = Scene::with_floor();
    let screen = scene.add(standing(0.0, [7.0, 0.0, 1.3], [0.05, 0.35, 0.3]));
    let eye = looking([0.0, 0.0, 0.22], 0.0, 0.0);
    let whole = scene.seen_from(&eye).box_around(screen);
    let cabinet = scene.add(standing(0.0, [4.2, 0.1, 0.43], [0.4, 0.6, 0.43]));
    let view = scene.seen_with(&eye, Some(3));
    let depth = within(&view, 5.0);
    let rays = Rays::new(camera());
    let frame = Frame::new(&depth, &rays, &view.up_in_camera(), DepthNoise::default());
    let boxes = [detection("tv", whole), detection("cabinet", view.box_around(cabinet))];
    let seen = estimate_frame(&frame, &boxes, &PerceptionSettings::default(), &mut ());
    assert!(seen.objects[0].is_err() && seen.objects[1].is_ok());
    let range_m = seen.glimpses[0].as_ref().unwrap().ellipsoid.center().z;
    assert!(range_m > 5.0, "the cabinet is 3.8 m off, the screen 7 m: {range_m}");
}
