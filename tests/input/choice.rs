//! Which topics of well-known cameras are chosen by type and name alone, as a live node has to, and what is said of it.

use ellipsoid_slam::{
    config::{Parameters, RosArguments},
    msg::{
        Message,
        nav_msgs::Odometry,
        sensor_msgs::{CameraInfo, CompressedImage, Image},
        vision_msgs::{Detection2DArray, Detection3DArray},
        yolo_msgs::DetectionArray,
    },
    topics::{Assigned, Remap, Role, Topic, choose, given_by, given_to_node},
};

/// Names of topics; `i` images, `z` compressed ones, `c` calibrations, `o` odometry, `b` boxes, `y` boxes of yolo_ros, `s` objects in space.
fn topics(list: &str) -> Vec<Topic> {
    let topic = |word: &str| {
        let (kind, name) = word.split_once(':').unwrap();
        let type_name = match kind {
            "i" => Image::TYPE,
            "z" => CompressedImage::TYPE,
            "c" => CameraInfo::TYPE,
            "o" => Odometry::TYPE,
            "b" => Detection2DArray::TYPE,
            "y" => DetectionArray::TYPE,
            "s" => Detection3DArray::TYPE,
            _ => panic!("{word}"),
        };
        let (name, type_name) = (name.into(), type_name.into());
        Topic { name, type_name, encoding: "cdr".into(), messages: 1, format: None }
    };
    list.split_whitespace().map(topic).collect()
}

/// `rgb depth camera_info depth_camera_info odometry detections`, `-` for none.
fn roles(assigned: &Assigned) -> String {
    let topic = |role: &Role| assigned.roles.topic_of(*role).unwrap_or("-");
    Role::ALL[..6].iter().map(topic).collect::<Vec<_>>().join(" ")
}

/// The camera, what is published where it runs, and what is to be chosen: colour, depth, both calibrations, odometry, boxes.
const CAMERAS: &[(&str, &str, &str)] = &[
    (
        "RealSense",
        "i:/camera/camera/color/image_raw z:/camera/camera/color/image_raw/compressed c:/camera/camera/color/camera_info
         i:/camera/camera/depth/image_rect_raw c:/camera/camera/depth/camera_info
         z:/camera/camera/depth/image_rect_raw/compressedDepth
         i:/camera/camera/aligned_depth_to_color/image_raw c:/camera/camera/aligned_depth_to_color/camera_info
         i:/camera/camera/infra1/image_rect_raw c:/camera/camera/infra1/camera_info
         o:/odometry/filtered o:/odom b:/detections",
        "/camera/camera/color/image_raw /camera/camera/aligned_depth_to_color/image_raw /camera/camera/color/camera_info \
         /camera/camera/aligned_depth_to_color/camera_info /odom /detections",
    ),
    (
        "OAK-D with depthai_ros_driver, and yolo_ros",
        "i:/oak/rgb/image_raw z:/oak/rgb/image_raw/compressed c:/oak/rgb/camera_info
         i:/oak/stereo/image_raw z:/oak/stereo/image_raw/compressedDepth c:/oak/stereo/camera_info
         i:/oak/left/image_raw c:/oak/left/camera_info i:/oak/right/image_raw c:/oak/right/camera_info
         y:/yolo/detections y:/yolo/tracking y:/yolo/detections_3d i:/yolo/dbg_image i:/yolo/debug_image o:/odom",
        "/oak/rgb/image_raw /oak/stereo/image_raw /oak/rgb/camera_info /oak/stereo/camera_info /odom /yolo/detections",
    ),
    (
        "a TurtleBot 4",
        "i:/oakd/rgb/preview/image_raw c:/oakd/rgb/preview/camera_info i:/oakd/stereo/image_raw c:/oakd/stereo/camera_info
         o:/odom y:/yolo/detections",
        "/oakd/rgb/preview/image_raw /oakd/stereo/image_raw /oakd/rgb/preview/camera_info /oakd/stereo/camera_info /odom \
         /yolo/detections",
    ),
    (
        "Orbbec",
        "i:/camera/color/image_raw c:/camera/color/camera_info i:/camera/depth/image_raw c:/camera/depth/camera_info
         i:/camera/ir/image_raw c:/camera/ir/camera_info b:/detections o:/vio/odometry",
        "/camera/color/image_raw /camera/depth/image_raw /camera/color/camera_info /camera/depth/camera_info /vio/odometry \
         /detections",
    ),
    (
        "Kinect with openni2_camera",
        "i:/camera/rgb/image_raw i:/camera/rgb/image_rect_color c:/camera/rgb/camera_info
         i:/camera/depth/image_raw c:/camera/depth/camera_info
         i:/camera/depth_registered/image_rect c:/camera/depth_registered/camera_info i:/camera/ir/image b:/detections",
        "/camera/rgb/image_raw /camera/depth_registered/image_rect /camera/rgb/camera_info \
         /camera/depth_registered/camera_info - /detections",
    ),
    (
        "Azure Kinect",
        "i:/rgb/image_raw c:/rgb/camera_info i:/depth/image_raw c:/depth/camera_info
         i:/depth_to_rgb/image_raw c:/depth_to_rgb/camera_info i:/rgb_to_depth/image_raw c:/rgb_to_depth/camera_info
         i:/ir/image_raw c:/ir/camera_info b:/detections o:/odom",
        "/rgb/image_raw /depth_to_rgb/image_raw /rgb/camera_info /depth_to_rgb/camera_info /odom /detections",
    ),
    (
        "Gazebo's rgbd_camera",
        "i:/rgbd_camera/image i:/rgbd_camera/depth_image c:/rgbd_camera/camera_info o:/model/robot/odometry b:/boxes",
        "/rgbd_camera/image /rgbd_camera/depth_image /rgbd_camera/camera_info - /model/robot/odometry /boxes",
    ),
    (
        "a camera of Gazebo classic that is called depth_camera",
        "i:/depth_camera/image_raw c:/depth_camera/camera_info i:/depth_camera/depth/image_raw
         c:/depth_camera/depth/camera_info o:/odom b:/detections",
        "/depth_camera/image_raw /depth_camera/depth/image_raw /depth_camera/camera_info \
         /depth_camera/depth/camera_info /odom /detections",
    ),
    (
        "ZED",
        "i:/zed/zed_node/rgb/image_rect_color c:/zed/zed_node/rgb/camera_info
         i:/zed/zed_node/left/image_rect_color c:/zed/zed_node/left/camera_info
         i:/zed/zed_node/depth/depth_registered c:/zed/zed_node/depth/camera_info i:/zed/zed_node/confidence/confidence_map
         o:/zed/zed_node/odom b:/detections",
        "/zed/zed_node/rgb/image_rect_color /zed/zed_node/depth/depth_registered /zed/zed_node/rgb/camera_info \
         /zed/zed_node/depth/camera_info /zed/zed_node/odom /detections",
    ),
];

