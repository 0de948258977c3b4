use super::{estimate_all, in_world, measure, size_sigmas};
use crate::scene::{Scene, View, detection, looking, round_all, standing};
use ellipsoid_slam::{
    geometry::{Outline, Rect},
    perception::{Classes, EllipsoidMeasurement, Side},
};
use nalgebra::Vector3;

/// Faces of the measurement by the world's direction they look in: the one nearest to `direction`.
fn face_towards(m: &EllipsoidMeasurement, view: &View, direction: Vector3<f64>) -> usize {
    let pose = view.world_from_camera * m.ellipsoid.pose;
    let own = pose.rotation.inverse() * direction;
    let axis = own.iamax();
    2 * axis + usize::from(own[axis] > 0.0)
}

/// Seen frontally and from below its top: nothing tells how deep it is.
#[test]
fn depth_behind_a_frontal_face_is_hidden_and_uncertain() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [4.1, 0.0, 1.5], [0.1, 5.0, 1.5]));
    let cabinet = scene.add(standing(0.0, [2.3, 0.0, 0.7], [0.3, 0.4, 0.7]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 10.0));
    let m = measure(&view, "cabinet", cabinet);
    let back = face_towards(&m, &view, Vector3::x());
    assert_eq!(m.sides[back], Side::Hidden);
    for seen in [-Vector3::x(), Vector3::y(), -Vector3::y()] {
        assert_eq!(m.sides[face_towards(&m, &view, seen)], Side::Seen, "{seen}");
    }
    let depth_axis = back / 2;
    let sigmas = size_sigmas(&m);
    for axis in 0..3 {
        if axis != depth_axis {
            assert!(sigmas[depth_axis] > 4.0 * sigmas[axis], "{sigmas}");
        }
    }
    assert!(sigmas[depth_axis] > 0.05);
    // The front stays where it was seen, whatever is guessed of the back.
    let e = in_world(&m, &view, scene.thing(cabinet));
    assert!((e.center().x - e.semi_axes.x - 2.0).abs() < 0.015, "{e:?}");
    assert!((e.semi_axes.y - 0.4).abs() < 0.015);
    // Centre and depth are wrong together: that is what lets the next view settle both.
    let (t, s) = (3 + depth_axis, 6 + depth_axis);
    let c = &m.covariance;
    let correlation = c[(t, s)] / (c[(t, t)] * c[(s, s)]).sqrt();
    let outward = if back % 2 == 1 { 1.0 } else { -1.0 };
    assert!(correlation * outward > 0.9, "{correlation}");
}

/// A box that the image cuts on its left.
#[test]
fn a_side_outside_the_image_is_not_seen() {
    let mut scene = Scene::with_floor();
    // The image shows y from -1.2 to 1.2 at 2 m: the box goes on to 1.7.
    let chest = scene.add(standing(0.0, [2.2, 1.0, 0.25], [0.2, 0.7, 0.25]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.1], 0.0, 20.0));
    assert_eq!(view.box_around(chest).x_min, 0.0);
    let m = measure(&view, "chest", chest);
    let left = face_towards(&m, &view, Vector3::y());
    assert!(!matches!(m.sides[left], Side::Seen | Side::Support), "{:?}", m.sides);
    let right = face_towards(&m, &view, -Vector3::y());
    assert_eq!(m.sides[right], Side::Seen);
    let axis = left / 2;
    let sigmas = size_sigmas(&m);
    assert!(sigmas[axis] > 0.04, "{sigmas}");
    // The back of a couch may be outside the image: what was seen of the top is not all of it.
    assert_eq!(m.sides[5], Side::Cut, "{:?}", m.sides);
    assert!(sigmas.z > 0.02, "{sigmas}");
    let e = in_world(&m, &view, scene.thing(chest));
    // It is seen from the side, 27 mm a sample: grazing stretches samples along the view, not across.
    let right_end = e.center().y - e.semi_axes.y;
    assert!((right_end - 0.3).abs() < 0.02, "it was seen to end at 0.3 m, not {right_end}");
}

