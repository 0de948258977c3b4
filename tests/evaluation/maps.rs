//! Map files.

use ellipsoid_slam::{
    geometry::Outline,
    io::{load_saved_map, map_json, read_map, save_map},
    time::Stamp,
};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::{fs, time::Instant};

fn covariance() -> Vec<f64> {
    let at =
        |i: usize, j: usize| if i == j { 0.01 * (i + 1) as f64 } else { 0.0001 * (i + j) as f64 };
    (0..81).map(|k| at(k / 9, k % 9)).collect()
}

fn object(id: u64) -> Value {
    json!({"id": id, "label": "chair", "labels": {"chair": 0.93, "couch": 0.07}, "existence": 0.98,
        "observations": 31, "first_seen": 1_700_000_000.25, "last_seen": 1_700_000_009.5,
        "position": [1.0, 2.0, 0.5], "orientation": [0.0, 0.0, 0.6, 0.8], "semi_axes": [0.3, 0.2, 0.5],
        "outline": {"superquadric": [0.4, 1.0]}, "support_height": null, "covariance": covariance(),
        "colour": "unknown fields are passed over"})
}

fn file() -> Value {
    json!({"version": 1, "frame_id": "map", "objects": [object(3), object(5)]})
}

#[test]
fn every_field_is_read() {
    let map = read_map(&file().to_string()).unwrap();
    assert_eq!((map.frame_id.as_str(), map.objects.len()), ("map", 2));
    let chair = &map.objects[1];
    assert_eq!((chair.id, chair.label.as_str(), chair.observations), (5, "chair", 31));
    assert_eq!(
        (chair.existence, chair.labels["couch"], chair.support_height_m),
        (0.98, 0.07, None)
    );
    // Seconds in a double are good to a fraction of a microsecond.
    let expected = Stamp::from_nanos(1_700_000_000_250_000_000);
    assert!(chair.first_seen.seconds_since(expected).abs() < 1e-6);
    assert_eq!(chair.outline, Outline::Superquadric(0.4, 1.0));
    assert_eq!(chair.ellipsoid.semi_axes, nalgebra::Vector3::new(0.3, 0.2, 0.5));
    let yaw = ellipsoid_slam::geometry::yaw_of(&chair.ellipsoid.pose);
    assert!((yaw - 2.0 * 0.75f64.atan()).abs() < 1e-12, "{yaw}");
    assert_eq!((chair.covariance[(2, 3)], chair.covariance[(8, 8)]), (0.0005, 0.09));
}

/// Whatever a class can have in the settings, a map with such an object can be read again.
#[test]
fn outlines_of_all_classes_are_read() {
    for (label, prior) in &ellipsoid_slam::perception::Classes::default().listed {
        let mut map = file();
        map["objects"][1]["outline"] = serde_json::to_value(prior.outline).unwrap();
        assert_eq!(
            read_map(&map.to_string()).unwrap().objects[1].outline,
            prior.outline,
            "{label}"
        );
    }
}

#[test]
fn what_cannot_be_is_refused_in_a_sentence() {
    let mut asymmetric = covariance();
    asymmetric[1] += 0.005;
    let mut indefinite = covariance();
    (indefinite[1], indefinite[9]) = (0.5, 0.5);
    let cases: [(&str, Value, &str); 23] = [
        ("/version", json!(2), "the map has version 2, this program reads version 1"),
        ("/objects/1/id", json!(3), "two objects have the id 3"),
        ("/objects/1/label", json!(""), "object 5: label"),
        ("/objects/1/labels", json!({"chair": 1.2}), "object 5: labels"),
        ("/objects/1/labels", json!({}), "object 5: labels"),
        ("/objects/1/labels", json!({"couch": 1.0}), "object 5: labels"),
        ("/objects/1/position", json!([1e300, 0.0, 0.0]), "object 5: position"),
        ("/objects/1/semi_axes", json!([0.3, 1e30, 0.5]), "object 5: semi_axes"),
        ("/version", json!(-1), "not a map file"),
        ("/objects/1/existence", json!(-0.1), "object 5: existence"),
        ("/objects/1/observations", json!(-1), "not a map file"),
        ("/objects/1/first_seen", json!(1_800_000_000.0), "object 5: first_seen"),
        ("/objects/1/position", json!([1.0, 2.0]), "not a map file"),
        ("/objects/1/orientation", json!([0.0, 0.0, 0.0, 0.9]), "object 5: orientation"),
        ("/objects/1/semi_axes", json!([0.3, -0.2, 0.5]), "object 5: semi_axes"),
        ("/objects/1/outline", json!({"superquadric": [0.0, 1.0]}), "object 5: outline"),
        ("/objects/1/outline", json!({"superquadric": [1.5, 1.0]}), "object 5: outline"),
        ("/objects/1/outline", json!({"superquadric": [0.5, 2.0]}), "object 5: outline"),
        ("/objects/1/outline", json!("cone"), "not a map file"),
        ("/objects/1/support_height", json!("low"), "not a map file"),
        ("/objects/1/covariance", json!([1.0, 2.0]), "object 5: covariance"),
        ("/objects/1/covariance", json!(asymmetric), "object 5: covariance"),
        ("/objects/1/covariance", json!(indefinite), "object 5: covariance"),
    ];
    for (pointer, value, expected) in cases {
        let mut broken = file();
        *broken.pointer_mut(pointer).unwrap() = value;
        let says = read_map(&broken.to_string()).unwrap_err().to_string();
        assert!(says.starts_with(expected) && !says.contains('\n'), "{pointer}: {says}");
    }
    for missing in object(3).as_object().unwrap().keys().filter(|key| *key != "colour") {
        let mut broken = file();
        broken["objects"][0].as_object_mut().unwrap().remove(missing);
        let is_optional = missing == "support_height";
        assert_eq!(read_map(&broken.to_string()).is_ok(), is_optional, "without {missing}");
    }
}