#[test]
fn topics_of_cameras_are_known_by_their_names() {
    for (camera, published, expected) in CAMERAS {
        let assigned = choose(&topics(published), &[], "/");
        assert_eq!(roles(&assigned), *expected, "{camera}");
        assert_eq!(assigned.missing, [], "{camera}");
    }
}

#[test]
fn what_was_chosen_says_rather_than_what_and_why() {
    let assigned = choose(&topics(CAMERAS[0].1), &[], "/");
    let of = |role: Role| assigned.choices.iter().find(|c| c.role == role).unwrap().to_string();
    assert_eq!(
        of(Role::Depth),
        "/camera/camera/aligned_depth_to_color/image_raw, rather than /camera/camera/depth/image_rect_raw, which is \
         not aligned to colour, or /camera/camera/depth/image_rect_raw/compressedDepth, which is not aligned to colour"
    );
    assert_eq!(
        of(Role::Odometry),
        "/odom, rather than /odometry/filtered, which is not called odom"
    );
    assert_eq!(of(Role::Detections), "/detections");
}

#[test]
fn a_robot_s_own_topics_come_first_in_its_namespace() {
    let both = "i:/r1/camera/color/image_raw c:/r1/camera/color/camera_info i:/r1/camera/depth/image_raw b:/r1/boxes o:/r1/odom
                i:/r2/camera/color/image_raw c:/r2/camera/color/camera_info i:/r2/camera/depth/image_raw b:/r2/boxes o:/r2/odom";
    for robot in ["/r1", "/r2"] {
        let chosen = roles(&choose(&topics(both), &[], robot));
        assert!(
            chosen.split(' ').all(|topic| topic == "-" || topic.starts_with(robot)),
            "{chosen}"
        );
    }
}