/// A detector's box that covers half of a thing that goes on.
#[test]
fn a_side_that_goes_on_outside_the_box_is_cut() {
    let mut scene = Scene::with_floor();
    let shelf = scene.add(standing(0.0, [2.2, 0.0, 0.4], [0.2, 0.7, 0.4]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.1], 0.0, 20.0));
    let whole = view.box_around(shelf);
    let x_max = whole.x_min + 0.6 * whole.width();
    let half = Rect::new(whole.x_min, whole.y_min, x_max, whole.y_max);
    let m = super::estimate_box(&view, "shelf", half.unwrap()).unwrap();
    let right = face_towards(&m, &view, -Vector3::y());
    let left = face_towards(&m, &view, Vector3::y());
    assert_eq!(m.sides[left], Side::Seen);
    let e = in_world(&m, &view, scene.thing(shelf));
    let right_end = e.center().y - e.semi_axes.y;
    let sigma = size_sigmas(&m)[right / 2];
    match m.sides[right] {
        Side::Cut => assert!(sigma > 0.04, "{sigma}"),
        // Symmetry, judged on the whole image, may know more than the box.
        Side::Mirrored => assert!((right_end + 0.7).abs() < 3.0 * sigma, "{right_end} ± {sigma}"),
        other => panic!("{other:?}, and it ends at {right_end} ± {sigma}"),
    }
}

/// Something nearer covers the left part.
#[test]
fn a_side_behind_something_else_is_hidden() {
    let mut scene = Scene::with_floor();
    let chest = scene.add(standing(0.0, [2.4, 0.0, 0.3], [0.2, 0.6, 0.3]));
    scene.add(standing(0.0, [1.2, 0.45, 0.7], [0.05, 0.3, 0.7]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.1], 0.0, 20.0));
    let m = measure(&view, "chest", chest);
    let left = face_towards(&m, &view, Vector3::y());
    assert!(matches!(m.sides[left], Side::Hidden | Side::Mirrored | Side::Cut), "{:?}", m.sides);
    assert_eq!(m.sides[face_towards(&m, &view, -Vector3::y())], Side::Seen);
    assert!(size_sigmas(&m)[left / 2] > 0.03, "{}", size_sigmas(&m));
}

/// A bed with its head at a wall: the wall is nearer than the bed would be if it went on, and still hides nothing of it.
#[test]
fn what_stands_against_a_wall_ends_there() {
    let far_end = |wall_m: f64| {
        let mut scene = Scene::with_floor();
        let bed = scene.add(standing(0.0, [3.0, 0.0, 0.3], [1.0, 0.75, 0.3]));
        scene.add(standing(0.0, [4.08, 0.0, 0.5 * wall_m], [0.05, 5.0, 0.5 * wall_m]));
        let view = scene.seen_with(&looking([0.6, -0.4, 1.7], 0.1, 25.0), Some(4));
        let m = super::estimate_box(&view, "bed", view.box_around(bed)).ok()?;
        let end = face_towards(&m, &view, Vector3::x());
        let e = in_world(&m, &view, scene.thing(bed));
        Some((m.sides[end], e.center().x + e.semi_axes.x, 2.0 * size_sigmas(&m)[end / 2]))
    };
    let (side, end_m, sigma_m) = far_end(2.5).unwrap();
    assert_eq!(side, Side::Seen);
    assert!((end_m - 4.0).abs() < 0.05 && sigma_m < 0.1, "{end_m} ± {sigma_m}");
    // Another thing's back, no higher than this one, may as well hide where it goes on.
    assert!(far_end(0.75).is_none_or(|(side, ..)| side != Side::Seen));
}

/// A couch of which one end was seen and something nearer hides the other: the couch is as long as couches are beyond it.
#[test]
fn what_one_end_lacks_is_at_the_other() {
    let mut scene = Scene::with_floor();
    let couch = scene.add(standing(0.0, [3.0, 0.0, 0.4], [0.45, 0.9, 0.4]));
    scene.add(standing(0.0, [1.8, 0.7, 0.6], [0.02, 0.6, 0.6]));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.3], 0.0, 20.0), Some(3));
    let m = measure(&view, "couch", couch);
    assert_eq!(m.sides[face_towards(&m, &view, -Vector3::y())], Side::Seen);
    assert_eq!(m.sides[face_towards(&m, &view, Vector3::y())], Side::Hidden);
    let e = in_world(&m, &view, scene.thing(couch));
    let (seen, hidden) = (e.center().y - e.semi_axes.y, e.center().y + e.semi_axes.y);
    assert!((seen + 0.9).abs() < 0.03 && (hidden - 1.0).abs() < 0.1, "{seen} to {hidden}");
}

