//! One MCAP file: where its messages lie, and reading a part of it.

use super::{
    BagError, Damage,
    bag_file::Contents,
    bag_folder::unreadable,
    mcap_scan::{self, Scan},
};
use mcap::{
    McapError,
    records::Record,
    sans_io::{
        LinearReadEvent, LinearReader, LinearReaderOptions, SummaryReadEvent, SummaryReader,
        SummaryReaderOptions,
    },
};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::Path,
    sync::Arc,
};

/// No ROS message is longer; a damaged length must not claim memory.
pub(super) const MAX_RECORD_BYTES: usize = 1 << 27;
/// How much is read at once.
const READ_BYTES: usize = 1 << 18;

/// Channels by id.
pub(super) type Channels = BTreeMap<u16, Channel>;

/// A topic within one file.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) topic: Arc<str>,
    pub(super) type_name: Arc<str>,
    pub(super) encoding: Arc<str>,
    pub(super) messages: u64,
}

/// A part of a file that consists of whole records (a chunk, or messages outside chunks) and can be read by itself;
/// only the last one of a truncated file ends inside a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    /// Log time of the earliest message in nanoseconds.
    pub(super) start: u64,
    /// Log time of the latest message in nanoseconds.
    pub(super) end: u64,
    /// First byte.
    pub(super) offset: u64,
    /// Length.
    pub(super) bytes: u64,
}

/// Finds the messages of a file, which its user knows as `name`, by its index, or by reading all of it where it has none.
pub(super) fn contents(path: &Path, name: &Path) -> Result<Contents, BagError> {
    let (mut file, bytes) = open(path).map_err(|source| unreadable(name, source))?;
    let mut magic = [0; mcap::MAGIC.len()];
    if file.read_exact(&mut magic).is_err() || magic != mcap::MAGIC {
        return Err(BagError::NotMcap { path: name.to_owned() });
    }
    let failed = |source| BagError::Io { path: name.to_owned(), source };
    let is_intact = has_intact_summary(&mut file, bytes).map_err(failed)?;
    if is_intact && let Some((channels, spans)) = indexed(&mut file, bytes) {
        return Ok(Contents { channels, spans, ..Contents::default() });
    }
    let Scan { channels, spans, damage } = mcap_scan::scan(&mut file, bytes).map_err(failed)?;
    let damage = (!is_intact).then_some(Damage::Index).into_iter().chain(damage).collect();
    Ok(Contents { channels, spans, damage, rows: None })
}

/// A file and its length.
pub(super) fn open(path: &Path) -> io::Result<(File, u64)> {
    let file = File::open(path)?;
    let bytes = file.metadata()?.len();
    Ok((file, bytes))
}

/// Hands every record of the span to `visit`, from inside chunks too.
///
/// # Errors
/// When the span ends inside a record or is damaged; whole records before that have been visited.
pub(super) fn visit_records(
    file: &mut File,
    span: &Span,
    mut visit: impl FnMut(Record<'_>),
) -> Result<(), McapError> {
    file.seek(SeekFrom::Start(span.offset))?;
    let mut bytes = file.take(span.bytes);
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(MAX_RECORD_BYTES);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let got = bytes.read(reader.insert(wanted.clamp(1, READ_BYTES)))?;
                reader.notify_read(got);
            }
            LinearReadEvent::Record { opcode, data } => visit(mcap::parse_record(opcode, data)?),
        }
    }
    Ok(())
}

/// Damage of a span as a warning's content.
pub(super) fn damage(span: &Span, problem: &McapError) -> Damage {
    if let McapError::UnsupportedCompression(name) = problem {
        return Damage::Compression { name: name.chars().take(32).collect() };
    }
    Damage::Corrupt { at_byte: span.offset, bytes: span.bytes, problem: problem.to_string() }
}

/// Whether the summary has the checksum that the footer states; true where it states none, or there is no footer.
fn has_intact_summary(file: &mut File, bytes: u64) -> io::Result<bool> {
    /// Opcode, length, start of the summary, start of its offsets, checksum.
    const FOOTER_BYTES: usize = 1 + 8 + 8 + 8 + 4;
    let end = bytes.saturating_sub(mcap::MAGIC.len() as u64);
    let Some(footer_at) = end.checked_sub(FOOTER_BYTES as u64) else { return Ok(true) };
    let (mut footer, mut magic) = ([0; FOOTER_BYTES], [0; mcap::MAGIC.len()]);
    file.seek(SeekFrom::Start(footer_at))?;
    file.read_exact(&mut footer)?;
    file.read_exact(&mut magic)?;
    let (true, Ok(Record::Footer(stated))) =
        (magic == mcap::MAGIC, mcap::parse_record(footer[0], &footer[9..]))
    else {
        return Ok(true);
    };
    let has_summary = (1..=footer_at).contains(&stated.summary_start);
    if stated.summary_crc == 0 || !has_summary {
        return Ok(true);
    }
    file.seek(SeekFrom::Start(stated.summary_start))?;
    // All but the checksum itself.
    let mut summary = file.take(end - 4 - stated.summary_start);
    let (mut sum, mut part) = (crc32fast::Hasher::new(), vec![0; READ_BYTES]);
    loop {
        match summary.read(&mut part)? {
            0 => return Ok(sum.finalize() == stated.summary_crc),
            got => sum.update(&part[..got]),
        }
    }
}

/// Channels and chunks as the file's summary lists them; nothing where it has no complete one.
fn indexed(file: &mut File, bytes: u64) -> Option<(Channels, Vec<Span>)> {
    let summary = read_summary(file, bytes).ok()??;
    let counts = &summary.stats.as_ref()?.channel_message_counts;
    let channels: Channels = summary
        .channels
        .iter()
        .map(|(id, channel)| {
            let type_name = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
            let messages = counts.get(id).copied().unwrap_or(0);
            let encoding = &channel.message_encoding;
            (*id, new_channel(&channel.topic, type_name, encoding, messages))
        })
        .collect();
    let spans = summary.chunk_indexes.iter().map(|chunk| Span {
        start: chunk.message_start_time,
        end: chunk.message_end_time,
        offset: chunk.chunk_start_offset,
        bytes: chunk.chunk_length,
    });
    let spans: Vec<Span> = spans.collect();
    let within = |span: &Span| span.offset.checked_add(span.bytes).is_some_and(|end| end <= bytes);
    let all_counted = counts.keys().all(|id| channels.contains_key(id));
    let has_messages = counts.values().any(|count| *count > 0);
    let usable = spans.iter().all(within) && all_counted && (!has_messages || !spans.is_empty());
    usable.then_some((channels, spans))
}

/// A channel, with the type's name as ROS 2 spells it.
pub(super) fn new_channel(topic: &str, type_name: &str, encoding: &str, messages: u64) -> Channel {
    let type_name = match type_name.split('/').collect::<Vec<_>>().as_slice() {
        [package, name] => format!("{package}/msg/{name}"),
        _ => type_name.to_owned(),
    };
    Channel {
        topic: topic.into(),
        type_name: type_name.into(),
        encoding: encoding.into(),
        messages,
    }
}

fn read_summary(file: &mut File, bytes: u64) -> Result<Option<mcap::Summary>, McapError> {
    let options = SummaryReaderOptions::default()
        .with_file_size(bytes)
        .with_record_length_limit(MAX_RECORD_BYTES);
    let mut reader = SummaryReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            SummaryReadEvent::ReadRequest(wanted) => {
                let got = file.read(reader.insert(wanted.clamp(1, READ_BYTES)))?;
                reader.notify_read(got);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to)?),
        }
    }
    Ok(reader.finish())
}
