//! One SQLite file of rosbag2, which Humble records to by default: only read, whatever is in it.

use super::{
    BagError, Damage,
    bag_file::Contents,
    mcap_file::{Channels, MAX_RECORD_BYTES, Span, new_channel},
};
use rusqlite::{Connection, ErrorCode, OpenFlags, limits::Limit};
use std::{path::Path, time::Duration};

/// First bytes of a SQLite file.
pub(super) const SQLITE_MAGIC: &[u8; 16] = b"SQLite format 3\0";

/// Where a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Row {
    /// Log time in nanoseconds.
    pub(super) time: u64,
    id: i64,
    pub(super) channel: u16,
}

/// Messages that are read at once: images of 1 MB must not fill the memory.
const PART_ROWS: usize = 16;
/// A row takes more than this.
const LEAST_ROW_BYTES: u64 = 6;
/// Rows that are passed over at once to get beyond damage.
const MOST_SKIPPED: i64 = 1 << 20;
/// A recorder that is still writing locks the file for moments only.
const PATIENCE: Duration = Duration::from_secs(1);

/// Opens a file to read it. What it says of the size of things is believed up to the size of the file.
pub(super) fn connect(path: &Path) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(path, flags)?;
    let bytes = std::fs::metadata(path).map_or(0, |meta| meta.len());
    let most = i32::try_from(bytes).unwrap_or(i32::MAX).clamp(1 << 16, MAX_RECORD_BYTES as i32);
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, most)?;
    database.busy_timeout(PATIENCE)?;
    // Schemas of strangers run nothing here, and damaged pages are noticed.
    database.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;")?;
    Ok(database)
}

/// Lists topics and messages of a file, which its user knows as `name`.
pub(super) fn contents(path: &Path, name: &Path) -> Result<Contents, BagError> {
    let wrong = |error: rusqlite::Error| not_readable(name, &error);
    let database = connect(path).map_err(wrong)?;
    let tables = "SELECT count(*) FROM sqlite_master \
                  WHERE type = 'table' AND name IN ('topics', 'messages') AND sql NOT LIKE '%VIRTUAL%'";
    let tables: i64 = database.query_row(tables, [], |row| row.get(0)).map_err(wrong)?;
    if tables != 2 {
        return Err(BagError::NotRosbag2 { path: name.to_owned() });
    }
    let (mut channels, mut ids) = (Channels::new(), Vec::new());
    let mut topics = database
        .prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id")
        .map_err(wrong)?;
    let mut found = topics.query([]).map_err(wrong)?;
    while let Some(row) = found.next().map_err(wrong)? {
        let text = |at| row.get::<_, String>(at).map_err(wrong);
        let Ok(channel) = u16::try_from(ids.len()) else { break };
        ids.push(row.get::<_, i64>(0).map_err(wrong)?);
        channels.insert(channel, new_channel(&text(1)?, &text(2)?, &text(3)?, 0));
    }
    let bytes = std::fs::metadata(path).map_or(0, |meta| meta.len());
    let (mut rows, damage) = rows(&database, &ids, bytes / LEAST_ROW_BYTES);
    for row in &rows {
        if let Some(channel) = channels.get_mut(&row.channel) {
            channel.messages += 1;
        }
    }
    rows.sort_unstable();
    let spans = rows.chunks(PART_ROWS).enumerate().map(|(at, part)| Span {
        start: part.first().map_or(0, |row| row.time),
        end: part.last().map_or(0, |row| row.time),
        offset: (at * PART_ROWS) as u64,
        bytes: part.len() as u64,
    });
    let (spans, damage) = (spans.collect(), damage.into_iter().collect());
    Ok(Contents { channels, spans, rows: Some(rows), damage })
}

/// The messages of known topics, as far as they can be read, and not more than `most`: pages of a damaged file can be
/// linked so that they seem to have any number of rows.
fn rows(database: &Connection, topics: &[i64], most: u64) -> (Vec<Row>, Option<Damage>) {
    let mut rows = Vec::new();
    let read = |rows: &mut Vec<Row>, after: i64| -> rusqlite::Result<()> {
        let listed = "SELECT id, topic_id, timestamp FROM messages WHERE id > ?1 ORDER BY id";
        let mut messages = database.prepare(listed)?;
        let mut found = messages.query([after])?;
        while let Some(row) = found.next()?
            && (rows.len() as u64) < most
        {
            let topic: i64 = row.get(1)?;
            let Some(channel) = topics.iter().position(|known| *known == topic) else { continue };
            let time = u64::try_from(row.get::<_, i64>(2)?).unwrap_or(0);
            rows.push(Row { time, id: row.get(0)?, channel: channel as u16 });
        }
        Ok(())
    };
    let (mut after, mut step, mut problem) = (i64::MIN, 1, None);
    while let Err(error) = read(&mut rows, after) {
        problem.get_or_insert(error.to_string());
        let reached = rows.last().map_or(0, |row| row.id).max(after);
        if reached > after {
            step = 1;
        }
        if step > MOST_SKIPPED {
            break;
        }
        after = reached.saturating_add(step);
        step *= 2;
    }
    if rows.len() as u64 >= most {
        problem = Some("it lists more messages than it can hold".into());
    }
    (rows, problem.map(|problem| Damage::Rows { problem }))
}

/// Hands the bytes of each message to `take`; those that cannot be read are passed over.
///
/// # Errors
/// When messages were passed over.
pub(super) fn read_rows(
    database: &Connection,
    rows: &[Row],
    mut take: impl FnMut(&Row, &[u8]),
) -> Result<(), Damage> {
    let damage = |error: rusqlite::Error| Damage::Rows { problem: error.to_string() };
    let mut message =
        database.prepare("SELECT data FROM messages WHERE id = ?1").map_err(damage)?;
    let mut failed = None;
    for row in rows {
        let read = message.query_row([row.id], |found| {
            take(row, found.get_ref(0)?.as_blob()?);
            Ok(())
        });
        failed = failed.or(read.err());
    }
    failed.map_or(Ok(()), |error| Err(damage(error)))
}

fn not_readable(path: &Path, error: &rusqlite::Error) -> BagError {
    let path = path.to_owned();
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => BagError::Busy { path },
        _ => BagError::BadDatabase { path, problem: error.to_string() },
    }
}
