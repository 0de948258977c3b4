//! Zenoh, as `rmw_zenoh_cpp` speaks it (its `docs/design.md`): topics and services are key expressions, who is there is
//! said by liveliness tokens, and what was published before a subscription came is asked of publishers' caches.
//!
//! ros2-client has Zenoh too, but 0.12 knows the hashes of few types, without which ROS 2 receives nothing from here,
//! and keeps nothing for those who come later.

mod ends;
mod graph;
mod keys;
mod session;

pub(in crate::ros) use ends::{Publisher, Request, Server, Subscription};
pub(in crate::ros) use graph::Graph;

use self::keys::{End, NodeKey, Role};
use crate::{
    msg::{schema_text, type_hash},
    ros::{
        domain::{Domain, DomainError},
        names::{dds_type, parsed},
        node::NotCreated,
        qos,
    },
};
use ::zenoh::{Session, Wait, liveliness::LivelinessToken};
use ros2_client::{NodeName, QosProfile, qos::History};

/// A node. Fields are dropped in this order.
pub(in crate::ros) struct Node {
    key: NodeKey,
    ends: u64,
    graph: Graph,
    _token: LivelinessToken,
    session: Session,
}

impl Node {
    pub(super) fn join(domain: Domain, name: &NodeName) -> Result<Self, DomainError> {
        let failed = |problem: String| DomainError::NotStarted {
            middleware: "Zenoh",
            id: domain.id,
            problem,
        };
        let session = session::open().map_err(failed)?;
        let key = NodeKey::new(domain.id, session.zid().to_string(), name);
        let start = || {
            let graph = Graph::listen(&session, &key)?;
            Ok((graph, session.liveliness().declare_token(key.token()).wait()?))
        };
        let started: ::zenoh::Result<_> = start();
        let (graph, token) = started.map_err(|e| failed(e.to_string()))?;
        Ok(Self { key, ends: 0, graph, _token: token, session })
    }

    pub(super) fn subscription(
        &mut self,
        topic: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Subscription, NotCreated> {
        let end = self.end(Role::Subscription, topic, kind, qos)?;
        Subscription::new(&self.session, &end, qos).map_err(|e| NotCreated::new(topic, e))
    }

    pub(super) fn publisher(
        &mut self,
        topic: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Publisher, NotCreated> {
        let end = self.end(Role::Publisher, topic, kind, qos)?;
        Publisher::new(&self.session, &end, qos).map_err(|e| NotCreated::new(topic, e))
    }

    /// Waits for subscribers that are too slow: nothing of a recording is to be lost.
    pub(super) fn raw_publisher(
        &mut self,
        topic: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<Publisher, NotCreated> {
        self.publisher(topic, kind, &qos.clone().history(History::KeepAll))
    }

    pub(super) fn server(&mut self, name: &str, kind: &str) -> Result<Server, NotCreated> {
        let end = self.end(Role::Server, name, kind, &qos::service())?;
        Server::new(&self.session, &end).map_err(|e| NotCreated::new(name, e))
    }

    pub(super) fn graph(&self) -> Graph {
        self.graph.clone()
    }

    /// A new end of this node.
    fn end(
        &mut self,
        role: Role,
        name: &str,
        kind: &str,
        qos: &QosProfile,
    ) -> Result<End, NotCreated> {
        parsed(name)?;
        self.ends += 1;
        let hash = match role {
            Role::Server => type_hash::service_hash(kind),
            _ => schema_text(kind).and_then(|text| type_hash::message_hash(kind, &text)),
        };
        let hash = keys::hash_of_distribution(hash);
        Ok(self.key.end(self.ends, role, [name, &dds_type(kind), &hash], qos))
    }
}
