//! `report.html` and the pictures beside it.

use crate::run::{Flaw, HOSTILE_LABEL, replayed, run, stderr, write_bag};
use ellipsoid_slam::{
    io::{BagReader, RawMessage, decode_color},
    msg::{
        cdr,
        convert::compressed_color_image,
        foxglove_msgs::{ImageAnnotations, PointsAnnotation},
        sensor_msgs::{CameraInfo, CompressedImage},
    },
};
use serde_json::Value;
use std::{fs, path::Path};

const DESK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/bags/desk.mcap");
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
    assert_eq!(run["steps"].as_array().unwrap().len(), 15);
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
fn the_plan_in_the_documentation_is_what_the_demo_draws() {
    let folder = tempfile::tempdir().unwrap();
    demo(folder.path());
    // Labels with the sizes that are written below them.
    let objects = |path: &Path| -> Vec<(String, Vec<f64>)> {
        let text = fs::read_to_string(path).unwrap();
        let between = |begin: &str| -> Vec<String> {
            let parts = text.split(begin).skip(1);
            parts.map(|part| part.split("</text>").next().unwrap().to_owned()).collect()
        };
        let labels = between("font-weight=\"bold\">").into_iter();
        let labels = labels.map(|name| name.rsplit_once(' ').unwrap().0.to_owned());
        let sizes = between("font-size=\"11\">").into_iter();
        let numbers = |size: String| size.split(' ').filter_map(|w| w.parse().ok()).collect();
        let mut all: Vec<(String, Vec<f64>)> = labels.zip(sizes.map(numbers)).collect();
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all
    };
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images/map.svg");
    let (new, old) = (objects(&folder.path().join("map.svg")), objects(&kept));
    // What a change of the method does to sizes is not worth another picture, another object is.
    let is_like = |(a, b): (&f64, &f64)| (a - b).abs() < 0.03_f64.max(0.15 * b);
    let same = new.iter().zip(&old).all(|(new, old)| {
        new.0 == old.0 && new.1.len() == 3 && new.1.iter().zip(&old.1).all(is_like)
    });
    let advice = "copy target/demo/map.svg to docs/images and look at it";
    assert!(new.len() == old.len() && same, "{advice}: {new:?} {old:?}");
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
fn the_result_has_images_with_what_was_made_of_them() {
    const TOPIC: &str = "/ellipsoid_slam/debug_image/compressed";
    let folder = tempfile::tempdir().unwrap();
    let images = |more: &[&str]| {
        let out = folder.path().join(format!("out{}", more.len()));
        let args = ["replay", "bags/desk.mcap", "--output", out.to_str().unwrap()];
        assert!(run(&[&args[..], more].concat()).status.success());
        let bag = BagReader::open(&out.join("result.mcap")).unwrap();
        let images = bag.messages().only([TOPIC]);
        images.map(|message| decode_color(&message).unwrap()).collect::<Vec<_>>()
    };
    // Ten seconds, an image each.
    let drawn = images(&[]);
    assert!((8..=11).contains(&drawn.len()), "{} images", drawn.len());
    let first = BagReader::open(Path::new(DESK)).unwrap();
    let first = first.messages().only(["/camera/color/image_raw/compressed"]).next().unwrap();
    let plain = decode_color(&first).unwrap();
    let pairs = drawn[0].data.iter().zip(&plain.data);
    let changed = pairs.filter(|(a, b)| a.abs_diff(**b) > 60).count();
    assert!(changed > 1000, "nothing is drawn: {changed}");
    assert!(images(&["--no-images"]).is_empty());
}

#[test]
fn the_result_has_what_foxglove_draws_over_its_images() {
    let folder = tempfile::tempdir().unwrap();
    demo(folder.path());
    let bag = BagReader::open(&folder.path().join("result.mcap")).unwrap();
    let of = |topic: &str| -> Vec<RawMessage> {
        bag.messages().only([format!("/ellipsoid_slam/{topic}")]).collect()
    };
    let annotations = of("annotations");
    let images = of("image/compressed");
    let pairs = annotations.iter().zip(&images);
    assert_eq!((annotations.len(), images.len()), (10, 10));
    assert!(pairs.into_iter().all(|(a, b)| a.log_time == b.log_time));
    assert_eq!(&*annotations[0].type_name, "foxglove_msgs/msg/ImageAnnotations");
    let last: ImageAnnotations = cdr::decode(&annotations[9].data).unwrap();
    let outlines = last.points.iter().filter(|p| p.kind == PointsAnnotation::LINE_LIST);
    let outlines: Vec<_> = outlines.collect();
    let boxes = last.points.iter().filter(|p| p.kind == PointsAnnotation::LINE_LOOP);
    assert!(outlines.len() >= 5, "{} outlines", outlines.len());
    assert_eq!(boxes.clone().count(), last.texts.len());
    assert!(last.texts.iter().any(|text| text.text.starts_with("cup 0.")), "{:?}", last.texts);
    assert!(boxes.clone().all(|b| b.points.len() == 4 && b.timestamp == last.texts[0].timestamp));
    assert!(outlines.iter().all(|o| o.points.len().is_multiple_of(2) && o.outline_color.a == 1.0));
    // The image is the bag's own, byte for byte.
    let source = BagReader::open(Path::new(DESK)).unwrap();
    let own: CompressedImage = cdr::decode(&images[3].data).unwrap();
    let is_own = |message: RawMessage| {
        cdr::decode::<CompressedImage>(&message.data).unwrap().data == own.data
    };
    assert!(source.messages().only(["/camera/color/image_raw/compressed"]).any(is_own));
    let camera: CameraInfo = cdr::decode(&of("camera_info")[3].data).unwrap();
    assert_eq!(camera.header, own.header);
    assert!(camera.k[0] > 100.0 && of("camera_pose").len() == 10);
}

#[test]
fn the_result_is_the_same_with_and_without_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let result = |more: &[&str]| {
        let out = folder.path().join(format!("out{}", more.len()));
        let args = ["replay", "bags/desk.mcap", "--output", out.to_str().unwrap()];
        assert!(run(&[&args[..], more].concat()).status.success());
        fs::read(out.join("result.mcap")).unwrap()
    };
    assert!(result(&[]) == result(&["--no-report"]), "the report changes result.mcap");
}

