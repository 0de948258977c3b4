//! An environment with other people's Python packages, made once under `target/`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::Mutex,
};

/// Python of an environment with the packages of a file, made when it is not there or when the file has changed:
/// `tests/requirements.txt` is installed in `target/python`, `tests/ros/requirements.txt` in `target/python_ros`.
///
/// # Errors
/// What went wrong when it was made, with the command.
pub(crate) fn python(requirements: &str) -> Result<PathBuf, String> {
    /// Tests run side by side and one environment is enough.
    static MAKING: Mutex<()> = Mutex::new(());
    let _making = MAKING.lock().map_err(|e| e.to_string())?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let requirements = root.join(requirements);
    let folder = requirements.parent().and_then(Path::file_name).unwrap_or_default();
    let environment = match folder.to_string_lossy().as_ref() {
        "tests" => root.join("target/python"),
        other => root.join(format!("target/python_{other}")),
    };
    let wanted = fs::read(&requirements).map_err(|e| format!("{}: {e}", requirements.display()))?;
    let (stamp, python) = (environment.join("installed.txt"), environment.join("bin/python"));
    if fs::read(&stamp).ok().as_ref() != Some(&wanted) {
        run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment))?;
        let install = ["-m", "pip", "install", "-q", "-r"];
        run(Command::new(&python).args(install).arg(&requirements))?;
        fs::write(&stamp, &wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    }
    Ok(python)
}

/// What a command printed.
///
/// # Errors
/// When it did not succeed: the command and its complaints.
pub(crate) fn run(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)))
    }
}
