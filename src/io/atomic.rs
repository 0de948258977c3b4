//! Files that are either whole or not there.

use std::{
    fs::{self, File},
    io::{self, Write},
    path::{Path, PathBuf},
};

/// Writes a file under a temporary name in the same folder and renames it when it is complete.
///
/// # Errors
/// When the folder is not there or not writable, or the disk is full; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (temporary, mut file) = TemporaryFile::create(path)?;
    file.write_all(bytes)?;
    drop(file);
    temporary.keep()
}

/// A file that disappears again unless it is kept.
#[derive(Debug)]
pub(super) struct TemporaryFile {
    target: PathBuf,
    temporary: PathBuf,
}

impl TemporaryFile {
    /// A new file beside `target`, of the same name with a suffix.
    pub(super) fn create(target: &Path) -> io::Result<(Self, File)> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", std::process::id()));
        let temporary = target.with_file_name(name);
        let file = File::create(&temporary)?;
        Ok((Self { target: target.to_owned(), temporary }, file))
    }

    /// Gives the file its final name.
    pub(super) fn keep(&self) -> io::Result<()> {
        fs::rename(&self.temporary, &self.target)
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        // Fails after `keep`, when there is nothing to remove; another failure cannot be mended here.
        let _ = fs::remove_file(&self.temporary);
    }
}
