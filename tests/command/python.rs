//! Our files in other people's programs: Python's `mcap-ros2-support` and evo.
//!
//! Their packages are installed once into an environment under `target/`.

use crate::run::{FRAMES, Flaw, replayed, stderr};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Mutex,
};

/// The environment's Python, made when it is not there or when `requirements.txt` has changed.
pub(crate) fn python() -> PathBuf {
    // Tests run at the same time, the environment is made once.
    static MAKING: Mutex<()> = Mutex::new(());
    let _one_at_a_time = MAKING.lock();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let environment = root.join("target/python");
    let requirements = root.join("tests/requirements.txt");
    let (wanted, stamp) = (fs::read(&requirements).unwrap(), environment.join("installed.txt"));
    let python = environment.join("bin/python");
    if fs::read(&stamp).ok().as_ref() != Some(&wanted) {
        let succeed = |command: &mut Command| {
            let output = command.output().unwrap();
            assert!(output.status.success(), "{command:?}: {}", stderr(&output));
        };
        succeed(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment));
        succeed(
            Command::new(&python).args(["-m", "pip", "install", "-q", "-r"]).arg(&requirements),
        );
        fs::write(&stamp, &wanted).unwrap();
    }
    python
}

#[test]
fn results_open_in_mcap_ros2_support_and_evo() {
    let (_folder, _, out) = replayed(Flaw::None);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/read_results.py");
    let read = Command::new(python()).arg(script).arg(&out).arg(FRAMES.to_string()).output();
    let read = read.unwrap();
    assert!(read.status.success(), "{}", stderr(&read));
}
