//! What is published, where that needs no map.

use ellipsoid_slam::{
    config::NodeSettings,
    geometry::{Camera, Distortion, Ellipsoid, Outline, Pose},
    io::{BagInput, BagWriter},
    mapping::{MappingSettings, ObjectId, ObjectMap, SlamSettings},
    msg::{
        convert::{ObjectShapes, deletion_markers, object_markers, outlined, pose_covariance},
        ellipsoid_slam::{ObjectArray, QueryObjectsRequest},
        std_msgs::ColorRGBA,
        visualization_msgs::Marker,
    },
    pipeline::{FramePose, ObjectSlam, Settings, Update},
    publication::{
        Outgoing, OutputTopic, Publication, Room, View, outline_in_image, query_objects,
    },
    time::Stamp,
};
use nalgebra::{Matrix6, Translation3, UnitQuaternion, Vector3, Vector6};
use std::{fs, path::Path};

fn view() -> View {
    let camera = Camera::new((640, 480), (500.0, 500.0), (320.0, 240.0), Distortion::None).unwrap();
    View { camera, map_from_camera: Pose::translation(1.0, 0.0, 0.0) }
}

#[test]
fn a_sphere_is_outlined_by_its_circle() {
    // Radius 1 m at 4 m: rays touch it at the angle whose sine is 1/4.
    let ball = Ellipsoid::new(Pose::translation(1.0, 0.0, 4.0), Vector3::repeat(1.0));
    let lines = outline_in_image(&ball, Outline::Ellipsoid, &view());
    assert!(lines.len() > 30);
    for [from, to] in &lines {
        let away = |p: &nalgebra::Point2<f64>| (p.x - 320.0).hypot(p.y - 240.0);
        let expected = 500.0 / 15.0_f64.sqrt();
        assert!((away(from) - expected).abs() < 1e-6 && (away(to) - expected).abs() < 1e-6);
    }
    let around = Ellipsoid::new(Pose::translation(1.0, 0.0, 0.5), Vector3::repeat(1.0));
    assert!(outline_in_image(&around, Outline::Ellipsoid, &view()).is_empty());
    assert!(outline_in_image(&around, Outline::Cuboid, &view()).is_empty());
}

#[test]
fn a_cuboid_is_outlined_by_its_edges() {
    let body = Ellipsoid::new(Pose::translation(1.0, 0.0, 4.0), Vector3::new(0.8, 0.4, 1.0));
    let lines = outline_in_image(&body, Outline::Cuboid, &view());
    let right = lines.iter().flatten().map(|p| p.x).fold(f64::MIN, f64::max);
    // The nearer face is at 3 m.
    assert!((right - (320.0 + 500.0 * 0.8 / 3.0)).abs() < 1e-9, "{right}");
}

#[test]
fn a_cylinder_is_outlined_by_its_rims() {
    // The optical frame's y is the object's axis turned upright: seen from the side, its rims are lines.
    let upright = UnitQuaternion::from_euler_angles(-std::f64::consts::FRAC_PI_2, 0.0, 0.0);
    let pose = Pose::from_parts(Translation3::new(1.0, 0.0, 4.0), upright);
    let body = Ellipsoid::new(pose, Vector3::new(1.0, 1.0, 0.5));
    let lines = outline_in_image(&body, Outline::Cylinder, &view());
    let pixels = || lines.iter().flatten();
    // Rays touch the side where the ellipsoid's would; the nearest point of a rim is at 3 m.
    let right = pixels().map(|p| p.x).fold(f64::MIN, f64::max);
    assert!((right - (320.0 + 500.0 / 15.0_f64.sqrt())).abs() < 1.0, "{right}");
    let low = pixels().map(|p| p.y).fold(f64::MIN, f64::max);
    assert!((low - (240.0 + 500.0 * 0.5 / 3.0)).abs() < 1e-6, "{low}");
}

#[test]
fn covariances_are_turned_to_fixed_axes() {
    // Base turned left by a quarter: its x is the map's y.
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2);
    let pose = Pose::from_parts(Translation3::new(5.0, 0.0, 0.0), turned);
    let own = Matrix6::from_diagonal(&Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
    let fixed = pose_covariance(&pose, &own);
    let diagonal: Vec<f64> = (0..6).map(|i| fixed[i][i].round()).collect();
    assert_eq!(diagonal, [5.0, 4.0, 6.0, 2.0, 1.0, 3.0]);
}

