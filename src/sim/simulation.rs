//! A whole simulated sequence, frame by frame.

use super::{
    detector::{self, Look, SimulatedDetection, Visible, visible_parts},
    odometry::{self, OdometryReading},
    random::{PixelRandom, Purpose, Random},
    render::{Rendered, Renderer},
    scene::{Scene, SceneObject},
    sensor,
    settings::{CameraSettings, SettingsError, SimulationSettings},
    trajectory::Trajectory,
};
use crate::{
    geometry::{Camera, CameraError, Distortion, Pose},
    time::Stamp,
};
use nalgebra::Vector3;
use thiserror::Error;

/// A scene, a way through it and sensors: [`Simulation::frame`] gives any frame, always the same.
///
/// ```
/// use ellipsoid_slam::sim::{Simulation, SimulationSettings};
///
/// let settings = SimulationSettings { frames: 2, ..SimulationSettings::default() };
/// let simulation = Simulation::new(settings)?;
/// let mut truth = simulation.ground_truth();
/// for frame in simulation.frames() {
///     truth.observe(&frame);
/// }
/// assert!(truth.objects.iter().any(|object| object.label == "keyboard"));
/// # Ok::<(), ellipsoid_slam::sim::SimulationError>(())
/// ```
pub struct Simulation {
    settings: SimulationSettings,
    scene: Scene,
    renderer: Renderer,
    /// After something was moved.
    moved: Option<Moved>,
    camera: Camera,
    depth_camera: Camera,
    trajectory: Trajectory,
    odometry: Vec<OdometryReading>,
}

/// A scene as it is from some frame on.
struct Moved {
    from_frame: usize,
    scene: Scene,
    renderer: Renderer,
}

impl Moved {
    fn new(scene: &Scene, settings: &SimulationSettings) -> Option<Self> {
        let from_frame = settings.moved_from_frame;
        (from_frame > 0).then(|| {
            let scene = scene.with_moved_chair(settings.moved_by_m);
            Self { from_frame, renderer: Renderer::new(&scene), scene }
        })
    }
}

/// Why there is no simulation.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SimulationError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The camera is none.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// Everything that belongs to one image.
#[derive(Clone, Debug)]
pub struct SimulatedFrame {
    /// From 0.
    pub index: usize,
    /// When the image was taken.
    pub stamp: Stamp,
    /// When the detector's boxes of this image come.
    pub detections_arrive: Stamp,
    /// Depth readings along the optical axis (m), row-major; NaN where there is none.
    pub depth_m: Vec<f32>,
    /// Red, green, blue, row-major.
    pub rgb: Vec<u8>,
    /// True id of the object at every pixel, row-major; 0 for the building.
    pub instances: Vec<u16>,
    /// The true visible parts, by id.
    pub visible: Vec<Visible>,
    /// What the detector reports.
    pub detections: Vec<SimulatedDetection>,
    /// The true pose of the base.
    pub world_from_base: Pose,
    /// The true pose of the camera's optical frame.
    pub world_from_camera: Pose,
    /// What the odometry says.
    pub odometry: OdometryReading,
}

/// The true objects of a scene in the world frame, which is `map` where the odometry starts at the true pose.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// By id.
    pub objects: Vec<TrueObject>,
    min_visible_pixels: usize,
}

/// One true object.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueObject {
    /// As in [`SimulatedFrame::instances`].
    pub id: u32,
    /// Class name as a COCO detector gives it.
    pub label: &'static str,
    /// `world_from_object`: the origin is the centre of the object's box, z is up and x the longer side.
    pub world_from_object: Pose,
    /// Full extents along the object's own axes (m).
    pub size: Vector3<f64>,
    /// Frames in which a detector could see it: at least `detector.min_visible_pixels` were visible.
    pub observations: usize,
}

impl Simulation {
    /// Builds the scene and lays out the way.
    ///
    /// # Errors
    /// When a setting is out of range.
    pub fn new(settings: SimulationSettings) -> Result<Self, SimulationError> {
        settings.check()?;
        let scene = Scene::new(settings.scene, settings.seed);
        let trajectory = Trajectory::new(&settings, &scene.routes);
        let camera = pinhole(&settings.camera)?;
        let depth_camera =
            settings.depth_camera.as_ref().map_or_else(|| Ok(camera.clone()), pinhole)?;
        Ok(Self {
            odometry: odometry::readings(
                &trajectory.world_from_base,
                &settings.odometry,
                settings.visit_seed(),
            ),
            renderer: Renderer::new(&scene),
            moved: Moved::new(&scene, &settings),
            settings,
            scene,
            camera,
            depth_camera,
            trajectory,
        })
    }

    /// What was asked for.
    pub fn settings(&self) -> &SimulationSettings {
        &self.settings
    }

    /// What stands where, at the end.
    pub fn scene(&self) -> &Scene {
        self.moved.as_ref().map_or(&self.scene, |moved| &moved.scene)
    }

    /// What stands where at the beginning.
    pub fn scene_before(&self) -> &Scene {
        &self.scene
    }

