//! Files for a while.

use super::atomic::unfinished;
use std::{fs::File, io, path::Path};
use tempfile::NamedTempFile;

/// A file in the system's folder for temporary files, which disappears again.
#[derive(Debug)]
pub(super) struct ScratchFile(NamedTempFile);

impl ScratchFile {
    /// A new file that nobody else can read.
    pub(super) fn create() -> io::Result<Self> {
        let file = NamedTempFile::new()?;
        unfinished().insert(file.path().to_owned());
        Ok(Self(file))
    }

    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(super) fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }
}

impl Drop for ScratchFile {
    fn drop(&mut self) {
        unfinished().remove(self.0.path());
    }
}
