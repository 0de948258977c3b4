//! Objects that were pushed: the latest measurements agree with one another and not with what is known from before.
//!
//! Asked about objects of which boxes are found elsewhere while others are where they were. What is a few centimetres off may as
//! well be the robot, unless the other objects of the same image say otherwise.

use super::MapObject;
use crate::{
    geometry::{Ellipsoid, Pose},
    graph::{EllipsoidPrior, Graph, Noise, NoiseError, PoseId},
};
use nalgebra::{Point3, SVector, Vector2};
use std::collections::VecDeque;

/// Where one measurement saw an object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Its centre in the map.
    pub(super) center: Point3<f64>,
    /// The larger horizontal variance of that (m^2).
    pub(super) variance: f64,
    /// Where the robot was in the map.
    pub(super) eye: Point3<f64>,
    /// Its number, counted from one.
    order: u32,
    /// Whether the other objects of the image tell how far the robot is off, and the centre is without that.
    is_relative: bool,
}

/// The latest looks at an object.
#[derive(Clone, Debug, Default)]
pub(super) struct Looks {
    latest: VecDeque<Look>,
    count: u32,
}

impl Looks {
    /// Adds one and returns its number.
    pub(super) fn push(&mut self, (center, variance): (Point3<f64>, f64), eye: Point3<f64>) -> u32 {
        self.count += 1;
        self.latest.push_back(Look {
            center,
            variance,
            eye,
            order: self.count,
            is_relative: false,
        });
        while self.latest.len() > REMEMBERED {
            self.latest.pop_front();
        }
        self.count
    }

    /// How many there have been.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// How many of them saw its centre within so much of a place (m).
    pub(super) fn near(&self, place: &Point3<f64>, reach_m: f64) -> usize {
        let is_near = |look: &&Look| nalgebra::distance(&look.center, place) < reach_m;
        self.latest.iter().filter(is_near).count()
    }

    /// Takes out of the latest one what the robot's pose is off (m), with the variance of that (m^2).
    fn relate_last(&mut self, (shift, variance): (Vector2<f64>, f64)) {
        if let Some(look) = self.latest.back_mut() {
            look.center -= shift.push(0.0);
            look.variance += variance;
            look.is_relative = true;
        }
    }

    pub(super) fn clear(&mut self) {
        self.latest.clear();
    }

    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        for look in &mut self.latest {
            look.center = new_from_old * look.center;
            look.eye = new_from_old * look.eye;
        }
    }

    /// Since which look the object has been elsewhere, and where, if it was pushed: a change-point test (Page 1954) with a
    /// window. The latest looks come from two places, agree with one another, and are farther off than errors
    /// are from what was seen of it from the same side before, or else from the estimate. `known` is its centre with the
    /// larger horizontal variance.
    ///
    /// A shift that is so small that the boxes still fit the object (`is_small`) is believed only between looks of which the other
    /// objects of each image say how far the robot is off, and from the same side.
    pub(super) fn change(
        &self,
        known: (Point3<f64>, f64),
        is_small: bool,
    ) -> Option<(u32, Vector2<f64>)> {
        let first = self.latest.len().checked_sub(WINDOW)?;
        let recent: Vec<&Look> = self.latest.range(first..).collect();
        if is_small && !recent.iter().all(|look| look.is_relative) {
            return None;
        }
        let (mean, variance) = mean_of(&recent)?;
        let jitter_m = if is_small { RELATIVE_JITTER_M } else { JITTER_M };
        let agrees = |look: &&Look| {
            (look.center.xy() - mean).norm() < SIGMAS * (look.variance + jitter_m.powi(2)).sqrt()
        };
        let places = |a: &&Look| recent.iter().any(|b| (a.eye - b.eye).norm() > OTHER_PLACE_M);
        if !recent.iter().all(agrees) || !recent.iter().any(places) {
            return None;
        }
        // Single frames are wrong alike as long as they are made from the same side.
        let side = |look: &Look| (look.eye - look.center).xy();
        let is_same_side = |look: &&Look| {
            recent.iter().any(|other| side(look).angle(&side(other)) < SAME_SIDE_RAD)
        };
        let is_comparable = |look: &&Look| look.is_relative || !is_small;
        let before = self.latest.range(..first).filter(is_same_side).filter(is_comparable);
        let before: Vec<&Look> = before.collect();
        let (center, doubt) = match mean_of(&before).filter(|_| before.len() >= WINDOW) {
            Some((before, doubt)) => (before, doubt),
            None if is_small => return None,
            None => (known.0.xy(), known.1 + SIDES_DIFFER_M.powi(2)),
        };
        let shift = mean - center;
        let sigma = (variance + doubt + jitter_m.powi(2)).sqrt();
        let is_elsewhere = shift.norm() > (SIGMAS * sigma).max(LEAST_SHIFT_M);
        is_elsewhere.then(|| (recent[0].order, mean.coords))
    }
}

