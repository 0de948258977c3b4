//! Wire types against the `.msg` and `.srv` files they mirror.

use ellipsoid_slam::msg::{
    Message, Service, cdr, diagnostic_msgs, ellipsoid_slam as own, foxglove_msgs, geometry_msgs,
    lifecycle_msgs, nav_msgs, rosgraph_msgs, rtabmap_msgs, schema_text, sensor_msgs, std_msgs,
    std_srvs, tf2_msgs, vision_msgs, visualization_msgs, yolo_msgs,
};
use serde::{Deserialize, Deserializer, de};
use std::fs;

/// Takes note of the names of a struct's fields, in order, and reads nothing.
struct FieldNames<'a>(&'a mut Vec<&'static str>);

impl<'de> Deserializer<'de> for FieldNames<'_> {
    type Error = de::value::Error;

    fn deserialize_any<V: de::Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
        Err(de::Error::custom("not a struct"))
    }

    fn deserialize_struct<V: de::Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Self::Error> {
        self.0.extend(fields);
        Err(de::Error::custom("seen enough"))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

fn fields_of<T: for<'de> Deserialize<'de>>() -> Vec<&'static str> {
    let mut names = Vec::new();
    let _ = T::deserialize(FieldNames(&mut names));
    names
}

/// Names of the fields of a definition; constants and comments are none.
fn defined(text: &str) -> Vec<&str> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap());
    let fields = lines.filter(|line| !line.contains('='));
    fields.filter_map(|line| line.split_whitespace().nth(1)).collect()
}

fn mirrors<T: Message>() {
    let text = schema_text(T::TYPE).unwrap_or_else(|| panic!("{} has no definition", T::TYPE));
    let own = text.split("\n====").next().unwrap();
    assert_eq!(fields_of::<T>(), defined(own), "{}", T::TYPE);
}

#[test]
fn structs_mirror_their_definitions_field_by_field() {
    macro_rules! check {
        ($($package:ident: $($name:ident)+;)+) => { $($(mirrors::<$package::$name>();)+)+ };
    }
    check! {
        own: LabelBelief Object ObjectArray EllipsoidMeasurement EllipsoidMeasurementArray;
        foxglove_msgs: Color Point2 CircleAnnotation PointsAnnotation TextAnnotation ImageAnnotations;
        diagnostic_msgs: KeyValue DiagnosticStatus DiagnosticArray;
        lifecycle_msgs: State Transition TransitionDescription TransitionEvent;
        rosgraph_msgs: Clock;
        rtabmap_msgs: LandmarkDetection LandmarkDetections;
        yolo_msgs: Point2D Vector2 Pose2D BoundingBox2D BoundingBox3D Mask KeyPoint2D KeyPoint2DArray
            KeyPoint3D KeyPoint3DArray Detection DetectionArray;
        std_msgs: Header ColorRGBA;
        geometry_msgs: Point Vector3 Quaternion Pose PoseStamped PoseWithCovariance
            PoseWithCovarianceStamped Twist
            TwistWithCovariance Transform TransformStamped;
        sensor_msgs: Image CompressedImage RegionOfInterest CameraInfo PointField PointCloud2;
        nav_msgs: MapMetaData OccupancyGrid Odometry Path;
        tf2_msgs: TFMessage;
        vision_msgs: Point2D Pose2D BoundingBox2D BoundingBox3D ObjectHypothesis ObjectHypothesisWithPose
            Detection2D Detection2DArray Detection3D Detection3DArray;
        visualization_msgs: UVCoordinate MeshFile Marker MarkerArray;
    }
}

#[test]
fn services_mirror_their_definitions_field_by_field() {
    fn check<S: Service>(text: &str) {
        let (request, response) = text.split_once("---").unwrap();
        assert_eq!(fields_of::<S::Request>(), defined(request), "{}", S::TYPE);
        assert_eq!(fields_of::<S::Response>(), defined(response), "{}", S::TYPE);
    }
    fn read<S: Service>() -> String {
        let name = S::TYPE.rsplit('/').next().unwrap();
        let path = format!("{}/srv/{name}.srv", env!("CARGO_MANIFEST_DIR"));
        fs::read_to_string(path).unwrap()
    }
    check::<own::SaveMap>(&read::<own::SaveMap>());
    check::<own::LoadMap>(&read::<own::LoadMap>());
    check::<own::QueryObjects>(&read::<own::QueryObjects>());
    check::<own::ApproachObject>(&read::<own::ApproachObject>());
    check::<own::RenameObject>(&read::<own::RenameObject>());
    check::<own::DeleteObject>(&read::<own::DeleteObject>());
    check::<own::LockObject>(&read::<own::LockObject>());
    check::<own::AddObject>(&read::<own::AddObject>());
    check::<std_srvs::SetBool>("bool data\n---\nbool success\nstring message\n");
    // What the generators make of a request without fields.
    let request = "uint8 structure_needs_at_least_one_member";
    check::<lifecycle_msgs::ChangeState>("Transition transition\n---\nbool success\n");
    check::<lifecycle_msgs::GetState>(&format!("{request}\n---\nState current_state\n"));
    check::<lifecycle_msgs::GetAvailableStates>(&format!(
        "{request}\n---\nState[] available_states\n"
    ));
    check::<lifecycle_msgs::GetAvailableTransitions>(&format!(
        "{request}\n---\nTransitionDescription[] available_transitions\n"
    ));
    check::<std_srvs::Trigger>(&format!("{request}\n---\nbool success\nstring message\n"));
}

#[test]
fn an_object_is_laid_out_as_its_definition_says() {
    let (label, name) = ("cup".to_owned(), "mug".to_owned());
    let mut object = own::Object { id: 7, label, name, locked: true, ..own::Object::default() };
    (object.observations, object.outline, object.support_height) = (3, own::Object::CYLINDER, 0.75);
    object.covariance[0][1] = 0.5;
    let bytes = cdr::encode(&object).unwrap();
    // id 8, label 4 + 4, name 4 + 4, locked 1, padding 3, labels 4, existence 8, observations 4, times 16, padding 4, pose 56, semi-axes 24.
    let covariance = 4 + 8 + 8 + 8 + 4 + 4 + 8 + 4 + 16 + 4 + 56 + 24;
    assert_eq!(bytes[covariance + 8..covariance + 16], 0.5_f64.to_le_bytes());
    let outline = covariance + 81 * 8;
    assert_eq!(bytes[outline], own::Object::CYLINDER);
    assert_eq!(bytes.len(), outline + 8 + 3 * 8);
    assert_eq!(bytes[bytes.len() - 8..], 0.75_f64.to_le_bytes());
    assert_eq!(cdr::decode::<own::Object>(&bytes).unwrap(), object);
}
