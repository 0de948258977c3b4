//! Objects from one's own arrays: depth images, poses and boxes, without ROS and without bags.
//!
//! `cargo run --example from_arrays`

mod suitcase;

use ellipsoid_slam::pipeline::{ObjectSlam, RgbdFrame, Settings};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let camera = suitcase::camera()?;
    let mut slam = ObjectSlam::new(Settings::default());
    for look in suitcase::looks(&camera) {
        // The pose's frame has z up; depth is in metres, aligned to the image that the boxes are in.
        let frame = RgbdFrame::new(look.stamp, &camera, &look.odom_from_camera, &look.depth_m)?
            .with_box(look.corners, "suitcase", 0.9)?;
        let update = slam.see(frame);
        for dropped in &update.dropped {
            println!("not used: {}", dropped.why);
        }
    }
    slam.finish(&mut ());

    for object in slam.objects() {
        let ellipsoid = object.ellipsoid();
        let center: [f64; 3] = ellipsoid.center().into();
        let size: [f64; 3] = (2.0 * ellipsoid.semi_axes).into();
        // Of rotation, translation, logarithms of the semi-axes.
        let variances = object.covariance().diagonal();
        let sigmas: [f64; 3] = variances.fixed_rows::<3>(3).map(f64::sqrt).into();
        let (id, label) = (object.id, object.label());
        println!(
            "{label} {id}: centre {center:.2?} m, standard deviations {sigmas:.3?} m, size {size:.2?} m"
        );
    }
    Ok(())
}
