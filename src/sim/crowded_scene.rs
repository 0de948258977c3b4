//! A room of things that look alike and stand close together.

use super::{
    desk_things, home_things as things,
    random::Random,
    scene::{Place, Routes, Scene},
};
use nalgebra::{Point2, Point3};
use std::f64::consts::PI;

const EAST_X: f64 = 8.0;
const NORTH_Y: f64 = 6.0;
/// Centre of the table (m).
const TABLE: [f64; 2] = [3.0, 2.9];

/// Six chairs round a table, books in a row on a low cabinet, a desk with two monitors side by side.
pub(super) fn crowded_scene(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    scene.add_room([0.0, 0.0], [EAST_X, NORTH_Y]);
    let table = Place::floor(TABLE[0], TABLE[1], 0.0).jittered(random, 0.1, 0.1);
    table_with_six_chairs(&mut scene, random, &table);
    row_of_books(&mut scene, random);
    two_monitors(&mut scene, random);
    let points = |way: &[(f64, f64)]| way.iter().map(|(x, y)| Point2::new(*x, *y)).collect();
    scene.routes = Routes {
        orbit_center: Point3::new(TABLE[0], TABLE[1], 0.75),
        orbit_radius: 2.1,
        forward: points(&[
            (0.8, 0.8),
            (3.0, 0.9),
            (5.2, 1.3),
            (5.9, 2.8),
            (5.0, 4.6),
            (3.0, 4.9),
            (0.9, 4.6),
            (0.7, 2.9),
        ]),
        round: points(&[
            (0.9, 1.2),
            (3.0, 0.9),
            (5.2, 1.3),
            (5.9, 2.8),
            (5.0, 4.6),
            (3.0, 4.9),
            (1.0, 4.6),
            (0.7, 2.9),
        ]),
    };
    scene
}

/// The chairs of a side touch with their arms nearly: 60 cm from centre to centre.
fn table_with_six_chairs(scene: &mut Scene, random: &mut Random, table: &Place) {
    let size = [random.between(1.7, 1.9), random.between(0.8, 0.9), random.between(0.72, 0.76)];
    scene.put(desk_things::table(random, size), *table);
    for (x, side) in [(-0.6, -1.0), (0.0, -1.0), (0.6, -1.0), (-0.6, 1.0), (0.0, 1.0), (0.6, 1.0)] {
        let away = 0.5 * size[1] + random.between(0.22, 0.34);
        let yaw = if side < 0.0 { PI } else { 0.0 };
        let seat = table.at(x, side * away, 0.0, yaw);
        scene.put(desk_things::chair(random), seat.jittered(random, 0.02, 0.08));
    }
}

/// Six books side by side, some centimetres apart.
fn row_of_books(scene: &mut Scene, random: &mut Random) {
    let size = [random.between(1.5, 1.7), 0.42, random.between(0.7, 0.8)];
    let cabinet = Place::floor(3.0 + random.between(-0.3, 0.3), NORTH_Y - 0.3, 0.0);
    scene.put(things::cabinet(random, size), cabinet);
    for i in 0..6 {
        let x = 0.25 * (f64::from(i) - 2.5);
        // Turned, so that the short side is along the row.
        let place = cabinet.at(x, -0.03, size[2], 0.5 * PI).jittered(random, 0.01, 0.06);
        scene.put(desk_things::book(random), place);
    }
}

/// A desk at the eastern wall.
fn two_monitors(scene: &mut Scene, random: &mut Random) {
    let size = [random.between(1.5, 1.7), random.between(0.75, 0.85), random.between(0.71, 0.75)];
    let desk = Place::floor(EAST_X - 0.5, 3.0, -0.5 * PI);
    scene.put(desk_things::table(random, size), desk);
    for side in [-1.0, 1.0] {
        let width = random.between(0.5, 0.56);
        let place = desk.at(side * 0.31, 0.12, size[2], -side * 0.12);
        scene.put(desk_things::screen(random, width), place.jittered(random, 0.01, 0.03));
    }
    scene.put(desk_things::keyboard(random), desk.at(0.0, -0.2, size[2], 0.0));
    let seat = desk.at(0.0, -0.5 * size[1] - 0.4, 0.0, PI);
    scene.put(desk_things::office_chair(random), seat.jittered(random, 0.05, 0.4));
}
