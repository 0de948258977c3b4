//! Which sides of objects were seen.

use crate::{
    geometry::{Pose, yaw_of},
    mapping::ObjectId,
    perception::{EllipsoidMeasurement, Side},
};
use std::{collections::BTreeMap, f64::consts::FRAC_PI_2};

/// For each face -x, +x, -y, +y, -z, +z, how often it was seen, supported, mirrored, told by the box, cut and hidden.
pub(super) type SideCounts = [[u32; 6]; 6];

#[derive(Clone, Copy, Debug, Default)]
struct Counted {
    /// Heading of the x axis that faces are named by (rad).
    heading: f64,
    counts: SideCounts,
}

#[derive(Debug, Default)]
pub(super) struct Sides {
    by_object: BTreeMap<ObjectId, Counted>,
}

impl Sides {
    /// Counts the faces of a measurement of an object that is turned by `heading` (rad) in the map.
    pub(super) fn add(
        &mut self,
        object: ObjectId,
        heading: f64,
        measured: &EllipsoidMeasurement,
        map_from_camera: &Pose,
    ) {
        let new = Counted { heading, ..Counted::default() };
        let counted = self.by_object.entry(object).or_insert(new);
        // The estimate turns as it gets better; its axes may be called otherwise from one image to the next.
        let turned = heading - counted.heading;
        counted.heading += turned - FRAC_PI_2 * (turned / FRAC_PI_2).round();
        let own = yaw_of(&(map_from_camera * measured.ellipsoid.pose));
        let quarters = quarters(own - counted.heading);
        for (face, side) in measured.sides.iter().enumerate() {
            counted.counts[turned_face(face, quarters)][kind(*side)] += 1;
        }
    }

    /// Two objects were one.
    pub(super) fn merge(&mut self, kept: ObjectId, gone: ObjectId) {
        let Some(gone) = self.by_object.remove(&gone) else { return };
        let own = self.by_object.entry(kept).or_insert(Counted { counts: [[0; 6]; 6], ..gone });
        let quarters = quarters(gone.heading - own.heading);
        for (face, counts) in gone.counts.iter().enumerate() {
            let into = &mut own.counts[turned_face(face, quarters)];
            into.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
    }

    /// The map got another frame.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        let turn = yaw_of(new_from_old);
        self.by_object.values_mut().for_each(|counted| counted.heading += turn);
    }

    /// The counts of an object, by the faces of a body of that heading.
    pub(super) fn of(&self, object: ObjectId, heading: f64) -> Option<SideCounts> {
        let counted = self.by_object.get(&object)?;
        let quarters = quarters(counted.heading - heading);
        let mut counts = [[0; 6]; 6];
        (0..6).for_each(|face| counts[turned_face(face, quarters)] = counted.counts[face]);
        Some(counts)
    }
}

fn quarters(angle: f64) -> usize {
    ((angle / FRAC_PI_2).round() as i64).rem_euclid(4) as usize
}

/// Which face it is after so many quarter turns from x to y.
fn turned_face(face: usize, quarters: usize) -> usize {
    /// +x, +y, -x, -y.
    const ROUND: [usize; 4] = [1, 3, 0, 2];
    match ROUND.iter().position(|upright| *upright == face) {
        Some(at) => ROUND[(at + quarters) % 4],
        None => face,
    }
}

fn kind(side: Side) -> usize {
    match side {
        Side::Seen => 0,
        Side::Support => 1,
        Side::Mirrored => 2,
        Side::Outline => 3,
        Side::Cut => 4,
        Side::Hidden => 5,
    }
}
