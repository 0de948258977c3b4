//! What stands on and at a desk.
//!
//! Every model stands on z = 0 about the origin, its front faces -y.

use super::{
    mesh::{Color, Mesh},
    random::Random,
};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

/// A thing that can be put into a scene.
pub(super) struct Model {
    /// Class name as a COCO detector gives it.
    pub(super) label: &'static str,
    /// In the model's own frame.
    pub(super) mesh: Mesh,
}

const BLACK: Color = [38, 38, 42];
const DARK: Color = [66, 68, 74];
const SILVER: Color = [176, 178, 182];
const SCREEN: Color = [44, 66, 96];
const WOODS: [Color; 4] = [[166, 120, 76], [196, 156, 108], [128, 88, 58], [212, 200, 180]];
const PAINTS: [Color; 6] =
    [[186, 60, 52], [58, 104, 170], [70, 138, 84], [214, 170, 62], [128, 82, 148], [224, 220, 210]];

/// A table of `size` = width, depth, height; a COCO detector calls a desk a dining table.
pub(super) fn table(random: &mut Random, [width, depth, height]: [f64; 3]) -> Model {
    let color = random.pick(&WOODS);
    let (x, y) = (0.5 * width, 0.5 * depth);
    let mut mesh = Mesh::default();
    mesh.add_box([-x, -y, height - 0.03], [x, y, height], color);
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let (cx, cy) = (sx * (x - 0.05), sy * (y - 0.05));
        mesh.add_box(
            [cx - 0.025, cy - 0.025, 0.0],
            [cx + 0.025, cy + 0.025, height - 0.03],
            darker(color),
        );
    }
    Model { label: "dining table", mesh }
}

/// A flat screen on a stand, as a computer monitor (about half a metre) or a television.
pub(super) fn screen(random: &mut Random, width: f64) -> Model {
    let height = width * random.between(0.58, 0.64);
    let clearance = random.between(0.18, 0.24) * width;
    let (base_x, base_y) = (0.22 * width, 0.16 * width);
    let mut mesh = Mesh::default();
    mesh.add_box([-base_x, -base_y, 0.0], [base_x, base_y, 0.015], DARK);
    mesh.add_box([-0.03, 0.015, 0.015], [0.03, 0.04, clearance + 0.5 * height], DARK);
    let half = 0.5 * width;
    mesh.add_box([-half, -0.02, clearance], [half, 0.015, clearance + height], BLACK);
    let (low, high) = (clearance + 0.02, clearance + height - 0.015);
    // A millimetre in front of the frame, so that the picture does not flicker between the two.
    mesh.add_box([-half + 0.015, -0.021, low], [half - 0.015, -0.02, high], SCREEN);
    Model { label: "tv", mesh }
}

/// A laptop, opened.
pub(super) fn laptop(random: &mut Random) -> Model {
    let (half_x, half_y) = (0.5 * random.between(0.31, 0.36), 0.5 * random.between(0.21, 0.25));
    let mut mesh = Mesh::default();
    mesh.add_box([-half_x, -half_y, 0.0], [half_x, half_y, 0.018], SILVER);
    let (key_x, key_y) = (half_x - 0.02, half_y - 0.015);
    mesh.add_box([-key_x, -0.02, 0.018], [key_x, key_y, 0.019], DARK);
    mesh.add_box([-0.05, -half_y + 0.02, 0.018], [0.05, -0.035, 0.0185], [150, 152, 156]);
    let mut lid = Mesh::default();
    lid.add_box([-half_x, 0.0, 0.0], [half_x, 0.008, 2.0 * half_y], SILVER);
    let edge = half_x - 0.01;
    lid.add_box([-edge, -0.001, 0.012], [edge, 0.0, 2.0 * half_y - 0.01], SCREEN);
    let tilt = random.between(0.15, 0.45);
    let hinge = Isometry3::from_parts(
        Translation3::new(0.0, half_y - 0.008, 0.018),
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -tilt),
    );
    mesh.add(&lid.transformed(&hinge));
    Model { label: "laptop", mesh }
}

