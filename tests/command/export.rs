//! Exports of the map, read back by other people's programs.

use crate::{
    environment::{self, python},
    run::{Flaw, replayed, run, stderr},
};
use ellipsoid_slam::{
    geometry::Outline,
    io::{load_saved_map, save_map},
};
use std::{fs, path::Path, process::Command};

const FORMS: [&str; 4] = ["csv", "ply", "geojson", "sdf"];
/// A label as only a hostile detector has it.
const HOSTILE: &str = "a \"cup\", </name>\n&";

#[test]
fn exports_are_read_by_numpy_trimesh_and_parsers() {
    let (folder, _, out) = replayed(Flaw::None);
    // One object of each outline, beside each other.
    let mut map = load_saved_map(&out.join("map.json")).unwrap();
    let outlines =
        [Outline::Cuboid, Outline::Cylinder, Outline::Ellipsoid, Outline::Superquadric(0.5, 0.5)];
    let seen = map.objects[0].clone();
    map.objects.clear();
    for (id, outline) in (1..).zip(outlines) {
        let mut object = seen.clone();
        (object.id, object.outline) = (id, outline);
        object.ellipsoid.pose.translation.x += id as f64;
        map.objects.push(object);
    }
    map.objects[1].name = Some("the \"blue\" one".into());
    map.objects[3].label = HOSTILE.into();
    map.objects[3].labels = [(HOSTILE.to_owned(), 0.9)].into();
    let file = folder.path().join("map.json");
    save_map(&file, &map).unwrap();
    for form in FORMS {
        let output = folder.path().join(format!("map.{form}"));
        let args = ["export", file.to_str().unwrap(), "--format", form];
        let written = run(&[&args[..], &["--output", output.to_str().unwrap()]].concat());
        assert!(written.status.success(), "{}", stderr(&written));
        let printed = run(&args);
        assert_eq!(
            String::from_utf8(printed.stdout).unwrap().trim_end(),
            fs::read_to_string(&output).unwrap().trim_end()
        );
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/read_exports.py");
    let python = python("tests/requirements.txt").unwrap();
    environment::run(Command::new(python).arg(script).arg(folder.path())).unwrap();
}

#[test]
fn what_is_no_map_is_not_exported() {
    let folder = tempfile::tempdir().unwrap();
    let none = folder.path().join("none.json");
    fs::write(&none, "{}").unwrap();
    for (map, words) in [(none.to_str().unwrap(), "not a map file"), ("bags", "bags/map.json")] {
        let output = run(&["export", map, "--format", "csv"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    assert_eq!(run(&["export", "bags", "--format", "obj"]).status.code(), Some(2));
}
