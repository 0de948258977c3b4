//! A process that is killed while it saves a map.

use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    io::{load_saved_map, save_map},
    mapping::{SavedMap, SavedObject},
    time::Stamp,
};
use nalgebra::{SMatrix, Vector3};
use std::{
    collections::BTreeMap,
    env,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

/// Names the file that [`the_one_who_saves`] saves to; not set in an ordinary run.
const FILE: &str = "ELLIPSOID_SLAM_TEST_SAVES_TO";
const KILLS: usize = 500;

fn map(objects: u64) -> SavedMap {
    let object = |id| SavedObject {
        id,
        label: "chair".into(),
        name: None,
        locked: false,
        labels: BTreeMap::from([("chair".into(), 1.0)]),
        existence: 0.9,
        observations: 3,
        first_seen: Stamp::default(),
        last_seen: Stamp::default(),
        ellipsoid: Ellipsoid::new(Pose::identity(), Vector3::new(0.3, 0.2, 0.5)),
        outline: Outline::Cuboid,
        support_height_m: None,
        covariance: SMatrix::identity() * 0.01,
    };
    SavedMap { frame_id: "map".into(), objects: (1..=objects).map(object).collect() }
}

/// Not a test by itself: the process that is killed. Saves maps of different sizes for ever.
#[test]
fn the_one_who_saves() {
    let Some(file) = env::var_os(FILE) else { return };
    let maps = [map(40), map(80)];
    loop {
        maps.iter().for_each(|map| save_map(Path::new(&file), map).unwrap());
    }
}

#[test]
fn a_map_is_whole_whenever_its_writer_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("map.json");
    save_map(&file, &map(40)).unwrap();
    let mut changed = 0;
    for kill in 0..KILLS {
        let before = load_saved_map(&file).unwrap().objects.len();
        let mut writer = Command::new(env::current_exe().unwrap())
            .args(["kill::the_one_who_saves", "--exact"])
            .env(FILE, &file)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // From before its first byte to the middle of a later save, at ever other moments.
        thread::sleep(Duration::from_micros(3000 + (kill as u64 * 7919) % 15_000));
        writer.kill().unwrap();
        writer.wait().unwrap();
        let objects = load_saved_map(&file).unwrap().objects.len();
        assert!(objects == 40 || objects == 80, "{objects} objects after kill {kill}");
        changed += usize::from(objects != before);
    }
    let interrupted = folder.path().read_dir().unwrap().count() - 1;
    println!(
        "{KILLS} kills: {interrupted} in the middle of a save; the map had changed after {changed}"
    );
    assert!(interrupted > 0 && changed > 0, "no kill has met a save: {interrupted}, {changed}");
}
