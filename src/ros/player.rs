//! Messages of a recording, published.

use super::{
    names::{NameError, parsed, type_name},
    node::NotCreated,
    participant::{DdsDomain, DomainError},
    qos,
    raw::RawCdr,
    status::now,
};
use crate::time::Stamp;
use ros2_client::{Context, Node, NodeName, NodeOptions, Publisher};
use std::{collections::BTreeMap, thread, time::Duration};
use thiserror::Error;

/// Publishes messages of any type on DDS.
pub struct Player {
    publishers: BTreeMap<String, Publisher<RawCdr>>,
    clock: Option<Publisher<RawCdr>>,
    node: Node,
    context: Context,
}

/// Why nothing can be published.
#[derive(Debug, Error)]
pub enum PlayError {
    /// The network.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A topic's name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A publisher or the node.
    #[error(transparent)]
    Create(#[from] NotCreated),
    /// A message that DDS does not take.
    #[error("{topic}: {problem}")]
    NotSent {
        /// The topic.
        topic: String,
        /// What DDS said.
        problem: String,
    },
}

impl Player {
    /// A node with a publisher for each topic, given with its type `package/msg/Name`.
    ///
    /// # Errors
    /// When the network or a topic cannot be used.
    pub fn new<'a>(
        domain: DdsDomain,
        topics: impl IntoIterator<Item = (&'a str, &'a str)>,
        clock: bool,
    ) -> Result<Self, PlayError> {
        let context = domain.join()?;
        let name = NodeName::new("/", NODE).map_err(|e| NotCreated::new(NODE, e))?;
        let mut node =
            context.new_node(name, NodeOptions::new()).map_err(|e| NotCreated::new(NODE, e))?;
        let mut publish = |topic: &str, kind: &str| -> Result<Publisher<RawCdr>, PlayError> {
            let qos =
                if topic.ends_with("/tf_static") { qos::tf_static() } else { qos::stream(DEPTH) };
            let dds = node
                .create_topic(&parsed(topic)?, type_name(kind), &qos)
                .map_err(|e| NotCreated::new(topic, e))?;
            Ok(node.create_publisher(&dds, Some(qos)).map_err(|e| NotCreated::new(topic, e))?)
        };
        let mut publishers = BTreeMap::new();
        for (topic, kind) in topics {
            publishers.insert(topic.to_owned(), publish(topic, kind)?);
        }
        let clock = if clock { Some(publish("/clock", "rosgraph_msgs/msg/Clock")?) } else { None };
        Ok(Self { publishers, clock, node, context })
    }

    /// Waits until somebody listens, and no more come for a second; at most `longest`. How many topics are heard.
    pub fn wait_for_listeners(&self, longest: Duration) -> usize {
        let (started, mut known, mut since) = (now(), 0, now());
        loop {
            let heard = self.heard();
            if heard != known {
                (known, since) = (heard, now());
            }
            let settled = known > 0 && since.elapsed() >= SETTLED;
            if settled || started.elapsed() >= longest {
                return known;
            }
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// The topics that it publishes on.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.publishers.keys().map(String::as_str)
    }

    /// Publishes CDR bytes on one of the topics.
    ///
    /// # Errors
    /// When the bytes are not little-endian CDR, or DDS does not take them.
    pub fn publish(&self, topic: &str, cdr: &[u8]) -> Result<(), PlayError> {
        let failed = |problem: String| PlayError::NotSent { topic: topic.to_owned(), problem };
        let publisher =
            self.publishers.get(topic).ok_or_else(|| failed("there is no such topic".into()))?;
        let message = RawCdr::from_little_endian(cdr)
            .ok_or_else(|| failed("the message is not little-endian CDR".into()))?;
        publisher.publish(message).map_err(|e| failed(e.forget_data().to_string()))
    }

    /// Publishes what time it is in the recording.
    pub fn tell_time(&self, stamp: Stamp) {
        let Some(clock) = &self.clock else { return };
        let nanos = stamp.as_nanos();
        let mut cdr = vec![0, 1, 0, 0];
        cdr.extend(((nanos / 1_000_000_000) as i32).to_le_bytes());
        cdr.extend(((nanos % 1_000_000_000) as u32).to_le_bytes());
        if let Some(Err(e)) = RawCdr::from_little_endian(&cdr).map(|time| clock.publish(time)) {
            tracing::debug!("/clock was not sent: {}", e.forget_data());
        }
    }

    fn heard(&self) -> usize {
        let readers = self.context.domain_participant().discovered_readers();
        let heard = |topic: &&String| {
            let dds = format!("rt{topic}");
            readers.iter().any(|r| *r.subscription_topic_data.topic_name() == dds)
        };
        self.publishers.keys().filter(heard).count()
    }
}

impl Drop for Player {
    /// Publishers go before the node, and the node before the context: so others learn of it.
    fn drop(&mut self) {
        self.publishers.clear();
        self.clock = None;
        tracing::debug!("{} leaves", self.node.fully_qualified_name());
    }
}

const NODE: &str = "ellipsoid_slam_play";
/// Messages kept for a reader that has to ask again.
const DEPTH: usize = 50;
/// A node's subscriptions become known within this time of each other.
const SETTLED: Duration = Duration::from_secs(1);