/// A keyboard, about 3 cm thick at the back.
pub(super) fn keyboard(random: &mut Random) -> Model {
    let (half_x, half_y) = (0.5 * random.between(0.42, 0.46), 0.5 * random.between(0.14, 0.17));
    let color = random.pick(&[BLACK, DARK, [214, 212, 204]]);
    let mut mesh = Mesh::default();
    mesh.add_box([-half_x, -half_y, 0.0], [half_x, half_y, 0.018], color);
    const ROWS: usize = 5;
    let pitch = (2.0 * half_y - 0.02) / ROWS as f64;
    for row in 0..ROWS {
        let y = -half_y + 0.01 + pitch * row as f64;
        let top = 0.024 + 0.0015 * row as f64;
        // The typing block and the number block.
        for (low, high) in [(-half_x + 0.01, 0.5 * half_x), (0.56 * half_x, half_x - 0.01)] {
            mesh.add_box([low, y, 0.018], [high, y + pitch - 0.004, top], lighter(color));
        }
    }
    Model { label: "keyboard", mesh }
}

/// A computer mouse.
pub(super) fn mouse(random: &mut Random) -> Model {
    let color = random.pick(&[BLACK, DARK, [220, 218, 212]]);
    let semi_axes = Vector3::new(random.between(0.029, 0.034), random.between(0.05, 0.06), 0.036);
    let mut mesh = Mesh::default();
    mesh.add_ellipsoid(Point3::origin(), semi_axes, true, color);
    Model { label: "mouse", mesh }
}

/// An open cup with a handle at +x.
pub(super) fn cup(random: &mut Random) -> Model {
    let color = random.pick(&PAINTS);
    let (radius, height) = (random.between(0.037, 0.045), random.between(0.085, 0.11));
    let foot = 0.85 * radius;
    let mut mesh = Mesh::default();
    mesh.add_lathe(
        0.0,
        0.0,
        &[
            (0.0, 0.0),
            (foot, 0.0),
            (radius, height),
            (radius - 0.004, height),
            (foot - 0.004, 0.012),
        ],
        color,
    );
    mesh.add_lathe(0.0, 0.0, &[(foot - 0.002, 0.6 * height), (0.0, 0.6 * height)], [84, 54, 34]);
    let path: Vec<Point3<f64>> = (0..=8)
        .map(|i| {
            let (sin, cos) = (PI * (i as f64 / 8.0 - 0.5)).sin_cos();
            Point3::new(0.92 * radius + 0.03 * cos, 0.0, height * (0.5 + 0.3 * sin))
        })
        .collect();
    mesh.add_tube(&path, 0.005, color);
    Model { label: "cup", mesh }
}

/// A bottle with shoulder, neck and cap.
pub(super) fn bottle(random: &mut Random) -> Model {
    let color = random.pick(&[[60, 110, 70], [120, 160, 190], [150, 90, 50]]);
    let (r, h) = (random.between(0.032, 0.042), random.between(0.22, 0.3));
    let mut mesh = Mesh::default();
    mesh.add_lathe(
        0.0,
        0.0,
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r, 0.6 * h),
            (0.8 * r, 0.7 * h),
            (0.38 * r, 0.8 * h),
            (0.38 * r, h),
        ],
        color,
    );
    mesh.add_cylinder((0.0, 0.0), 0.46 * r, (0.93 * h, h), [220, 220, 220]);
    let label = [(1.01 * r, 0.2 * h), (1.01 * r, 0.48 * h)];
    mesh.add_lathe(0.0, 0.0, &label, random.pick(&PAINTS));
    Model { label: "bottle", mesh }
}

