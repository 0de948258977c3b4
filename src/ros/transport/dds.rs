//! DDS, by ros2-client and RustDDS.
//!
//! RustDDS 0.15 keeps 64 received messages of a topic whatever its history says, which are 40 MB of depth images, and
//! 8192 published ones of a latched topic that nobody listens to. Resource limits of the topic bound both.

use super::{NotSent, NotTaken, Offered, raw::RawCdr, same_name::SameName};
use crate::{
    msg::{Message, Service, cdr::CdrError},
    ros::{
        domain::{Domain, DomainError},
        names::{parsed, ros_type, service_type_name, type_name},
        node::NotCreated,
        qos,
    },
};
use ros2_client::{
    NodeName, NodeOptions, QosProfile, ReadError, RmwRequestId, WriteError,
    dds::{
        self, Context, ServiceMapping,
        rustdds::{
            DomainParticipant, DomainParticipantBuilder, QosPolicies, QosPolicyBuilder, Topic,
            TopicKind, policy,
        },
    },
    qos::{History, WhenFull},
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::{net::Ipv4Addr, thread, time::Duration};

pub(super) type Publisher<M> = dds::Publisher<M>;
pub(super) type RawPublisher = dds::Publisher<RawCdr>;
pub(super) type Subscription<M> = dds::Subscription<M>;
pub(super) type RequestId = RmwRequestId;
pub(super) type Server<S> =
    dds::Server<Wire<<S as Service>::Request>, Wire<<S as Service>::Response>>;

/// Largest answer (bytes). RustDDS 0.15 garbles what it has to cut into fragments if it says at the same time which
/// request it answers (a stray byte before the inline QoS of `DATA_FRAG`), so answers must fit into one datagram.
pub(super) const LARGEST_ANSWER: usize = 1100;

/// From the discovery of a client's requests to that of its reader of answers, about.
const DISCOVERY: Duration = Duration::from_millis(150);

/// A node. Fields are dropped in this order: the node goes before the context, or others would believe it to be alive.
pub(in crate::ros) struct Node {
    node: dds::Node,
    _goodbye: Goodbye,
    context: Context,
}

/// The context stops sending when it goes, also what it was given before: time for the last words to be sent, and once
/// more where they were lost.
struct Goodbye;

impl Drop for Goodbye {
    fn drop(&mut self) {
        thread::sleep(Duration::from_millis(500));
    }
}

impl Node {
    pub(super) fn join(domain: Domain, name: NodeName) -> Result<Self, DomainError> {
        let failed =
            |problem: String| DomainError::NotStarted { middleware: "DDS", id: domain.id, problem };
        let mut builder = DomainParticipantBuilder::new(domain.id);
        if domain.local_only {
            builder = builder.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let participant = builder.build().map_err(|e| failed(e.to_string()))?;
        let context =
            Context::from_domain_participant(participant).map_err(|e| failed(e.to_string()))?;
        // Parameters and the log are ours.
        let options = NodeOptions::new().start_parameter_services(false).enable_rosout(false);
        let node = context.new_node(name, options).map_err(|e| failed(e.to_string()))?;
        Ok(Self { node, _goodbye: Goodbye, context })
    }

    pub(super) fn subscription<M: Message + 'static>(
        &mut self,
        name: &str,
        qos: &QosProfile,
    ) -> Result<Subscription<M>, NotCreated> {
        let topic = self.topic(name, M::TYPE, qos, 1)?;
        self.node
            .create_subscription(&topic, Some(qos.clone()))
            .map_err(|e| NotCreated::new(name, e))
    }

    pub(super) fn publisher<M: Message>(
        &mut self,
        name: &str,
        qos: &QosProfile,
    ) -> Result<Publisher<M>, NotCreated> {
        let qos = qos.clone().reliability_reliable(WhenFull::Fail);
        let topic = self.topic(name, M::TYPE, &qos, LEAST_WINDOW)?;
        self.node.create_publisher(&topic, Some(qos)).map_err(|e| NotCreated::new(name, e))
    }

    pub(super) fn raw_publisher(
        &mut self,
        name: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<RawPublisher, NotCreated> {
        let qos = qos.clone().reliability_reliable(WhenFull::Wait(PATIENCE));
        let topic = self.topic(name, kind, &qos, PLAYED_WINDOW)?;
        self.node.create_publisher(&topic, Some(qos)).map_err(|e| NotCreated::new(name, e))
    }

    pub(super) fn server<S: Service>(&mut self, name: &str) -> Result<Server<S>, NotCreated> {
        let (service, kind) = (parsed(name)?, service_type_name(S::TYPE));
        let (mapping, qos) = (ServiceMapping::Enhanced, qos::service());
        self.node
            .create_server(mapping, &service, &kind, qos.clone(), qos)
            .map_err(|e| NotCreated::new(name, e))
    }

    pub(super) fn graph(&mut self) -> Result<Graph, NotCreated> {
        let same_name = SameName::listen(&self.context, &mut self.node)?;
        Ok(Graph { participant: self.context.domain_participant(), same_name })
    }

    /// A topic of which as many messages are kept as its history says, and at least so many.
    fn topic(
        &self,
        name: &str,
        kind: &str,
        qos: &QosProfile,
        at_least: usize,
    ) -> Result<Topic, NotCreated> {
        // For the error: DDS takes names that ROS 2 does not.
        parsed(name)?;
        let most = match qos.history {
            History::KeepLast { depth } => i32::try_from(depth.max(at_least)).unwrap_or(i32::MAX),
            History::KeepAll => i32::MAX,
        };
        let limits = policy::ResourceLimits {
            max_samples: most,
            max_instances: 1,
            max_samples_per_instance: most,
        };
        let limits = QosPolicyBuilder::new().resource_limits(limits).build();
        self.context
            .domain_participant()
            .create_topic(
                format!("rt{name}"),
                type_name(kind).dds_msg_type(),
                &QosPolicies::from(qos).modify_by(&limits),
                TopicKind::NoKey,
            )
            .map_err(|e| NotCreated::new(name, e))
    }
}

/// Messages that may be on their way to a subscriber: half a second of a camera's.
const LEAST_WINDOW: usize = 16;

/// The same of a recording: 60 MB of colour images.
const PLAYED_WINDOW: usize = 64;
/// A recording waits so long for a subscriber that is slow.
const PATIENCE: Duration = Duration::from_secs(1);

pub(super) fn publish<M: Message>(publisher: &Publisher<M>, message: M) -> Result<(), NotSent<M>> {
    publisher.publish(message).map_err(|e| match e {
        WriteError::WouldBlock { data } => NotSent::NoRoom(data),
        e => NotSent::Failed(e.forget_data().to_string()),
    })
}

pub(super) fn publish_raw(publisher: &RawPublisher, cdr: &[u8]) -> Result<(), String> {
    let message = RawCdr::from_little_endian(cdr).ok_or("the message is not little-endian CDR")?;
    publisher.publish(message).map_err(|e| e.forget_data().to_string())
}

pub(super) async fn take<M: Message + 'static>(
    subscription: &Subscription<M>,
) -> Result<M, NotTaken> {
    match subscription.async_take().await {
        Ok((message, _)) => Ok(message),
        Err(ReadError::Deserialization { reason }) => {
            Err(NotTaken::BadBytes(CdrError::BadBytes { type_name: M::TYPE, problem: reason }))
        }
        Err(e) => Err(NotTaken::Failed(e.to_string())),
    }
}

pub(super) async fn receive<S: Service>(
    server: &Server<S>,
) -> Result<(RequestId, S::Request), String> {
    let received = server.async_receive_request().await;
    received.map(|(id, Wire(request))| (id, request)).map_err(|e| e.to_string())
}

pub(super) async fn answer<S: Service>(
    server: &Server<S>,
    id: RequestId,
    response: S::Response,
) -> Result<(), String> {
    // Who has just come may not have been discovered as a reader of answers yet: the first one would be lost.
    if id.sequence_number <= 1 {
        tokio::time::sleep(DISCOVERY).await;
    }
    server.async_send_response(id, Wire(response)).await.map_err(|e| e.to_string())
}

/// A request or response as ros2-client wants it: on the wire it is what it holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub(in crate::ros) struct Wire<T>(T);

impl<T: Serialize + DeserializeOwned> ros2_client::Message for Wire<T> {}

/// What DDS's discovery knows.
pub(in crate::ros) struct Graph {
    participant: DomainParticipant,
    same_name: SameName,
}

impl Graph {
    pub(super) fn publishers(&self) -> Vec<Offered> {
        let writers = self.participant.discovered_writers();
        let of_ros = writers.iter().filter_map(|writer| {
            let data = &writer.publication_topic_data;
            Some(Offered {
                topic: data.topic_name.strip_prefix("rt")?.to_owned(),
                type_name: ros_type(&data.type_name),
                best_effort: data.reliability == Some(policy::Reliability::BestEffort),
                volatile: matches!(data.durability, None | Some(policy::Durability::Volatile)),
            })
        });
        of_ros.collect()
    }

    pub(super) fn is_heard(&self, topic: &str) -> bool {
        let name = format!("rt{topic}");
        let readers = self.participant.discovered_readers();
        readers.iter().any(|reader| *reader.subscription_topic_data.topic_name() == name)
    }

    pub(super) fn has_another(&mut self, full_name: &str) -> bool {
        self.same_name.has_another(full_name, &self.participant.discovered_writers())
    }
}
