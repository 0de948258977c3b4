//! Walls as landmarks: they hold the robot's heading and place where objects are rarely seen twice.

use super::{
    SlamSettings,
    gate::Step,
    odometry::{KeyframeId, Place},
};
use crate::{
    geometry::{Pose, Wall, adjoint},
    graph::{
        Factor, FactorId, Graph, NoiseError, PoseId, RightAngle, Variable, WallId, WallObservation,
    },
};
use nalgebra::{DMatrix, DVector, Matrix6, Point2, Point3, Vector3};
use std::{collections::BTreeMap, f64::consts::FRAC_PI_2};

/// What one image shows of a wall, in the frame of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSighting {
    /// The middle of what is seen (m).
    pub center: Point3<f64>,
    /// Horizontal unit vector to the side from where it is seen.
    pub normal: Vector3<f64>,
    /// Half of the length that is seen (m).
    pub half_length_m: f64,
    /// Standard deviations of the normal's direction (rad) and of the distance at the middle (m).
    pub sigmas: [f64; 2],
}

impl WallSighting {
    fn factor(&self, pose: PoseId, wall: WallId) -> Result<WallObservation, NoiseError> {
        WallObservation::new((pose, wall), (self.center, self.normal), self.sigmas)
    }

    /// Where it is in the map.
    fn in_map(&self, map_from_base: &Pose) -> Wall {
        let normal = map_from_base * self.normal;
        Wall { point: (map_from_base * self.center).xy(), heading: normal.y.atan2(normal.x) }
    }
}

/// A wall of the map.
#[derive(Clone, Debug)]
struct MapWall {
    variable: WallId,
    /// From where to where it has been seen, along the wall from its point (m).
    span: (f64, f64),
    /// By the square metre that it was seen from.
    views: BTreeMap<[i64; 2], Vec<WallView>>,
}

#[derive(Clone, Copy, Debug)]
struct WallView {
    keyframe: KeyframeId,
    factor: FactorId,
}

/// A sighting that has become a factor of the graph's next update.
#[derive(Debug)]
pub(super) struct Tied {
    /// The wall's place among all.
    at: usize,
    variable: WallId,
    square: [i64; 2],
    span: (f64, f64),
    view: WallView,
    forgotten: Option<FactorId>,
}

/// All walls, in the order in which they were first seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    all: Vec<MapWall>,
}

/// The pose from where walls are seen, before they have been looked at.
struct Eye<'a> {
    graph: &'a Graph,
    step: &'a Step,
    map_from_base: Pose,
}

impl Walls {
    /// Gives the graph a factor for each wall in sight of a new keyframe; [`Walls::settle`] has to follow when the update
    /// succeeds. A wall that may be one of several, or is hardly where one of them is, is left out.
    pub(super) fn tie(
        &self,
        graph: &mut Graph,
        (place, step): (&Place, Option<&Step>),
        sightings: &[WallSighting],
        settings: &SlamSettings,
    ) -> Result<Vec<Tied>, NoiseError> {
        let map_from_base = place.map_from_base(graph);
        let mut tied: Vec<Tied> = Vec::new();
        for sighting in sightings {
            let seen = sighting.in_map(&map_from_base);
            let eye = step.map(|step| Eye { graph, step, map_from_base });
            let found =
                eye.as_ref().map_or(Ok(Found::New), |eye| self.find(eye, sighting, &seen))?;
            let (at, variable) = match found {
                Found::Unclear => continue,
                Found::Known(at) if tied.iter().any(|t| t.at == at) => continue,
                Found::Known(at) => (at, self.all[at].variable),
                Found::New => {
                    let square =
                        eye.and_then(|eye| self.square_with(&eye, sighting, &seen, settings));
                    let new = tied.iter().filter(|t| t.at >= self.all.len()).count();
                    (self.all.len() + new, begin(graph, seen, square, settings)?)
                }
            };
            let wall = graph.wall(variable);
            let factor = sighting.factor(place.keyframe.pose, variable)?;
            let factor = graph.add_factor(factor.with_kernel(settings.robust_kernel()));
            let base = map_from_base.translation.vector.xy() - wall.point.coords;
            let square =
                [wall.along(), wall.normal()].map(|d| (d.dot(&base) / SQUARE_M).floor() as i64);
            let middle = wall.along().dot(&(seen.point - wall.point));
            tied.push(Tied {
                at,
                variable,
                square,
                span: (middle - sighting.half_length_m, middle + sighting.half_length_m),
                view: WallView { keyframe: place.keyframe, factor },
                forgotten: self.least_needed(at, square),
            });
        }
        tied.iter().filter_map(|t| t.forgotten).for_each(|factor| graph.remove_factor(factor));
        Ok(tied)
    }

