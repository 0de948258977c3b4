//! Files that are either whole or not there.

use std::{
    collections::BTreeSet,
    fs::{self, File},
    io::{self, BufWriter, IntoInnerError, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

/// Writes a file under a temporary name in the same folder and renames it when it is complete and on the disk: whenever
/// the process or the machine dies, there is either the old file or the new one.
///
/// # Errors
/// When the folder is not there or not writable, or the disk is full; then nothing is left behind.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_atomically_with(path, |out| out.write_all(bytes))
}

/// The same with what `write` writes, for files that are not to be in memory as a whole.
///
/// # Errors
/// Likewise, and those of `write`.
pub fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let (temporary, file) = TemporaryFile::create(path)?;
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    let file = out.into_inner().map_err(IntoInnerError::into_error)?;
    // Otherwise the name may reach the disk before the content.
    file.sync_all()?;
    drop(file);
    temporary.keep()?;
    sync_folder(path);
    Ok(())
}

/// Brings a rename to the disk. Where folders cannot be opened as files, the system looks after that itself.
fn sync_folder(file: &Path) {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
        let _ = folder.sync_all();
    }
}

/// Removes what this process has not finished, before it ends otherwise than by returning from `main`.
pub fn remove_unfinished() {
    for path in unfinished().iter() {
        // Nothing can be done here where that fails.
        let _ = fs::remove_file(path);
    }
}

/// The temporary files that there are now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

pub(super) fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
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
        let file = created(&temporary)?;
        unfinished().insert(temporary.clone());
        Ok((Self { target: target.to_owned(), temporary }, file))
    }

    /// Gives the file its final name.
    pub(super) fn keep(&self) -> io::Result<()> {
        fs::rename(&self.temporary, &self.target)
    }
}

/// A new file, never one that somebody has put there, nor what a link points to.
fn created(path: &Path) -> io::Result<File> {
    match File::create_new(path) {
        // Left behind by a process of the same number.
        Err(why) if why.kind() == io::ErrorKind::AlreadyExists => {
            fs::remove_file(path)?;
            File::create_new(path)
        }
        created => created,
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        // Fails after `keep`, when there is nothing to remove; another failure cannot be mended here.
        let _ = fs::remove_file(&self.temporary);
        unfinished().remove(&self.temporary);
    }
}
