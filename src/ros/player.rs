//! Messages of a recording, published.

use super::{
    domain::{Domain, DomainError},
    names::node_name,
    node::NotCreated,
    qos,
    status::now,
    transport::{Graph, Node, RawPublisher},
};
use crate::time::Stamp;
use std::{collections::BTreeMap, thread, time::Duration};
use thiserror::Error;

/// Publishes messages of any type.
///
/// Publishers go before the node, so that others learn of it: fields are dropped in this order.
pub struct Player {
    publishers: BTreeMap<String, RawPublisher>,
    clock: Option<RawPublisher>,
    graph: Graph,
    _node: Node,
}

/// Why nothing can be published.
#[derive(Debug, Error)]
pub enum PlayError {
    /// The network.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A publisher or the node.
    #[error(transparent)]
    Create(#[from] NotCreated),
    /// A message that the middleware does not take.
    #[error("{topic}: {problem}")]
    NotSent {
        /// The topic.
        topic: String,
        /// What it said.
        problem: String,
    },
}

impl Player {
    /// A node with a publisher for each topic, given with its type `package/msg/Name`.
    ///
    /// # Errors
    /// When the network or a topic cannot be used.
    pub fn new<'a>(
        domain: Domain,
        topics: impl IntoIterator<Item = (&'a str, &'a str)>,
        clock: bool,
    ) -> Result<Self, PlayError> {
        let mut node = Node::join(domain, node_name("/", NODE)?)?;
        let mut publish = |topic: &str, kind: &str| {
            let qos =
                if topic.ends_with("/tf_static") { qos::tf_static() } else { qos::stream(DEPTH) };
            node.raw_publisher(topic, kind, &qos)
        };
        let mut publishers = BTreeMap::new();
        for (topic, kind) in topics {
            publishers.insert(topic.to_owned(), publish(topic, kind)?);
        }
        let clock = if clock { Some(publish("/clock", "rosgraph_msgs/msg/Clock")?) } else { None };
        Ok(Self { publishers, clock, graph: node.graph()?, _node: node })
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
    /// When the bytes are not little-endian CDR, or they are not taken.
    pub fn publish(&self, topic: &str, cdr: &[u8]) -> Result<(), PlayError> {
        let failed = |problem: String| PlayError::NotSent { topic: topic.to_owned(), problem };
        let publisher =
            self.publishers.get(topic).ok_or_else(|| failed("there is no such topic".into()))?;
        publisher.publish(cdr).map_err(failed)
    }

    /// Publishes what time it is in the recording.
    pub fn tell_time(&self, stamp: Stamp) {
        let Some(clock) = &self.clock else { return };
        let nanos = stamp.as_nanos();
        let mut cdr = vec![0, 1, 0, 0];
        cdr.extend(((nanos / 1_000_000_000) as i32).to_le_bytes());
        cdr.extend(((nanos % 1_000_000_000) as u32).to_le_bytes());
        if let Err(why) = clock.publish(&cdr) {
            tracing::debug!("/clock was not sent: {why}");
        }
    }

    fn heard(&self) -> usize {
        self.publishers.keys().filter(|topic| self.graph.is_heard(topic)).count()
    }
}

const NODE: &str = "ellipsoid_slam_play";
/// Messages kept for a reader that has to ask again.
const DEPTH: usize = 50;
/// A node's subscriptions become known within this time of each other.
const SETTLED: Duration = Duration::from_secs(1);
