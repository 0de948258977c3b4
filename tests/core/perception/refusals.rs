use super::estimate_box;
use crate::scene::{Scene, looking, standing};
use ellipsoid_slam::{geometry::Rect, perception::Refused};

fn rect(x_min: f64, y_min: f64, x_max: f64, y_max: f64) -> Rect {
    Rect::new(x_min, y_min, x_max, y_max).unwrap()
}

fn room() -> (Scene, usize) {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.5, [2.0, 0.0, 0.25], [0.3, 0.2, 0.25]));
    (scene, thing)
}

#[test]
fn an_empty_image_has_too_few_points() {
    let view = Scene::default().seen_from(&looking([0.0, 0.0, 1.2], 0.0, 25.0));
    let refused = estimate_box(&view, "chair", rect(100.0, 100.0, 200.0, 200.0));
    assert!(matches!(refused, Err(Refused::TooFewPoints { got: 0, needed }) if needed > 0));
}

#[test]
fn a_box_outside_the_image_is_refused() {
    let (scene, _) = room();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 25.0));
    for outside in [
        rect(700.0, 100.0, 800.0, 200.0),
        rect(-300.0, 100.0, -200.0, 200.0),
        rect(100.0, 490.0, 200.0, 600.0),
    ] {
        assert_eq!(estimate_box(&view, "chair", outside).err(), Some(Refused::OutsideImage));
    }
}

#[test]
fn a_tiny_box_has_too_few_points() {
    let (scene, _) = room();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 25.0));
    let refused = estimate_box(&view, "chair", rect(310.0, 240.0, 315.0, 245.0));
    assert!(matches!(refused, Err(Refused::TooFewPoints { .. })), "{refused:?}");
}

#[test]
fn a_wall_behind_is_no_object() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [3.1, 0.0, 1.5], [0.1, 5.0, 1.5]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 10.0));
    let refused = estimate_box(&view, "tv", rect(250.0, 100.0, 400.0, 200.0));
    // Without the wall nothing is left.
    let expected = matches!(refused, Err(Refused::NoCluster));
    assert!(expected, "{refused:?}");
}

#[test]
fn bare_floor_is_no_object() {
    let view = Scene::with_floor().seen_from(&looking([0.0, 0.0, 1.2], 0.0, 30.0));
    let refused = estimate_box(&view, "chair", rect(250.0, 200.0, 400.0, 350.0));
    assert_eq!(refused.err(), Some(Refused::NoCluster));
}

#[test]
fn what_is_out_of_range_is_refused() {
    let mut scene = Scene::with_floor();
    let far = scene.add(standing(0.0, [8.0, 0.0, 0.5], [0.5, 0.5, 0.5]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 5.0));
    let refused = estimate_box(&view, "chair", view.box_around(far));
    assert!(refused.is_err());
}

#[test]
fn every_refusal_has_a_key_and_a_sentence() {
    let refusals = [
        Refused::OutsideImage,
        Refused::TooFewPoints { got: 3, needed: 12 },
        Refused::NoCluster,
        Refused::GoesOnOutsideBox { outside: 0.256 },
        Refused::FillsTooLittle { overlap: 0.1 },
        Refused::TooLittleSeen { known: 0 },
    ];
    let mut keys: Vec<&str> = refusals.iter().map(Refused::reason).collect();
    keys.sort_unstable();
    keys.dedup();
    assert_eq!(keys.len(), refusals.len());
    assert_eq!(refusals[1].to_string(), "3 points where 12 are needed");
    assert_eq!(refusals[3].to_string(), "26 % of the points lie outside the box");
}
