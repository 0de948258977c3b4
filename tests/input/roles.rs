//! Which topic is used for what.

use ellipsoid_slam::{
    msg::{
        Message,
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, CompressedImage, Image},
        tf2_msgs::TFMessage,
        vision_msgs::Detection2DArray,
    },
    topics::{Remap, RoleError, Roles, Topic},
};

const IMAGE: &str = Image::TYPE;
const PACKED: &str = CompressedImage::TYPE;
const INFO: &str = CameraInfo::TYPE;
const BOXES: &str = Detection2DArray::TYPE;
const ODOMETRY: &str = Odometry::TYPE;
const TF: &str = TFMessage::TYPE;

fn topics(list: &[(&str, &str)]) -> Vec<Topic> {
    let topic = |(name, type_name): &(&str, &str)| Topic {
        name: (*name).into(),
        type_name: (*type_name).into(),
        encoding: "cdr".into(),
        messages: 3,
        format: None,
    };
    list.iter().map(topic).collect()
}

fn remaps(list: &[&str]) -> Vec<Remap> {
    list.iter().map(|text| text.parse().unwrap()).collect()
}

/// `rgb depth camera_info depth_camera_info odometry detections`, `-` for none.
fn assigned(list: &[(&str, &str)], by_hand: &[&str]) -> String {
    let roles = Roles::assign(&topics(list), &remaps(by_hand)).unwrap();
    let or_none = |topic: &Option<String>| topic.clone().unwrap_or("-".into());
    [
        or_none(&roles.rgb),
        roles.depth,
        roles.camera_info,
        or_none(&roles.depth_camera_info),
        or_none(&roles.odometry),
        roles.detections,
    ]
    .join(" ")
}

#[test]
fn by_type_and_name() {
    let cases: &[(&[(&str, &str)], &str)] = &[
        // The least.
        (
            &[("/depth", IMAGE), ("/camera_info", INFO), ("/det", BOXES)],
            "- /depth /camera_info - - /det",
        ),
        // RealSense with aligned depth: aligned before raw, raw before compressed, no infrared.
        (
            &[
                ("/camera/color/image_raw", IMAGE),
                ("/camera/color/image_raw/compressed", PACKED),
                ("/camera/color/camera_info", INFO),
                ("/camera/depth/image_rect_raw", IMAGE),
                ("/camera/depth/camera_info", INFO),
                ("/camera/aligned_depth_to_color/image_raw", IMAGE),
                ("/camera/aligned_depth_to_color/camera_info", INFO),
                ("/camera/infra1/image_rect_raw", IMAGE),
                ("/camera/infra1/camera_info", INFO),
                ("/odometry/filtered", ODOMETRY),
                ("/odom", ODOMETRY),
                ("/det", BOXES),
            ],
            "/camera/color/image_raw /camera/aligned_depth_to_color/image_raw /camera/color/camera_info /camera/aligned_depth_to_color/camera_info /odom /det",
        ),
        // Compressed transports only.
        (
            &[
                ("/cam/rgb/image_rect_color/compressed", PACKED),
                ("/cam/rgb/camera_info", INFO),
                ("/cam/depth_registered/image_rect/compressed", PACKED),
                ("/cam/depth_registered/image_rect/compressedDepth", PACKED),
                ("/det", BOXES),
            ],
            "/cam/rgb/image_rect_color/compressed /cam/depth_registered/image_rect/compressedDepth /cam/rgb/camera_info - - /det",
        ),
        // Depth brings the only calibration: then it is the one camera.
        (
            &[("/d/depth/image", IMAGE), ("/d/depth/camera_info", INFO), ("/det", BOXES)],
            "- /d/depth/image /d/depth/camera_info - - /det",
        ),
        // Truth is never input, and a detector's picture is not the camera's.
        (
            &[
                ("/ground_truth/odom", ODOMETRY),
                ("/ground_truth/depth/image", IMAGE),
                ("/ground_truth/boxes", BOXES),
                ("/ground_truth/camera_info", INFO),
                ("/a/debug_image", IMAGE),
                ("/rgb/image", IMAGE),
                ("/rgb/camera_info", INFO),
                ("/z/depth", IMAGE),
                ("/z/det", BOXES),
            ],
            "/rgb/image /z/depth /rgb/camera_info - - /z/det",
        ),
    ];
    for (list, expected) in cases {
        assert_eq!(assigned(list, &[]), *expected);
        let mut backwards = list.to_vec();
        backwards.reverse();
        assert_eq!(assigned(&backwards, &[]), *expected, "the order of topics does not matter");
    }
}

