//! Odometry as one track: where its frame jumps, the robot did not.
//!
//! Base drivers begin at zero again when they are restarted, and some correct themselves by a leap. Between two readings
//! that follow each other closely a robot goes hardly anywhere: what is more is taken for a move of odometry's frame, and
//! the track goes on where it was. `map -> odom` leaps instead, as it may (REP 105).

use super::{
    OdometryMessage,
    history::{History, Jump, Outside},
};
use crate::{
    geometry::{Pose, local, retract},
    time::Stamp,
};
use nalgebra::Vector6;
use std::collections::VecDeque;

#[derive(Debug)]
pub(super) struct Odometry {
    pub(super) frame_id: String,
    pub(super) child_frame_id: String,
    /// Of the base, in the frame that odometry had at first.
    history: History,
    /// Of the latest readings, as they came.
    covariances: VecDeque<(Stamp, Box<[f64; 36]>)>,
    /// The latest reading, as it came.
    latest: Option<(Stamp, Pose)>,
    /// How the base moved to it, `[rotation, translation]` a second in its own frame.
    velocity: Option<Vector6<f64>>,
    /// From when on odometry's frame was where in the one that it had at first.
    moves: VecDeque<(Stamp, Pose)>,
}

/// Where the base is by odometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// As it came.
    pub(super) odom_from_base: Pose,
    /// Where odometry's frame is in the one that it had at first.
    pub(super) start_from_odom: Pose,
}

impl Reading {
    /// Where the base is in the frame that odometry had at first: nothing jumps there.
    pub(super) fn start_from_base(&self) -> Pose {
        self.start_from_odom * self.odom_from_base
    }
}

impl Odometry {
    /// Nothing has come yet in these frames.
    pub(super) fn of(message: &OdometryMessage) -> Self {
        Self {
            frame_id: message.frame_id.clone(),
            child_frame_id: message.child_frame_id.clone(),
            history: History::changing(),
            covariances: VecDeque::new(),
            latest: None,
            velocity: None,
            moves: VecDeque::new(),
        }
    }

    /// Takes a reading. Returns what happened if the frame jumped with it.
    pub(super) fn push(&mut self, message: OdometryMessage) -> Option<String> {
        let OdometryMessage { stamp, odom_from_base, covariance, .. } = message;
        let reading = (stamp, &odom_from_base);
        let jump = (self.latest.zip(self.velocity))
            .and_then(|(latest, velocity)| jump(latest, &velocity, reading));
        self.velocity = self.latest.and_then(|(before, from)| {
            let seconds = stamp.seconds_since(before);
            // The step of a jump is no motion, and the one after it is judged by the motion before.
            let is_motion = jump.is_none() && seconds > 0.0;
            if is_motion { Some(local(&from, &odom_from_base) / seconds) } else { self.velocity }
        });
        if let (Some(_), Some((_, latest))) = (&jump, self.latest) {
            let moved = self.start_from_odom(stamp) * latest * odom_from_base.inverse();
            self.moves.push_back((stamp, moved));
            while self.moves.len() > MAX_MOVES {
                self.moves.pop_front();
            }
        }
        self.latest = Some((stamp, odom_from_base));
        self.history.push(stamp, self.start_from_odom(stamp) * odom_from_base);
        self.covariances.extend(covariance.map(|c| (stamp, c)));
        while self.covariances.len() > MAX_COVARIANCES {
            self.covariances.pop_front();
        }
        jump
    }

    /// The clock jumped back.
    pub(super) fn jump_back(&mut self, jump: &Jump) {
        self.history.jump_back(jump);
        self.covariances.retain(|(stamp, _)| !jump.is_before(*stamp));
        // What moved before is moved in the new time, too.
        if let Some((_, last)) = self.moves.pop_back() {
            self.moves = [(jump.to, last)].into();
        }
    }

    pub(super) fn at(&self, stamp: Stamp) -> Result<Reading, Outside> {
        let start_from_base = self.history.at(stamp)?;
        if self.moves.is_empty() {
            let start_from_odom = Pose::identity();
            return Ok(Reading { odom_from_base: start_from_base, start_from_odom });
        }
        let start_from_odom = self.start_from_odom(stamp);
        Ok(Reading { odom_from_base: start_from_odom.inv_mul(&start_from_base), start_from_odom })
    }

    fn start_from_odom(&self, stamp: Stamp) -> Pose {
        let moved = self.moves.iter().rev().find(|(since, _)| *since <= stamp);
        moved.map_or_else(Pose::identity, |(_, pose)| *pose)
    }

    pub(super) fn covariance_at(&self, stamp: Stamp) -> Option<Box<[f64; 36]>> {
        let apart = |reading: &&(Stamp, _)| reading.0.seconds_since(stamp).abs();
        let nearest = self.covariances.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        Some(nearest.1.clone())
    }
}

/// What happened between two readings if no robot can do it: it went neither so far from where it was, nor from where it
/// would have come at the velocity (a second, in its own frame) that it had.
fn jump(
    (before, from): (Stamp, Pose),
    velocity: &Vector6<f64>,
    (stamp, to): (Stamp, &Pose),
) -> Option<String> {
    let seconds = stamp.seconds_since(before);
    let is_beyond = |expected: &Pose| {
        let way = expected.inv_mul(to);
        let (metres, radians) = (way.translation.vector.norm(), way.rotation.angle());
        metres > LEAST_JUMP_M + MAX_SPEED * seconds
            || radians > LEAST_JUMP_RAD + MAX_TURN_RATE * seconds
    };
    let is_jump = is_beyond(&from) && is_beyond(&retract(&from, &(velocity * seconds)));
    let way = from.inv_mul(to);
    (seconds > 0.0 && seconds < JUDGED_S && is_jump).then(|| {
        format!(
            "the odometry moved by {:.2} m and {:.0} degrees within {seconds:.3} s: taken for a jump of its frame, \
             not of the robot",
            way.translation.vector.norm(),
            way.rotation.angle().to_degrees()
        )
    })
}

/// No robot indoors is faster (m/s, rad/s),
const MAX_SPEED: f64 = 3.0;
const MAX_TURN_RATE: f64 = 4.0;
/// and what is less does no harm (m, rad).
const LEAST_JUMP_M: f64 = 0.1;
const LEAST_JUMP_RAD: f64 = 0.1;
/// Between readings that are farther apart too much may have happened (s).
const JUDGED_S: f64 = 0.5;
/// Jumps that are remembered: far more than while an image waits.
const MAX_MOVES: usize = 16;
/// Covariances kept: ten seconds at 100 Hz, as long as an image may wait for its boxes.
const MAX_COVARIANCES: usize = 1000;
