//! Trajectories in TUM form: `stamp tx ty tz qx qy qz qw`, one pose a line.

use crate::{geometry::Pose, time::Stamp};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use std::{fmt::Write, fs, io, path::Path, path::PathBuf};
use thiserror::Error;

/// Why a file is not a trajectory.
#[derive(Debug, Error)]
pub enum TrajectoryError {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A line is not a pose.
    #[error("{}, line {line}: expected `stamp tx ty tz qx qy qz qw` with finite numbers and a quaternion that is not zero", path.display())]
    BadLine {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
    },
}

/// The text of a trajectory, readable by evo.
pub fn trajectory_text<'a>(poses: impl IntoIterator<Item = &'a (Stamp, Pose)>) -> String {
    let mut text = String::new();
    for (stamp, pose) in poses {
        let (t, q) = (pose.translation.vector, pose.rotation);
        let line = writeln!(
            text,
            "{stamp} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9}",
            t.x, t.y, t.z, q.i, q.j, q.k, q.w
        );
        debug_assert!(line.is_ok(), "writing to a string cannot fail");
    }
    text
}

/// Reads a trajectory, in the order of its stamps. Lines that are empty or begin with `#` are passed over.
///
/// # Errors
/// When the file cannot be read or a line is not a pose.
pub fn read_trajectory(path: &Path) -> Result<Vec<(Stamp, Pose)>, TrajectoryError> {
    let text = fs::read_to_string(path)
        .map_err(|source| TrajectoryError::Io { path: path.to_owned(), source })?;
    let mut poses = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let bad = || TrajectoryError::BadLine { path: path.to_owned(), line: i + 1 };
        poses.push(parse(line).ok_or_else(bad)?);
    }
    poses.sort_by_key(|(stamp, _)| *stamp);
    Ok(poses)
}

fn parse(line: &str) -> Option<(Stamp, Pose)> {
    let mut words = line.split_whitespace();
    let stamp = parse_stamp(words.next()?)?;
    let numbers: Vec<f64> = words.map(|w| w.parse().ok()).collect::<Option<_>>()?;
    let [tx, ty, tz, qx, qy, qz, qw] = numbers[..] else { return None };
    let finite = numbers.iter().all(|n| n.is_finite());
    let rotation =
        UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 1e-6).filter(|_| finite)?;
    Some((stamp, Pose::from_parts(Translation3::new(tx, ty, tz), rotation)))
}

/// Seconds with decimals, exact to the nanosecond: present-day stamps do not fit a double.
pub(super) fn parse_stamp(text: &str) -> Option<Stamp> {
    let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
    let digits = |t: &str| t.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !digits(whole) || !digits(decimals) {
        // Negative or in exponent form.
        return text.parse().ok().filter(|s: &f64| s.is_finite()).map(Stamp::from_secs);
    }
    let nanos: String = decimals.chars().chain("000000000".chars()).take(9).collect();
    let secs: i64 = whole.parse().ok()?;
    Some(Stamp::from_nanos(secs.checked_mul(1_000_000_000)?.checked_add(nanos.parse().ok()?)?))
}
