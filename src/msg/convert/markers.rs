//! Objects and measurements as shapes for RViz and Foxglove.

use super::{header, pose_message, surface::superquadric_triangles};
use crate::{
    geometry::{Ellipsoid, Outline, Plane, Pose},
    mapping::{MapObject, ObjectId},
    msg::{
        coco::NAMES,
        geometry_msgs::Vector3,
        std_msgs::ColorRGBA,
        visualization_msgs::{Marker, MarkerArray},
    },
    perception::{EllipsoidMeasurement, WallSegment},
    pipeline::Keyframe,
    time::Stamp,
};
use nalgebra::{Point3, Translation3, UnitQuaternion};
use std::f64::consts::PI;

/// How objects are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjectShapes {
    /// As ellipsoids, as the paper draws them, and not as their outlines.
    pub ellipsoids: bool,
    /// The box round each, too.
    pub cuboids: bool,
}

/// A shape for each object and a text above it, in the frame of the map; on demand the box round it. Superquadrics, which
/// viewers have no shape for, are triangles.
///
/// Ids are the objects' own, in the namespaces `objects`, `labels` and `cuboids`.
pub fn object_markers<'a>(
    objects: impl IntoIterator<Item = &'a MapObject>,
    shapes: ObjectShapes,
    stamp: Stamp,
    frame_id: &str,
) -> MarkerArray {
    let mut markers = Vec::new();
    let mut names: Vec<Name> = Vec::new();
    for object in objects {
        let ellipsoid = object.ellipsoid();
        let color = color_of(object.label());
        let outline = if shapes.ellipsoids { Outline::Ellipsoid } else { object.outline };
        let body = Marker {
            header: header(stamp, frame_id),
            id: marker_id(object.id),
            ..outlined("objects", outline, &ellipsoid, with_alpha(color, 0.6))
        };
        if shapes.cuboids {
            let shape = solid("cuboids", Marker::CUBE, &ellipsoid, with_alpha(color, 0.25));
            markers.push(Marker { header: body.header.clone(), id: body.id, ..shape });
        }
        let text = format!("{} {}", object.name(), object.id);
        let name = Name::above(&ellipsoid, &text, &names);
        let mut above = body.pose;
        above.position.z = name.at.z;
        names.push(name);
        markers.push(Marker {
            ns: "labels".into(),
            kind: Marker::TEXT_VIEW_FACING,
            pose: above,
            scale: Vector3 { x: 0.0, y: 0.0, z: TEXT_HEIGHT_M },
            color: ColorRGBA { r: 1.0, g: 1.0, b: 1.0, a: 1.0 },
            text,
            points: Vec::new(),
            ..body.clone()
        });
        markers.push(body);
    }
    MarkerArray { markers }
}

/// Where a text is.
struct Name {
    at: Point3<f64>,
    half_width_m: f64,
}

impl Name {
    /// Above a body, as low as it covers no other text or, where many things stand close, the fewest.
    fn above(body: &Ellipsoid, text: &str, others: &[Name]) -> Self {
        let half_width_m = 0.5 * LETTER_WIDTH * TEXT_HEIGHT_M * text.chars().count() as f64;
        let center = body.center();
        let lowest_m = center.z + body.semi_axes.z + 0.6 * TEXT_HEIGHT_M;
        let raised = |steps: usize| {
            let height_m = lowest_m + 0.5 * TEXT_HEIGHT_M * steps as f64;
            Self { at: Point3::new(center.x, center.y, height_m), half_width_m }
        };
        let covered = |steps: &usize| {
            let name = raised(*steps);
            others.iter().filter(|other| name.covers(other)).count()
        };
        raised((0..=MOST_STEPS).min_by_key(covered).unwrap_or(0))
    }

    /// Whether one of two texts covers the other from some side, for somebody who looks down at them as usual.
    fn covers(&self, other: &Self) -> bool {
        let apart_m = (other.at.xy() - self.at.xy()).norm();
        let higher_m = (other.at.z - self.at.z).abs();
        let (sine, cosine) = LOOKS_DOWN_RAD.sin_cos();
        (0..=SIDES).any(|side| {
            // Half a turn about the line between them: the other half is the same.
            let (across, along) = (PI * side as f64 / SIDES as f64).sin_cos();
            (apart_m * across).abs() < self.half_width_m + other.half_width_m
                && (apart_m * along * sine - higher_m * cosine).abs() < TEXT_HEIGHT_M
        })
    }
}

/// A body as its outline says.
pub fn outlined(ns: &str, outline: Outline, body: &Ellipsoid, color: ColorRGBA) -> Marker {
    match outline {
        Outline::Cuboid => solid(ns, Marker::CUBE, body, color),
        Outline::Cylinder => solid(ns, Marker::CYLINDER, body, color),
        Outline::Ellipsoid => solid(ns, Marker::SPHERE, body, color),
        Outline::Superquadric(profile, footprint) => Marker {
            points: superquadric_triangles(profile, footprint, &body.semi_axes),
            // The corners are in metres.
            scale: Vector3 { x: 1.0, y: 1.0, z: 1.0 },
            ..solid(ns, Marker::TRIANGLE_LIST, body, color)
        },
    }
}

/// Takes away what [`object_markers`] showed of objects.
pub fn deletion_markers(
    objects: impl IntoIterator<Item = ObjectId>,
    stamp: Stamp,
    frame_id: &str,
) -> MarkerArray {
    let delete = |id: ObjectId| {
        ["objects", "labels", "cuboids"].map(|ns| Marker {
            header: header(stamp, frame_id),
            ns: ns.into(),
            id: marker_id(id),
            action: Marker::DELETE,
            ..Marker::default()
        })
    };
    MarkerArray { markers: objects.into_iter().flat_map(delete).collect() }
}

