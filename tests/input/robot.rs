//! What a robot gets of the map: a costmap, frames and places before objects.

use ellipsoid_slam::{
    config::{GroundSettings, NodeSettings},
    geometry::{Outline, Pose},
    io::{map_json, read_map},
    mapping::{Edit, NewObject, ObjectId, SavedMap},
    msg::{cdr, ellipsoid_slam::ApproachObjectRequest, nav_msgs::OccupancyGrid},
    pipeline::{FramePose, ObjectSlam, Settings, Update},
    publication::{Outgoing, Publication, Whereabouts, approach_object},
    time::Stamp,
};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

const NOW: Stamp = Stamp::from_nanos(1_000_000_000);

/// A map made by hand: label, centre, heading (rad), size.
fn made_of(things: &[(&str, [f64; 3], f64, [f64; 3])]) -> ObjectSlam {
    let mut slam = ObjectSlam::new(Settings::default());
    for described in things {
        slam.edit(&Edit::Add(thing(described)), NOW).unwrap();
    }
    slam
}

fn thing((label, at, yaw, size): &(&str, [f64; 3], f64, [f64; 3])) -> NewObject {
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, *yaw);
    NewObject {
        label: (*label).into(),
        pose: Pose::from_parts(Translation3::from(*at), turned),
        size_m: Vector3::from(*size),
        outline: Outline::Cuboid,
        locked: false,
    }
}

/// A table that is turned to the left, and a lamp over it.
const TABLE: (&str, [f64; 3], f64, [f64; 3]) =
    ("dining table", [-2.0, 5.0, 0.4], 0.5, [1.6, 0.4, 0.8]);
const LAMP: (&str, [f64; 3], f64, [f64; 3]) = ("lamp", [2.0, 5.0, 2.0], 0.0, [0.4, 0.4, 0.4]);

fn settings() -> NodeSettings {
    let mut settings = NodeSettings::default();
    (settings.publish.costmap, settings.publish.object_frames) = (true, true);
    settings
}

fn costmaps(messages: &[(Stamp, Outgoing)]) -> Vec<&OccupancyGrid> {
    let costmap = |message: &'_ Outgoing| match message {
        Outgoing::Costmap(grid) => Some(std::ptr::from_ref(grid)),
        _ => None,
    };
    let all = messages.iter().filter(|(_, message)| costmap(message).is_some());
    all.map(|(_, m)| if let Outgoing::Costmap(grid) = m { grid } else { unreachable!() }).collect()
}

/// The value of the cell at a place, as readers compute it.
fn at(grid: &OccupancyGrid, x: f64, y: f64) -> i8 {
    let (origin, cell) = (&grid.info.origin.position, f64::from(grid.info.resolution));
    let (column, row) = (((x - origin.x) / cell).floor(), ((y - origin.y) / cell).floor());
    grid.data[row as usize * grid.info.width as usize + column as usize]
}

#[test]
fn the_costmap_has_the_footprints_where_they_are_and_nothing_of_what_one_passes_under() {
    let slam = made_of(&[TABLE, LAMP]);
    let out = Publication::new(&settings()).edited(NOW, &slam);
    let [grid] = costmaps(&out)[..] else { panic!("one costmap") };
    assert_eq!((grid.header.frame_id.as_str(), grid.info.resolution), ("map", 0.05));
    assert_eq!(grid.data.len(), (grid.info.width * grid.info.height) as usize);
    let (sin, cos) = 0.5_f64.sin_cos();
    assert_eq!(at(grid, -2.0 + 0.75 * cos, 5.0 + 0.75 * sin), OccupancyGrid::OCCUPIED);
    assert_eq!(at(grid, -2.0 + 0.75 * cos, 5.0 - 0.75 * sin), OccupancyGrid::UNKNOWN);
    // Nothing reaches to the lamp.
    assert!(grid.info.origin.position.x + f64::from(grid.info.width) * 0.05 < 0.0);
    let again: OccupancyGrid = cdr::decode(&cdr::encode(grid).unwrap()).unwrap();
    assert_eq!(&again, grid);

    let wide =
        GroundSettings { inflation_m: 0.3, robot_height_m: 3.0, ..GroundSettings::default() };
    let out = Publication::new(&NodeSettings { ground: wide, ..settings() }).edited(NOW, &slam);
    let grid = costmaps(&out)[0];
    assert_eq!(at(grid, -2.0 + 1.05 * cos, 5.0 + 1.05 * sin), OccupancyGrid::OCCUPIED);
    assert_eq!(at(grid, 2.0, 5.0), OccupancyGrid::OCCUPIED);
}

