//! Which files a bag consists of.

use super::BagError;
use serde::Deserialize;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// The MCAP files of a bag, in order: the file itself, or those of a rosbag2 folder.
pub(super) fn mcap_files(path: &Path) -> Result<Vec<PathBuf>, BagError> {
    let meta = fs::metadata(path).map_err(|source| unreadable(path, source))?;
    if !meta.is_dir() {
        return match path.extension() {
            Some(extension) if extension == "db3" => {
                Err(BagError::Sqlite { path: path.to_owned() })
            }
            _ => Ok(vec![path.to_owned()]),
        };
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
    if bag.storage_identifier == "sqlite3" {
        return Err(BagError::Sqlite { path: folder.to_owned() });
    }
    if bag.compression_mode.eq_ignore_ascii_case("message") {
        return Err(BagError::MessageCompression { path: folder.to_owned() });
    }
    if bag.relative_file_paths.is_empty() {
        return Err(BagError::NoMcapInFolder { path: folder.to_owned() });
    }
    bag.relative_file_paths.iter().map(|name| listed_file(folder, name)).collect()
}

/// A listed file; where it is not there, the one of that name in the folder itself (early rosbag2 wrote the path
/// as seen from outside).
fn listed_file(folder: &Path, name: &str) -> Result<PathBuf, BagError> {
    let listed = folder.join(name);
    let beside = Path::new(name).file_name().map(|name| folder.join(name));
    [Some(listed.clone()), beside]
        .into_iter()
        .flatten()
        .find(|path| path.is_file())
        .ok_or(BagError::NotFound { path: listed })
}

/// All MCAP files of a folder, by name.
fn present_files(folder: &Path) -> Result<Vec<PathBuf>, BagError> {
    let entries = fs::read_dir(folder).map_err(|source| unreadable(folder, source))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let with = |extension: &str| {
        let found = paths.iter().filter(|p| p.extension().is_some_and(|e| e == extension));
        found.cloned().collect::<Vec<_>>()
    };
    match (with("mcap"), with("db3")) {
        (mcap, _) if !mcap.is_empty() => Ok(mcap),
        (_, sqlite) if !sqlite.is_empty() => Err(BagError::Sqlite { path: folder.to_owned() }),
        _ => Err(BagError::NoMcapInFolder { path: folder.to_owned() }),
    }
}

/// What matters here of rosbag2's `metadata.yaml`.
#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: BagInformation,
}

#[derive(Deserialize)]
struct BagInformation {
    #[serde(default)]
    storage_identifier: String,
    #[serde(default)]
    relative_file_paths: Vec<String>,
    #[serde(default)]
    compression_mode: String,
}
