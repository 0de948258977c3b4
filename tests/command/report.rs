//! `report.html` and the pictures beside it.

use crate::run::{Flaw, HOSTILE_LABEL, replayed, run, stderr, write_bag};
use serde_json::Value;
use std::{fs, path::Path};

const WEB: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/report/web");

/// The data of a page under a name.
fn data(page: &str, name: &str) -> Value {
    let (_, rest) = page.split_once(&format!("id=\"{name}\">")).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn page_of(flaw: Flaw) -> String {
    let (_folder, _, out) = replayed(flaw);
    fs::read_to_string(out.join("report.html")).unwrap()
}

/// What a page says is missing or left out.
fn notes(page: &str) -> String {
    data(page, "run")["notes"].to_string()
}

fn demo(folder: &Path) -> String {
    let output = run(&["replay", "bags/desk.mcap", "--output", folder.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    fs::read_to_string(folder.join("report.html")).unwrap()
}

#[test]
fn the_demos_page_shows_its_map_and_is_the_same_again_but_for_the_clock() {
    let folder = tempfile::tempdir().unwrap();
    let page = demo(&folder.path().join("a"));
    let again = demo(&folder.path().join("b"));
    let lines = |page: &str| -> Vec<String> {
        page.lines().filter(|line| !line.contains("id=\"clock\"")).map(str::to_owned).collect()
    };
    assert!(lines(&page) == lines(&again), "two pages of one bag differ");
    assert_ne!(data(&page, "clock")["seconds"], Value::Null);

    let map = fs::read_to_string(folder.path().join("a/map.json")).unwrap();
    assert_eq!(data(&page, "map"), serde_json::from_str::<Value>(&map).unwrap());
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    let run = data(&page, "run");
    assert_eq!(run["steps"].as_array().unwrap().len(), 30);
    assert!(run["steps"].as_array().unwrap().iter().all(|step| step["jpeg"].is_string()));
    assert!(run["points"]["count"].as_u64().unwrap() > 20_000);
    let refused = run["steps"].to_string();
    assert!(refused.contains("of the points lie outside the box"), "no reason in words");
    for object in data(&page, "map")["objects"].as_array().unwrap() {
        let id = object["id"].to_string();
        let crops = run["crops"][&id].as_array().unwrap().len();
        assert!((1..=8).contains(&crops), "object {id} has {crops} crops");
        let sides = run["sides"][&id].to_string();
        assert!(sides.contains(|digit: char| ('1'..='9').contains(&digit)), "{id}: {sides}");
    }
    // The truth is on topics of the bag; eval reads it from a file.
    let scores = &run["truth"]["scores"];
    assert!(scores["recall"].as_f64().unwrap() > 0.9, "{scores:#}");
    assert!(run["truth"]["trajectory"]["ate_m"]["rmse"].as_f64().unwrap() < 0.1);
}

#[test]
fn the_truth_of_a_file_is_measured_as_eval_does() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let truth = ["--ground-truth", "bags/desk.gt.json"];
    let replay = run(&[&["replay", "bags/desk.mcap", "--output", out][..], &truth[..]].concat());
    assert!(replay.status.success(), "{}", stderr(&replay));
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let output = run(&["eval", out, truth[0], truth[1], "--json"]);
    let scores: Value = serde_json::from_slice(&output.stdout).unwrap();
    let shown = &data(&page, "run")["truth"]["scores"];
    assert_eq!(shown["matches"].as_array().unwrap().len(), 11);
    for key in ["recall", "precision", "true_objects", "duplicates"] {
        assert_eq!(shown[key], scores["objects"][key], "{key}");
    }
}

#[test]
fn texts_of_a_bag_are_never_html() {
    let (_folder, _, out) = replayed(Flaw::HostileLabel);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(!page.contains("<img src=x"), "a label is an element");
    assert_eq!(data(&page, "map")["objects"][0]["label"], HOSTILE_LABEL);
    let plan = fs::read_to_string(out.join("map.svg")).unwrap();
    assert!(!plan.contains("<img") && plan.contains("&lt;img src=x onerror"), "{plan}");
}

#[test]
fn without_colour_the_page_says_so_and_has_the_rest() {
    let page = page_of(Flaw::None);
    assert!(notes(&page).contains("no colour images"), "{}", notes(&page));
    let run = data(&page, "run");
    assert!(run["points"]["count"].as_u64().unwrap() > 1000);
    assert_eq!(run["points"]["colors"], "");
    assert_eq!(run["steps"][0]["boxes"][0]["label"], "suitcase");
}

#[test]
fn images_that_do_not_decode_are_counted() {
    let page = page_of(Flaw::BrokenColor);
    assert!(notes(&page).contains("6 colour images could not be used"), "{}", notes(&page));
    assert_eq!(data(&page, "map")["objects"][0]["label"], "suitcase");
}

#[test]
fn a_page_that_cannot_be_written_leaves_the_other_results_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, Flaw::None);
    // A folder has the page's name.
    fs::create_dir_all(out.join("report.html/x")).unwrap();
    let output =
        run(&["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--force"]);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.lines().count() == 1 && said.contains("report.html"), "{said}");
    let names = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name());
    let names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
    for name in ["map.json", "trajectory.tum", "result.mcap", "summary.json"] {
        assert!(names.iter().any(|there| there == name), "{name} is not in {names:?}");
    }
    assert!(!names.iter().any(|name| name.ends_with(".part")), "{names:?}");
}

#[test]
fn no_report_writes_none() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, out) = (folder.path().join("box.mcap"), folder.path().join("out"));
    write_bag(&bag, Flaw::None);
    let args = ["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap(), "--no-report"];
    assert!(run(&args).status.success());
    assert!(out.join("map.json").exists());
    assert!(!out.join("report.html").exists() && !out.join("map.svg").exists());
    // The plan can be drawn later.
    assert!(run(&["show", out.to_str().unwrap()]).status.success());
    let plan = fs::read_to_string(out.join("map.svg")).unwrap();
    assert!(plan.contains("suitcase 1") && plan.contains("× 0.50 m"), "{plan}");
}

#[test]
fn the_bundle_is_made_of_the_sources_beside_it() {
    let read = |name: &str| fs::read_to_string(Path::new(WEB).join(name)).unwrap();
    let bundle = read("three.js");
    for source in ["package.json", "three.entry.js"] {
        assert!(
            bundle.contains(&read(source)),
            "run src/report/web/bundle.sh: {source} has changed"
        );
    }
    assert!(bundle.contains("The MIT License"));
}