#[test]
fn a_costmap_comes_once_a_second_at_most_and_only_when_it_is_another_one() {
    let mut slam = made_of(&[TABLE]);
    let mut publication = Publication::new(&settings());
    let mut after = |slam: &ObjectSlam, seconds: f64| {
        let pose = FramePose {
            stamp: Stamp::from_secs(seconds),
            map_from_base: Pose::identity(),
            odom_from_base: Pose::identity(),
            start_from_odom: Pose::identity(),
            keyframes: 0,
        };
        publication.change_settings(&settings());
        let update = Update { poses: vec![pose], ..Update::default() };
        costmaps(&publication.update(&update, slam)).len()
    };
    assert_eq!([after(&slam, 1.0), after(&slam, 1.5), after(&slam, 9.0)], [1, 0, 0]);
    slam.edit(&Edit::Delete(ObjectId(1)), NOW).unwrap();
    assert_eq!(after(&slam, 9.5), 1);
    // Within a second of that there is a table again: it comes when the second is over.
    slam.edit(&Edit::Add(thing(&TABLE)), NOW).unwrap();
    assert_eq!([after(&slam, 9.9), after(&slam, 10.6), after(&slam, 12.0)], [0, 1, 0]);
    let out = Publication::new(&NodeSettings::default()).edited(NOW, &slam);
    assert!(costmaps(&out).is_empty(), "it is off where nobody asks for it");
}

#[test]
fn each_object_has_a_frame_and_named_ones_have_another() {
    let mut slam = made_of(&[TABLE, LAMP, LAMP]);
    for (id, name) in [(1, "Anna's desk"), (2, "7"), (3, "Anna's desk")] {
        slam.edit(&Edit::Rename(ObjectId(id), name.into()), NOW).unwrap();
    }
    let out = Publication::new(&settings()).edited(NOW, &slam);
    let frames = out.iter().find_map(|(_, message)| match message {
        Outgoing::ObjectFrames(message) => Some(&message.transforms),
        _ => None,
    });
    let frames = frames.unwrap();
    let names: Vec<&str> = frames.iter().map(|frame| frame.child_frame_id.as_str()).collect();
    assert_eq!(names, ["object_1", "object_Anna_s_desk", "object_2", "object_3"]);
    assert!(frames.iter().all(|frame| frame.header.frame_id == "map"));
    let at = &frames[0].transform;
    assert!((at.translation.x + 2.0).abs() < 1e-6 && (at.translation.y - 5.0).abs() < 1e-6);
    assert!((at.rotation.z - 0.25_f64.sin()).abs() < 1e-6, "{:?}", at.rotation);
}

#[test]
fn a_client_is_told_where_to_send_the_robot_or_why_not() {
    let near = ("chair", [2.0, 0.0, 0.45], 0.0, [0.5, 0.5, 0.9]);
    let far = ("chair", [-6.0, 0.0, 0.45], 0.0, [0.5, 0.5, 0.9]);
    let slam = made_of(&[far, TABLE, near]);
    let objects: Vec<_> = slam.objects().cloned().collect();
    let ask = |id: u64, label: &str, distance: f64, base: Option<Pose>| {
        let request = ApproachObjectRequest { id, label: label.into(), distance };
        let whereabouts = Whereabouts { base, walls: Vec::new() };
        let ground = GroundSettings::default();
        approach_object(&request, &objects, &whereabouts, &ground, (NOW, "map"))
    };
    let here = Some(Pose::identity());
    let nearest = ask(0, "chair", 0.0, here);
    assert_eq!(
        (nearest.success, nearest.id, nearest.pose.header.frame_id.as_str()),
        (true, 3, "map")
    );
    let position = nearest.pose.pose.position;
    // 0.6 m before its side at 1.75, which it looks at.
    assert!((position.x - 1.15).abs() < 0.01 && position.y.abs() < 0.05, "{position:?}");
    assert!(nearest.pose.pose.orientation.w > 0.99);
    assert_eq!(ask(1, "", 1.0, here).id, 1);
    for (response, words) in [
        (ask(0, "unicorn", 0.0, here), "there is chair, dining table"),
        (ask(0, "", 0.0, here), "an id or a label"),
        (ask(77, "", 0.0, here), "no object 77"),
        (ask(0, "chair", f64::NAN, here), "NaN"),
        (ask(0, "chair", 0.0, None), "where the robot is"),
    ] {
        assert!(!response.success && response.message.contains(words), "{}", response.message);
    }
}

#[test]
fn names_and_locks_are_in_the_map_file_and_files_without_them_still_read() {
    let mut slam = made_of(&[TABLE, LAMP]);
    let plain = map_json(&SavedMap::of(slam.objects(), "map")).unwrap();
    assert!(!plain.contains("\"name\"") && !plain.contains("locked"), "{plain}");
    assert!(read_map(&plain).unwrap().objects.iter().all(|o| o.name.is_none() && !o.locked));
    slam.edit(&Edit::Rename(ObjectId(1), "desk".into()), NOW).unwrap();
    slam.edit(&Edit::Lock(ObjectId(1), true), NOW).unwrap();
    let text = map_json(&SavedMap::of(slam.objects(), "map")).unwrap();
    let read = read_map(&text).unwrap();
    assert_eq!((read.objects[0].name.as_deref(), read.objects[0].locked), (Some("desk"), true));
    let why = read_map(&text.replace("\"desk\"", "\"\"")).unwrap_err().to_string();
    assert!(why.contains("object 1: name"), "{why}");
    let next = ObjectSlam::continuing(Settings::default(), read.clone(), Some(Pose::identity()));
    assert_eq!(next.maps("map").map, read);
}