#[test]
fn by_hand() {
    let list = &[
        ("/a/depth", IMAGE),
        ("/b/zimage", IMAGE),
        ("/a/camera_info", INFO),
        ("/b/camera_info", INFO),
        ("/det", BOXES),
        ("/det2", BOXES),
        ("/wheel", ODOMETRY),
    ];
    assert_eq!(assigned(list, &[]), "/b/zimage /a/depth /b/camera_info /a/camera_info /wheel /det");
    assert_eq!(
        assigned(list, &["depth:=/b/zimage", "detections:=det2", "rgb:=/a/depth"]),
        "/a/depth /b/zimage /a/camera_info /b/camera_info /wheel /det2"
    );
    assert_eq!(
        assigned(list, &["camera_info:=/a/camera_info"]),
        "/b/zimage /a/depth /a/camera_info - /wheel /det"
    );
    assert_eq!(
        assigned(list, &["detections:=/det", "detections:=/det2"]),
        "/b/zimage /a/depth /b/camera_info /a/camera_info /wheel /det2"
    );
}

#[test]
fn transforms_and_rectification() {
    let list = [
        ("/tf", TF),
        ("/tf_static", TF),
        ("/r1/tf", TF),
        ("/ground_truth/tf", TF),
        ("/other", TF),
        ("/depth/image_rect", IMAGE),
        ("/rgb/image_rect_color/compressed", PACKED),
        ("/rgb/camera_info", INFO),
        ("/det", BOXES),
    ];
    let roles = Roles::assign(&topics(&list), &[]).unwrap();
    assert_eq!(
        (roles.tf.clone(), roles.tf_static.clone()),
        (vec!["/tf".into(), "/r1/tf".into()], vec!["/tf_static".to_owned()])
    );
    assert!(roles.is_color_rectified() && roles.is_depth_rectified());
    let raw = Roles::assign(
        &topics(&list),
        &remaps(&["depth:=/rgb/image_rect_color/compressed", "rgb:=/depth/image_rect"]),
    )
    .unwrap();
    assert!(raw.is_color_rectified());
    assert!(
        !roles.core_topics().any(|topic| topic.contains("rgb/image")),
        "colour is not read for the core"
    );
}

#[test]
fn the_images_name_says_whether_its_calibration_distorts() {
    let cases: &[(&[&str], bool, bool)] = &[
        (&["/depth/image_raw"], false, false),
        (&["/depth/image_rect_raw"], true, true),
        (&["/depth/image_rect", "/rgb/image_raw"], false, true),
        (&["/depth/image_raw", "/rgb/image_rect_color"], true, false),
        (&["/depth_rect/image", "/rgb_rect/image"], false, false),
    ];
    for (images, color, depth) in cases {
        let mut list = topics(&[("/camera_info", INFO), ("/det", BOXES)]);
        list.extend(images.iter().flat_map(|image| topics(&[(image, IMAGE)])));
        let roles = Roles::assign(&list, &[]).unwrap();
        assert_eq!(
            (roles.is_color_rectified(), roles.is_depth_rectified()),
            (*color, *depth),
            "{images:?}"
        );
    }
}

#[test]
fn refusals_say_what_is_there_and_what_to_do() {
    let list = topics(&[("/camera_info", INFO), ("/rgb", IMAGE), ("/ground_truth/odom", ODOMETRY)]);
    let missing = Roles::assign(&list, &[]).unwrap_err().to_string();
    for part in [
        "depth, detections",
        "/camera_info (sensor_msgs/msg/CameraInfo)",
        "/rgb (sensor_msgs/msg/Image)",
        "-r depth:=/topic",
    ] {
        assert!(missing.contains(part), "{missing}");
    }
    assert!(Roles::assign(&[], &[]).unwrap_err().to_string().contains("no topics at all"));
    let cases = [
        ("depth:=/nope", "the bag has no topic /nope for depth"),
        (
            "depth:=/camera_info",
            "/camera_info is a sensor_msgs/msg/CameraInfo, but depth needs a sensor_msgs/msg/Image or",
        ),
        ("odometry:=/ground_truth/odom", "never input"),
    ];
    for (remap, expected) in cases {
        let says = Roles::assign(&list, &remaps(&[remap])).unwrap_err().to_string();
        assert!(says.contains(expected), "{says}");
    }
    for (given, expected) in [
        ("depht:=/x", "no role `depht`; the roles are rgb, depth,"),
        ("depth=/x", "role:=/topic"),
        ("depth:=", "role:=/topic"),
        ("", "role:=/topic"),
    ] {
        let says = given.parse::<Remap>().unwrap_err().to_string();
        assert!(says.contains(expected), "{says}");
    }
}

#[test]
fn silent_topics_and_other_encodings_are_no_input() {
    let mut list = topics(&[("/depth", IMAGE), ("/camera_info", INFO), ("/det", BOXES)]);
    list[2].messages = 0;
    let says = Roles::assign(&list, &[]).unwrap_err().to_string();
    assert!(says.contains("detections") && says.contains("no messages"), "{says}");
    (list[2].messages, list[0].encoding) = (1, "ros1".into());
    assert_eq!(
        Roles::assign(&list, &[]).unwrap_err(),
        RoleError::NotCdr { topic: "/depth".into(), encoding: "ros1".into() }
    );
}