    /// Takes over what [`Walls::tie`] gave the graph. Returns the poses whose sightings were forgotten.
    pub(super) fn settle(&mut self, tied: Vec<Tied>) -> Vec<PoseId> {
        let mut forgotten = Vec::new();
        for tied in tied {
            if tied.at == self.all.len() {
                let (variable, span) = (tied.variable, tied.span);
                self.all.push(MapWall { variable, span, views: BTreeMap::new() });
            }
            let wall = &mut self.all[tied.at];
            wall.span = (wall.span.0.min(tied.span.0), wall.span.1.max(tied.span.1));
            let views = wall.views.entry(tied.square).or_default();
            let gone = views.iter().position(|view| Some(view.factor) == tied.forgotten);
            forgotten.extend(gone.map(|at| views.remove(at).keyframe.pose));
            views.push(tied.view);
        }
        forgotten
    }

    /// Where they are.
    pub(super) fn all<'a>(&'a self, graph: &'a Graph) -> impl Iterator<Item = Wall> + 'a {
        self.all.iter().map(|wall| graph.wall(wall.variable))
    }

    /// From where to where each has been seen, seen from above (m).
    pub(super) fn ends<'a>(
        &'a self,
        graph: &'a Graph,
    ) -> impl Iterator<Item = [Point2<f64>; 2]> + 'a {
        self.all.iter().map(|wall| {
            let at = graph.wall(wall.variable);
            [wall.span.0, wall.span.1].map(|along| at.point + at.along() * along)
        })
    }

    /// Which wall is seen.
    fn find(
        &self,
        eye: &Eye<'_>,
        sighting: &WallSighting,
        seen: &Wall,
    ) -> Result<Found, NoiseError> {
        let mut candidates: Vec<(f64, usize)> = Vec::new();
        for (at, wall) in self.all.iter().enumerate() {
            if wall.may_be(&eye.graph.wall(wall.variable), seen, sighting) {
                let distance = eye.squared_distance(wall.variable, sighting)?;
                candidates.extend(distance.filter(|d| *d < NEW_FROM).map(|d| (d, at)));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(match candidates[..] {
            [] => Found::New,
            [(least, _), ..] if least > SAME_UP_TO => Found::Unclear,
            [(least, at), (next, rival), ..]
                if next < least + AMBIGUITY && !self.are_one(eye, at, rival) =>
            {
                Found::Unclear
            }
            [(_, at), ..] => Found::Known(at),
        })
    }

    /// Whether two walls of the map are the same one, which was taken for new when nobody knew where the robot was.
    fn are_one(&self, eye: &Eye<'_>, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|at| eye.graph.wall(self.all[at].variable));
        let off = a.local(&b);
        off.x.abs() < SAME_RAD && off.y.abs() < SAME_M
    }

    /// The oldest wall that a new one is parallel to, or at right angles, as far as that can be told, and by how many quarter
    /// turns.
    fn square_with(
        &self,
        eye: &Eye<'_>,
        sighting: &WallSighting,
        seen: &Wall,
        settings: &SlamSettings,
    ) -> Option<(WallId, i8)> {
        let sigma = settings.right_angle_sigma_deg.to_radians();
        self.all.iter().filter(|_| sigma > 0.0).find_map(|wall| {
            let turn = eye.graph.wall(wall.variable).local(seen).x;
            let quarters = (turn / FRAC_PI_2).round();
            let off = turn - quarters * FRAC_PI_2;
            let may_be = off.abs() < MAX_OFF_SQUARE_RAD;
            let is_square = may_be && {
                let variance = eye.heading_variance(wall.variable) + sighting.sigmas[0].powi(2);
                off * off < (variance + sigma * sigma) * ANGLE_SIGMAS.powi(2)
            };
            is_square.then_some((wall.variable, quarters as i8))
        })
    }

    /// The view to forget for another one from the same square, where there are too many.
    fn least_needed(&self, at: usize, square: [i64; 2]) -> Option<FactorId> {
        let views = self.all.get(at)?.views.get(&square)?;
        let least = views.iter().min_by_key(|view| view.keyframe.worth())?;
        (views.len() >= MAX_SIMILAR).then_some(least.factor)
    }
}

/// A wall that is new, at right angles to another one where that is known.
fn begin(
    graph: &mut Graph,
    seen: Wall,
    square: Option<(WallId, i8)>,
    settings: &SlamSettings,
) -> Result<WallId, NoiseError> {
    let variable = graph.add_wall(seen);
    if let Some((other, quarters)) = square {
        let sigma = settings.right_angle_sigma_deg.to_radians();
        let angle = RightAngle::new(other, variable, quarters, sigma)?;
        graph.add_factor(angle.with_kernel(settings.robust_kernel()));
    }
    Ok(variable)
}

/// Which wall of the map a sighting shows.
enum Found {
    Known(usize),
    New,
    Unclear,
}

impl MapWall {
    /// A first look without covariances: whether it faces the same way, near where it has been seen.
    fn may_be(&self, estimate: &Wall, seen: &Wall, sighting: &WallSighting) -> bool {
        let off = estimate.local(seen);
        let middle = estimate.along().dot(&(seen.point - estimate.point));
        let gap_m = (self.span.0 - middle).max(middle - self.span.1) - sighting.half_length_m;
        off.x.abs() < MAX_TURN_RAD
            && estimate.signed_distance(&seen.point).abs() < MAX_OFF_M
            && gap_m < MAX_GAP_M
    }
}

impl Eye<'_> {
    /// The joint covariance of the pose from where it is seen and a wall.
    fn joint(&self, wall: WallId) -> DMatrix<f64> {
        let Some(last) = self.step.pose else { return DMatrix::zeros(8, 8) };
        let mut moved = DMatrix::identity(8, 8);
        moved.view_mut((0, 0), (6, 6)).copy_from(&adjoint(&self.step.pose_from_base.inverse()));
        let known = self.graph.covariance(&[last.into(), wall.into()]);
        let mut joint = &moved * known * moved.transpose();
        let step: Matrix6<f64> = self.step.covariance;
        let mut own = joint.view_mut((0, 0), (6, 6));
        own += step;
        joint
    }

    /// Mahalanobis' distance, squared; nothing where the robot is too lost for it to mean much: walls that are parallel are
    /// apart by less, then.
    fn squared_distance(
        &self,
        wall: WallId,
        sighting: &WallSighting,
    ) -> Result<Option<f64>, NoiseError> {
        let Some(pose) = self.step.pose else { return Ok(None) };
        let sigmas = [sighting.sigmas[0].hypot(UNEVEN_RAD), sighting.sigmas[1].hypot(UNEVEN_M)];
        let factor = WallSighting { sigmas, ..*sighting }.factor(pose, wall)?;
        let at = [Variable::Pose(self.map_from_base), Variable::Wall(self.graph.wall(wall))];
        let linear = factor.linearize(&at);
        let spread = &linear.jacobian * self.joint(wall) * linear.jacobian.transpose()
            + DMatrix::identity(2, 2);
        if spread[(1, 1)].sqrt() * sigmas[1] > LOST_M {
            return Ok(None);
        }
        let solved = spread.cholesky().map(|c| c.solve(&linear.residual));
        Ok(solved.map(|solved| linear.residual.dot(&solved)))
    }

    /// Of the angle between the robot and a wall (rad^2).
    fn heading_variance(&self, wall: WallId) -> f64 {
        let up = self.map_from_base.rotation.inverse() * Vector3::z();
        let mut row = DVector::zeros(8);
        row.fixed_rows_mut::<3>(0).copy_from(&up);
        row[6] = -1.0;
        (row.transpose() * self.joint(wall) * &row)[(0, 0)]
    }
}

