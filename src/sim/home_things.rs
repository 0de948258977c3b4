//! Furniture of living rooms, bedrooms and corridors.
//!
//! Every model stands on z = 0 about the origin, its front faces -y.

use super::{
    desk_things::Model,
    mesh::{Color, Mesh},
    random::Random,
};
use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

const CLOTHS: [Color; 4] = [[92, 104, 122], [140, 72, 64], [84, 116, 92], [176, 160, 132]];
const WOODS: [Color; 3] = [[150, 108, 70], [110, 78, 54], [204, 196, 182]];
const WHITE: Color = [228, 228, 224];
const DARK: Color = [60, 58, 58];

/// A sofa with arms, cushions and feet.
pub(super) fn sofa(random: &mut Random) -> Model {
    let cloth = random.pick(&CLOTHS);
    let (half_x, half_y) = (0.5 * random.between(1.6, 1.95), 0.5 * random.between(0.82, 0.92));
    let (seat, arm, top) =
        (random.between(0.4, 0.45), random.between(0.56, 0.62), random.between(0.78, 0.88));
    let mut mesh = Mesh::default();
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        mesh.add_cylinder((sx * (half_x - 0.08), sy * (half_y - 0.08)), 0.03, (0.0, 0.09), DARK);
    }
    mesh.add_box([-half_x, -half_y, 0.08], [half_x, half_y, 0.26], cloth);
    mesh.add_box([-half_x, half_y - 0.22, 0.26], [half_x, half_y, top], cloth);
    for side in [-1.0, 1.0] {
        let (a, b) = (side * half_x, side * (half_x - 0.18));
        mesh.add_box([a.min(b), -half_y, 0.26], [a.max(b), half_y - 0.22, arm], cloth);
        // Two cushions with a gap between them.
        let (a, b) = (side * 0.008, side * (half_x - 0.185));
        let pale = cloth.map(|c| c.saturating_add(18));
        mesh.add_box([a.min(b), -half_y + 0.01, 0.26], [a.max(b), half_y - 0.225, seat], pale);
    }
    Model { label: "couch", mesh }
}

/// A bed with headboard at +y, mattress, blanket and two pillows.
pub(super) fn bed(random: &mut Random) -> Model {
    let (wood, cloth) = (random.pick(&WOODS), random.pick(&CLOTHS));
    let (half_x, half_y) = (0.5 * random.between(1.3, 1.65), 0.5 * random.between(2.0, 2.1));
    let mattress = random.between(0.44, 0.52);
    let mut mesh = Mesh::default();
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let (cx, cy) = (sx * (half_x - 0.05), sy * (half_y - 0.05));
        mesh.add_box([cx - 0.04, cy - 0.04, 0.0], [cx + 0.04, cy + 0.04, 0.14], wood);
    }
    mesh.add_box([-half_x, -half_y, 0.14], [half_x, half_y, 0.3], wood);
    let headboard = random.between(0.85, 1.05);
    mesh.add_box([-half_x, half_y - 0.05, 0.3], [half_x, half_y, headboard], wood);
    let inner = half_x - 0.03;
    mesh.add_box([-inner, -half_y + 0.03, 0.3], [inner, half_y - 0.06, mattress], WHITE);
    let blanket = half_y - 0.75;
    mesh.add_box([-half_x, -half_y + 0.01, 0.31], [half_x, blanket, mattress + 0.03], cloth);
    for side in [-0.5, 0.5] {
        let center = Point3::new(side * half_x, half_y - 0.36, mattress + 0.04);
        mesh.add_ellipsoid(center, Vector3::new(0.42 * half_x, 0.24, 0.08), false, WHITE);
    }
    Model { label: "bed", mesh }
}

/// A chest or cupboard of `size` = width, depth, height with doors and knobs.
pub(super) fn cabinet(random: &mut Random, [width, depth, height]: [f64; 3]) -> Model {
    let wood = random.pick(&WOODS);
    let (half_x, half_y) = (0.5 * width, 0.5 * depth);
    let mut mesh = Mesh::default();
    mesh.add_box([-half_x + 0.02, -half_y + 0.05, 0.0], [half_x - 0.02, half_y, 0.06], DARK);
    mesh.add_box([-half_x, -half_y + 0.018, 0.06], [half_x, half_y, height], wood);
    let doors = (width / 0.55).round().max(1.0);
    let pale = wood.map(|c| c.saturating_add(14));
    for door in 0..doors as usize {
        let left = -half_x + width * door as f64 / doors;
        let right = left + width / doors;
        mesh.add_box(
            [left + 0.006, -half_y, 0.08],
            [right - 0.006, -half_y + 0.018, height - 0.02],
            pale,
        );
        let knob_x = if door % 2 == 0 { right - 0.06 } else { left + 0.06 };
        let z = 0.55 * height;
        mesh.add_box(
            [knob_x - 0.01, -half_y - 0.02, z - 0.05],
            [knob_x + 0.01, -half_y, z + 0.05],
            DARK,
        );
    }
    Model { label: "cabinet", mesh }
}