/// What is known of an object becomes surer as it is seen, and the page has it as it was at each time.
#[test]
fn uncertainty_is_shown_as_it_was_known_at_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let page = demo(folder.path());
    let (run, map) = (data(&page, "run"), data(&page, "map"));
    let mut surer = 0;
    for object in map["objects"].as_array().unwrap() {
        let states = &run["tracks"][object["id"].to_string()]["states"];
        let sigma = |state: &Value, at: usize| state[9 + at].as_f64().unwrap();
        let known: Vec<&Value> =
            states.as_array().unwrap().iter().filter(|s| s.as_array().unwrap().len() > 1).collect();
        let (first, last) = (known[0], known[known.len() - 1]);
        assert_eq!(last.as_array().unwrap().len(), 15);
        for axis in 0..6 {
            // Rounded, and changes of less are not written down.
            let at_end = object["covariance"][10 * (3 + axis)].as_f64().unwrap().sqrt();
            assert!((sigma(last, axis) - at_end).abs() < 0.011, "{object}: {last}");
        }
        let total = |state: &Value| (0..3).map(|axis| sigma(state, axis)).sum::<f64>();
        surer += usize::from(total(first) > 1.1 * total(last));
    }
    assert!(surer >= 3, "only {surer} objects were less sure at first");
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

/// Walls and outlines in images as well, of a drive that was replayed without a report.
#[test]
fn show_draws_a_result_as_replay_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (bag, with, without) = (path("home.mcap"), path("with"), path("without"));
    let [bag, with_name, without_name] = [&bag, &with, &without].map(|p| p.to_str().unwrap());
    let scene = ["simulate", "--scene", "home", "--trajectory", "forward", "--frames", "16"];
    assert!(run(&[&scene[..], &["--output", bag]].concat()).status.success());
    assert!(run(&["replay", bag, "--output", with_name]).status.success());
    assert!(run(&["replay", bag, "--output", without_name, "--no-report"]).status.success());
    let shown = run(&["show", without_name]);
    assert!(shown.status.success(), "{}", stderr(&shown));
    let plans = [&with, &without].map(|out| fs::read_to_string(out.join("map.svg")).unwrap());
    assert!(plans[0].contains("stroke-linecap=\"round\""), "the drive has no walls");
    assert!(plans[0] == plans[1], "two plans of one map differ");
    let said = String::from_utf8(shown.stdout).unwrap();
    assert!(said.lines().count() == 5, "{said}");
    // The image of the beginning is in both; later ones are of other moments.
    let pictures = [&with, &without].map(|out| {
        let data = fs::read(out.join("overlay_1.png")).unwrap();
        compressed_color_image(&CompressedImage { data, ..CompressedImage::default() }).unwrap()
    });
    let pixels = pictures[0].data.iter().zip(&pictures[1].data);
    let other = pixels.filter(|(a, b)| a != b).count();
    // Poses in the result are rounded.
    assert!(other < pictures[0].data.len() / 500, "{other} differ");
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
