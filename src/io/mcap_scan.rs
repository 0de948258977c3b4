//! Finding the messages of a file without an index: a truncated one, or one that was written without chunks.

use super::{
    Damage,
    mcap_file::{Channels, MAX_RECORD_BYTES, Span, damage, new_channel, visit_records},
};
use mcap::records::{Record, op};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
};

/// What a scan found.
#[derive(Debug, Default)]
pub(super) struct Scan {
    pub(super) channels: Channels,
    pub(super) spans: Vec<Span>,
    pub(super) damage: Vec<Damage>,
}

/// Opcode and length.
const RECORD_HEADER_BYTES: u64 = 9;
/// Messages outside chunks are gathered into parts of about this size.
const PART_BYTES: u64 = 1 << 22;
/// A record that seems to lack more than this has a damaged length.
const MAX_MISSING_BYTES: u64 = MAX_RECORD_BYTES as u64;

/// Reads the whole file of `bytes` bytes once.
pub(super) fn scan(file: &mut File, bytes: u64) -> io::Result<Scan> {
    let mut scan = Scan::default();
    let (parts, outer_damage) = parts(file, bytes)?;
    let mut schemas = BTreeMap::new();
    for part in parts {
        let mut span = Span { start: u64::MAX, end: 0, ..part };
        let outcome = visit_records(file, &part, |record| {
            scan.note(record, &mut schemas, &mut span);
        });
        // A cut last record is reported once, by how much it lacks.
        let reported = outer_damage.is_some() && part.offset + part.bytes == bytes;
        if let (Err(problem), false) = (outcome, reported) {
            let damage = damage(&part, &problem);
            if !scan.damage.contains(&damage) {
                scan.damage.push(damage);
            }
        }
        if span.start <= span.end {
            scan.spans.push(span);
        }
    }
    scan.damage.extend(outer_damage);
    Ok(scan)
}

impl Scan {
    fn note(&mut self, record: Record<'_>, schemas: &mut BTreeMap<u16, String>, span: &mut Span) {
        match record {
            Record::Schema { header, .. } => {
                schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let type_name = schemas.get(&channel.schema_id).map_or("", String::as_str);
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                self.channels
                    .entry(channel.id)
                    .or_insert_with(|| new_channel(topic, type_name, encoding, 0));
            }
            Record::Message { header, .. } => {
                if let Some(channel) = self.channels.get_mut(&header.channel_id) {
                    channel.messages += 1;
                }
                span.start = span.start.min(header.log_time);
                span.end = span.end.max(header.log_time);
            }
            _ => (),
        }
    }
}

/// Parts of the file that can be read by themselves, and how it ends if not with a footer.
fn parts(file: &mut File, bytes: u64) -> io::Result<(Vec<Span>, Option<Damage>)> {
    let mut file = BufReader::new(file);
    let mut parts: Vec<Span> = Vec::new();
    let mut at = mcap::MAGIC.len() as u64;
    file.seek(SeekFrom::Start(at))?;
    // Whether the last part may grow: it holds plain records and is still small.
    let mut growing = false;
    while at + RECORD_HEADER_BYTES <= bytes {
        let (opcode, length) = record_header(&mut file)?;
        let end = at.saturating_add(RECORD_HEADER_BYTES).saturating_add(length);
        if !is_known(opcode) || end > bytes.saturating_add(MAX_MISSING_BYTES) {
            let problem = "there is no valid record".to_owned();
            return Ok((parts, Some(Damage::Corrupt { at_byte: at, bytes: bytes - at, problem })));
        }
        if matches!(opcode, op::DATA_END | op::FOOTER) {
            return Ok((parts, (!ends_with_magic(&mut file, bytes)?).then_some(Damage::NoFooter)));
        }
        let size = end.min(bytes) - at;
        let plain = matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE);
        match parts.last_mut() {
            Some(part) if growing && plain => part.bytes += size,
            _ if plain || opcode == op::CHUNK => {
                parts.push(Span { start: 0, end: 0, offset: at, bytes: size });
            }
            _ => (),
        }
        growing = plain && parts.last().is_some_and(|part| part.bytes < PART_BYTES);
        if end > bytes {
            return Ok((parts, Some(Damage::CutRecord { missing_bytes: end - bytes })));
        }
        // Fits: record lengths were compared with the file's length.
        file.seek_relative(length as i64)?;
        at = end;
    }
    let cut = Damage::CutRecord { missing_bytes: RECORD_HEADER_BYTES - (bytes - at) };
    Ok((parts, Some(if at == bytes { Damage::NoFooter } else { cut })))
}

fn record_header(file: &mut impl Read) -> io::Result<(u8, u64)> {
    let mut opcode = [0; 1];
    let mut length = [0; 8];
    file.read_exact(&mut opcode)?;
    file.read_exact(&mut length)?;
    Ok((opcode[0], u64::from_le_bytes(length)))
}

/// Opcodes of the format, and those from 0x80 that it leaves to applications.
fn is_known(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) || opcode >= 0x80
}

fn ends_with_magic(file: &mut (impl Read + Seek), bytes: u64) -> io::Result<bool> {
    let mut magic = [0; mcap::MAGIC.len()];
    file.seek(SeekFrom::Start(bytes.saturating_sub(magic.len() as u64)))?;
    file.read_exact(&mut magic)?;
    Ok(magic == mcap::MAGIC)
}