#[test]
fn what_is_saved_is_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let map = read_map(&file().to_string()).unwrap();
    save_map(&path, &map).unwrap();
    let loaded = load_saved_map(&path).unwrap();
    let text = |map| map_json(map).unwrap();
    assert_eq!(text(&loaded), text(&map));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
}

/// Doubles of 17 digits, and what their reading is off by where it is done in doubles.
#[test]
fn a_map_that_is_read_and_written_has_the_same_bytes() {
    let mut map = file();
    for (at, existence) in [0.9933071490757153, 0.9820137900379085].into_iter().enumerate() {
        map["objects"][at]["existence"] = json!(existence);
        map["objects"][at]["position"] =
            json!([0.002741609664808939, -0.002493845714016407, 0.37445646833822366]);
    }
    let text = map_json(&read_map(&map.to_string()).unwrap()).unwrap();
    assert!(text.contains("0.9933071490757153") && text.contains("0.9820137900379085"));
    assert_eq!(map_json(&read_map(&text).unwrap()).unwrap(), text);
}

#[test]
fn texts_that_are_no_map_are_refused_in_a_sentence() {
    let whole = file().to_string();
    let mut texts = vec![
        String::new(),
        "null".into(),
        "[]".into(),
        "\u{0}".into(),
        whole.replace("0.98", "NaN"),
        whole.replace("0.98", "1e999"),
        whole[..whole.len() / 2].to_owned(),
        format!("{whole}{whole}"),
        "[".repeat(1_000_000),
        format!("{{\"version\":1,\"x\":{}", "{\"a\":".repeat(100_000)),
        // It claims more than there is.
        whole.replace("\"id\":3", "\"id\":99999999999999999999999"),
    ];
    texts.push(whole.replace("\"version\":1", "\"version\":4294967297"));
    for text in texts {
        let says = read_map(&text).unwrap_err().to_string();
        let start: String = text.chars().take(40).collect();
        assert!(!says.contains('\n') && says.len() < 300, "{start}: {says}");
    }
}

#[test]
fn a_file_of_four_gigabytes_is_not_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    // Sparse: it takes no room on the disk.
    fs::File::create(&path).unwrap().set_len(4 << 30).unwrap();
    let says = load_saved_map(&path).unwrap_err().to_string();
    assert!(says.contains("larger than"), "{says}");
    let nowhere = load_saved_map(&folder.path().join("none.json")).unwrap_err().to_string();
    assert!(nowhere.starts_with("the map cannot be read"), "{nowhere}");
}

