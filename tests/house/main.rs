//! House rules that the compiler does not check, read from the source itself.
//!
//! Every rule is a function from a path and its text to the sentences that say what is wrong, so that each can be
//! tried on a planted fault: a check that cannot fail protects nothing.
#![expect(clippy::unwrap_used, reason = "a test that cannot read the source has to stop")]

mod files;
mod layers;
mod paths;
mod source;

use source::SourceFile;

fn assert_kept(rule: impl Fn(&SourceFile) -> Vec<String>, folders: &[&str]) {
    let files = source::rust_files(folders);
    assert!(
        files.len() > 20,
        "only {} files were found: the rule looks in the wrong place",
        files.len()
    );
    let broken: Vec<String> = files
        .iter()
        .flat_map(|file| rule(file).into_iter().map(|what| format!("{}: {what}", file.path)))
        .collect();
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

#[test]
fn layers_only_look_inwards() {
    assert_kept(layers::outward_uses, &["src"]);
}

#[test]
fn every_file_belongs_to_a_layer() {
    assert_kept(layers::homeless, &["src"]);
}

#[test]
fn pure_layers_touch_no_files_clocks_or_threads() {
    assert_kept(layers::impurities, &["src"]);
}

#[test]
fn large_dependencies_stay_at_home() {
    assert_kept(layers::strayed_dependencies, &["src"]);
}

#[test]
fn files_stay_small() {
    assert_kept(files::too_long, &["src", "tests", "python/src"]);
}

#[test]
fn files_are_named_after_a_concept() {
    assert_kept(files::vaguely_named, &["src", "tests", "python/src"]);
}

#[test]
fn paths_start_at_the_crate() {
    assert_kept(files::climbing_paths, &["src", "tests", "python/src"]);
}
