//! What rosbag2 compressed with zstd: whole files, or each message by itself.

use super::{BagError, disk_problem, scratch_file::ScratchFile};
use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

/// First bytes of what zstd compressed. A message in CDR begins with a zero.
pub(super) const ZSTD_MAGIC: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// Recordings shrink to a hundredth at best; what claims far more must not fill the disk.
const MAX_RATIO: u64 = 1000;

/// Unpacks a file into the system's folder for temporary files.
pub(super) fn unpacked_file(path: &Path) -> Result<ScratchFile, BagError> {
    let failed =
        |e: io::Error| BagError::NotUnpacked { path: path.to_owned(), problem: disk_problem(&e) };
    let packed = File::open(path).map_err(failed)?;
    let most = packed.metadata().map_err(failed)?.len().saturating_mul(MAX_RATIO);
    let mut out = ScratchFile::create().map_err(failed)?;
    let mut plain = zstd::Decoder::new(packed).map_err(failed)?.take(most);
    io::copy(&mut plain, out.file()).map_err(failed)?;
    if plain.limit() == 0 {
        return Err(failed(io::Error::other("it is no recording: it would be far larger")));
    }
    Ok(out)
}

/// A message as it was before it was compressed, of at most `most` bytes; one that is not compressed stays as it is. What
/// cannot be unpacked is left as it is, too: it will be refused as no message.
pub(super) fn unpacked_message(data: Vec<u8>, most: usize) -> Vec<u8> {
    if !data.starts_with(ZSTD_MAGIC) {
        return data;
    }
    let mut plain = Vec::new();
    let unpack = zstd::Decoder::new(data.as_slice())
        .and_then(|decoder| decoder.take(most as u64).read_to_end(&mut plain));
    if unpack.is_ok() { plain } else { data }
}
