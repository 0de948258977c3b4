//! A desk in the middle of a room.

use super::{
    desk_things::{self as things, Model},
    random::Random,
    scene::{Place, Routes, Scene},
};
use nalgebra::{Point2, Point3};
use std::f64::consts::PI;

/// A desk with monitor, laptop, keyboard, mouse, cups, books and a bottle; a chair in front of it.
pub(super) fn desk_scene(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    scene.add_room([-4.5, -3.5], [4.5, 3.5]);
    let size = [random.between(1.5, 1.8), random.between(0.75, 0.85), random.between(0.71, 0.76)];
    let desk = Place::floor(0.0, 0.0, random.between(-0.5, 0.5));
    scene.put(things::table(random, size), desk);
    furnish_desk(&mut scene, random, &desk, size);
    let chair = things::chair(random);
    let seat = desk.at(random.between(-0.2, 0.2), -0.5 * size[1] - 0.42, 0.0, PI);
    scene.put(chair, seat.jittered(random, 0.05, 0.35));
    scene.routes = Routes {
        orbit_center: Point3::new(0.0, -0.1, 0.75),
        orbit_radius: 1.75,
        // Aims a little beside the desk for as long as it can, then passes the chair.
        forward: [(-4.0, -1.2), (-2.7, -1.3), (-1.5, -1.25), (-0.8, -1.75), (0.6, -1.95)]
            .map(|(x, y)| Point2::new(x, y))
            .to_vec(),
        // Towards the desk along its middle, past it on one side, round, and the same from the other end: a
        // circle about the desk would never show it to a camera that looks ahead.
        round: [
            (-3.1, 0.1),
            (-2.0, -0.5),
            (-1.0, -1.6),
            (1.0, -1.75),
            (2.6, -1.75),
            (3.6, -1.3),
            (3.7, -0.5),
            (3.1, -0.1),
            (2.0, 0.5),
            (1.0, 1.35),
            (-1.0, 1.6),
            (-2.6, 1.7),
            (-3.6, 1.2),
            (-3.7, 0.5),
        ]
        .map(|(x, y)| Point2::new(x, y))
        .to_vec(),
    };
    scene
}

/// Puts what is used on a desk of `size` at `desk`: in their places first, then clutter where there is room.
pub(super) fn furnish_desk(scene: &mut Scene, random: &mut Random, desk: &Place, size: [f64; 3]) {
    let [width, depth, height] = size;
    let side = random.pick(&[-1.0, 1.0]);
    let screen_width = random.between(0.48, 0.58);
    let screen = things::screen(random, screen_width);
    let monitor = desk.at(-side * 0.14 * width, 0.25 * depth, height, 0.0);
    scene.put(screen, monitor.jittered(random, 0.03, 0.12));
    let keyboard = things::keyboard(random);
    let typing = desk.at(-side * 0.14 * width, -0.24 * depth, height, 0.0);
    scene.put(keyboard, typing.jittered(random, 0.03, 0.1));
    let laptop = things::laptop(random);
    let beside = desk.at(side * 0.3 * width, 0.02, height, -side * 0.3);
    scene.put(laptop, beside.jittered(random, 0.04, 0.2));
    let mouse = things::mouse(random);
    scene.put(mouse, typing.at(0.33, 0.0, 0.0, 0.0).jittered(random, 0.02, 0.3));
    // The largest first, while there is room.
    let maker = |model: fn(&mut Random) -> Model, count: usize| std::iter::repeat_n(model, count);
    let clutter = maker(things::book, random.integer(1, 3))
        .chain(maker(things::bottle, 1))
        .chain(maker(things::cup, random.integer(1, 3)));
    for model in clutter {
        scene.scatter(random, model, &desk.at(0.0, 0.0, height, 0.0), [0.5 * width, 0.5 * depth]);
    }
}
