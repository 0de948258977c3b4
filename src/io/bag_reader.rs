//! Bags as a stream of messages in the order of their log time.

use super::{
    BagError, BagWarning, Damage,
    bag_file::BagFile,
    bag_folder,
    mcap_file::{self, MAX_RECORD_BYTES, Span, damage, visit_records},
    sqlite_file::{self, Row, read_rows},
    unpacked::unpacked_message,
};
use crate::{
    msg::{
        Message,
        cdr::decode,
        sensor_msgs::{CompressedImage, Image},
    },
    time::Stamp,
    topics::Topic,
};
use mcap::records::Record;
use rusqlite::Connection;
use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet, BinaryHeap},
    fs::File,
    path::Path,
    sync::Arc,
};

/// A bag that has been opened: one file or those of a rosbag2 folder.
#[derive(Debug)]
pub struct BagReader {
    files: Vec<BagFile>,
    topics: Vec<Topic>,
}

/// A message as it lies in the bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawMessage {
    /// Topic.
    pub topic: Arc<str>,
    /// Type, such as `sensor_msgs/msg/Image`.
    pub type_name: Arc<str>,
    /// When it was recorded.
    pub log_time: Stamp,
    /// CDR bytes.
    pub data: Vec<u8>,
}

impl BagReader {
    /// Opens an `.mcap` or `.db3` file or a rosbag2 folder, also where rosbag2 compressed it.
    ///
    /// # Errors
    /// When there is no such file or it cannot be read. Damage is a warning, not an error.
    pub fn open(path: &Path) -> Result<Self, BagError> {
        let paths = bag_folder::bag_files(path)?;
        let files: Vec<BagFile> =
            paths.iter().map(|path| BagFile::open(path)).collect::<Result<_, _>>()?;
        let topics = topics_of(&files);
        let mut bag = Self { files, topics };
        let formats = bag.formats();
        for topic in &mut bag.topics {
            topic.format = formats.get(&topic.name).cloned();
        }
        Ok(bag)
    }

    /// What the first image on each topic says of its format, as far as these come early.
    fn formats(&self) -> BTreeMap<String, String> {
        let is_image = |topic: &&Topic| {
            [Image::TYPE, CompressedImage::TYPE].contains(&topic.type_name.as_str())
        };
        let with_images = self.topics.iter().filter(|topic| topic.messages > 0).filter(is_image);
        let images: Vec<&str> = with_images.map(|topic| topic.name.as_str()).collect();
        let mut formats = BTreeMap::new();
        if images.is_empty() {
            return formats;
        }
        for message in self.messages().only(&images).take(MOST_SEARCHED) {
            if !formats.contains_key(&*message.topic)
                && let Some(format) = format_of(&message)
            {
                formats.insert(message.topic.to_string(), format);
            }
            if formats.len() == images.len() {
                break;
            }
        }
        formats
    }

    /// All topics, by name.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// Number of messages in all topics.
    pub fn message_count(&self) -> u64 {
        self.topics.iter().map(|topic| topic.messages).sum()
    }

    /// Log times of the first and the last message; nothing for an empty bag.
    pub fn time_range(&self) -> Option<(Stamp, Stamp)> {
        let spans = || self.files.iter().flat_map(|file| &file.spans);
        let first = spans().map(|span| span.start).min()?;
        let last = spans().map(|span| span.end).max()?;
        Some((stamp_of(first), stamp_of(last)))
    }

    /// What was found damaged when the bag was opened.
    pub fn warnings(&self) -> impl Iterator<Item = &BagWarning> {
        self.files.iter().flat_map(|file| &file.warnings)
    }

    /// All messages in the order of their log time, or in that of the files where it is the same.
    pub fn messages(&self) -> Messages<'_> {
        let of_file = |(file, source): (usize, &BagFile)| {
            source.spans.iter().map(|span| PendingSpan { file, span: *span }).collect::<Vec<_>>()
        };
        let mut pending: Vec<PendingSpan> =
            self.files.iter().enumerate().flat_map(of_file).collect();
        pending.sort_by_key(|p| Reverse((p.span.start, p.file, p.span.offset)));
        Messages {
            bag: self,
            only: None,
            pending,
            ready: BinaryHeap::new(),
            open: None,
            database: None,
            warnings: Vec::new(),
        }
    }
}

/// The messages of a bag. Damaged parts are left out, and noted.
///
/// Holds one chunk in memory, and more only where chunks overlap in time.
#[derive(Debug)]
pub struct Messages<'a> {
    bag: &'a BagReader,
    only: Option<BTreeSet<String>>,
    /// Latest first, so that the next one is at the end.
    pending: Vec<PendingSpan>,
    ready: BinaryHeap<Reverse<Ready>>,
    open: Option<(usize, File)>,
    database: Option<(usize, Connection)>,
    warnings: Vec<BagWarning>,
}

#[derive(Clone, Copy, Debug)]
struct PendingSpan {
    file: usize,
    span: Span,
}

/// A message that has been read. The fields' order is the order in which messages are handed out.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Ready {
    log_time: u64,
    file: usize,
    offset: u64,
    index: usize,
    channel_id: u16,
    data: Vec<u8>,
}

impl<'a> Messages<'a> {
    /// Only those of some topics.
    pub fn only<S: AsRef<str>>(mut self, topics: impl IntoIterator<Item = S>) -> Self {
        self.only = Some(topics.into_iter().map(|topic| topic.as_ref().to_owned()).collect());
        self
    }

    /// What was found damaged while reading; complete after the last message.
    pub fn warnings(&self) -> &[BagWarning] {
        &self.warnings
    }