/// A short table between two cupboards that hide both of its ends: it goes on behind them, but not past them.
#[test]
fn what_is_hidden_is_not_where_one_can_look_through() {
    // Half of the length of the table, if the cupboards are as wide as this.
    let length = |width_m: f64| {
        let mut scene = Scene::with_floor();
        let table = scene.add(standing(0.0, [2.8, 0.0, 0.375], [0.4, 0.45, 0.375]));
        for side in [-1.0, 1.0] {
            let at = [1.8, side * (0.28 + 0.5 * width_m), 0.6];
            scene.add(standing(0.0, at, [0.02, 0.5 * width_m, 0.6]));
        }
        let view = scene.seen_with(&looking([0.0, 0.0, 1.3], 0.0, 20.0), Some(3));
        let m = measure(&view, "dining table", table);
        let e = in_world(&m, &view, scene.thing(table));
        let axis = face_towards(&m, &view, Vector3::y()) / 2;
        (e.semi_axes.y, size_sigmas(&m)[axis])
    };
    let (free, free_sigma) = length(0.15);
    assert!(free > 0.4 && free < 0.7 && free_sigma < 0.2, "{free} ± {free_sigma}");
    // Where nothing says where it ends it is as long as tables are.
    let (open, open_sigma) = length(1.5);
    assert!(open > 0.7 && open_sigma > free_sigma, "{open} ± {open_sigma}");
}

/// The seat of a chair before a table is level and in its box too, and what is above it is not what stands on the table.
#[test]
fn the_seat_before_a_table_is_not_its_top() {
    let mut scene = Scene::with_floor();
    let table = scene.add(standing(0.0, [3.2, 0.0, 0.73], [0.4, 0.75, 0.02]));
    let legs = [(2.83, 0.72), (2.83, -0.72), (3.57, 0.72), (3.57, -0.72)]
        .map(|(x, y)| scene.add(standing(0.0, [x, y, 0.355], [0.03, 0.03, 0.355])));
    let chair = scene.add(standing(0.0, [2.3, 0.1, 0.22], [0.3, 0.4, 0.22]));
    let view = scene.seen_with(&looking([0.0, 0.0, 0.95], 0.0, 12.0), Some(5));
    let rect = Rect { y_max: view.box_around(legs[0]).y_max, ..view.box_around(table) };
    let boxes = [detection("dining table", rect), detection("chair", view.box_around(chair))];
    let m = estimate_all(&view, &boxes).objects.remove(0).unwrap();
    let truth = standing(0.0, [3.2, 0.0, 0.375], [0.4, 0.75, 0.375]);
    let e = in_world(&m, &view, &truth);
    assert!((e.center().z + e.semi_axes.z - 0.75).abs() < 0.02, "{e:?}");
    assert!((e.semi_axes.y - 0.75).abs() < 0.05, "{e:?}");
}

/// A handle, or leaves: the detector sees them, the depth camera does not.
#[test]
fn a_part_without_depth_readings_reaches_as_far_as_the_box() {
    const HANDLE_M: f64 = 0.25;
    let mut scene = Scene::with_floor();
    let body = scene.add(standing(0.6, [2.4, 0.0, 0.3], [0.2, 0.15, 0.3]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.1], 0.0, 15.0));
    let mut whole = scene.clone();
    let handle = whole.add(standing(0.6, [2.4, 0.0, 0.6], [0.01, 0.01, HANDLE_M]));
    let upper = whole.seen_from(&looking([0.0, 0.0, 1.1], 0.0, 15.0)).box_around(handle).y_min;
    let rect = Rect { y_min: upper, ..view.box_around(body) };
    let m = super::estimate_box(&view, "thing", rect).unwrap();
    let e = in_world(&m, &view, scene.thing(body));
    let top = e.center().z + e.semi_axes.z;
    assert_eq!(m.sides[5], Side::Outline, "{:?}", m.sides);
    // The box does not tell whether the front or the back of the object is so high: 0.15 m of 2.4 m.
    assert!((top - 0.6 - HANDLE_M).abs() < 0.06, "{top}");
    let sigma = 2.0 * size_sigmas(&m).z;
    assert!(sigma > 0.02, "{sigma}");
}

/// Depth cameras see nothing of a handle, wherever it is.
#[test]
fn where_something_with_a_handle_ends_is_less_sure_than_where_its_points_do() {
    let mut scene = Scene::with_floor();
    let body = scene.add(standing(0.6, [1.2, 0.0, 0.1], [0.1, 0.1, 0.1]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.0, 35.0));
    let sigma = |label: &str| size_sigmas(&measure(&view, label, body)).xy().min();
    // A third of a width of 0.2 m, at one of two ends.
    assert!(
        sigma("suitcase") < 0.02 && sigma("cup") > 0.03,
        "{} {}",
        sigma("suitcase"),
        sigma("cup")
    );
}