#[test]
#[expect(clippy::disallowed_methods, reason = "the time is what is measured")]
fn ten_thousand_objects_are_loaded_in_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let objects: Vec<Value> = (1..=10_000).map(object).collect();
    fs::write(&path, json!({"version": 1, "frame_id": "map", "objects": objects}).to_string())
        .unwrap();
    let start = Instant::now();
    let map = load_saved_map(&path).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    println!("{} objects in {seconds:.3} s", map.objects.len());
    assert_eq!(map.objects.len(), 10_000);
    assert!(seconds < 1.0, "{seconds} s");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Whatever bytes change, it is a map or a sentence, never a panic; and what is read can be written and read again.
    #[test]
    fn damaged_files_are_maps_or_refused(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        is_cut in proptest::bool::weighted(0.2),
    ) {
        let mut bytes = file().to_string().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let text = String::from_utf8_lossy(&bytes);
        match read_map(&text) {
            Ok(map) => {
                let again = read_map(&map_json(&map).unwrap()).unwrap();
                prop_assert_eq!(again.objects.len(), map.objects.len());
            }
            Err(why) => prop_assert!(!why.to_string().contains('\n'), "{}", why),
        }
    }

    /// Any number in place of any other.
    #[test]
    fn any_number_is_taken_or_refused(
        field in prop::sample::select(vec!["id", "existence", "observations", "first_seen", "last_seen",
            "position/0", "orientation/2", "semi_axes/1", "support_height", "covariance/0", "covariance/40", "covariance/7"]),
        number in prop_oneof![any::<f64>(), -10.0..10.0, Just(0.0), Just(-1.0), Just(1e308)],
    ) {
        let mut broken = file();
        *broken.pointer_mut(&format!("/objects/0/{field}")).unwrap() = json!(number);
        match read_map(&broken.to_string()) {
            Ok(map) => prop_assert!(map.objects[0].covariance.cholesky().is_some()),
            Err(why) => prop_assert!(!why.to_string().contains('\n'), "{}", why),
        }
    }
}

/// What is saved can be loaded: a map that cannot is refused before anything is written.
#[test]
fn what_cannot_be_loaded_is_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let good = read_map(&file().to_string()).unwrap();
    save_map(&path, &good).unwrap();
    let bytes = fs::read(&path).unwrap();
    let with = |change: fn(&mut ellipsoid_slam::mapping::SavedObject)| {
        let mut bad = good.clone();
        change(&mut bad.objects[1]);
        save_map(&path, &bad).unwrap_err().to_string()
    };
    let says = with(|o| o.ellipsoid.pose.translation.vector.x = 2e8);
    assert_eq!(says, "object 5: position has to be within 100,000 km");
    let says = with(|o| o.outline = Outline::Superquadric(0.5, 2.0));
    assert!(says.starts_with("object 5: outline has to"), "{says}");
    let says = with(|o| o.covariance[(4, 4)] = f64::NAN);
    assert!(says.starts_with("object 5: covariance has to"), "{says}");
    let says = with(|o| o.id = 3);
    assert_eq!(says, "two objects have the id 3");
    assert_eq!(fs::read(&path).unwrap(), bytes, "the old map is still there");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
}

/// Eastings and northings of UTM (m) are places like others.
#[test]
fn a_map_in_utm_coordinates_is_saved_and_loaded() {
    let mut map = read_map(&file().to_string()).unwrap();
    map.objects[0].ellipsoid.pose.translation.vector = nalgebra::Vector3::new(5e5, 9.9e6, 112.25);
    let again = read_map(&map_json(&map).unwrap()).unwrap();
    assert_eq!(again.objects[0].ellipsoid.center(), map.objects[0].ellipsoid.center());
}

/// Devices and pipes, and what links point to, stay as they are, and nobody waits for them.
#[test]
#[cfg(unix)]
fn maps_are_regular_files() {
    let folder = tempfile::tempdir().unwrap();
    let map = read_map(&file().to_string()).unwrap();
    let [pipe, link, target] = ["pipe", "link", "target"].map(|name| folder.path().join(name));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    fs::write(&target, "precious").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    let refused = "it is no regular file, and maps are; of a link, give what it points to";
    for path in [&pipe, &link, &folder.path().to_owned()] {
        assert_eq!(save_map(path, &map).unwrap_err().to_string(), refused);
        assert_eq!(load_saved_map(path).unwrap_err().to_string(), refused);
    }
    let kept = save_map(&target, &map).unwrap_err().to_string();
    assert_eq!(kept, "the file that is there is no map of this version: it is not overwritten");
    assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}

/// The tables of the documentation have the fields of a map file, and no others.
#[test]
fn every_field_is_documented() {
    let mut map = read_map(&file().to_string()).unwrap();
    // What is left out where nobody gave it.
    map.objects[0].name = Some("Grandmother's cupboard".into());
    map.objects[0].locked = true;
    let written: Value = serde_json::from_str(&map_json(&map).unwrap()).unwrap();
    let of_file = written.as_object().unwrap().keys();
    let of_object = written["objects"][0].as_object().unwrap().keys();
    let mut fields: Vec<&str> = of_file.chain(of_object).map(String::as_str).collect();
    let path = format!("{}/docs/map-file.md", env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(path).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.trim_start_matches("| ").split(" | ").next());
    let mut named: Vec<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    fields.sort_unstable();
    named.sort_unstable();
    assert_eq!(named, fields);
}