/// What one image says, in the frame of the map: ellipsoids, the mirror planes that were used, support planes and walls.
/// It takes the place of what was shown of the image before.
pub fn measurement_markers(keyframe: &Keyframe, frame_id: &str) -> MarkerArray {
    let mut markers = vec![Marker { action: Marker::DELETEALL, ..Marker::default() }];
    let found = keyframe.boxes.iter().filter_map(|found| {
        found.measurement.as_ref().ok().map(|measured| (measured, found.detection.label()))
    });
    for (measured, label) in found {
        let body = measured.ellipsoid.transformed(&keyframe.map_from_camera);
        let color = with_alpha(color_of(label), 0.3);
        markers.push(solid("measurements", Marker::SPHERE, &body, color));
        markers.extend(mirrors(measured, &keyframe.map_from_camera));
    }
    let eye = keyframe.map_from_camera.translation.vector;
    markers.extend(keyframe.support_heights_m.iter().map(|height| {
        let at = Point3::new(eye.x, eye.y, *height);
        sheet("support_planes", &at, UnitQuaternion::identity(), [3.0, 3.0, SHEET_M])
    }));
    markers.extend(keyframe.walls.iter().map(|wall| wall_sheet(wall, &keyframe.map_from_camera)));
    for (id, marker) in (0..).zip(&mut markers) {
        (marker.header, marker.id) = (header(keyframe.stamp, frame_id), id);
    }
    MarkerArray { markers }
}

/// The mirror planes of a measurement, as large as the object.
fn mirrors<'a>(
    measured: &'a EllipsoidMeasurement,
    map_from_camera: &'a Pose,
) -> impl Iterator<Item = Marker> + 'a {
    let body = measured.ellipsoid.transformed(map_from_camera);
    measured.symmetry.iter().map(move |mirror| {
        let plane: Plane = mirror.plane.transformed(map_from_camera);
        let center = body.center();
        let at = center - plane.normal.into_inner() * plane.signed_distance(&center);
        let yaw = plane.normal.y.atan2(plane.normal.x);
        let width = 2.2 * body.semi_axes.xy().norm();
        let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw);
        sheet("symmetry", &at, turned, [SHEET_M, width, 2.2 * body.semi_axes.z])
    })
}

/// What is seen of a wall, as long as that is.
fn wall_sheet(wall: &WallSegment, map_from_camera: &Pose) -> Marker {
    let normal = map_from_camera * wall.normal;
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, normal.y.atan2(normal.x));
    let size = [SHEET_M, 2.0 * wall.half_length_m, WALL_HEIGHT_M];
    sheet("walls", &(map_from_camera * wall.center), turned, size)
}

fn solid(ns: &str, kind: i32, body: &Ellipsoid, color: ColorRGBA) -> Marker {
    let [x, y, z]: [f64; 3] = (body.semi_axes * 2.0).into();
    Marker {
        ns: ns.into(),
        kind,
        action: Marker::ADD,
        pose: pose_message(&body.pose),
        scale: Vector3 { x, y, z },
        color,
        ..Marker::default()
    }
}

fn sheet(ns: &str, at: &Point3<f64>, turned: UnitQuaternion<f64>, [x, y, z]: [f64; 3]) -> Marker {
    Marker {
        ns: ns.into(),
        kind: Marker::CUBE,
        action: Marker::ADD,
        pose: pose_message(&Pose::from_parts(Translation3::from(at.coords), turned)),
        scale: Vector3 { x, y, z },
        color: ColorRGBA { r: 0.6, g: 0.8, b: 1.0, a: 0.25 },
        ..Marker::default()
    }
}

/// Marker ids are 32 bits wide; object ids count up from one.
fn marker_id(object: ObjectId) -> i32 {
    (object.0 % (1 << 31)) as i32
}

fn with_alpha([r, g, b]: [f32; 3], a: f32) -> ColorRGBA {
    ColorRGBA { r, g, b, a }
}

/// A colour (red, green, blue in [0, 1]) that stays with the class: COCO's by their number, so that things that are seen together
/// differ, others by a hash of the name.
pub fn color_of(label: &str) -> [f32; 3] {
    // FNV-1a: spreads short names well and is the same everywhere.
    let hash = || {
        let mix = |hash: u32, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        label.bytes().fold(0x811c_9dc5, mix) as usize
    };
    let number = NAMES.iter().position(|name| *name == label).unwrap_or_else(hash);
    COLORS[number % COLORS.len()].map(|part| f32::from(part) / 255.0)
}

/// Colours that the colour-blind can tell apart: those of Okabe and Ito (2008), and between them Tol's (2021).
const COLORS: [[u8; 3]; 14] = [
    [230, 159, 0],
    [68, 170, 153],
    [153, 153, 51],
    [213, 94, 0],
    [221, 204, 119],
    [136, 204, 238],
    [86, 180, 233],
    [181, 68, 110],
    [240, 228, 66],
    [204, 102, 119],
    [0, 158, 115],
    [59, 142, 219],
    [119, 119, 204],
    [204, 121, 167],
];

const TEXT_HEIGHT_M: f64 = 0.08;
/// Width of a letter beside its height.
const LETTER_WIDTH: f64 = 0.55;
/// How far down one usually looks at a map (rad).
const LOOKS_DOWN_RAD: f64 = 0.5;
/// Half text heights that a text is raised, at most: farther from its object it is of no use.
const MOST_STEPS: usize = 20;
/// From so many sides it is asked whether a text covers another one.
const SIDES: usize = 24;
/// How thick a plane is drawn (m).
const SHEET_M: f64 = 0.005;
/// How high walls are drawn (m).
const WALL_HEIGHT_M: f64 = 1.0;
