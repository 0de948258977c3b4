use ellipsoid_slam::{
    geometry::Rect,
    perception::{DepthError, DepthImage, Detection, DetectionError},
};

#[test]
fn hypotheses_are_sorted_and_checked() {
    let rect = Rect::new(0.0, 0.0, 10.0, 10.0).unwrap();
    let new = |h: &[(&str, f64)]| {
        Detection::new(rect, h.iter().map(|(name, p)| ((*name).into(), *p)).collect())
    };
    let detection =
        new(&[("couch", 0.3), ("chair", 0.6), ("", 0.9), ("bed", 1.5), ("tv", f64::NAN)]);
    let detection = detection.unwrap();
    assert_eq!((detection.label(), detection.probability()), ("chair", 0.6));
    assert_eq!(detection.hypotheses().len(), 2);
    // Equal probabilities: by name, so that the result does not hang on the order of arrival.
    assert_eq!(new(&[("b", 0.5), ("a", 0.5)]).unwrap().label(), "a");
    for bad in [&[][..], &[("chair", 0.0)], &[("chair", -0.5)], &[("", 0.5)]] {
        assert_eq!(new(bad), Err(DetectionError::NoClass));
    }
}

#[test]
fn depth_without_a_reading_is_none() {
    let bad = [0.0, -1.0, f32::NAN, f32::INFINITY, 1.5, f32::NEG_INFINITY];
    let image = DepthImage::new(3, 2, bad.to_vec()).unwrap();
    let read: Vec<_> = (0..2).flat_map(|v| (0..3).map(move |u| (u, v))).collect();
    let read: Vec<_> = read.into_iter().map(|(u, v)| image.at(u, v)).collect();
    assert_eq!(read, [None, None, None, None, Some(1.5), None]);
    for (u, v) in [(-1, 0), (0, -1), (3, 0), (0, 2)] {
        assert_eq!(image.at(u, v), None);
    }
    let short = DepthImage::new(3, 2, vec![1.0; 5]);
    assert_eq!(short, Err(DepthError::WrongLength { width: 3, height: 2, got: 5 }));
    assert!(short.unwrap_err().to_string().contains("6 pixels, got 5"));
}
