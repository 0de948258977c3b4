//! Which files a bag consists of.

use super::BagError;
use serde::Deserialize;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// The files of a bag, in order: the file itself, or those of a rosbag2 folder.
pub(super) fn bag_files(path: &Path) -> Result<Vec<PathBuf>, BagError> {
    let meta = fs::metadata(path).map_err(|source| unreadable(path, source))?;
    if !meta.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join("metadata.yaml");
    if metadata.is_file() { listed_files(path, &metadata) } else { present_files(path) }
}

/// An error that says "no such file" in our words.
pub(super) fn unreadable(path: &Path, source: io::Error) -> BagError {
    let path = path.to_owned();
    match source.kind() {
        io::ErrorKind::NotFound => BagError::NotFound { path },
        _ => BagError::Io { path, source },
    }
}

/// The files that `metadata.yaml` lists.
fn listed_files(folder: &Path, metadata: &Path) -> Result<Vec<PathBuf>, BagError> {
    let text = fs::read_to_string(metadata).map_err(|source| unreadable(metadata, source))?;
    let parsed: Metadata = serde_saphyr::from_str(&text).map_err(|e| {
        let problem = e.to_string().lines().next().unwrap_or_default().to_owned();
        BagError::BadMetadata { path: metadata.to_owned(), problem }
    })?;
    let bag = parsed.rosbag2_bagfile_information;
    if bag.relative_file_paths.is_empty() {
        return Err(BagError::NoBagInFolder { path: folder.to_owned() });
    }
    bag.relative_file_paths.iter().map(|name| listed_file(folder, name)).collect()
}

/// A listed file; where it is not there, the one of that name in the folder itself (early rosbag2 wrote the path
/// as seen from outside), or what was made of it by compression.
fn listed_file(folder: &Path, name: &str) -> Result<PathBuf, BagError> {
    let listed = folder.join(name);
    let beside = Path::new(name).file_name().map(|name| folder.join(name));
    let packed = folder.join(format!("{name}.zstd"));
    [Some(listed.clone()), beside, Some(packed)]
        .into_iter()
        .flatten()
        .find(|path| path.is_file())
        .ok_or(BagError::NotFound { path: listed })
}

/// All files of a folder that are bags of one kind, compressed ones too, by name.
fn present_files(folder: &Path) -> Result<Vec<PathBuf>, BagError> {
    let entries = fs::read_dir(folder).map_err(|source| unreadable(folder, source))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let of_kind = |kind: &&str| {
        let is = |path: &&PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            name.trim_end_matches(".zstd").ends_with(kind)
        };
        paths.iter().filter(is).cloned().collect::<Vec<_>>()
    };
    // Those of ROS 1 are refused by name when they are opened.
    let kinds = [".mcap", ".db3", ".bag"];
    let found = kinds.iter().map(of_kind).find(|files| !files.is_empty());
    found.ok_or(BagError::NoBagInFolder { path: folder.to_owned() })
}

/// What matters here of rosbag2's `metadata.yaml`.
#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: BagInformation,
}

#[derive(Deserialize)]
struct BagInformation {
    #[serde(default)]
    relative_file_paths: Vec<String>,
}
