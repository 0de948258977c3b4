//! A node with its publishers, subscriptions and services, on DDS or on Zenoh. The rest of the node does not know on
//! which: only how much an answer may hold depends on it.
#![cfg_attr(
    feature = "zenoh",
    expect(clippy::large_enum_variant, reason = "there are a few dozen of them, made once")
)]

mod dds;
mod raw;
mod same_name;
#[cfg(feature = "zenoh")]
mod zenoh;

use super::{
    domain::{Domain, DomainError, Middleware},
    node::NotCreated,
};
use crate::msg::{Message, Service, cdr::CdrError};
use ros2_client::{NodeName, QosProfile};

/// A node that others see.
pub(super) enum Node {
    Dds(dds::Node),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Node),
}

/// Sends messages of a type; it never waits for subscribers.
pub(super) enum Publisher<M: Message> {
    Dds(dds::Publisher<M>),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Publisher),
}

/// Sends messages of a recording as the bytes they came as.
pub(super) enum RawPublisher {
    Dds(dds::RawPublisher),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Publisher),
}

/// Receives messages of a type.
pub(super) enum Subscription<M: Message> {
    Dds(dds::Subscription<M>),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Subscription),
}

/// Receives requests and answers them.
pub(super) enum Server<S: Service> {
    Dds(dds::Server<S>),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Server),
}

/// Which request an answer is for.
pub(super) enum RequestId {
    Dds(dds::RequestId),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Request),
}

/// What is known of other nodes.
pub(super) enum Graph {
    Dds(dds::Graph),
    #[cfg(feature = "zenoh")]
    Zenoh(zenoh::Graph),
}

/// A publisher that discovery knows of.
#[derive(Clone, Debug)]
pub(super) struct Offered {
    pub(super) topic: String,
    /// `package/msg/Name`.
    pub(super) type_name: String,
    /// It offers no more than this, and the middleware pairs by it.
    pub(super) best_effort: bool,
    /// The same of what was said before a subscription came.
    pub(super) volatile: bool,
}

/// Why a message was not sent.
pub(super) enum NotSent<M> {
    /// A subscriber is too slow: there is no room for the message.
    NoRoom(M),
    Failed(String),
}

/// Why there is no message.
pub(super) enum NotTaken {
    /// The bytes are not one.
    BadBytes(CdrError),
    Failed(String),
}

impl Node {
    /// Takes part in the network as a node of this name.
    pub(super) fn join(domain: Domain, name: NodeName) -> Result<Self, DomainError> {
        match domain.middleware {
            Middleware::Dds => dds::Node::join(domain, name).map(Self::Dds),
            #[cfg(feature = "zenoh")]
            Middleware::Zenoh => zenoh::Node::join(domain, &name).map(Self::Zenoh),
            #[cfg(not(feature = "zenoh"))]
            Middleware::Zenoh => Err(DomainError::WithoutZenoh),
        }
    }

