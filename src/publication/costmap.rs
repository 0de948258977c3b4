//! The ground that objects cover, bounded in cells and in how often it is published.

use crate::{
    config::GroundSettings,
    geometry::GroundGrid,
    mapping::{MapObject, footprint_of},
    msg::{convert::occupancy_grid, nav_msgs::OccupancyGrid},
    time::Stamp,
};

/// Least time between two costmaps (s): planners ask for no more.
const PERIOD_S: f64 = 1.0;
/// A square of 50 m at 5 cm: larger maps get larger cells.
const MOST_CELLS: usize = 1 << 20;

/// What was published last.
#[derive(Debug, Default)]
pub(super) struct Costmap {
    published: Option<(Stamp, GroundGrid)>,
    /// Whether objects have changed since it was looked at.
    changed: bool,
}

impl Costmap {
    /// Objects have changed.
    pub(super) fn note_change(&mut self) {
        self.changed = true;
    }

    /// Whether there may be another one to publish.
    pub(super) fn is_due(&self, now: Stamp) -> bool {
        let passed = self.published.as_ref().map(|(at, _)| now.seconds_since(*at));
        self.changed && passed.is_none_or(|passed| !(0.0..PERIOD_S).contains(&passed))
    }

    /// The costmap, if it is not what was published last. What moves by itself is not in it, nor what a robot on a floor of
    /// this height (m) passes under.
    pub(super) fn next<'a>(
        &mut self,
        objects: impl Iterator<Item = &'a MapObject>,
        floor_m: f64,
        settings: &GroundSettings,
        (stamp, frame_id): (Stamp, &str),
    ) -> Option<OccupancyGrid> {
        self.changed = false;
        let is_in_the_way = |object: &&MapObject| {
            let body = object.ellipsoid();
            let bottom_m = body.center().z - body.semi_axes.z;
            !object.moves && bottom_m < floor_m + settings.robot_height_m
        };
        let footprint = |object: &MapObject| {
            let mut body = object.oriented_box(0.0);
            body.half_extents.add_scalar_mut(settings.inflation_m);
            footprint_of(&body, object.outline)
        };
        let footprints: Vec<_> = objects.filter(is_in_the_way).map(footprint).collect();
        let grid = GroundGrid::covering(&footprints, settings.cell_m, MOST_CELLS);
        if self.published.as_ref().is_some_and(|(_, before)| *before == grid) {
            return None;
        }
        let message = occupancy_grid(&grid, stamp, frame_id);
        self.published = Some((stamp, grid));
        Some(message)
    }
}
