//! Rules on single files: length, names, paths.

use crate::source::SourceFile;

const MAX_LINES: usize = 500;
/// Names that say nothing, so that everything ends up under them.
const VAGUE: &[&str] =
    &["util", "utils", "common", "helper", "helpers", "misc", "type", "types", "manager"];

pub(crate) fn too_long(file: &SourceFile) -> Vec<String> {
    let lines = file.text.lines().count();
    let what = format!("{lines} lines, more than {MAX_LINES}: split it by concept");
    (lines > MAX_LINES).then_some(what).into_iter().collect()
}

pub(crate) fn vaguely_named(file: &SourceFile) -> Vec<String> {
    let parts = file.path.split('/').map(|part| part.strip_suffix(".rs").unwrap_or(part));
    parts
        .filter(|part| VAGUE.contains(part) || part.ends_with("_utils"))
        .map(|part| format!("\"{part}\" names no concept"))
        .collect()
}

pub(crate) fn climbing_paths(file: &SourceFile) -> Vec<String> {
    // In pieces, or this file would break its own rule.
    let climbs = file.code.contains(concat!("super", "::", "super"));
    climbs.then(|| "a path climbs twice: start it at the crate".to_owned()).into_iter().collect()
}

#[test]
fn planted_faults_are_found() {
    let long = "\n".repeat(MAX_LINES + 1);
    assert_eq!(too_long(&SourceFile::new("src/a.rs", &long)).len(), 1);
    assert!(too_long(&SourceFile::new("src/a.rs", &long[1..])).is_empty());

    for path in
        ["src/utils.rs", "src/geometry/common.rs", "src/helpers/a.rs", "src/io/bag_utils.rs"]
    {
        assert_eq!(vaguely_named(&SourceFile::new(path, "")).len(), 1, "{path}");
    }
    assert!(vaguely_named(&SourceFile::new("src/geometry/outline.rs", "")).is_empty());

    let climbing = concat!("use super", "::", "super::Pose;");
    assert_eq!(climbing_paths(&SourceFile::new("src/a/b.rs", climbing)).len(), 1);
    assert!(climbing_paths(&SourceFile::new("src/a/b.rs", "use super::Pose;")).is_empty());
}
