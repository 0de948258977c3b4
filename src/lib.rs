//! Object-level SLAM for indoor robots: from RGB-D frames, 2D boxes and odometry to a map of ellipsoids.
//!
//! # From arrays
//!
//! One call an image: its stamp, the camera, the camera's pose, depth, and a detector's boxes.
//!
//! ```
//! use ellipsoid_slam::pipeline::{ObjectSlam, RgbdFrame, Settings};
//! # mod suitcase { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/suitcase/mod.rs")); }
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let camera = suitcase::camera()?;
//!
//! let mut slam = ObjectSlam::new(Settings::default());
//! for look in suitcase::looks(&camera) {
//!     let frame = RgbdFrame::new(look.stamp, &camera, &look.odom_from_camera, &look.depth_m)?
//!         .with_box(look.corners, "suitcase", 0.9)?;
//!     slam.see(frame);
//! }
//! slam.finish(&mut ());
//!
//! let found: Vec<_> = slam.objects().collect();
//! assert_eq!((found.len(), found[0].label()), (1, "suitcase"));
//! let height_m = 2.0 * found[0].ellipsoid().semi_axes.z;
//! assert!((height_m - 0.5).abs() < 0.03);
//! # Ok(())
//! # }
//! ```
//!
//! - The pose `odom_from_camera` is that of the optical frame: x right, y down, z forward. Its fixed frame has **z up**, against gravity:
//!   drift along and about z is corrected, a tilt of the frame is not.
//! - Depth is in metres along the optical axis, row by row, zero or NaN where there is none, aligned to the image in which the boxes
//!   are; pixel centres have integer coordinates.
//! - Labels are those of the configuration's classes where they are to have a usual size and symmetry: names of COCO.
//! - Stamps grow. What comes of an image may be in the update of the next one.
//!
//! # From messages
//!
//! [`pipeline::ObjectSlam::handle`] takes one [`pipeline::Input`] after another, in the order in which they came: calibration, odometry or
//! transforms, depth, and the boxes whenever the detector has them, with the stamp of their image. It pairs them by stamp, interpolates poses,
//! registers depth to colour, and says in [`pipeline::Update`] what happened and what could not be used. [`io::BagInput`] makes inputs of bags.
//! The programs in `examples/` do all this; `ask_the_map` shows what the map answers.
//!
//! [`nalgebra`] is re-exported: its types are in the interface.
//!
//! # Features
//!
//! All of these are on by default. `default-features = false` leaves the method, its settings and its map files, with half of the crates; `bags` adds
//! messages of ROS 2 and bags of them, `detector` a 2D detector, `sim` scenes with exact truth, `publication` and `report` what is published and shown of a run,
//! `jazzy` (or another distribution of ROS 2) the live node, `cli` the program.
//!
//! # The house
//!
//! In reading order; every layer uses only layers above it, and a test holds this.

pub use nalgebra;

pub mod time;

pub mod geometry;

pub mod perception;

pub mod graph;

pub mod mapping;

pub mod pipeline;

pub mod config;

#[cfg(feature = "bags")]
pub mod msg;

#[cfg(feature = "bags")]
pub mod topics;

#[cfg(feature = "detector")]
pub mod detector;

#[cfg(feature = "publication")]
pub mod publication;

#[cfg(feature = "report")]
pub mod report;

pub mod io;

#[cfg(feature = "ros")]
pub mod ros;

#[cfg(feature = "sim")]
pub mod sim;

pub mod eval;

#[cfg(feature = "cli")]
pub mod cli;
