//! Ground truth files.

use ellipsoid_slam::eval::GroundTruth;
use serde_json::{Value, json};

fn file() -> Value {
    json!({"frame_id": "map", "surveyor": "unknown fields are passed over", "objects": [
        {"id": 7, "label": "chair", "position": [1.0, -2.0, 0.5], "orientation": [0.0, 0.0, 0.6, 0.8],
         "size": [0.5, 0.4, 0.9], "observations": 100},
        {"id": 0, "label": "dining table", "position": [0.0, 0.0, 0.4], "orientation": [0.0, 0.0, 0.0, 1.0],
         "size": [1.8, 0.9, 0.7], "observations": 4},
    ]})
}

#[test]
fn a_file_is_read_and_written() {
    let truth = GroundTruth::from_json(&file().to_string()).unwrap();
    let chair = &truth.objects[0];
    assert_eq!((truth.frame_id.as_str(), chair.id, chair.label.as_str()), ("map", 7, "chair"));
    assert_eq!(chair.oriented_box().half_extents, nalgebra::Vector3::new(0.25, 0.2, 0.45));
    // A quaternion (0, 0, 0.6, 0.8) turns counter-clockwise by 2 atan(0.6 / 0.8).
    let yaw = ellipsoid_slam::geometry::yaw_of(&chair.pose);
    assert!((yaw - 2.0 * 0.75f64.atan()).abs() < 1e-12, "{yaw}");
    let again = GroundTruth::from_json(&truth.to_json().unwrap()).unwrap();
    assert_eq!(again, truth);
}

#[test]
fn what_cannot_be_is_refused_in_a_sentence() {
    let cases: [(&str, Value, &str); 7] = [
        ("/objects/0/size", json!([0.5, 0.0, 0.9]), "object 7: the size is not positive"),
        ("/objects/0/orientation", json!([0.0, 0.0, 0.0, 0.0]), "object 7: the pose"),
        ("/objects/0/position", json!([1.0, 2.0]), "not a ground truth file"),
        ("/objects/0/label", json!(""), "object 7: the label is empty"),
        ("/objects/1/id", json!(7), "two objects have the id 7"),
        ("/objects/0/observations", json!(-1), "not a ground truth file"),
        ("/frame_id", json!(null), "not a ground truth file"),
    ];
    for (pointer, value, expected) in cases {
        let mut broken = file();
        *broken.pointer_mut(pointer).unwrap() = value;
        let says = GroundTruth::from_json(&broken.to_string()).unwrap_err().to_string();
        assert!(says.starts_with(expected) && !says.contains('\n'), "{pointer}: {says}");
    }
    assert!(GroundTruth::from_json("").is_err());
}