/// Walls are not quite flat, and what is seen of them may be a door that stands open: standard deviations (rad, m).
const UNEVEN_RAD: f64 = 0.01;
const UNEVEN_M: f64 = 0.03;
/// Squared distances up to which it is the same wall, and from which on it is another one.
const SAME_UP_TO: f64 = 12.0;
const NEW_FROM: f64 = 30.0;
/// A robot whose distance from a wall is known no better than this does not know which wall it is: standard deviation (m).
const LOST_M: f64 = 0.25;
/// Where the nearest is nearer than the next one by less, nobody knows which it is.
const AMBIGUITY: f64 = 6.0;
/// Two walls of the map that differ by less are one (rad, m).
const SAME_RAD: f64 = 0.03;
const SAME_M: f64 = 0.1;
/// What differs by more is not looked at: drift is smaller (rad, m).
const MAX_TURN_RAD: f64 = 0.5;
const MAX_OFF_M: f64 = 1.5;
/// Between what has been seen of a wall and what is seen now, at most (m): rooms have walls in line that are not the same.
const MAX_GAP_M: f64 = 1.0;
/// Walls are taken for square within so many standard deviations,
const ANGLE_SIGMAS: f64 = 3.0;
/// and never beyond this (rad).
const MAX_OFF_SQUARE_RAD: f64 = 0.2;
/// Views from one square of this size are alike (m),
const SQUARE_M: f64 = 1.0;
/// and of such so many are kept.
const MAX_SIMILAR: usize = 4;