/// A refrigerator with two doors and their handles on one side.
pub(super) fn refrigerator(random: &mut Random) -> Model {
    let color = random.pick(&[WHITE, [188, 192, 196], [64, 66, 70]]);
    let (half_x, half_y) = (0.5 * random.between(0.56, 0.66), 0.5 * random.between(0.58, 0.66));
    let height = random.between(1.55, 1.85);
    let split = random.between(0.3, 0.38) * height;
    let side = random.pick(&[-1.0, 1.0]);
    let mut mesh = Mesh::default();
    mesh.add_box([-half_x, -half_y + 0.06, 0.0], [half_x, half_y, height], color);
    let pale = color.map(|c| c.saturating_add(12));
    let x = side * (half_x - 0.06);
    for (low, high) in [(0.06, split), (split + 0.012, height)] {
        mesh.add_box([-half_x, -half_y, low], [half_x, -half_y + 0.055, high], pale);
        let middle = if low < 0.1 { high - 0.22 } else { low + 0.25 };
        let (back, front) = (-half_y, -half_y - 0.035);
        mesh.add_box([x - 0.012, front, middle - 0.18], [x + 0.012, back, middle + 0.18], DARK);
    }
    Model { label: "refrigerator", mesh }
}

/// A plant in a pot, its stems leaning to one side: it has no plane of symmetry.
pub(super) fn plant(random: &mut Random, height: f64) -> Model {
    let pot_height = 0.26 * height;
    let (foot, rim) = (0.1 * height, 0.15 * height);
    let mut mesh = Mesh::default();
    let profile = [(0.0, 0.0), (foot, 0.0), (rim, pot_height), (0.9 * rim, pot_height)];
    mesh.add_lathe(
        0.0,
        0.0,
        &profile,
        random.pick(&[[168, 92, 62], [224, 222, 214], [92, 100, 110]]),
    );
    let soil = 0.94 * pot_height;
    mesh.add_lathe(0.0, 0.0, &[(0.92 * rim, soil), (0.0, soil)], [74, 54, 40]);
    let lean = random.between(0.0, TAU);
    for stem in 0..3 {
        let direction = lean + 0.9 * (stem as f64 - 1.0) + random.between(-0.3, 0.3);
        let reach = random.between(0.08, 0.24) * height;
        let top = height * random.between(0.62, 0.86);
        let at = |t: f64| {
            let out = reach * t * t;
            Point3::new(out * direction.cos(), out * direction.sin(), soil + (top - soil) * t)
        };
        let path: Vec<Point3<f64>> = (0..=4).map(|i| at(0.25 * f64::from(i))).collect();
        mesh.add_tube(&path, 0.012 * height, [112, 92, 56]);
        for _ in 0..random.integer(9, 12) {
            let root = at(random.between(0.4, 1.0));
            let turn = direction + random.between(-PI, PI);
            let (length, rise) = (height * random.between(0.16, 0.27), random.between(-0.25, 0.8));
            let tip = root + Vector3::new(turn.cos(), turn.sin(), rise) * (0.8 * length);
            let green = random.pick(&[[62, 122, 58], [84, 146, 66], [48, 102, 62]]);
            mesh.add_leaf(root, kept_near(tip, pot_height, 0.36 * height), green);
        }
    }
    // What people would draw round it: along the axes that its leaves were drawn in, a box has no meaning.
    Model { label: "potted plant", mesh: mesh.turned_into_its_smallest_box() }
}

/// Keeps a leaf's tip above the pot, where other things may stand, and within a radius, so that a layout knows
/// how much room a plant takes.
fn kept_near(tip: Point3<f64>, lowest: f64, radius: f64) -> Point3<f64> {
    let out = tip.x.hypot(tip.y);
    let shrink = if out > radius { radius / out } else { 1.0 };
    Point3::new(tip.x * shrink, tip.y * shrink, tip.z.max(lowest))
}

/// A suitcase standing on its wheels, the handle drawn out.
pub(super) fn suitcase(random: &mut Random) -> Model {
    let color = random.pick(&[[150, 52, 56], [50, 70, 112], [70, 74, 78]]);
    let (half_x, half_y) = (0.5 * random.between(0.38, 0.48), 0.5 * random.between(0.22, 0.28));
    let height = random.between(0.55, 0.7);
    let mut mesh = Mesh::default();
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        mesh.add_cylinder((sx * (half_x - 0.04), sy * (half_y - 0.04)), 0.022, (0.0, 0.05), DARK);
    }
    mesh.add_box([-half_x, -half_y, 0.045], [half_x, half_y, height], color);
    for x in [-0.5 * half_x, 0.0, 0.5 * half_x] {
        let pale = color.map(|c| c.saturating_add(24));
        mesh.add_box([x - 0.02, -half_y - 0.006, 0.08], [x + 0.02, -half_y, height - 0.04], pale);
    }
    let (back, top) = (half_y - 0.04, height + 0.3);
    let handle = [
        Point3::new(-0.1, back, height - 0.02),
        Point3::new(-0.1, back, top),
        Point3::new(0.1, back, top),
        Point3::new(0.1, back, height - 0.02),
    ];
    for pair in handle.windows(2) {
        mesh.add_tube(pair, 0.01, DARK);
    }
    Model { label: "suitcase", mesh }
}
