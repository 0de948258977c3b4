//! Publishers and subscriptions that keep no more messages than they are to.
//!
//! RustDDS 0.15 keeps 64 received messages of a topic whatever its history says, which are 40 MB of depth images, and
//! 8192 published ones of a latched topic that nobody listens to. Resource limits of the topic bound both.

use super::{
    names::{parsed, type_name},
    node::{NodeError, NotCreated},
};
use crate::msg::Message;
use ros2_client::{
    Context, Node, Publisher, QosProfile, Subscription, WriteError,
    dds::rustdds::{QosPolicies, QosPolicyBuilder, Topic, TopicKind, policy::ResourceLimits},
    qos::{History, WhenFull},
};

/// Where publishers and subscriptions are made.
pub(super) struct Ends<'a> {
    pub(super) context: &'a Context,
    pub(super) node: &'a mut Node,
}

impl Ends<'_> {
    /// A subscription to one of our message types.
    pub(super) fn subscription<M: Message + 'static>(
        &mut self,
        name: &str,
        qos: QosProfile,
    ) -> Result<Subscription<M>, NodeError> {
        let topic = self.topic::<M>(name, &qos, 1)?;
        self.node
            .create_subscription(&topic, Some(qos))
            .map_err(|e| NotCreated::new(name, e).into())
    }

    /// A publisher of one of our message types, that never waits for subscribers.
    pub(super) fn publisher<M: Message>(
        &mut self,
        name: &str,
        qos: QosProfile,
    ) -> Result<Publisher<M>, NodeError> {
        let qos = qos.reliability_reliable(WhenFull::Fail);
        let topic = self.topic::<M>(name, &qos, LEAST_WINDOW)?;
        self.node.create_publisher(&topic, Some(qos)).map_err(|e| NotCreated::new(name, e).into())
    }

    /// A topic of which as many messages are kept as its history says, and at least so many.
    fn topic<M: Message>(
        &self,
        name: &str,
        qos: &QosProfile,
        at_least: usize,
    ) -> Result<Topic, NodeError> {
        // For the error: DDS takes names that ROS 2 does not.
        parsed(name)?;
        let most = match qos.history {
            History::KeepLast { depth } => i32::try_from(depth.max(at_least)).unwrap_or(i32::MAX),
            History::KeepAll => i32::MAX,
        };
        let limits =
            ResourceLimits { max_samples: most, max_instances: 1, max_samples_per_instance: most };
        let limits = QosPolicyBuilder::new().resource_limits(limits).build();
        self.context
            .domain_participant()
            .create_topic(
                format!("rt{name}"),
                type_name(M::TYPE).dds_msg_type(),
                &QosPolicies::from(qos).modify_by(&limits),
                TopicKind::NoKey,
            )
            .map_err(|e| NotCreated::new(name, e).into())
    }
}

/// Messages that may be on their way to a subscriber: half a second of a camera's.
const LEAST_WINDOW: usize = 16;

/// Publishes; a subscriber that is too slow must not stop the node.
pub(super) fn send<M: Message>(publisher: &Publisher<M>, message: M) {
    if let Err(e) = publisher.publish(message) {
        tracing::debug!("a {} was not sent: {}", M::TYPE, e.forget_data());
    }
}

/// A topic whose last message holds all there is: as long as a slow subscriber leaves no room for it, it waits for that
/// or for a newer one.
pub(super) struct Latched<M: Message> {
    publisher: Publisher<M>,
    waiting: Option<M>,
}

impl<M: Message> Latched<M> {
    pub(super) fn new(publisher: Publisher<M>) -> Self {
        Self { publisher, waiting: None }
    }

    pub(super) fn send(&mut self, message: M) {
        self.waiting = Some(message);
        self.send_waiting();
    }

    pub(super) fn send_waiting(&mut self) {
        let Some(message) = self.waiting.take() else { return };
        match self.publisher.publish(message) {
            Ok(()) => (),
            Err(WriteError::WouldBlock { data }) => self.waiting = Some(data),
            Err(e) => tracing::debug!("a {} was not sent: {}", M::TYPE, e.forget_data()),
        }
    }
}
