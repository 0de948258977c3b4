//! Why a bag cannot be used, and what is wrong with one that can.

use std::{fmt, io, path::PathBuf};
use thiserror::Error;

/// Why a bag cannot be read or written at all.
#[derive(Debug, Error)]
pub enum BagError {
    /// Nothing there.
    #[error("{}: no such file or folder", path.display())]
    NotFound {
        /// What was asked for.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// Another kind of file.
    #[error("{} is neither an MCAP file nor one in SQLite storage", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// A folder without files of a bag.
    #[error("{} contains no .mcap or .db3 file", path.display())]
    NoBagInFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A database of something else.
    #[error("{} is an SQLite file, but not a bag of rosbag2: it has no tables `topics` and `messages`", path.display())]
    NotRosbag2 {
        /// The file.
        path: PathBuf,
    },
    /// Another program keeps the file to itself.
    #[error("{} is being written by another program: stop the recording first", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// A database that cannot be read.
    #[error("{} cannot be read as SQLite: {problem}", path.display())]
    BadDatabase {
        /// The file.
        path: PathBuf,
        /// What SQLite met.
        problem: String,
    },
    /// A bag of ROS 1.
    #[error(
        "{0} is a bag of ROS 1: convert it with `pip install rosbags` and `rosbags-convert --src {0} --dst FOLDER`",
        path.display()
    )]
    Ros1 {
        /// The file.
        path: PathBuf,
    },
    /// Compressed as a whole, and damaged or too large.
    #[error("{} cannot be decompressed: {problem}", path.display())]
    NotUnpacked {
        /// The file.
        path: PathBuf,
        /// What was met.
        problem: String,
    },
    /// `metadata.yaml` is not what rosbag2 writes.
    #[error("{}: {problem}", path.display())]
    BadMetadata {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The disk or the MCAP library refused to write.
    #[error("{} cannot be written: {problem}", path.display())]
    NotWritable {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
}

/// What is wrong with a part of a bag; the rest has been read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BagWarning {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it, with numbers.
    pub damage: Damage,
}

/// Kinds of damage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Damage {
    /// The file ends inside a record.
    CutRecord {
        /// Bytes that the last record lacks.
        missing_bytes: u64,
    },
    /// The file ends after a whole record, but before its footer.
    NoFooter,
    /// The index at the end is not what was written: everything was read instead.
    Index,
    /// A part is compressed in a way that is not known here.
    Compression {
        /// What the file calls it.
        name: String,
    },
    /// Rows of a database that cannot be read.
    Rows {
        /// What SQLite met.
        problem: String,
    },
    /// Bytes that are not what they should be.
    Corrupt {
        /// First byte of the part.
        at_byte: u64,
        /// Length of the part.
        bytes: u64,
        /// What the reader met.
        problem: String,
    },
}

impl fmt::Display for BagWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match &self.damage {
            Damage::CutRecord { missing_bytes } => write!(
                f,
                "{path} is truncated: at least {missing_bytes} bytes of its last record and the footer are missing; \
                 all whole messages are used"
            ),
            Damage::NoFooter => {
                write!(f, "{path} is truncated: the footer is missing; all whole messages are used")
            }
            Damage::Index => write!(
                f,
                "{path} is damaged: the checksum of its index is wrong; the whole file was read instead of it"
            ),
            Damage::Compression { name } => write!(
                f,
                "{path} is compressed with `{name}`, which is not supported (zstd and lz4 are): what is compressed so \
                 is not read"
            ),
            Damage::Rows { problem } => {
                write!(f, "{path} is damaged: {problem}; messages there are lost")
            }
            Damage::Corrupt { at_byte, bytes, problem } => write!(
                f,
                "{path} is damaged between byte {at_byte} and byte {end}: {problem}; messages there may be lost",
                end = at_byte + bytes
            ),
        }
    }
}

/// What the system said of a file that cannot be written; in our words where it is about the disk.
pub fn disk_problem(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull => "the disk is full".into(),
        io::ErrorKind::QuotaExceeded => "the disk quota is used up".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk can only be read".into(),
        io::ErrorKind::FileTooLarge => "the disk takes no larger file".into(),
        _ => error.to_string(),
    }
}
