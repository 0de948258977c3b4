//! A living room with a dining table, and a bedroom; two doors between them make a round walk.

use super::{
    desk_things, home_things as things,
    random::Random,
    scene::{Place, Routes, Scene},
};
use nalgebra::{Point2, Point3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Where the two rooms meet (m).
const DIVIDER_X: f64 = 7.8;
const EAST_X: f64 = 12.0;
const NORTH_Y: f64 = 5.0;
/// Centre of the dining table (m).
const TABLE: [f64; 2] = [5.6, 2.5];

/// Sofa, television on a stand, refrigerator, cabinets, dining table, bed, chairs and plants.
pub(super) fn home_scene(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    scene.add_room([0.0, 0.0], [EAST_X, NORTH_Y]);
    for (from, to) in [(0.0, 0.4), (1.4, 3.6), (4.6, NORTH_Y)] {
        scene.add_wall([DIVIDER_X, from], [DIVIDER_X, to]);
    }
    furnish_living_room(&mut scene, random);
    let table = Place::floor(TABLE[0], TABLE[1], 0.0).jittered(random, 0.1, 0.12);
    dining_group(&mut scene, random, &table);
    furnish_bedroom(&mut scene, random);
    let points = |way: &[(f64, f64)]| way.iter().map(|(x, y)| Point2::new(*x, *y)).collect();
    scene.routes = Routes {
        orbit_center: Point3::new(TABLE[0], TABLE[1], 0.75),
        orbit_radius: 1.65,
        forward: points(&[
            (7.2, 4.1),
            (4.8, 4.1),
            (2.3, 3.95),
            (1.6, 2.7),
            (1.7, 1.2),
            (3.5, 0.85),
            (7.0, 0.85),
            (8.8, 1.1),
            (9.1, 2.6),
        ]),
        round: points(&[
            (1.6, 2.5),
            (1.9, 3.9),
            (4.5, 4.1),
            (7.8, 4.1),
            (8.9, 3.8),
            (8.9, 1.2),
            (7.8, 0.9),
            (4.5, 0.85),
            (1.9, 1.1),
        ]),
    };
    scene
}

/// A table with four chairs and what is left on it.
pub(super) fn dining_group(scene: &mut Scene, random: &mut Random, table: &Place) {
    let size = [random.between(1.3, 1.5), random.between(0.78, 0.9), random.between(0.72, 0.76)];
    scene.put(desk_things::table(random, size), *table);
    for (x, side) in [(-0.32, -1.0), (0.32, -1.0), (-0.32, 1.0), (0.32, 1.0)] {
        let away = 0.5 * size[1] + random.between(0.22, 0.34);
        let yaw = if side < 0.0 { PI } else { 0.0 };
        let seat = table.at(x, side * away, 0.0, yaw);
        scene.put(desk_things::chair(random), seat.jittered(random, 0.02, 0.08));
    }
    let top = table.at(0.0, 0.0, size[2], 0.0);
    let half = [0.5 * size[0], 0.5 * size[1]];
    for _ in 0..random.integer(1, 2) {
        scene.scatter(random, desk_things::cup, &top, half);
    }
    for model in [desk_things::bottle, desk_things::book] {
        scene.scatter(random, model, &top, half);
    }
}

fn furnish_living_room(scene: &mut Scene, random: &mut Random) {
    let stand_size =
        [random.between(1.3, 1.6), random.between(0.4, 0.45), random.between(0.42, 0.55)];
    let stand = Place::floor(0.33, 2.5 + random.between(-0.15, 0.15), FRAC_PI_2);
    scene.put(things::cabinet(random, stand_size), stand);
    let width = random.between(0.9, 1.15);
    let television = stand.at(0.0, 0.0, stand_size[2], 0.0);
    scene.put(desk_things::screen(random, width), television.jittered(random, 0.02, 0.05));
    let sofa = Place::floor(3.1, 2.5, -FRAC_PI_2);
    scene.put(things::sofa(random), sofa.jittered(random, 0.1, 0.08));
    let refrigerator = Place::floor(0.5, 4.55, 0.0);
    scene.put(things::refrigerator(random), refrigerator.jittered(random, 0.04, 0.02));
    let size = [random.between(0.8, 1.1), random.between(0.36, 0.42), random.between(0.8, 1.2)];
    let cabinet = Place::floor(random.between(2.2, 4.6), 4.72, 0.0);
    scene.put(things::cabinet(random, size), cabinet);
    let top = cabinet.at(0.0, 0.0, size[2], 0.0);
    let half = [0.5 * size[0], 0.5 * size[1]];
    scene.scatter(random, |random| things::plant(random, 0.35), &top, half);
    scene.scatter(random, desk_things::book, &top, half);
    let height = random.between(0.9, 1.2);
    let corner = Place::floor(0.55, 0.55, random.between(-PI, PI));
    scene.put(things::plant(random, height), corner);
}

fn furnish_bedroom(scene: &mut Scene, random: &mut Random) {
    let bed = Place::floor(10.85, 2.5, -FRAC_PI_2);
    scene.put(things::bed(random), bed.jittered(random, 0.03, 0.03));
    let size = [random.between(1.0, 1.4), random.between(0.45, 0.52), random.between(1.7, 2.0)];
    let wardrobe = Place::floor(10.8 + random.between(-0.3, 0.3), 4.66, 0.0);
    scene.put(things::cabinet(random, size), wardrobe);
    let chair = Place::floor(11.35, 0.7, -2.4);
    scene.put(desk_things::chair(random), chair.jittered(random, 0.1, 0.4));
    let suitcase = Place::floor(10.1, 0.5, PI);
    scene.put(things::suitcase(random), suitcase.jittered(random, 0.1, 0.3));
}