#[test]
fn formats_count_more_than_names() {
    let with = |formats: &[(&str, &str)]| {
        let mut all =
            topics("i:/tof/range i:/depth/painted i:/cam/image c:/cam/camera_info b:/boxes");
        for (name, format) in formats {
            all.iter_mut().find(|t| t.name == *name).unwrap().format = Some((*format).into());
        }
        roles(&choose(&all, &[], "/"))
    };
    assert!(with(&[]).starts_with("/cam/image /depth/painted "));
    for depth in ["32FC1", "16UC1", "16UC1; compressedDepth png"] {
        let known = [("/tof/range", depth), ("/depth/painted", "rgb8"), ("/cam/image", "bgr8")];
        assert!(with(&known).starts_with("/cam/image /tof/range "), "{depth}");
    }
    // Mono16 may be either: the name decides.
    assert!(with(&[("/depth/painted", "mono16")]).starts_with("/cam/image /depth/painted "));
}

/// What the section `topics` and ROS 2's arguments give a node in a namespace.
fn given(settings: &[(&str, &str)], arguments: &[&str]) -> Vec<Remap> {
    let mut parameters = Parameters::default();
    for (key, value) in settings {
        parameters.set_text(key, value).unwrap();
    }
    let arguments: Vec<String> =
        ["--ros-args"].iter().chain(arguments).map(|word| (*word).to_owned()).collect();
    let (arguments, _) = RosArguments::parse(&arguments, "node").unwrap();
    given_to_node(&parameters.node.topics, &arguments)
}

#[test]
fn roles_and_topics_of_the_node_are_remapped_alike_live_and_offline() {
    let expected = [Remap { role: Role::Depth, topic: "/a/depth".into() }];
    for name in ["depth", "depth/image", "/depth/image"] {
        let rule = format!("{name}:=/a/depth");
        assert_eq!(rule.parse::<Remap>().unwrap(), expected[0]);
        assert_eq!(given(&[], &["-r", &rule]), expected);
        // It counts more than what the file says.
        assert_eq!(given(&[("topics.depth", "/b")], &["-r", &rule]), expected);
    }
    let in_namespace = given(
        &[
            ("topics.depth", "d"),
            ("topics.depth_transport", "compressedDepth"),
            ("topics.odometry", "''"),
        ],
        &["-r", "__ns:=/r1", "-r", "rgb:=/cam/rgb"],
    );
    let remap = |role, topic: &str| Remap { role, topic: topic.into() };
    assert_eq!(
        in_namespace,
        [
            remap(Role::Rgb, "/cam/rgb"),
            remap(Role::Depth, "/r1/d/compressedDepth"),
            remap(Role::Odometry, "")
        ]
    );
}

#[test]
fn the_section_topics_counts_offline() {
    let mut parameters = Parameters::default();
    assert_eq!(given_by(&parameters.node.topics), []);
    for (key, value) in [("topics.depth", "/x/zimage"), ("topics.depth_transport", "compressed")] {
        parameters.set_text(key, value).unwrap();
    }
    parameters.set_text("topics.odometry", "''").unwrap();
    let named = given_by(&parameters.node.topics);
    let all = topics("i:/x/depth z:/x/zimage/compressed c:/x/camera_info o:/odom b:/boxes");
    assert_eq!(
        roles(&choose(&all, &named, "/")),
        "- /x/zimage/compressed /x/camera_info - - /boxes"
    );
}

/// Depth and boxes tell more than objects in space: these are used where there is no depth, or where they are named.
#[test]
fn objects_in_space_stand_in_for_depth() {
    let in_space = |published: &str, given: &[Remap]| {
        let assigned = choose(&topics(published), given, "/");
        (assigned.roles.detections_3d.clone(), assigned)
    };
    let (of_oak, assigned) =
        in_space("s:/oak/nn/spatial_detections o:/odom i:/oak/rgb/image_raw", &[]);
    assert_eq!(of_oak.as_deref(), Some("/oak/nn/spatial_detections"));
    assert_eq!((roles(&assigned).as_str(), assigned.missing.len()), ("- - - - /odom -", 0));
    let (of_yolo, _) = in_space("y:/yolo/detections y:/yolo/detections_3d o:/odom", &[]);
    assert_eq!(of_yolo.as_deref(), Some("/yolo/detections_3d"));
    let with_depth = "s:/spatial i:/depth/image_raw c:/depth/camera_info b:/boxes";
    let (none, assigned) = in_space(with_depth, &[]);
    assert_eq!((none, assigned.missing.len()), (None, 0));
    let named: Remap = "detections_3d:=/spatial".parse().unwrap();
    let (named, assigned) = in_space(with_depth, &[named]);
    assert_eq!((named.as_deref(), assigned.roles.depth.as_str()), (Some("/spatial"), ""));
    // A detector of our own needs depth.
    let missing = in_space("s:/spatial i:/color/image_raw", &[]).1.for_detector().missing;
    assert_eq!(missing, [Role::Depth, Role::CameraInfo, Role::Rgb]);
}
