//! What shells and manuals know of the program.

use crate::run::{run, stderr};
use std::{fs, io::Write, process};

#[test]
fn a_shell_reads_its_completions() {
    for (shell, checks) in [("bash", true), ("zsh", false), ("fish", false)] {
        let output = run(&["completions", shell]);
        assert!(output.status.success(), "{}", stderr(&output));
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(script.contains("replay") && script.contains("camera-pose"), "{shell}: {script}");
        if checks {
            let mut bash = process::Command::new("bash");
            let mut bash = bash.arg("-n").stdin(process::Stdio::piped()).spawn().unwrap();
            bash.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
            assert!(bash.wait().unwrap().success());
        }
    }
    assert_eq!(run(&["completions", "cmd.exe"]).status.code(), Some(2));
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let man = folder.path().join("man1");
    let output = run(&["man", man.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let page = |name: &str| fs::read_to_string(man.join(name)).unwrap();
    assert!(page("ellipsoid_slam.1").contains("ellipsoid_slam"));
    assert!(page("ellipsoid_slam-replay.1").contains("ground\\-truth"));
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let output = run(&["man", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("cannot write manual pages into"), "{}", stderr(&output));
}
