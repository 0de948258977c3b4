//! Where a robot can stand before an object.

use super::MapObject;
use crate::geometry::{Pose, from_segment, points_around, polygon_distance, segments_cross};
use nalgebra::{Point2, Translation3, UnitQuaternion, Vector3};
use thiserror::Error;

/// How near a robot comes, and what it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachSettings {
    /// From the object's footprint to the robot's base (m).
    pub distance_m: f64,
    /// Of the circle round the base that has to be free of other objects and of walls (m).
    pub robot_radius_m: f64,
    /// Objects whose lower side is higher above the floor are not in the way (m).
    pub robot_height_m: f64,
}

/// What is known of the ground round about.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// The objects of the map.
    pub objects: &'a [MapObject],
    /// Walls, from where to where (m).
    pub walls: &'a [[Point2<f64>; 2]],
    /// Where the robot's base is, on the floor: `map_from_base`.
    pub base: &'a Pose,
}

/// Why there is no place before an object.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoApproach {
    /// Such a distance cannot be kept.
    #[error(
        "a distance of {distance_m} m is not between the robot's radius of {robot_radius_m} m and 10 m"
    )]
    BadDistance {
        /// What was asked for.
        distance_m: f64,
        /// The robot's radius.
        robot_radius_m: f64,
    },
    /// Everything round it is taken.
    #[error(
        "nowhere {distance_m} m before {object} is free: of {places} places {at_objects} are within {robot_radius_m} m of other \
         objects, the others within that of walls or behind them"
    )]
    NothingFree {
        /// The object's label and number.
        object: String,
        /// What was asked for.
        distance_m: f64,
        /// The robot's radius.
        robot_radius_m: f64,
        /// Places that were looked at.
        places: usize,
        /// Those of them that are taken by other objects.
        at_objects: usize,
    },
}

/// A footprint with the height of the object's lower side.
struct Standing {
    corners: Vec<Point2<f64>>,
    bottom_m: f64,
}

impl Standing {
    fn of(object: &MapObject) -> Self {
        let body = object.ellipsoid();
        Self { corners: object.footprint(0.0), bottom_m: body.center().z - body.semi_axes.z }
    }

    fn distance_m(&self, point: &Point2<f64>) -> f64 {
        polygon_distance(&self.corners, point).0
    }
}

impl Surroundings<'_> {
    /// The pose on the floor from which a robot faces an object, `distance_m` before its footprint: the one nearest to the robot
    /// of those where nothing is in the way. Before something that stands on something else it is as far from that, and as
    /// near to the object as can be.
    ///
    /// # Errors
    /// When the distance is no distance, or nothing is free; in a sentence.
    pub fn approach(
        &self,
        target: &MapObject,
        settings: &ApproachSettings,
    ) -> Result<Pose, NoApproach> {
        let ApproachSettings { distance_m, robot_radius_m, .. } = *settings;
        if !(robot_radius_m..=FARTHEST_M).contains(&distance_m) {
            return Err(NoApproach::BadDistance { distance_m, robot_radius_m });
        }
        let own = Standing::of(target);
        let center = target.ellipsoid().center().xy();
        let floor_m = self.base.translation.z;
        let others = self.objects.iter().filter(|object| object.id != target.id).map(Standing::of);
        let others: Vec<Standing> =
            others.filter(|other| other.bottom_m < floor_m + settings.robot_height_m).collect();
        let carries = |other: &&Standing| {
            other.bottom_m < own.bottom_m - CARRIED_M && other.distance_m(&center) < 0.0
        };
        let carrier = others.iter().find(carries);
        let from = match carrier {
            Some(_) => center,
            None => self.base.translation.vector.xy().into(),
        };
        let places = points_around(
            &carrier.unwrap_or(&own).corners,
            distance_m,
            STEP_M.max(distance_m / 20.0),
        );
        let is_at_object = |place: &Point2<f64>| {
            others.iter().any(|other| other.distance_m(place) < robot_radius_m * ROUNDING)
        };
        let is_at_wall = |place: &Point2<f64>| {
            self.walls.iter().any(|wall| {
                from_segment(wall, place).norm() < robot_radius_m
                    || segments_cross(wall, &[*place, center])
            })
        };
        let at_objects = places.iter().filter(|place| is_at_object(place)).count();
        let free = places.iter().filter(|place| !is_at_object(place) && !is_at_wall(place));
        let nearest = free.min_by(|a, b| {
            nalgebra::distance_squared(a, &from).total_cmp(&nalgebra::distance_squared(b, &from))
        });
        let Some(place) = nearest else {
            return Err(NoApproach::NothingFree {
                object: format!("{} {}", target.name(), target.id),
                distance_m,
                robot_radius_m,
                places: places.len(),
                at_objects,
            });
        };
        let ahead = center - place;
        let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), ahead.y.atan2(ahead.x));
        Ok(Pose::from_parts(Translation3::new(place.x, place.y, floor_m), heading))
    }
}

/// Between places that are looked at (m).
const STEP_M: f64 = 0.05;
const FARTHEST_M: f64 = 10.0;
/// What begins so much higher than something that is under its middle stands on it (m).
const CARRIED_M: f64 = 0.1;
/// A carrier is exactly as far away as was asked for, which may be the radius.
const ROUNDING: f64 = 1.0 - 1e-9;
