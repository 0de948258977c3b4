//! Calibration.

use crate::fixtures::camera_info;
use ellipsoid_slam::{
    geometry::Distortion,
    msg::{
        convert::{camera, camera_info as to_wire},
        sensor_msgs::{CameraInfo, RegionOfInterest},
    },
    pipeline::CameraRole,
};

fn changed(change: &dyn Fn(&mut CameraInfo)) -> CameraInfo {
    let mut info = camera_info(4);
    change(&mut info);
    info
}

#[test]
fn raw_images_obey_k_and_d_and_rectified_ones_p() {
    let raw = camera(&camera_info(4), CameraRole::Color, false).unwrap();
    assert_eq!((raw.camera.width(), raw.camera.height()), (3, 2));
    assert_eq!((raw.camera.focal(), raw.camera.principal()), ((500.0, 510.0), (1.5, 0.5)));
    assert_eq!(raw.camera.distortion(), Distortion::PlumbBob([0.1, -0.2, 0.001, -0.002, 0.03]));
    assert_eq!((raw.role, raw.frame_id.as_str()), (CameraRole::Color, "camera"));

    let rectified = camera(&camera_info(4), CameraRole::Depth, true).unwrap();
    assert_eq!(
        (rectified.camera.focal(), rectified.camera.principal()),
        ((450.0, 460.0), (1.25, 0.75))
    );
    assert_eq!(
        (rectified.camera.distortion(), rectified.role),
        (Distortion::None, CameraRole::Depth)
    );

    let without_p = camera(&changed(&|info| info.p = [0.0; 12]), CameraRole::Color, true).unwrap();
    assert_eq!(without_p.camera.focal(), (500.0, 510.0));
}

#[test]
fn distortion_models() {
    let cases: &[(&str, &[f64], Option<Distortion>)] = &[
        ("plumb_bob", &[], Some(Distortion::None)),
        ("plumb_bob", &[0.0; 5], Some(Distortion::None)),
        ("", &[0.0; 5], Some(Distortion::None)),
        ("thin_prism", &[0.0; 4], Some(Distortion::None)),
        ("equidistant", &[0.0; 4], None),
        ("plumb_bob", &[1.0, 2.0, 3.0, 4.0], Some(Distortion::PlumbBob([1.0, 2.0, 3.0, 4.0, 0.0]))),
        (
            "rational_polynomial",
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
            Some(Distortion::Rational([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])),
        ),
        (
            "plumb_bob",
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
            Some(Distortion::Rational([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])),
        ),
        (
            "rational_polynomial",
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 0.0, 0.0, 0.0, 0.0],
            Some(Distortion::Rational([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])),
        ),
        ("rational_polynomial", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0], None),
        ("equidistant", &[0.1, 0.0, 0.0, 0.0], None),
        ("", &[0.1], None),
    ];
    for (model, d, expected) in cases {
        let info = changed(&|info| (info.distortion_model, info.d) = ((*model).into(), d.to_vec()));
        match (camera(&info, CameraRole::Color, false), expected) {
            (Ok(got), Some(expected)) => {
                assert_eq!(got.camera.distortion(), *expected, "{model} {d:?}")
            }
            (Err(error), None) => {
                assert_eq!(error.reason(), "unknown_distortion");
                assert!(error.to_string().contains(model), "{error}");
            }
            (got, _) => panic!("{model} {d:?} gave {got:?}"),
        }
        // Rectified images need no model.
        camera(&info, CameraRole::Color, true).unwrap();
    }
}

#[test]
fn binning_and_region_of_interest() {
    let info = changed(&|info| {
        (info.width, info.height) = (640, 480);
        (info.binning_x, info.binning_y) = (2, 4);
        info.roi = RegionOfInterest {
            x_offset: 100,
            y_offset: 40,
            height: 400,
            width: 500,
            do_rectify: false,
        };
        info.k = [500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0];
    });
    let got = camera(&info, CameraRole::Color, false).unwrap().camera;
    assert_eq!((got.width(), got.height()), (250, 100));
    assert_eq!((got.focal(), got.principal()), ((250.0, 127.5), (110.0, 50.0)));
}

#[test]
fn an_uncalibrated_camera_is_refused() {
    let cases: &[&dyn Fn(&mut CameraInfo)] = &[
        &|info| info.k = [0.0; 9],
        &|info| info.k[0] = f64::NAN,
        &|info| info.k[4] = -1.0,
        &|info| info.k[2] = f64::INFINITY,
        &|info| info.d[0] = f64::NAN,
        &|info| info.width = 0,
    ];
    for change in cases {
        let error = camera(&changed(change), CameraRole::Color, false).unwrap_err();
        assert_eq!(error.reason(), "bad_camera", "{error}");
    }
    let zeros = camera(&changed(cases[0]), CameraRole::Color, false).unwrap_err();
    assert!(zeros.to_string().contains("not calibrated"), "{zeros}");
}

#[test]
fn what_is_written_is_read_again() {
    for rectified in [false, true] {
        let message = camera(&camera_info(4), CameraRole::Color, rectified).unwrap();
        let again = camera(&to_wire(&message), CameraRole::Color, rectified).unwrap();
        assert_eq!(
            (again.camera, again.stamp, again.frame_id),
            (message.camera, message.stamp, message.frame_id)
        );
    }
}
