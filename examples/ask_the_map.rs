//! What a robot asks its map: what is called so, what is near, what is in view, and what to drive round.
//!
//! `cargo run --example ask_the_map -- bags/desk.mcap`

use ellipsoid_slam::{
    io::BagInput,
    mapping::{Queries, Region},
    nalgebra::Point3,
    pipeline::{FramePose, Keyframe, ObjectSlam, Settings},
};
use std::{env, error::Error, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let bag = env::args_os().nth(1).map_or("bags/desk.mcap".into(), PathBuf::from);
    let bag = BagInput::open(&bag, &[])?;
    let mut slam = ObjectSlam::new(Settings::default());
    let (mut robot, mut seen): (Option<FramePose>, Option<Keyframe>) = (None, None);
    for input in bag.inputs() {
        let update = slam.handle(input, &mut ());
        robot = update.poses.last().copied().or(robot);
        seen = update.keyframes.last().cloned().or(seen);
    }
    slam.finish(&mut ());
    let map = slam.map();

    for (object, probability) in map.labelled("cup", 0.5) {
        println!("a cup with probability {probability:.2} at {:.2}", object.ellipsoid().center());
    }
    if let Some(robot) = robot {
        let here = Point3::from(slam.map_from_base(&robot).translation.vector);
        for near in map.nearest(&here, None, 3) {
            println!(
                "{} is {:.2} m away, give or take {:.2}",
                near.object.label(),
                near.distance_m,
                near.sigma_m
            );
        }
        let around = Region::Sphere { center: here, radius_m: 2.0 };
        println!("{} objects within 2 m", map.within(&around, 0.5).len());
    }
    if let Some(look) = seen {
        for object in map.in_view(&look.camera, &look.map_from_camera, 5.0) {
            println!("in the last image: {} at {:?}", object.object.label(), object.rect);
        }
    }
    for object in slam.objects() {
        // Two standard deviations wider than estimated: a planner keeps off.
        let corners: Vec<String> =
            object.footprint(2.0).iter().map(|p| format!("({:.2}, {:.2})", p.x, p.y)).collect();
        println!("{} stands on {}", object.label(), corners.join(" "));
    }
    Ok(())
}
