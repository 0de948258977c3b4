//! A scene: objects with their true boxes, and the building around them.

use super::{
    crowded_scene::crowded_scene,
    desk_scene::desk_scene,
    desk_things::Model,
    home_scene::home_scene,
    mesh::Mesh,
    office_scene::office_scene,
    random::{Purpose, Random},
    settings::SceneKind,
};
use crate::geometry::{OrientedBox, Pose};
use nalgebra::{Isometry3, Point2, Point3, Translation3, Unit, UnitQuaternion, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A thing that stands somewhere.
#[derive(Clone, Debug)]
pub struct SceneObject {
    /// From 1; 0 is the building.
    pub id: u32,
    /// Class name as a COCO detector gives it.
    pub label: &'static str,
    /// `world_from_object`: the origin is the centre of the object's box, z is up and x the longer side.
    pub world_from_object: Pose,
    /// Full extents along the object's own axes (m): the tight box of its mesh.
    pub size: Vector3<f64>,
    /// In the world frame.
    pub mesh: Mesh,
}

impl SceneObject {
    /// The object's tight box.
    pub fn oriented_box(&self) -> OrientedBox {
        OrientedBox { pose: self.world_from_object, half_extents: self.size * 0.5 }
    }

    fn new(id: u32, model: Model, world_from_model: &Pose) -> Option<Self> {
        let (low, high) = model.mesh.bounds()?;
        let mut size = high - low;
        let center = nalgebra::center(&low, &high);
        let quarter_turn = if size.x < size.y { FRAC_PI_2 } else { 0.0 };
        if size.x < size.y {
            size.swap((0, 0), (1, 0));
        }
        let model_from_object = Isometry3::from_parts(
            Translation3::from(center.coords),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), quarter_turn),
        );
        Some(Self {
            id,
            label: model.label,
            world_from_object: world_from_model * model_from_object,
            size,
            mesh: model.mesh.transformed(world_from_model),
        })
    }
}

/// Objects, the building, and where a robot may go.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// In order of their ids, which count from 1.
    pub objects: Vec<SceneObject>,
    /// Floor and walls.
    pub building: Mesh,
    /// Where to go in it.
    pub(super) routes: Routes,
}

/// Places for trajectories, in the world's horizontal plane (m).
#[derive(Clone, Debug)]
pub(super) struct Routes {
    /// What an orbit looks at.
    pub(super) orbit_center: Point3<f64>,
    /// Mean radius of an orbit.
    pub(super) orbit_radius: f64,
    /// Waypoints of a walk from one end to the other.
    pub(super) forward: Vec<Point2<f64>>,
    /// Waypoints of a round walk; the last is followed by the first.
    pub(super) round: Vec<Point2<f64>>,
}

impl Default for Routes {
    fn default() -> Self {
        Self {
            orbit_center: Point3::origin(),
            orbit_radius: 1.0,
            forward: Vec::new(),
            round: Vec::new(),
        }
    }
}

/// Where a model is put.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Horizontal position (m).
    pub(super) x: f64,
    /// Horizontal position (m).
    pub(super) y: f64,
    /// Height of what it stands on (m).
    pub(super) height: f64,
    /// Heading (rad); at 0 the front faces -y.
    pub(super) yaw: f64,
}

impl Place {
    /// A place on the floor.
    pub(super) fn floor(x: f64, y: f64, yaw: f64) -> Self {
        Self { x, y, height: 0.0, yaw }
    }

    /// A place given relative to this one: on the table that stands here, say.
    pub(super) fn at(&self, x: f64, y: f64, height: f64, yaw: f64) -> Self {
        let (sin, cos) = self.yaw.sin_cos();
        Self {
            x: self.x + cos * x - sin * y,
            y: self.y + sin * x + cos * y,
            height: self.height + height,
            yaw: self.yaw + yaw,
        }
    }

    /// Moved and turned at random by at most so much.
    pub(super) fn jittered(&self, random: &mut Random, metres: f64, radians: f64) -> Self {
        Self {
            x: self.x + random.between(-metres, metres),
            y: self.y + random.between(-metres, metres),
            yaw: self.yaw + random.between(-radians, radians),
            ..*self
        }
    }

    fn world_from_model(&self) -> Pose {
        Isometry3::from_parts(
            Translation3::new(self.x, self.y, self.height),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw),
        )
    }
}

impl Scene {
    /// The scene of a kind, its poses, sizes and clutter drawn by `seed`.
    pub fn new(kind: SceneKind, seed: u64) -> Self {
        let mut random = Random::new(seed, Purpose::Scene, 0);
        match kind {
            SceneKind::Desk => desk_scene(&mut random),
            SceneKind::Home => home_scene(&mut random),
            SceneKind::Office => office_scene(&mut random),
            SceneKind::Crowded => crowded_scene(&mut random),
        }
    }