/// A book lying on its back cover.
pub(super) fn book(random: &mut Random) -> Model {
    let cover = random.pick(&PAINTS);
    let (half_x, half_y) = (0.5 * random.between(0.2, 0.28), 0.5 * random.between(0.14, 0.2));
    let thickness = random.between(0.025, 0.05);
    let mut mesh = Mesh::default();
    mesh.add_box([-half_x, -half_y, 0.0], [half_x, half_y, 0.003], cover);
    let (page_x, page_y) = (half_x - 0.004, half_y - 0.004);
    let pages = [232, 226, 208];
    mesh.add_box([-page_x, -page_y, 0.003], [page_x, page_y, thickness - 0.003], pages);
    mesh.add_box([-half_x, -half_y, thickness - 0.003], [half_x, half_y, thickness], cover);
    mesh.add_box([-half_x, half_y - 0.004, 0.0], [half_x, half_y, thickness], cover);
    Model { label: "book", mesh }
}

/// A chair with four legs, seat and back.
pub(super) fn chair(random: &mut Random) -> Model {
    let (wood, cushion) = (random.pick(&WOODS), random.pick(&PAINTS));
    let (half_x, half_y) = (0.5 * random.between(0.42, 0.48), 0.5 * random.between(0.42, 0.5));
    let (seat, top) = (random.between(0.43, 0.48), random.between(0.84, 0.98));
    let mut mesh = Mesh::default();
    for (sx, front) in [(-1.0, true), (1.0, true), (-1.0, false), (1.0, false)] {
        let (cx, cy) = (sx * (half_x - 0.02), if front { 0.02 - half_y } else { half_y - 0.02 });
        let height = if front { seat - 0.03 } else { top };
        mesh.add_box([cx - 0.02, cy - 0.02, 0.0], [cx + 0.02, cy + 0.02, height], wood);
    }
    mesh.add_box([-half_x, -half_y, seat - 0.03], [half_x, half_y - 0.041, seat + 0.015], cushion);
    mesh.add_box(
        [-half_x + 0.04, half_y - 0.035, top - 0.2],
        [half_x - 0.04, half_y - 0.01, top - 0.02],
        wood,
    );
    mesh.add_box(
        [-half_x + 0.04, half_y - 0.035, seat + 0.12],
        [half_x - 0.04, half_y - 0.01, seat + 0.2],
        wood,
    );
    for sx in [-1.0, 1.0] {
        let cx = sx * (half_x - 0.02);
        mesh.add_box([cx - 0.012, 0.04 - half_y, 0.16], [cx + 0.012, half_y - 0.04, 0.2], wood);
    }
    Model { label: "chair", mesh }
}

/// A swivel chair on a five-armed foot, with arm rests.
pub(super) fn office_chair(random: &mut Random) -> Model {
    let cushion = random.pick(&[BLACK, [46, 60, 92], [92, 44, 44]]);
    let (seat, top) = (random.between(0.44, 0.5), random.between(0.9, 1.04));
    let mut mesh = Mesh::default();
    for arm in 0..5 {
        let (sin, cos) = (TAU * (arm as f64 / 5.0 + 0.05)).sin_cos();
        let tip = Point3::new(0.26 * cos, 0.26 * sin, 0.07);
        mesh.add_tube(&[Point3::new(0.0, 0.0, 0.1), tip], 0.018, DARK);
        mesh.add_cylinder((tip.x, tip.y), 0.025, (0.0, 0.06), BLACK);
    }
    mesh.add_cylinder((0.0, 0.0), 0.03, (0.08, seat - 0.06), SILVER);
    mesh.add_box([-0.24, -0.24, seat - 0.06], [0.24, 0.22, seat + 0.02], cushion);
    mesh.add_box([-0.22, 0.2, seat + 0.1], [0.22, 0.26, top], cushion);
    mesh.add_box([-0.04, 0.22, seat - 0.04], [0.04, 0.255, seat + 0.2], DARK);
    for side in [-1.0, 1.0] {
        let x = side * 0.265;
        mesh.add_box([x - 0.02, -0.02, seat - 0.04], [x + 0.02, 0.02, seat + 0.2], DARK);
        mesh.add_box([x - 0.03, -0.15, seat + 0.2], [x + 0.03, 0.13, seat + 0.23], DARK);
    }
    Model { label: "chair", mesh }
}

fn darker(color: Color) -> Color {
    color.map(|c| (f64::from(c) * 0.75) as u8)
}

fn lighter(color: Color) -> Color {
    color.map(|c| c.saturating_add(28))
}
