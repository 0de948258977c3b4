use super::{estimate_with, measure};
use crate::scene::{Scene, View, looking, standing};
use ellipsoid_slam::perception::{PerceptionSettings, Side, SymmetryType};
use nalgebra::{Point3, Vector3};

/// A box seen across an edge: both mirror planes have evidence on their far side.
#[test]
fn mirror_planes_of_a_box_are_found() {
    for yaw in [0.5, 0.8] {
        let mut scene = Scene::with_floor();
        let center = [2.0, 0.0, 0.2];
        let carton = scene.add(standing(yaw, center, [0.3, 0.22, 0.2]));
        let view = scene.seen_from(&looking([0.0, 0.0, 1.5], 0.0, 35.0));
        let m = measure(&view, "suitcase", carton);
        assert_eq!(m.symmetry.len(), 2, "{:?}", m.symmetry);
        for found in &m.symmetry {
            let plane = found.plane.transformed(&view.world_from_camera);
            let off = plane.signed_distance(&Point3::from(Vector3::from(center)));
            assert!(off.abs() < 0.02, "off the centre by {off}");
            assert!(plane.normal.z.abs() < 1e-6, "upright");
            let angle = plane.normal.y.atan2(plane.normal.x) - yaw;
            assert!((4.0 * angle).cos() > 0.97, "turned by {angle}");
            assert!(found.probability > 0.8 && found.evidence > 0.15);
        }
        assert!(m.probability.symmetry > 0.8);
    }
}

#[test]
fn a_class_with_one_plane_gets_one_and_without_none() {
    let mut scene = Scene::with_floor();
    let carton = scene.add(standing(0.6, [2.0, 0.0, 0.2], [0.3, 0.22, 0.2]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.5], 0.0, 35.0));
    for (symmetry, planes) in
        [(SymmetryType::None, 0), (SymmetryType::Plane, 1), (SymmetryType::DualPlane, 2)]
    {
        let mut settings = PerceptionSettings::default();
        settings.classes.unlisted.symmetry = symmetry;
        let up = view.up_in_camera();
        let rect = view.box_around(carton);
        let m = estimate_with(&view, "thing", rect, &up, &settings).objects.remove(0).unwrap();
        assert_eq!(m.symmetry.len(), planes, "{symmetry:?}");
        if symmetry == SymmetryType::None {
            assert!(m.probability.symmetry <= 0.5, "not more probable than symmetric classes");
        }
    }
}

/// A frontal face mirrored in itself agrees perfectly and proves nothing.
#[test]
fn a_plane_laid_on_the_visible_face_is_no_symmetry() {
    let mut scene = Scene::with_floor();
    let cabinet = scene.add(standing(0.0, [2.3, 0.0, 0.9], [0.3, 0.4, 0.9]));
    let view: View = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 5.0));
    let m = measure(&view, "suitcase", cabinet);
    for found in &m.symmetry {
        let plane = found.plane.transformed(&view.world_from_camera);
        assert!(plane.normal.x.abs() < 0.3, "no plane across the line of sight: {plane:?}");
    }
    assert!(
        !m.sides.contains(&Side::Mirrored),
        "nothing is completed from the face alone: {:?}",
        m.sides
    );
}

/// One arm of an angle is longer: no upright plane maps it to itself.
#[test]
fn a_lopsided_thing_has_no_convincing_plane_across() {
    let score = |lopsided: bool| {
        let mut scene = Scene::with_floor();
        let low = scene.add(standing(0.0, [2.0, 0.0, 0.1], [0.25, 0.4, 0.1]));
        let y = if lopsided { 0.25 } else { 0.0 };
        let tower = scene.add(standing(0.0, [2.0, y, 0.45], [0.25, 0.15, 0.25]));
        let view = scene.seen_from(&looking([0.0, 0.0, 1.3], 0.0, 30.0));
        let (a, b) = (view.box_around(low), view.box_around(tower));
        let rect = ellipsoid_slam::geometry::Rect::new(
            a.x_min.min(b.x_min),
            a.y_min.min(b.y_min),
            a.x_max.max(b.x_max),
            a.y_max.max(b.y_max),
        );
        let m = super::estimate_box(&view, "suitcase", rect.unwrap()).unwrap();
        let across = m.symmetry.iter().map(|s| {
            (
                s.plane.transformed(&view.world_from_camera).normal.y.abs(),
                s.probability * s.evidence,
            )
        });
        across.filter(|(y, _)| *y > 0.9).map(|(_, worth)| worth).fold(0.0, f64::max)
    };
    let (symmetric, lopsided) = (score(false), score(true));
    assert!(symmetric > 0.4, "{symmetric}");
    assert!(lopsided < 0.8 * symmetric, "{lopsided} against {symmetric}");
}
