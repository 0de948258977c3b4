//! One file of a bag, whatever its storage: which topics it has, and where their messages lie.

use super::{
    BagError, BagWarning, Damage,
    bag_folder::unreadable,
    mcap_file::{self, Channels, Span},
    scratch_file::ScratchFile,
    sqlite_file::{self, Row, SQLITE_MAGIC},
    unpacked::{ZSTD_MAGIC, unpacked_file},
};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

/// A file of a bag.
#[derive(Debug)]
pub(super) struct BagFile {
    /// As its user knows it.
    pub(super) path: PathBuf,
    /// Where its bytes are.
    pub(super) data: PathBuf,
    pub(super) channels: Channels,
    pub(super) spans: Vec<Span>,
    pub(super) warnings: Vec<BagWarning>,
    /// Of a file in SQLite storage, where its messages are.
    pub(super) rows: Option<Vec<Row>>,
    /// Of a file that was compressed as a whole: gone when this is.
    _unpacked: Option<ScratchFile>,
}

/// What a file holds, without the messages themselves.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) channels: Channels,
    pub(super) spans: Vec<Span>,
    /// Of SQLite storage, in the order of log time: offsets and lengths of spans count these.
    pub(super) rows: Option<Vec<Row>>,
    pub(super) damage: Vec<Damage>,
}

impl BagFile {
    /// Opens a file; its first bytes say what it is.
    pub(super) fn open(path: &Path) -> Result<Self, BagError> {
        let unpacked = match first_bytes(path)?.starts_with(ZSTD_MAGIC) {
            true => Some(unpacked_file(path)?),
            false => None,
        };
        let data = unpacked.as_ref().map_or(path, ScratchFile::path).to_owned();
        let first = first_bytes(&data)?;
        let contents = if first.starts_with(b"#ROSBAG V") {
            return Err(BagError::Ros1 { path: path.to_owned() });
        } else if first == SQLITE_MAGIC {
            sqlite_file::contents(&data, path)?
        } else {
            mcap_file::contents(&data, path)?
        };
        let warning = |damage| BagWarning { path: path.to_owned(), damage };
        Ok(Self {
            path: path.to_owned(),
            data,
            channels: contents.channels,
            spans: contents.spans,
            warnings: contents.damage.into_iter().map(warning).collect(),
            rows: contents.rows,
            _unpacked: unpacked,
        })
    }
}

/// As many as SQLite's mark has, or fewer where the file is shorter.
fn first_bytes(path: &Path) -> Result<Vec<u8>, BagError> {
    let mut first = Vec::new();
    let read = |file: File| file.take(SQLITE_MAGIC.len() as u64).read_to_end(&mut first);
    File::open(path).and_then(read).map_err(|source| unreadable(path, source))?;
    Ok(first)
}
