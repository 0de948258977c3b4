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
    #[error("{} is not an MCAP file", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// A folder without MCAP files.
    #[error("{} contains no .mcap file", path.display())]
    NoMcapInFolder {
        /// The folder.
        path: PathBuf,
    },
    /// rosbag2's other storage.
    #[error(
        "{} is a bag in SQLite storage, which is not supported: convert it to MCAP with `ros2 bag convert`",
        path.display()
    )]
    Sqlite {
        /// The folder or file.
        path: PathBuf,
    },
    /// rosbag2 compressed each message by itself.
    #[error(
        "{} is compressed message by message, which is not supported: convert it with `ros2 bag convert`, \
         or record with `--storage-preset-profile zstd_fast`",
        path.display()
    )]
    MessageCompression {
        /// The folder.
        path: PathBuf,
    },
    /// rosbag2 compressed the file as a whole.
    #[error(
        "{} is compressed as a whole, which is not supported: decompress it with `zstd -d` or convert the bag with \
         `ros2 bag convert`",
        path.display()
    )]
    FileCompression {
        /// The file.
        path: PathBuf,
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
