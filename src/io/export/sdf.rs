//! A world of static models in SDFormat, for Gazebo.

use crate::{
    geometry::Outline,
    mapping::{SavedMap, SavedObject},
    msg::convert::color_of,
};

/// Footprints whose axes differ by a larger part are ellipses and no circles, which SDF's cylinders are.
const ROUND: f64 = 0.1;

pub(super) fn world(map: &SavedMap) -> String {
    let models: String = map.objects.iter().map(model).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <world name=\"{}\">\n{models}  </world>\n</sdf>\n",
        escaped(&map.frame_id)
    )
}

fn model(object: &SavedObject) -> String {
    let (pose, geometry) = (object.ellipsoid.pose, geometry(object));
    let t = pose.translation.vector;
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    let [r, g, b] = color_of(&object.label);
    let name = escaped(&format!("{}_{}", object.name().replace(' ', "_"), object.id));
    format!(
        "    <model name=\"{name}\">\n      <static>true</static>\n      \
         <pose>{} {} {} {roll} {pitch} {yaw}</pose>\n      <link name=\"link\">\n        \
         <collision name=\"collision\"><geometry>{geometry}</geometry></collision>\n        \
         <visual name=\"visual\"><geometry>{geometry}</geometry>\
         <material><ambient>{r} {g} {b} 1</ambient><diffuse>{r} {g} {b} 1</diffuse></material></visual>\n      \
         </link>\n    </model>\n",
        t.x, t.y, t.z
    )
}

/// The nearest of SDF's shapes that fills the object's extents.
fn geometry(object: &SavedObject) -> String {
    let [x, y, z]: [f64; 3] = object.ellipsoid.semi_axes.into();
    let is_round = (x - y).abs() <= ROUND * x.max(y);
    match object.outline {
        Outline::Ellipsoid => format!("<ellipsoid><radii>{x} {y} {z}</radii></ellipsoid>"),
        Outline::Cylinder if is_round => {
            let (radius, length) = (0.5 * (x + y), 2.0 * z);
            format!("<cylinder><radius>{radius}</radius><length>{length}</length></cylinder>")
        }
        _ => format!("<box><size>{} {} {}</size></box>", 2.0 * x, 2.0 * y, 2.0 * z),
    }
}

/// Text in XML; what XML cannot have is left out.
fn escaped(text: &str) -> String {
    let plain = text.chars().filter(|c| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}'));
    plain.fold(String::new(), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            _ => out.push(c),
        }
        out
    })
}