/// A cup is as wide as its body but where its handle is. An outline that fits what is seen of it from all round has its
/// extents.
#[test]
fn boxes_from_all_round_give_a_cup_its_handle() {
    const RADIUS_MM: f64 = 42.0;
    const HANDLE_MM: f64 = 30.0;
    let extents_mm = |outline: Outline| {
        let misfit = |[long_mm, short_mm, center_mm]: [f64; 3]| {
            let semi_axes = Vector3::new(0.5 * long_mm, 0.5 * short_mm, 50.0);
            let off = |degrees: usize| {
                let (sin, cos) = (degrees as f64).to_radians().sin_cos();
                let support = outline.support(&Vector3::new(cos, sin, 0.0), &semi_axes);
                let reach_mm = center_mm * cos + support.reach;
                (reach_mm - RADIUS_MM.max((RADIUS_MM + HANDLE_MM) * cos)).powi(2)
            };
            (0..360).step_by(10).map(off).sum::<f64>()
        };
        let steps = |from: usize, to: usize| (from..to).step_by(2).map(|mm| mm as f64);
        let sizes = steps(100, 130).flat_map(|long| steps(70, 100).map(move |short| (long, short)));
        let tries = sizes.flat_map(|(long, short)| steps(6, 20).map(move |c| [long, short, c]));
        tries.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap()
    };
    let (truth_mm, width_mm) = (2.0 * RADIUS_MM + HANDLE_MM, 2.0 * RADIUS_MM);
    let cup = extents_mm(Classes::default().prior("cup").outline);
    assert!((cup[0] - truth_mm).abs() <= 2.0 && (cup[1] - width_mm).abs() <= 2.0, "{cup:?}");
    let ellipse = extents_mm(Outline::Superquadric(0.5, 1.0));
    assert!(ellipse[0] < truth_mm && ellipse[1] < width_mm - 3.0, "{ellipse:?}");
}

/// Of the thin posts of a back rest hardly more than one side is seen, and that there is nothing behind: of what stands on
/// legs, that is no end.
#[test]
fn a_back_rest_goes_on_behind_its_front_side() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [2.4, 0.0, 0.44], [0.18, 0.2, 0.02]));
    for y in [-0.2, 0.2] {
        scene.add(standing(0.0, [2.6, y, 0.47], [0.02, 0.008, 0.47]));
        scene.add(standing(0.0, [2.24, y, 0.22], [0.02, 0.02, 0.22]));
    }
    let view = scene.seen_from(&looking([0.0, -1.2, 1.0], 0.42, 12.0));
    let rect = round_all((1..6).map(|part| view.box_around(part)));
    let back_m = |label: &str| {
        let m = super::estimate_box(&view, label, rect).unwrap();
        let back = face_towards(&m, &view, Vector3::x());
        assert_eq!(m.sides[back], Side::Seen, "{label} {:?}", m.sides);
        let center = view.world_from_camera * m.ellipsoid.center();
        center.x + m.ellipsoid.semi_axes[back / 2]
    };
    let thicker_m = back_m("chair") - back_m("suitcase");
    assert!((thicker_m - 0.02).abs() < 0.005, "{thicker_m}");
}

/// The foot of a screen that stands at eye level is hidden, and as deep as the screen is wide.
#[test]
fn a_wide_screen_has_a_deep_foot() {
    let depth_m = |half_width_m: f64| {
        let mut scene = Scene::with_floor();
        let size = [0.02, half_width_m, 0.45 / 0.7 * half_width_m];
        let screen = scene.add(standing(0.0, [2.2, 0.0, 1.0], size));
        let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.0, 0.0));
        let m = measure(&view, "tv", screen);
        2.0 * m.ellipsoid.semi_axes[face_towards(&m, &view, Vector3::x()) / 2]
    };
    // The usual one is 0.7 m wide and 0.2 m deep.
    let (usual_m, wide_m) = (depth_m(0.35), depth_m(0.5));
    assert!(
        (usual_m - 0.2).abs() < 0.02 && (wide_m - 0.2 / 0.7).abs() < 0.02,
        "{usual_m} {wide_m}"
    );
}

/// A couch that ends behind something narrow is shorter than it was thought, if it is one: who guessed wrong by so much
/// knows the end no better.
#[test]
fn a_guess_that_was_taken_back_was_no_good() {
    let sigma_m = |pillar_half_m: f64| {
        let mut scene = Scene::with_floor();
        let couch = scene.add(standing(0.0, [3.0, 0.4, 0.4], [0.4, 0.5, 0.4]));
        let pillar = [1.5, 0.1 - pillar_half_m, 0.8];
        scene.add(standing(0.0, pillar, [0.02, pillar_half_m, 0.8]));
        let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 10.0));
        let m = measure(&view, "couch", couch);
        let end = face_towards(&m, &view, -Vector3::y());
        assert_eq!(m.sides[end], Side::Hidden, "{:?}", m.sides);
        size_sigmas(&m)[end / 2]
    };
    assert!(sigma_m(0.05) > 1.1 * sigma_m(0.5), "{} {}", sigma_m(0.05), sigma_m(0.5));
}
