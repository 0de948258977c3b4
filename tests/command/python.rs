//! Our files in other people's programs: Python's `mcap-ros2-support` and evo.

use crate::{
    environment::{python, run},
    run::{FRAMES, Flaw, replayed},
};
use std::{path::Path, process::Command};

#[test]
fn results_open_in_mcap_ros2_support_and_evo() {
    let (_folder, _, out) = replayed(Flaw::None);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/read_results.py");
    run(Command::new(python("tests/requirements.txt").unwrap())
        .arg(script)
        .arg(&out)
        .arg(FRAMES.to_string()))
    .unwrap();
}
