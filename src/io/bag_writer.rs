//! Bags that other programs read: MCAP with the profile `ros2`.

use super::{BagError, atomic::TemporaryFile, disk_problem};
use crate::{
    msg::{Message, cdr, schema_text},
    time::Stamp,
};
use mcap::{McapError, records::MessageHeader};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::BufWriter,
    path::{Path, PathBuf},
};

/// Writes a bag under a temporary name; [`BagWriter::finish`] gives it its own.
///
/// The same messages give the same bytes.
pub struct BagWriter {
    path: PathBuf,
    mcap: Option<mcap::Writer<BufWriter<File>>>,
    temporary: TemporaryFile,
    channels: BTreeMap<String, Channel>,
    latched: BTreeSet<String>,
}

struct Channel {
    id: u16,
    type_name: String,
    messages: u32,
}

impl BagWriter {
    /// A new bag; an existing file at `path` stays until the new one is finished.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn create(path: &Path) -> Result<Self, BagError> {
        let (temporary, file) = TemporaryFile::create(path)
            .map_err(|source| BagError::Io { path: path.to_owned(), source })?;
        // Threads would make the compressed bytes depend on the machine.
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library(concat!("ellipsoid_slam ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0);
        let mcap = options.create(BufWriter::new(file)).map_err(|e| refused(path, &e))?;
        let path = path.to_owned();
        Ok(Self {
            path,
            mcap: Some(mcap),
            temporary,
            channels: BTreeMap::new(),
            latched: BTreeSet::new(),
        })
    }

    /// Has the topic offered like `/tf_static` when the bag is played: who comes late gets its last message.
    pub fn latch(&mut self, topic: String) {
        self.latched.insert(topic);
    }

    /// Appends a message, logged and published at `stamp`.
    ///
    /// # Errors
    /// When the disk is full or `topic` had another type before.
    pub fn write<T: Message>(
        &mut self,
        topic: &str,
        message: &T,
        stamp: Stamp,
    ) -> Result<(), BagError> {
        let data = cdr::encode(message).map_err(|e| not_writable(&self.path, &e))?;
        self.write_raw(topic, T::TYPE, &data, stamp)
    }

    /// Appends a message that is CDR already.
    ///
    /// # Errors
    /// When the disk is full or the definition of `type_name` is not known here.
    pub fn write_raw(
        &mut self,
        topic: &str,
        type_name: &str,
        cdr: &[u8],
        stamp: Stamp,
    ) -> Result<(), BagError> {
        let header = self.next_header(topic, type_name, stamp)?;
        let Some(mcap) = &mut self.mcap else { return Ok(()) };
        mcap.write_to_known_channel(&header, cdr).map_err(|e| refused(&self.path, &e))
    }

    /// Completes the bag and gives it its name.
    ///
    /// # Errors
    /// When the disk is full; then nothing is left behind.
    pub fn finish(mut self) -> Result<(), BagError> {
        if let Some(mut mcap) = self.mcap.take() {
            mcap.finish().map_err(|e| refused(&self.path, &e))?;
            let file = mcap.into_inner().into_inner();
            file.map_err(|e| not_writable(&self.path, &disk_problem(e.error())))?;
        }
        let keep = self.temporary.keep();
        keep.map_err(|source| BagError::Io { path: self.path.clone(), source })
    }

    /// Counts a message of the topic, whose channel is made for the first one.
    fn next_header(
        &mut self,
        topic: &str,
        type_name: &str,
        stamp: Stamp,
    ) -> Result<MessageHeader, BagError> {
        if !self.channels.contains_key(topic) {
            let id = self.add_channel(topic, type_name)?;
            self.channels
                .insert(topic.to_owned(), Channel { id, type_name: type_name.into(), messages: 0 });
        }
        let time = u64::try_from(stamp.as_nanos()).unwrap_or(0);
        let mut header =
            MessageHeader { channel_id: 0, sequence: 0, log_time: time, publish_time: time };
        if let Some(channel) = self.channels.get_mut(topic) {
            if channel.type_name != type_name {
                let had = &channel.type_name;
                let problem = format!("the topic {topic} has type {had}, got a {type_name}");
                return Err(not_writable(&self.path, &problem));
            }
            (header.channel_id, header.sequence) = (channel.id, channel.messages);
            channel.messages = channel.messages.wrapping_add(1);
        }
        Ok(header)
    }

    fn add_channel(&mut self, topic: &str, type_name: &str) -> Result<u16, BagError> {
        let path = &self.path;
        let unknown = || format!("the definition of {type_name} is not known");
        let definition = schema_text(type_name).ok_or_else(|| not_writable(path, &unknown()))?;
        let Some(mcap) = &mut self.mcap else { return Ok(0) };
        let schema = mcap
            .add_schema(type_name, "ros2msg", definition.as_bytes())
            .map_err(|e| refused(path, &e))?;
        let latched = topic.ends_with("tf_static") || self.latched.contains(topic);
        let qos = latched.then(|| ("offered_qos_profiles".to_owned(), LATCHED_QOS.to_owned()));
        mcap.add_channel(schema, topic, "cdr", &qos.into_iter().collect())
            .map_err(|e| refused(path, &e))
    }
}

impl Drop for BagWriter {
    fn drop(&mut self) {
        // Taken apart without finishing: the library would otherwise complete the file, only to have it removed.
        if let Some(mcap) = self.mcap.take() {
            drop(mcap.into_inner());
        }
    }
}

fn refused(path: &Path, error: &McapError) -> BagError {
    match error {
        McapError::Io(error) => not_writable(path, &disk_problem(error)),
        other => not_writable(path, other),
    }
}

fn not_writable(path: &Path, problem: &impl ToString) -> BagError {
    BagError::NotWritable { path: path.to_owned(), problem: problem.to_string() }
}

/// `ros2 bag play` offers this quality of service: reliable and transient local, which a listener to `/tf_static`
/// asks for. Times of 2^63 ns mean "no limit".
const LATCHED_QOS: &str = "\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false
";