    /// The colour camera, in whose image the boxes are.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The depth camera, in the same place.
    pub fn depth_camera(&self) -> &Camera {
        &self.depth_camera
    }

    /// The static transform of the camera's optical frame, as TF has it.
    pub fn base_from_optical(&self) -> &Pose {
        &self.trajectory.base_from_optical
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.trajectory.world_from_base.len()
    }

    /// When a frame is taken.
    pub fn stamp(&self, index: usize) -> Stamp {
        let start = Stamp::from_secs(self.settings.start_time_s);
        start.shifted(index as f64 / self.settings.frame_rate_hz)
    }

    /// True poses `world_from_base`, one a frame.
    pub fn world_from_base(&self) -> &[Pose] {
        &self.trajectory.world_from_base
    }

    /// What odometry says, one reading a frame.
    pub fn odometry(&self) -> &[OdometryReading] {
        &self.odometry
    }

    /// The true objects where they are at the end, none of them observed yet.
    pub fn ground_truth(&self) -> GroundTruth {
        let objects = self.scene().objects.iter().map(TrueObject::new).collect();
        GroundTruth { objects, min_visible_pixels: self.settings.detector.min_visible_pixels }
    }

    /// All frames in order, each made when it is asked for.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = SimulatedFrame> + '_ {
        (0..self.frame_count()).map(|index| self.frame(index))
    }

    /// One frame; the same whatever was asked for before and on however many threads.
    ///
    /// # Panics
    /// When `index` is not below [`Simulation::frame_count`].
    pub fn frame(&self, index: usize) -> SimulatedFrame {
        let world_from_base = self.trajectory.world_from_base[index];
        let world_from_camera = world_from_base * self.trajectory.true_base_from_optical;
        let moved = self.moved.as_ref().filter(|moved| index >= moved.from_frame);
        let renderer = moved.map_or(&self.renderer, |moved| &moved.renderer);
        let exact = renderer.render(&self.camera, &world_from_camera);
        let depth_m = if self.depth_camera == self.camera {
            self.depth_readings(index, &exact)
        } else {
            let exact = renderer.render(&self.depth_camera, &world_from_camera);
            self.depth_readings(index, &exact)
        };
        let visible = visible_parts(&exact.instances, self.camera.width() as usize);
        let mut random = Random::new(self.settings.visit_seed(), Purpose::Detector, index as u64);
        let jitter_s = random.between(0.0, self.settings.detector.delay_jitter_s);
        let stamp = self.stamp(index);
        SimulatedFrame {
            index,
            stamp,
            detections_arrive: stamp.shifted(self.settings.detector.delay_s + jitter_s),
            depth_m,
            detections: self.detections(&visible, &world_from_camera, &mut random),
            rgb: exact.rgb,
            instances: exact.instances,
            visible,
            world_from_base,
            world_from_camera,
            odometry: self.odometry[index].clone(),
        }
    }

    fn depth_readings(&self, index: usize, exact: &Rendered) -> Vec<f32> {
        let key = PixelRandom::frame_key(self.settings.visit_seed(), index as u64);
        let (width, focal_px) = (self.depth_camera.width() as usize, self.depth_camera.focal().0);
        sensor::readings(exact, width, focal_px, &self.settings.depth, key)
    }

    fn detections(
        &self,
        visible: &[Visible],
        world_from_camera: &Pose,
        random: &mut Random,
    ) -> Vec<SimulatedDetection> {
        let look = |part: &Visible| {
            let object = &self.scene.objects[part.id as usize - 1];
            let away =
                world_from_camera.translation.vector - object.world_from_object.translation.vector;
            let sector = (away.y.atan2(away.x) / VIEW_RAD).floor() as i64;
            let octave = away.norm().log2().floor() as i64;
            let view = self.settings.visit_seed() ^ (sector * 1000 + octave) as u64;
            Look { part: *part, label: object.label, view }
        };
        let looks: Vec<Look> = visible.iter().map(look).collect();
        let size = (self.camera.width(), self.camera.height());
        detector::detections(&looks, size, &self.settings.detector, random)
    }
}

/// Views of an object from directions within this angle, and from ranges within an octave, are about the same (rad).
const VIEW_RAD: f64 = 0.35;

fn pinhole(lens: &CameraSettings) -> Result<Camera, CameraError> {
    let principal = (0.5 * (f64::from(lens.width) - 1.0), 0.5 * (f64::from(lens.height) - 1.0));
    let focal = (lens.focal_px, lens.focal_px);
    Camera::new((lens.width, lens.height), focal, principal, Distortion::None)
}

impl GroundTruth {
    /// Counts which objects a frame shows.
    pub fn observe(&mut self, frame: &SimulatedFrame) {
        for part in frame.visible.iter().filter(|p| p.pixels >= self.min_visible_pixels) {
            self.objects[part.id as usize - 1].observations += 1;
        }
    }
}

impl TrueObject {
    fn new(object: &SceneObject) -> Self {
        Self {
            id: object.id,
            label: object.label,
            world_from_object: object.world_from_object,
            size: object.size,
            observations: 0,
        }
    }
}