    /// Reads the spans that may hold a message before the first one that is ready.
    fn fill(&mut self) {
        while let Some(next) = self.pending.last().copied() {
            let first_ready = self.ready.peek().map(|Reverse(ready)| ready.log_time);
            if first_ready.is_some_and(|log_time| log_time < next.span.start) {
                return;
            }
            self.pending.pop();
            if let Err(damage) = self.load(next) {
                let path = self.bag.files[next.file].path.clone();
                let warning = BagWarning { path, damage };
                let known = &self.bag.files[next.file].warnings;
                if !known.contains(&warning) && !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
    }

    fn load(&mut self, next: PendingSpan) -> Result<(), Damage> {
        let PendingSpan { file, span } = next;
        if self.bag.files[file].rows.is_some() {
            return self.load_rows(next);
        }
        let mut handle = match self.open.take() {
            Some((open, handle)) if open == file => handle,
            _ => self.reopen(&next)?,
        };
        let channels = &self.bag.files[file].channels;
        let (only, ready) = (&self.only, &mut self.ready);
        let mut unknown = 0_u64;
        let outcome = visit_records(&mut handle, &span, |record| {
            let Record::Message { header, data } = record else { return };
            let Some(channel) = channels.get(&header.channel_id) else {
                unknown += 1;
                return;
            };
            if only.as_ref().is_none_or(|only| only.contains(&*channel.topic)) {
                ready.push(Reverse(Ready {
                    log_time: header.log_time,
                    file,
                    offset: span.offset,
                    index: ready.len(),
                    channel_id: header.channel_id,
                    data: data.into_owned(),
                }));
            }
        });
        self.open = Some((file, handle));
        let cut = self.bag.files[file].warnings.iter().any(|w| is_cut(&w.damage));
        match outcome {
            Err(_) if cut && next.is_last_of(&self.bag.files[file]) => Ok(()),
            Err(problem) => Err(damage(&span, &problem)),
            Ok(()) if unknown > 0 => {
                let problem = format!("{unknown} messages belong to no known channel");
                Err(Damage::Corrupt { at_byte: span.offset, bytes: span.bytes, problem })
            }
            Ok(()) => Ok(()),
        }
    }

    /// The same of a file in SQLite storage.
    fn load_rows(&mut self, PendingSpan { file, span }: PendingSpan) -> Result<(), Damage> {
        let source = &self.bag.files[file];
        let database = match self.database.take() {
            Some((open, database)) if open == file => database,
            _ => sqlite_file::connect(&source.data)
                .map_err(|e| Damage::Rows { problem: e.to_string() })?,
        };
        let (first, count) = (span.offset as usize, span.bytes as usize);
        let all = source.rows.as_deref().unwrap_or_default();
        let part = all.get(first..first + count).unwrap_or_default();
        let only = &self.only;
        let wanted = |channel: &u16| {
            let topic = source.channels.get(channel).map(|channel| &channel.topic);
            topic.is_some_and(|name| only.as_ref().is_none_or(|only| only.contains(&**name)))
        };
        let rows: Vec<Row> = part.iter().filter(|row| wanted(&row.channel)).copied().collect();
        let ready = &mut self.ready;
        let outcome = read_rows(&database, &rows, |row, data| {
            ready.push(Reverse(Ready {
                log_time: row.time,
                file,
                offset: span.offset,
                index: ready.len(),
                channel_id: row.channel,
                data: data.to_vec(),
            }));
        });
        self.database = Some((file, database));
        outcome
    }

    fn reopen(&self, next: &PendingSpan) -> Result<File, Damage> {
        let opened = mcap_file::open(&self.bag.files[next.file].data);
        opened.map(|(file, _)| file).map_err(|e| damage(&next.span, &e.into()))
    }
}

impl PendingSpan {
    fn is_last_of(&self, file: &BagFile) -> bool {
        file.spans.iter().all(|span| span.offset <= self.span.offset)
    }
}

impl Iterator for Messages<'_> {
    type Item = RawMessage;

    fn next(&mut self) -> Option<RawMessage> {
        self.fill();
        let Reverse(ready) = self.ready.pop()?;
        // OK because only messages of known channels are made ready.
        let channel = &self.bag.files[ready.file].channels[&ready.channel_id];
        Some(RawMessage {
            topic: channel.topic.clone(),
            type_name: channel.type_name.clone(),
            log_time: stamp_of(ready.log_time),
            data: unpacked_message(ready.data, MAX_RECORD_BYTES),
        })
    }
}

/// Most images that are looked at to learn the formats of all topics.
const MOST_SEARCHED: usize = 200;
/// No format that is known is longer.
const MOST_OF_FORMAT: usize = 64;

fn format_of(image: &RawMessage) -> Option<String> {
    let format = match &*image.type_name {
        CompressedImage::TYPE => decode::<CompressedImage>(&image.data).ok()?.format,
        _ => decode::<Image>(&image.data).ok()?.encoding,
    };
    Some(format.chars().filter(|c| !c.is_control()).take(MOST_OF_FORMAT).collect())
}

fn is_cut(damage: &Damage) -> bool {
    matches!(damage, Damage::CutRecord { .. })
}

/// The topics of all files together, by name.
fn topics_of(files: &[BagFile]) -> Vec<Topic> {
    let mut messages: BTreeMap<(String, String, String), u64> = BTreeMap::new();
    for channel in files.iter().flat_map(|file| file.channels.values()) {
        let key = [&channel.topic, &channel.type_name, &channel.encoding].map(|s| s.to_string());
        *messages.entry(key.into()).or_default() += channel.messages;
    }
    let topic = |((name, type_name, encoding), messages)| Topic {
        name,
        type_name,
        encoding,
        messages,
        format: None,
    };
    messages.into_iter().map(topic).collect()
}

fn stamp_of(nanos: u64) -> Stamp {
    Stamp::from_nanos(i64::try_from(nanos).unwrap_or(i64::MAX))
}