    /// The same scene with its first chair pushed away from the middle of an orbit by so much (m).
    pub(super) fn with_moved_chair(&self, by_m: f64) -> Self {
        let mut scene = self.clone();
        let center = self.routes.orbit_center.coords;
        if let Some(chair) = scene.objects.iter_mut().find(|object| object.label == "chair") {
            let outwards = (chair.world_from_object.translation.vector - center).xy();
            let outwards = Unit::try_new(outwards, 1e-6).unwrap_or_else(Vector2::x_axis);
            let push = Isometry3::translation(by_m * outwards.x, by_m * outwards.y, 0.0);
            chair.world_from_object = push * chair.world_from_object;
            chair.mesh = std::mem::take(&mut chair.mesh).transformed(&push);
        }
        scene
    }

    /// Puts a model where the layout has made room for it.
    pub(super) fn put(&mut self, model: Model, place: Place) {
        let id = self.objects.len() as u32 + 1;
        self.objects.extend(SceneObject::new(id, model, &place.world_from_model()));
    }

    /// Puts a model somewhere in a rectangle of half side lengths `half` about `center`, where it keeps a distance
    /// from what stands at the same height and does not stick out; leaves it out when there is no room.
    pub(super) fn scatter(
        &mut self,
        random: &mut Random,
        model: impl FnOnce(&mut Random) -> Model,
        center: &Place,
        half: [f64; 2],
    ) {
        const ATTEMPTS: usize = 80;
        let id = self.objects.len() as u32 + 1;
        let Some(object) = SceneObject::new(id, model(random), &Pose::identity()) else {
            return;
        };
        let radius = 0.5 * object.size.x.hypot(object.size.y);
        let [x, y] = half.map(|h| (h - radius).max(0.0));
        for _ in 0..ATTEMPTS {
            let (x, y) = (random.between(-x, x), random.between(-y, y));
            let place = center.at(x, y, 0.0, random.between(-PI, PI));
            let world_from_model = place.world_from_model();
            let placed = SceneObject {
                world_from_object: world_from_model * object.world_from_object,
                mesh: Mesh::default(),
                ..object
            };
            if self.objects.iter().all(|other| keeps_distance(&placed, other)) {
                let mesh = object.mesh.transformed(&world_from_model);
                self.objects.push(SceneObject { mesh, ..placed });
                return;
            }
        }
    }

    /// Adds a rectangle of floor and the ceiling above it.
    pub(super) fn add_floor(&mut self, low: [f64; 2], high: [f64; 2]) {
        for (z, color) in [(0.0, FLOOR), (CEILING_M, WALL)] {
            let corners = [
                Point3::new(low[0], low[1], z),
                Point3::new(high[0], low[1], z),
                Point3::new(high[0], high[1], z),
                Point3::new(low[0], high[1], z),
            ];
            self.building.add_face(corners, color);
        }
    }

    /// Adds a straight wall 10 cm thick centred on the segment between two points along x or y.
    pub(super) fn add_wall(&mut self, from: [f64; 2], to: [f64; 2]) {
        const HALF_THICKNESS_M: f64 = 0.05;
        let low =
            [from[0].min(to[0]) - HALF_THICKNESS_M, from[1].min(to[1]) - HALF_THICKNESS_M, 0.0];
        let high = [
            from[0].max(to[0]) + HALF_THICKNESS_M,
            from[1].max(to[1]) + HALF_THICKNESS_M,
            CEILING_M,
        ];
        self.building.add_box(low, high, WALL);
    }

    /// Adds four walls and the floor between them.
    pub(super) fn add_room(&mut self, low: [f64; 2], high: [f64; 2]) {
        self.add_floor(low, high);
        self.add_wall(low, [high[0], low[1]]);
        self.add_wall([low[0], high[1]], high);
        self.add_wall(low, [low[0], high[1]]);
        self.add_wall([high[0], low[1]], high);
    }
}

/// Height of all rooms (m).
const CEILING_M: f64 = 2.6;
const FLOOR: [u8; 3] = [186, 180, 168];
const WALL: [u8; 3] = [176, 196, 204];

/// Between things that stand side by side (m).
const CLEARANCE_M: f64 = 0.02;

/// Whether two objects' boxes stay apart, or one stands well above the other.
fn keeps_distance(a: &SceneObject, b: &SceneObject) -> bool {
    let (center_a, center_b) =
        (a.world_from_object.translation.vector, b.world_from_object.translation.vector);
    let half_heights = 0.5 * (a.size.z + b.size.z);
    if (center_a.z - center_b.z).abs() >= half_heights - 1e-6 {
        return true;
    }
    // Separating axes of two rectangles: their four side directions.
    [a, b]
        .iter()
        .flat_map(|o| [o.world_from_object * Vector3::x(), o.world_from_object * Vector3::y()])
        .any(|axis| {
            let reach = |o: &SceneObject| {
                let own = o.world_from_object.inverse_transform_vector(&axis);
                0.5 * (own.x.abs() * o.size.x + own.y.abs() * o.size.y)
            };
            (center_a - center_b).dot(&axis).abs() > reach(a) + reach(b) + CLEARANCE_M
        })
}