#[test]
fn all_that_is_shown_of_an_object_is_deleted() {
    let markers = deletion_markers([ObjectId(7)], Stamp::from_secs(1.0), "map").markers;
    assert!(markers.iter().all(|m| m.action == Marker::DELETE && m.id == 7));
    let spaces: Vec<&str> = markers.iter().map(|m| m.ns.as_str()).collect();
    assert_eq!(spaces, ["objects", "labels", "cuboids"]);
}

#[test]
fn names_of_what_stands_on_a_desk_can_be_read_from_all_sides() {
    let bag = BagInput::open(Path::new("bags/desk.mcap"), &[]).unwrap();
    let mut slam = ObjectSlam::new(Settings::default());
    bag.inputs().for_each(|input| drop(slam.handle(input, &mut ())));
    slam.finish(&mut ());
    let shapes = ObjectShapes::default();
    let all = object_markers(slam.objects(), shapes, Stamp::from_secs(1.0), "map").markers;
    let names: Vec<&Marker> = all.iter().filter(|m| m.ns == "labels").collect();
    assert!(names.len() >= 8);
    for (name, object) in names.iter().zip(slam.objects()) {
        let body = object.ellipsoid();
        let above = name.pose.position.z - body.center().z - body.semi_axes.z;
        assert!((0.0..1.0).contains(&above), "{} is {above} m above its object", name.text);
    }
    // As the camera of config/ellipsoid_slam.rviz looks, which can be turned.
    let (sine, cosine) = 0.5_f64.sin_cos();
    let (mut pairs, mut covered) = (0, 0);
    for side in 0..72 {
        let (s, c) = (f64::from(side) * std::f64::consts::TAU / 72.0).sin_cos();
        let seen = |m: &Marker| {
            let p = &m.pose.position;
            (c * p.y - s * p.x, cosine * p.z + sine * (c * p.x + s * p.y))
        };
        for (at, a) in names.iter().enumerate() {
            for b in &names[at + 1..] {
                let ((ax, ay), (bx, by)) = (seen(a), seen(b));
                let letters = (a.text.len() + b.text.len()) as f64;
                let covers = (ax - bx).abs() < 0.45 * 0.5 * letters * a.scale.z
                    && (ay - by).abs() < 0.8 * a.scale.z;
                (pairs, covered) = (pairs + 1, covered + usize::from(covers));
            }
        }
    }
    println!("{covered} of {pairs} pairs of names cover each other");
    assert!(100 * covered < pairs, "{covered} of {pairs}");
}

#[test]
fn a_superquadric_is_marked_by_its_own_surface() {
    let half = Vector3::new(0.2, 0.1, 0.3);
    let pose = Pose::translation(1.0, 2.0, 0.3);
    let outline = Outline::Superquadric(0.5, 1.3);
    let body = Ellipsoid::new(pose, half);
    let marker = outlined("objects", outline, &body, ColorRGBA::default());
    assert_eq!((marker.kind, marker.scale.x, marker.scale.z), (Marker::TRIANGLE_LIST, 1.0, 1.0));
    assert_eq!(marker.pose.position.y, 2.0);
    let corners: Vec<Vector3<f64>> =
        marker.points.iter().map(|p| Vector3::new(p.x, p.y, p.z)).collect();
    assert!(corners.len() > 300 && corners.len().is_multiple_of(3));
    let mut volume = 0.0;
    for triangle in corners.as_chunks::<3>().0 {
        for corner in triangle {
            let radius = outline.radius(&corner.component_div(&half));
            assert!((radius - 1.0).abs() < 1e-9, "{corner} is not on the surface: {radius}");
        }
        // Counterclockwise from outside: the tetrahedra from the centre add up.
        let [a, b, c] = triangle;
        let part = a.dot(&b.cross(c)) / 6.0;
        assert!(part > 0.0, "a triangle looks inwards");
        volume += part;
    }
    // Between those of the body's rhombic bipyramid and its box.
    let of_box = 8.0 * half.product();
    assert!(volume > 0.3 * of_box && volume < 0.75 * of_box, "{}", volume / of_box);
    let table = outlined("objects", Outline::Cuboid, &body, ColorRGBA::default());
    assert_eq!((table.kind, table.points.len(), table.scale.x), (Marker::CUBE, 0, 0.4));
}