    /// A subscription to one of our message types.
    pub(super) fn subscription<M: Message + 'static>(
        &mut self,
        topic: &str,
        qos: &QosProfile,
    ) -> Result<Subscription<M>, NotCreated> {
        match self {
            Self::Dds(node) => node.subscription(topic, qos).map(Subscription::Dds),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(node) => node.subscription(topic, M::TYPE, qos).map(Subscription::Zenoh),
        }
    }

    /// A publisher of one of our message types.
    pub(super) fn publisher<M: Message>(
        &mut self,
        topic: &str,
        qos: &QosProfile,
    ) -> Result<Publisher<M>, NotCreated> {
        match self {
            Self::Dds(node) => node.publisher(topic, qos).map(Publisher::Dds),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(node) => node.publisher(topic, M::TYPE, qos).map(Publisher::Zenoh),
        }
    }

    /// A publisher of a recording's messages, of a type `package/msg/Name`.
    pub(super) fn raw_publisher(
        &mut self,
        topic: &str,
        type_name: &str,
        qos: &QosProfile,
    ) -> Result<RawPublisher, NotCreated> {
        match self {
            Self::Dds(node) => node.raw_publisher(topic, type_name, qos).map(RawPublisher::Dds),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(node) => node.raw_publisher(topic, type_name, qos).map(RawPublisher::Zenoh),
        }
    }

    /// A service.
    pub(super) fn server<S: Service>(&mut self, name: &str) -> Result<Server<S>, NotCreated> {
        match self {
            Self::Dds(node) => node.server::<S>(name).map(Server::Dds),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(node) => node.server(name, S::TYPE).map(Server::Zenoh),
        }
    }

    /// Listens to what is said of other nodes.
    pub(super) fn graph(&mut self) -> Result<Graph, NotCreated> {
        match self {
            Self::Dds(node) => node.graph().map(Graph::Dds),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(node) => Ok(Graph::Zenoh(node.graph())),
        }
    }

    /// Largest answer of a service (bytes).
    pub(super) fn largest_answer(&self) -> usize {
        match self {
            Self::Dds(_) => dds::LARGEST_ANSWER,
            #[cfg(feature = "zenoh")]
            Self::Zenoh(_) => usize::MAX,
        }
    }
}

impl<M: Message> Publisher<M> {
    pub(super) fn publish(&self, message: M) -> Result<(), NotSent<M>> {
        match self {
            Self::Dds(publisher) => dds::publish(publisher, message),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(publisher) => publisher.publish(&message).map_err(NotSent::Failed),
        }
    }
}

impl RawPublisher {
    /// Publishes CDR bytes with their header.
    pub(super) fn publish(&self, cdr: &[u8]) -> Result<(), String> {
        match self {
            Self::Dds(publisher) => dds::publish_raw(publisher, cdr),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(publisher) => publisher.put(cdr.to_vec()),
        }
    }
}

impl<M: Message + 'static> Subscription<M> {
    /// The next message; waits for one.
    pub(super) async fn take(&self) -> Result<M, NotTaken> {
        match self {
            Self::Dds(subscription) => dds::take(subscription).await,
            #[cfg(feature = "zenoh")]
            Self::Zenoh(subscription) => subscription.take().await,
        }
    }
}

impl<S: Service> Server<S> {
    /// The next request; waits for one.
    pub(super) async fn receive(&self) -> Result<(RequestId, S::Request), String> {
        match self {
            Self::Dds(server) => {
                dds::receive::<S>(server).await.map(|(id, request)| (RequestId::Dds(id), request))
            }
            #[cfg(feature = "zenoh")]
            Self::Zenoh(server) => {
                let (id, request) = server.receive::<S>().await?;
                Ok((RequestId::Zenoh(id), request))
            }
        }
    }

    pub(super) async fn answer(&self, id: RequestId, response: S::Response) -> Result<(), String> {
        match (self, id) {
            (Self::Dds(server), RequestId::Dds(id)) => dds::answer::<S>(server, id, response).await,
            #[cfg(feature = "zenoh")]
            (Self::Zenoh(_), RequestId::Zenoh(request)) => request.answer::<S>(&response),
            #[cfg(feature = "zenoh")]
            _ => Err("the request was made elsewhere".into()),
        }
    }
}

impl Graph {
    /// The publishers there are at present.
    pub(super) fn publishers(&self) -> Vec<Offered> {
        match self {
            Self::Dds(graph) => graph.publishers(),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(graph) => graph.publishers(),
        }
    }

    /// Whether somebody subscribes to a topic.
    pub(super) fn is_heard(&self, topic: &str) -> bool {
        match self {
            Self::Dds(graph) => graph.is_heard(topic),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(graph) => graph.is_heard(topic),
        }
    }

    /// Whether there is another node of this full name.
    pub(super) fn has_another(&mut self, full_name: &str) -> bool {
        match self {
            Self::Dds(graph) => graph.has_another(full_name),
            #[cfg(feature = "zenoh")]
            Self::Zenoh(graph) => graph.has_another(full_name),
        }
    }
}
