//! Map files.

use ellipsoid_slam::{geometry::Outline, io::read_map, time::Stamp};
use serde_json::{Value, json};

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

#[test]
fn what_cannot_be_is_refused_in_a_sentence() {
    let mut asymmetric = covariance();
    asymmetric[1] += 0.005;
    let mut indefinite = covariance();
    (indefinite[1], indefinite[9]) = (0.5, 0.5);
    let cases: [(&str, Value, &str); 16] = [
        ("/version", json!(2), "the map has version 2, this program reads version 1"),
        ("/objects/1/id", json!(3), "two objects have the id 3"),
        ("/objects/1/label", json!(""), "object 5: label"),
        ("/objects/1/labels", json!({"chair": 1.2}), "object 5: labels"),
        ("/objects/1/existence", json!(-0.1), "object 5: existence"),
        ("/objects/1/observations", json!(-1), "not a map file"),
        ("/objects/1/first_seen", json!(1_800_000_000.0), "object 5: first_seen"),
        ("/objects/1/position", json!([1.0, 2.0]), "not a map file"),
        ("/objects/1/orientation", json!([0.0, 0.0, 0.0, 0.9]), "object 5: orientation"),
        ("/objects/1/semi_axes", json!([0.3, -0.2, 0.5]), "object 5: semi_axes"),
        ("/objects/1/outline", json!({"superquadric": [0.0, 1.0]}), "object 5: outline"),
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
