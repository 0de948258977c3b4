//! What a run saw and made of it, to be looked at: one page for a browser, a plan and pictures.
//!
//! [`Recorder`] takes note during the run, within bounds; [`Recorded`] is what is left at its end. The page is one file that
//! needs no other: `web` has its parts, of which `three.js` is made by `web/bundle.sh` and the others are read as they are.

mod color_images;
mod crops;
mod overlay;
mod page;
mod picture;
mod plan;
mod points;
mod recorded;
mod recorder;
mod series;
mod sides;
mod thinned;
mod tracks;
mod truth;

pub use color_images::ColorImages;
pub use page::{Clock, Page};
pub use plan::plan;
pub use points::{Anchor, Cloud, Placed};
pub use recorded::Recorded;
pub use recorder::{MAX_OVERLAYS, Recorder};
pub use truth::{Truth, estimated};

/// To the millimetre, the millisecond or a thousandth: what is drawn needs no more.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
