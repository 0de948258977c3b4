//! How often latched messages go into a recording.

use super::OutputTopic;
use crate::time::Stamp;
use std::collections::BTreeMap;

/// Bytes of each latched topic that are recorded however soon they come: those of a drive of some minutes.
const FREE_BYTES: f64 = 5e6;
/// What is added with each second of the recording (bytes/s): a gigabyte in three days, before compression.
const BYTES_PER_SECOND: f64 = 4e3;

/// Room for latched messages in a recording.
///
/// Each of them holds all there is, and most of it is what the one before held. A live listener wants every one; a
/// recording of hours would consist of nothing else, so it gets them as seldom as they are large.
#[derive(Debug, Default)]
pub struct Room {
    first: Option<Stamp>,
    seconds: f64,
    recorded: BTreeMap<OutputTopic, f64>,
}

impl Room {
    /// Whether a message of so many bytes is to be recorded; if so, it counts. Streams always are.
    pub fn takes(&mut self, topic: OutputTopic, bytes: usize, stamp: Stamp) -> bool {
        if !topic.is_latched() {
            return true;
        }
        let first = *self.first.get_or_insert(stamp);
        self.seconds = self.seconds.max(stamp.seconds_since(first));
        let recorded = self.recorded.entry(topic).or_default();
        let takes = *recorded + bytes as f64 <= FREE_BYTES + self.seconds * BYTES_PER_SECOND;
        if takes {
            *recorded += bytes as f64;
        }
        takes
    }
}
