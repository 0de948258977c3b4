use ellipsoid_slam::geometry::Rect;
use proptest::prelude::*;

fn rects() -> impl Strategy<Value = Rect> {
    (-100.0..700.0, -100.0..500.0, 1.0..400.0, 1.0..400.0)
        .prop_map(|(x, y, w, h): (f64, f64, f64, f64)| Rect::new(x, y, x + w, y + h).unwrap())
}

#[test]
fn what_is_no_rectangle_is_refused() {
    for (x_min, y_min, x_max, y_max) in [
        (1.0, 0.0, 1.0, 5.0),
        (0.0, 2.0, 5.0, 1.0),
        (f64::NAN, 0.0, 1.0, 1.0),
        (0.0, 0.0, f64::INFINITY, 1.0),
    ] {
        assert_eq!(Rect::new(x_min, y_min, x_max, y_max), None);
    }
}

#[test]
fn overlap_by_hand() {
    let a = Rect::new(0.0, 0.0, 4.0, 2.0).unwrap();
    let b = Rect::new(2.0, 1.0, 6.0, 3.0).unwrap();
    // 2 common of 8 + 8 - 2.
    assert!((a.overlap(&b) - 2.0 / 14.0).abs() < 1e-12);
    assert_eq!(a.intersection(&b), Rect::new(2.0, 1.0, 4.0, 2.0));
    let apart = Rect::new(4.0, 0.0, 5.0, 1.0).unwrap();
    assert_eq!(a.overlap(&apart), 0.0, "touching sides have nothing in common");
    assert_eq!((a.center(), a.width(), a.height(), a.area()), ((2.0, 1.0), 4.0, 2.0, 8.0));
}

#[test]
fn clipping_leaves_what_pixels_there_are() {
    let wide = Rect::new(-10.0, 100.0, 1000.0, 200.0).unwrap();
    assert_eq!(wide.clipped(640, 480), Rect::new(0.0, 100.0, 639.0, 200.0));
    let below = Rect::new(10.0, 480.0, 20.0, 500.0).unwrap();
    assert_eq!(below.clipped(640, 480), None);
}

proptest! {
    #[test]
    fn overlap_is_a_symmetric_share(a in rects(), b in rects()) {
        let share = a.overlap(&b);
        prop_assert!((0.0..=1.0).contains(&share));
        prop_assert_eq!(share, b.overlap(&a));
        prop_assert!((a.overlap(&a) - 1.0).abs() < 1e-12);
        prop_assert_eq!(share > 0.0, a.intersection(&b).is_some());
    }

    #[test]
    fn clipping_is_the_part_inside(rect in rects()) {
        let image = Rect::new(0.0, 0.0, 639.0, 479.0).unwrap();
        prop_assert_eq!(rect.clipped(640, 480), rect.intersection(&image));
    }
}
