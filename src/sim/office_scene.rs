//! Two offices along a corridor, with a door between them, so that a walk can come round.

use super::{
    desk_scene::furnish_desk,
    desk_things,
    home_scene::dining_group,
    home_things as things,
    random::Random,
    scene::{Place, Routes, Scene},
};
use nalgebra::{Point2, Point3};
use std::f64::consts::{FRAC_PI_2, PI};

const DIVIDER_X: f64 = 5.0;
const EAST_X: f64 = 12.4;
/// Between the rooms and the corridor (m).
const CORRIDOR_Y: f64 = 4.5;
const NORTH_Y: f64 = 6.3;
/// Centre of the meeting table (m).
const MEETING: [f64; 2] = [10.3, 2.25];

/// A desk in each of two rooms, a meeting table in the second, a corridor with chairs to wait on.
pub(super) fn office_scene(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    scene.add_room([0.0, 0.0], [EAST_X, NORTH_Y]);
    for (from, to) in [(0.0, 1.8), (2.8, 7.2), (8.2, EAST_X)] {
        scene.add_wall([from, CORRIDOR_Y], [to, CORRIDOR_Y]);
    }
    for (from, to) in [(0.0, 1.8), (2.8, CORRIDOR_Y)] {
        scene.add_wall([DIVIDER_X, from], [DIVIDER_X, to]);
    }
    work_place(&mut scene, random, &Place::floor(0.55, 2.3, FRAC_PI_2));
    work_place(&mut scene, random, &Place::floor(7.6, 0.55, PI));
    let table = Place::floor(MEETING[0], MEETING[1], FRAC_PI_2).jittered(random, 0.05, 0.1);
    dining_group(&mut scene, random, &table);
    furnish_walls(&mut scene, random);
    let points = |way: &[(f64, f64)]| way.iter().map(|(x, y)| Point2::new(*x, *y)).collect();
    scene.routes = Routes {
        orbit_center: Point3::new(MEETING[0], MEETING[1], 0.75),
        orbit_radius: 1.6,
        forward: points(&[
            (1.6, 5.1),
            (2.5, 5.3),
            (6.2, 5.2),
            (7.7, 4.9),
            (7.7, 3.4),
            (6.6, 2.4),
            (5.0, 2.3),
            (2.9, 2.4),
        ]),
        // Begins before the desk, which the robot sees again when it has come round.
        round: points(&[
            (5.0, 2.3),
            (3.2, 2.4),
            (2.3, 3.6),
            (2.3, 4.9),
            (4.0, 5.2),
            (6.0, 5.2),
            (7.7, 4.9),
            (7.7, 3.4),
            (6.6, 2.4),
        ]),
    };
    scene
}

/// A desk with all that belongs on it and a swivel chair.
fn work_place(scene: &mut Scene, random: &mut Random, desk: &Place) {
    let size = [random.between(1.5, 1.7), random.between(0.75, 0.85), random.between(0.71, 0.75)];
    scene.put(desk_things::table(random, size), *desk);
    furnish_desk(scene, random, desk, size);
    let seat = desk.at(random.between(-0.15, 0.15), -0.5 * size[1] - 0.4, 0.0, PI);
    scene.put(desk_things::office_chair(random), seat.jittered(random, 0.05, 0.4));
}

fn furnish_walls(scene: &mut Scene, random: &mut Random) {
    let size = [random.between(0.8, 1.1), random.between(0.38, 0.44), random.between(0.9, 1.4)];
    let cabinet = Place::floor(random.between(3.5, 4.2), 4.22, 0.0);
    scene.put(things::cabinet(random, size), cabinet);
    let top = cabinet.at(0.0, 0.0, size[2], 0.0);
    let half = [0.5 * size[0], 0.5 * size[1]];
    scene.scatter(random, desk_things::book, &top, half);
    scene.scatter(random, desk_things::cup, &top, half);
    let plants = [[0.5, 3.95, 0.9], [0.6, 5.68, 1.2], [11.8, 3.85, 1.0]];
    for [x, y, height] in plants {
        let height = height * random.between(0.85, 1.1);
        let place = Place::floor(x, y, random.between(-PI, PI));
        scene.put(things::plant(random, height), place);
    }
    for x in [4.4, 5.1] {
        let chair = Place::floor(x, 5.92, 0.0).jittered(random, 0.03, 0.1);
        scene.put(desk_things::chair(random), chair);
    }
    let refrigerator = Place::floor(9.6 + random.between(-0.3, 0.3), 5.87, 0.0);
    scene.put(things::refrigerator(random), refrigerator);
    let suitcase = Place::floor(5.45, 0.6, FRAC_PI_2).jittered(random, 0.08, 0.3);
    scene.put(things::suitcase(random), suitcase);
}