#[test]
fn layouts_show_topics_that_there_are() {
    let mut known: Vec<String> = OutputTopic::ALL.map(OutputTopic::default_name).to_vec();
    // Of result bags only.
    let of_results =
        ["debug_image/compressed", "image/compressed", "camera_info", "annotations", "points"];
    known.extend(of_results.map(|name| format!("/ellipsoid_slam/{name}")));
    for file in ["foxglove.json", "ellipsoid_slam.rviz"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("config").join(file);
        let text = fs::read_to_string(path).unwrap();
        let words = text.split(|c: char| !(c.is_alphanumeric() || "/_".contains(c)));
        let topics: Vec<&str> = words.filter(|word| word.starts_with("/ellipsoid_slam/")).collect();
        assert!(topics.len() >= 4, "{file}: {topics:?}");
        for topic in topics {
            assert!(known.iter().any(|name| name == topic), "{file}: nothing is on {topic}");
        }
    }
}

#[test]
fn a_question_about_the_view_needs_one() {
    let request = QueryObjectsRequest { in_view: true, ..QueryObjectsRequest::default() };
    let at = (Stamp::from_secs(1.0), "map");
    let map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let answer = query_objects(&request, &map, None, at);
    assert!(!answer.success && answer.message.contains("no view"), "{}", answer.message);
    let answer = query_objects(&request, &map, Some(&view()), at);
    assert!(answer.success && answer.ids.is_empty() && answer.header.frame_id == "map");
}

#[test]
fn topics_are_told_apart() {
    let mut names = OutputTopic::ALL.map(OutputTopic::default_name).to_vec();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), OutputTopic::ALL.len());
}

/// Two hours at 15 images a second, with turns, and thirty objects of which all change every second.
#[test]
fn a_long_drive_fits_into_a_small_bag() {
    const HOURS: f64 = 2.0;
    const MOST_BYTES: u64 = 100_000_000;
    let slam = ObjectSlam::new(Settings::default());
    let mut publication = Publication::new(&NodeSettings::default());
    let mut room = Room::default();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    let mut bag = BagWriter::create(&path).unwrap();
    let mut pose = Pose::identity();
    for frame in 0..(HOURS * 3600.0 * 15.0) as i64 {
        let turn = 0.05 * (frame as f64 / 40.0).sin();
        pose *= Pose::new(Vector3::new(0.4 / 15.0, 0.0, 0.0), Vector3::new(0.0, 0.0, turn));
        let stamp = Stamp::from_nanos(frame * 1_000_000_000 / 15);
        let start_from_odom = Pose::identity();
        let now = FramePose {
            stamp,
            map_from_base: pose,
            odom_from_base: pose,
            start_from_odom,
            keyframes: 0,
        };
        let update = Update { poses: vec![now], ..Update::default() };
        let mut out = publication.update(&update, &slam);
        if frame % 15 == 0 {
            out.push((stamp, Outgoing::Objects(restless_objects(30, frame))));
        }
        for (stamp, message) in out {
            let (type_name, data) = message.cdr().unwrap();
            if room.takes(message.topic(), data.len(), stamp) {
                bag.write_raw(&message.topic().default_name(), type_name, &data, stamp).unwrap();
            }
        }
    }
    bag.finish().unwrap();
    let bytes = path.metadata().unwrap().len();
    println!("{:.1} MB for {HOURS} hours", bytes as f64 / 1e6);
    assert!(bytes < MOST_BYTES, "{bytes}");
}

/// Objects of which no number is the same as in the frame before.
fn restless_objects(count: i64, frame: i64) -> ObjectArray {
    let number = |k: i64| ((frame * 7919 + k) as f64).sin();
    let object = |id: i64| {
        let mut object = ellipsoid_slam::msg::ellipsoid_slam::Object::default();
        object
            .covariance
            .as_flattened_mut()
            .iter_mut()
            .zip(id * 100..)
            .for_each(|(c, k)| *c = number(k));
        object
    };
    ObjectArray { objects: (0..count).map(object).collect(), ..ObjectArray::default() }
}

#[test]
fn a_short_drive_is_recorded_whole() {
    let mut room = Room::default();
    let kept = (0..300)
        .filter(|s| room.takes(OutputTopic::Markers, 10_000, Stamp::from_secs(f64::from(*s))));
    assert_eq!(kept.count(), 300);
    // A day of the same, by far too fast.
    let late = |s: i32| Stamp::from_secs(300.0 + f64::from(s) / 10.0);
    let kept = (0..864_000).filter(|s| room.takes(OutputTopic::Markers, 10_000, late(*s))).count();
    assert!((30_000..40_000).contains(&kept), "{kept}");
    assert!(
        room.takes(OutputTopic::Odometry, 1_000_000_000, late(0)),
        "streams are recorded whole"
    );
}
