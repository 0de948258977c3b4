//! Range and meaning of every key.

use super::node_keys::NODE_KEYS;
use std::ops::RangeInclusive;

/// A key of the settings.
#[derive(Clone, Debug)]
pub struct Key {
    /// Sections and name, joined by dots.
    pub path: &'static str,
    /// What the value may be, for numbers.
    pub range: Option<RangeInclusive<f64>>,
    /// One line on what it does.
    pub meaning: &'static str,
    /// Whether it can change while the program runs.
    pub live: bool,
}

impl Key {
    /// The same key, which counts only at the start.
    pub(super) const fn at_start(mut self) -> Self {
        self.live = false;
        self
    }
}

pub(super) const fn number(path: &'static str, low: f64, high: f64, meaning: &'static str) -> Key {
    Key { path, range: Some(low..=high), meaning, live: true }
}

pub(super) const fn other(path: &'static str, meaning: &'static str) -> Key {
    Key { path, range: None, meaning, live: true }
}

/// All keys in the order of the file: the node's, then the method's.
pub fn keys() -> impl Iterator<Item = &'static Key> + Clone {
    NODE_KEYS.iter().chain(METHOD_KEYS)
}

/// Keys of [`Settings`](crate::pipeline::Settings) in the order of the file.
const METHOD_KEYS: &[Key] = &[
    other("sync", "Pairing of depth images, boxes and odometry."),
    number("sync.slop_s", 0.0, 1.0, "largest difference between the stamps of boxes and depth [s]"),
    number("sync.max_delay_s", 0.0, 60.0, "how long a depth image waits for its boxes [s]"),
    number("sync.max_waiting", 1.0, 1000.0, "most depth images that wait at once"),
    other("sync.odom_frame", "odometry's frame, where odometry comes from TF only").at_start(),
    other("sync.base_frame", "base frame, likewise; empty: the camera's own frame").at_start(),
    other(
        "sync.camera_pose",
        "where the camera is on the base: X,Y,Z,ROLL,PITCH,YAW [m, deg]; empty: TF tells",
    )
    .at_start(),
    number(
        "sync.stamp_sigma_s",
        0.0,
        0.2,
        "how far stamps of odometry and images usually are apart [s]",
    ),
    other(
        "depth_noise",
        "Standard deviation of depth: base_m + quadratic_per_m * (z - best_range_m)^2.",
    ),
    number("depth_noise.base_m", 0.0, 0.1, "at the best range [m]; the defaults are a Kinect's"),
    number("depth_noise.quadratic_per_m", 0.0, 0.1, "growth with the squared range [m/m^2]"),
    number("depth_noise.best_range_m", 0.0, 10.0, "range of the best readings [m]"),
    other(
        "detections_3d",
        "Standard deviations of a detector that measures in space, for robots without depth.",
    ),
    number("detections_3d.range_sigma_m", 0.001, 10.0, "of the range of a centre [m]"),
    number("detections_3d.range_sigma_per_m2", 0.0, 1.0, "growth with the squared range [m/m^2]"),
    number("detections_3d.across_sigma_m", 0.001, 10.0, "of a centre across the ray [m]"),
    number("detections_3d.across_sigma_ratio", 0.0, 1.0, "growth with the range [m/m]"),
    number("detections_3d.size_sigma_m", 0.001, 10.0, "of an extent [m]"),
    number("detections_3d.size_sigma_ratio", 0.0, 1.0, "besides, as a share of it"),
    number(
        "detections_3d.heading_sigma_deg",
        0.1,
        180.0,
        "of the heading of a box that is turned in its frame [deg]",
    ),
    other("perception", "From one frame and one box to an ellipsoid."),
    other("perception.support", "Support planes: floor, table tops."),
    number(
        "perception.support.max_tilt_deg",
        0.0,
        45.0,
        "largest angle to gravity, the paper's eps0 [deg]",
    ),
    number(
        "perception.support.min_points",
        20.0,
        1e6,
        "fewest points at full resolution, the paper's eps1",
    ),
    number("perception.support.max_planes", 1.0, 32.0, "most planes in a frame"),
    number("perception.support.stride_px", 1.0, 32.0, "every how many pixels a point is taken"),
    number("perception.support.hypotheses", 1.0, 10_000.0, "RANSAC hypotheses a plane"),
    number("perception.support.flatness_m", 0.0, 0.1, "how much the sensor bends planes [m]"),
    other("perception.walls", "Walls in sight."),
    number("perception.walls.max_walls", 0.0, 32.0, "most walls in a frame; 0: none"),
    number("perception.walls.min_length_m", 0.1, 100.0, "shortest wall that is used [m]"),
    number("perception.walls.flatness_m", 0.001, 0.1, "how much the sensor bends walls [m]"),
    number(
        "perception.walls.range_error",
        0.0,
        0.2,
        "error that all ranges share, as a share of them",
    ),
    other("perception.segmentation", "Cutting out an object's points."),
    number(
        "perception.segmentation.min_points",
        12.0,
        1e6,
        "fewest points at full resolution, the paper's eps3",
    ),
    number("perception.segmentation.max_points", 100.0, 1e6, "most points sampled in a box"),
    number(
        "perception.segmentation.box_margin",
        0.0,
        1.0,
        "how far objects may reach out of their box, as a share of its sides",
    ),
    number(
        "perception.segmentation.max_outside_box",
        0.0,
        1.0,
        "largest share of an object's points outside its box",
    ),
    number(
        "perception.segmentation.min_box_overlap",
        0.0,
        1.0,
        "smallest intersection over union of box and points",
    ),
    number("perception.segmentation.max_range_m", 0.1, 100.0, "farthest reading used [m]"),
    number(
        "perception.segmentation.support_margin_m",
        0.0,
        0.5,
        "least height above the support plane, the paper's eps2 [m]",
    ),
    number(
        "perception.segmentation.cluster_gap_m",
        0.001,
        1.0,
        "gap between clusters, besides what noise asks for [m]",
    ),
    other("perception.fit", "faces: from the object's faces; quadric: the paper's eq. (7)"),
    number("perception.min_score", 0.0, 1.0, "boxes of a lower score are not looked at"),
    other(
        "perception.glimpses",
        "boxes without a measurement place an object, seen from several places",
    ),
    number("perception.max_boxes", 1.0, 1000.0, "most boxes of an image, the most probable ones"),
    number("perception.max_names", 1.0, 100.0, "most names of a box, the most probable ones"),
    other(
        "perception.classes",
        "What is known of classes: symmetry none|plane|dual_plane; outline ellipsoid|cuboid|cylinder|superquadric: [e1, e2]; legs; on_floor; carries things on its top; moves by itself; usual size_m [long, short, height].",
    ),
    other("perception.classes.unlisted", "any class without an entry"),
    other("perception.classes.listed", "by the detector's label"),
    other("mapping", "Which measurements are one object, and what they say together."),
    number("mapping.min_observations", 1.0, 1000.0, "measurements after which an object counts"),
    other(
        "mapping.gate",
        "Which measurements may be one object; costs are negative logarithms of probabilities.",
    ),
    number(
        "mapping.gate.new_object_cost",
        1.0,
        1000.0,
        "what fits an object worse than this is not that object",
    ),
    number(
        "mapping.gate.ambiguity",
        0.0,
        1000.0,
        "where two answers differ by less, none is given",
    ),
    number(
        "mapping.gate.position_sigma_m",
        0.0,
        1.0,
        "standard deviation of a centre besides what covariances say [m]",
    ),
    number("mapping.gate.size_sigma_ratio", 0.0, 1.0, "of a semi-axis besides, as a share of it"),
    number("mapping.gate.heading_sigma_deg", 0.0, 180.0, "of a heading besides [deg]"),
    number(
        "mapping.gate.min_box_overlap",
        0.0,
        1.0,
        "a box shows an object whose expected box it overlaps so much",
    ),
    other("mapping.labels", "How detectors confuse classes."),
    other("mapping.labels.alike", "groups of classes that are taken for each other"),
    number(
        "mapping.labels.confused",
        1e-6,
        0.5,
        "probability of the name of another class of a group",
    ),
    number("mapping.labels.wrong", 1e-9, 0.5, "probability of any other name"),
    other("mapping.life", "When an object counts, and when it is gone."),
    number(
        "mapping.life.detection_probability",
        0.01,
        0.999,
        "probability that an object is detected where it can be seen",
    ),
    number(
        "mapping.life.false_detection_probability",
        0.001,
        0.999,
        "probability of a detection where there is nothing",
    ),
    number("mapping.life.confirmed_from", 0.5, 0.99, "existence from which an object counts"),
    number("mapping.life.removed_below", 0.01, 0.5, "existence below which an object is removed"),
    number(
        "mapping.life.different_views_m",
        0.0,
        10.0,
        "views from places so far apart are different [m]",
    ),
    other(
        "mapping.life.moved_keeps_id",
        "whether an object that was moved keeps its identity at its new place",
    ),
    other("slam", "The graph of poses and objects."),
    other("slam.optimize_poses", "false: poses are the odometry's, as in the paper's experiments")
        .at_start(),
    number("slam.min_translation_m", 0.0, 10.0, "a new pose for the graph after so much way [m]"),
    number("slam.min_rotation_deg", 0.0, 180.0, "or after turning by so much [deg]"),
    other("slam.kernel", "quadratic, huber, cauchy or geman_mcclure"),
    number(
        "slam.kernel_threshold",
        0.1,
        1000.0,
        "whitened residual from which an observation loses weight",
    ),
    other("slam.observations", "single-frame ellipsoids, eq. (13)"),
    other("slam.boxes", "the detector's boxes, eq. (15), besides what faces take from them"),
    other("slam.silhouettes", "of round objects, sides that are seen to be the silhouette"),
    other("slam.walls", "walls hold the robot's heading and place"),
    number(
        "slam.right_angle_sigma_deg",
        0.0,
        45.0,
        "how exactly walls are at right angles; 0: they may not be [deg]",
    ),
    number("slam.box_sigma_px", 0.01, 1000.0, "standard deviation of a box's side [px]"),
    number("slam.box_sigma_ratio", 0.0, 1.0, "besides, as a share of the box's width or height"),
    number("slam.box_border_px", 0.0, 1000.0, "a side this near to the image's border is cut [px]"),
    other("slam.box_outline", "class: what the class has; ellipsoid: the paper's"),
    other("slam.support", "hold objects on their support planes, besides their lower faces"),
    number("slam.support_sigma_m", 0.0001, 10.0, "standard deviation of a plane's height [m]"),
    number("slam.upright_sigma_deg", 0.001, 90.0, "standard deviation of an object's tilt [deg]"),
    other(
        "slam.weighting",
        "covariance: each measurement's own; faces: each face by itself, bounded where it was not seen; paper: eps_z P_e for all alike",
    ),
    number("slam.eps_z", 1e-6, 1e12, "the paper's eps_z, for weighting: paper"),
    number("slam.similar_views_correlation", 0.0, 1.0, "correlation of errors of similar views"),
    number("slam.similar_views_deg", 1.0, 360.0, "views within this angle are similar [deg]"),
    number("slam.min_position_sigma_m", 0.0, 1.0, "no position is known better than this [m]"),
    number("slam.min_size_sigma_m", 0.0, 1.0, "no semi-axis is known better than this [m]"),
    number("slam.min_heading_sigma_deg", 0.0, 90.0, "no heading is known better than this [deg]"),
    other("slam.motion", "Odometry's noise where its own covariance is missing or absurd."),
    number("slam.motion.position_m_per_m", 0.0, 10.0, "position, a metre driven [m/m]"),
    number("slam.motion.position_m_per_rad", 0.0, 10.0, "position, a radian turned [m/rad]"),
    number("slam.motion.heading_rad_per_m", 0.0, 10.0, "heading, a metre driven [rad/m]"),
    number("slam.motion.heading_rad_per_rad", 0.0, 10.0, "heading, a radian turned [rad/rad]"),
    number("slam.motion.floor_m", 1e-6, 1.0, "no step is known better than this [m]"),
    number("slam.motion.floor_deg", 1e-5, 90.0, "no step is known better than this [deg]"),
    number(
        "slam.motion.credible_factor",
        1.0,
        1e6,
        "how far odometry's own standard deviations may be from these",
    ),
    other(
        "slam.solver",
        "When the solver works again on what it has; both are costs without units.",
    ),
    number(
        "slam.solver.linearization_tolerance",
        1e-9,
        1e3,
        "a factor is linearised anew when its model misses its cost by this share",
    )
    .at_start(),
    number(
        "slam.solver.propagation_tolerance",
        0.0,
        1e3,
        "cost for which a change is kept from the rest of the map",
    )
    .at_start(),
    other("relocalisation", "Recognising a place of a saved map by its objects."),
    number(
        "relocalisation.max_false_probability",
        1e-12,
        0.5,
        "probability with which a place that is accepted may be false",
    ),
    number(
        "relocalisation.new_object_probability",
        1e-6,
        0.9,
        "share of seen objects that are not in the map: moved or new",
    ),
    number(
        "relocalisation.elsewhere_probability",
        1e-6,
        0.999,
        "probability beforehand that the robot is not in the map",
    ),
    number(
        "relocalisation.position_sigma_m",
        1e-4,
        10.0,
        "standard deviation of positions, besides what covariances say [m]",
    ),
    number("relocalisation.heading_sigma_deg", 0.01, 90.0, "the same of headings [deg]"),
    number("relocalisation.size_sigma_ratio", 1e-4, 10.0, "the same of sizes, as a share"),
];