/// The mean of what some looks saw, on the ground, and its variance (m^2).
fn mean_of(looks: &[&Look]) -> Option<(nalgebra::Point2<f64>, f64)> {
    let count = looks.len() as f64;
    if looks.is_empty() {
        return None;
    }
    let sum: Vector2<f64> = looks.iter().map(|look| look.center.xy().coords).sum();
    let variance = looks.iter().map(|look| look.variance).sum::<f64>() / count;
    Some(((sum / count).into(), variance / count))
}

impl MapObject {
    /// Counts a look that did not fit. If it was pushed, its estimate goes there, as large as it was, and only what was seen
    /// of it since then is kept. Returns the poses of what was forgotten; nothing if it was not pushed.
    pub(super) fn follow(
        &mut self,
        graph: &mut Graph,
        is_small: bool,
    ) -> Result<Option<Vec<PoseId>>, NoiseError> {
        if !self.counts() || self.locked || self.glimpsed {
            return Ok(None);
        }
        let covariance = self.covariance();
        let known = (self.estimate().center(), covariance[(3, 3)].max(covariance[(4, 4)]));
        let Some((since, place)) = self.looks.change(known, is_small) else { return Ok(None) };
        let mut there = *self.estimate();
        there.pose.translation.vector.x = place.x;
        there.pose.translation.vector.y = place.y;
        self.looks.clear();
        self.company.acquit();
        let old: Vec<_> = self.views.all().filter(|view| view.order < since).cloned().collect();
        self.views.take(graph, &old);
        let forgotten: Vec<PoseId> = old.iter().map(|view| view.keyframe.pose).collect();
        self.forget_ties(graph, &forgotten);
        self.remember_size(graph, &there)?;
        graph.set_ellipsoid(self.variable, there);
        Ok(Some(forgotten))
    }

    /// The latest look fits the object, more or less, and the other objects of its image say how far the robot is off (m, with its
    /// variance), if there are enough. Returns the poses of what was forgotten if all such looks together say that it was pushed a
    /// little.
    pub(super) fn follow_little(
        &mut self,
        graph: &mut Graph,
        of_pose: Option<(Vector2<f64>, f64)>,
    ) -> Result<Vec<PoseId>, NoiseError> {
        let Some(of_pose) = of_pose else { return Ok(Vec::new()) };
        self.looks.relate_last(of_pose);
        Ok(self.follow(graph, true)?.unwrap_or_default())
    }

    /// Of a thing that stands elsewhere, the size is known from before.
    fn remember_size(&mut self, graph: &mut Graph, there: &Ellipsoid) -> Result<(), NoiseError> {
        let known = self.own_covariance();
        let mut sigmas = SVector::<f64, 9>::from(ANYWHERE);
        for i in 6..9 {
            sigmas[i] = known[(i, i)].sqrt().max(LEAST_SIZE_SIGMA);
        }
        let noise = Noise::from_sigmas(sigmas.into())?;
        self.replace_prior(graph, EllipsoidPrior::new(self.variable, *there, noise));
        Ok(())
    }
}

/// Looks that are remembered.
const REMEMBERED: usize = 30;
/// Looks that have to agree before an object is believed to have been pushed.
const WINDOW: usize = 5;
/// They come from places so far apart (m).
const OTHER_PLACE_M: f64 = 0.05;
/// Standard deviations that errors of measurements rarely exceed.
const SIGMAS: f64 = 3.0;
/// Besides what a measurement says of itself, how far its place in the map is off: that of the robot's pose (m).
const JITTER_M: f64 = 0.02;
/// The same where the other objects of the image say how far that is off (m).
const RELATIVE_JITTER_M: f64 = 0.01;
/// Looks from directions within this are wrong alike (rad),
const SAME_SIDE_RAD: f64 = 0.35;
/// and such as are not differ by so much more than they say (m).
const SIDES_DIFFER_M: f64 = 0.04;
/// Nobody needs to know of less (m).
const LEAST_SHIFT_M: f64 = 0.06;
/// Of a thing that was pushed neither place nor heading is known (rad, m); the last three are set from its size.
const ANYWHERE: [f64; 9] = [10.0, 10.0, 10.0, 100.0, 100.0, 100.0, 1.0, 1.0, 1.0];
/// No size is known better, as a share of it.
const LEAST_SIZE_SIGMA: f64 = 0.03;
