//! Publishers, subscriptions and services.

use super::keys::{End, GID};
use crate::{
    msg::{Message, Service, cdr},
    ros::{status::system_time, transport::NotTaken},
};
use ros2_client::{
    QosProfile,
    qos::{Durability, History, Reliability},
};
use std::{
    sync::atomic::{AtomicI64, Ordering},
    time::Duration,
};
use zenoh::{
    Result, Session, Wait,
    handlers::{FifoChannelHandler, RingChannel, RingChannelHandler},
    liveliness::LivelinessToken,
    qos::CongestionControl,
    query::{Query, Queryable},
    sample::{Locality, Sample},
};
use zenoh_ext::{
    AdvancedPublisher, AdvancedPublisherBuilderExt, AdvancedSubscriber,
    AdvancedSubscriberBuilderExt, CacheConfig, HistoryConfig, MissDetectionConfig, RecoveryConfig,
};

/// Sends CDR bytes. Where a subscriber is too slow, messages are left out for it, unless the whole history is asked for.
pub(in crate::ros) struct Publisher {
    publisher: AdvancedPublisher<'static>,
    sequence: AtomicI64,
    gid: [u8; GID],
    _token: LivelinessToken,
}

/// The last message of a latched topic that was lost on its way is asked for again after this time.
const HEARTBEAT: Duration = Duration::from_millis(500);

impl Publisher {
    pub(super) fn new(session: &Session, end: &End, qos: &QosProfile) -> Result<Self> {
        let congestion = match qos.history {
            History::KeepAll => CongestionControl::Block,
            History::KeepLast { .. } => CongestionControl::Drop,
        };
        let mut builder =
            session.declare_publisher(end.key.clone()).congestion_control(congestion).advanced();
        if qos.durability == Durability::TransientLocal {
            builder = builder
                .cache(CacheConfig::default().max_samples(depth(qos)))
                .publisher_detection()
                .sample_miss_detection(
                    MissDetectionConfig::default().sporadic_heartbeat(HEARTBEAT),
                );
        }
        let publisher = builder.wait()?;
        let (sequence, gid) = (AtomicI64::new(0), end.gid());
        Ok(Self { publisher, sequence, gid, _token: end.announce(session)? })
    }

    pub(in crate::ros) fn publish<M: Message>(
        &self,
        message: &M,
    ) -> std::result::Result<(), String> {
        self.put(cdr::encode(message).map_err(|e| e.to_string())?)
    }

    /// Publishes CDR bytes with their header.
    pub(in crate::ros) fn put(&self, cdr: Vec<u8>) -> std::result::Result<(), String> {
        let number = self.sequence.fetch_add(1, Ordering::Relaxed) + 1;
        let attachment = attachment(number, &self.gid);
        self.publisher.put(cdr).attachment(attachment).wait().map_err(|e| e.to_string())
    }
}

/// Receives messages; the oldest go when more come than are read.
pub(in crate::ros) struct Subscription {
    subscriber: AdvancedSubscriber<RingChannelHandler<Sample>>,
    _token: LivelinessToken,
}

impl Subscription {
    pub(super) fn new(session: &Session, end: &End, qos: &QosProfile) -> Result<Self> {
        // Of any hash, so that another version of a type is named and not passed over in silence. What the node says
        // itself on `/tf` is not for it, as with RustDDS.
        let mut builder = session
            .declare_subscriber(end.key_of_any_hash.clone())
            .with(RingChannel::new(depth(qos)))
            .allowed_origin(Locality::Remote)
            .advanced();
        if qos.durability == Durability::TransientLocal {
            let history = HistoryConfig::default().detect_late_publishers();
            builder = builder.subscriber_detection().history(history.max_samples(depth(qos)));
            if qos.reliability != Reliability::BestEffort {
                builder = builder.recovery(RecoveryConfig::default().heartbeat());
            }
        }
        Ok(Self { subscriber: builder.wait()?, _token: end.announce(session)? })
    }

    pub(in crate::ros) async fn take<M: Message>(&self) -> std::result::Result<M, NotTaken> {
        let sample = self.subscriber.recv_async().await;
        let sample = sample.map_err(|e| NotTaken::Failed(e.to_string()))?;
        cdr::decode(&sample.payload().to_bytes()).map_err(NotTaken::BadBytes)
    }
}

/// Receives requests.
pub(in crate::ros) struct Server {
    queryable: Queryable<FifoChannelHandler<Query>>,
    _token: LivelinessToken,
}

/// A request that waits for its answer.
pub(in crate::ros) struct Request(Query);

impl Server {
    pub(super) fn new(session: &Session, end: &End) -> Result<Self> {
        let queryable = session.declare_queryable(end.key.clone()).complete(true).wait()?;
        Ok(Self { queryable, _token: end.announce(session)? })
    }

    pub(in crate::ros) async fn receive<S: Service>(
        &self,
    ) -> std::result::Result<(Request, S::Request), String> {
        let query = self.queryable.recv_async().await.map_err(|e| e.to_string())?;
        let bytes = query.payload().ok_or("it has no content")?.to_bytes();
        let request = cdr::decode_request::<S>(&bytes).map_err(|e| e.to_string())?;
        Ok((Request(query), request))
    }
}

impl Request {
    pub(in crate::ros) fn answer<S: Service>(
        &self,
        response: &S::Response,
    ) -> std::result::Result<(), String> {
        let cdr = cdr::encode_response::<S>(response).map_err(|e| e.to_string())?;
        let reply = self.0.reply(self.0.key_expr().clone(), cdr);
        // Who asked finds the answer by the number and the identifier of its own request.
        let asked = self.0.attachment().map(|attached| attached.to_bytes());
        let reply = match asked.as_deref().and_then(asked_by) {
            Some((number, gid)) => reply.attachment(attachment(number, &gid)),
            None => reply,
        };
        reply.wait().map_err(|e| e.to_string())
    }
}

/// Messages to keep.
fn depth(qos: &QosProfile) -> usize {
    match qos.history {
        History::KeepLast { depth } => depth.max(1),
        History::KeepAll => MOST,
    }
}

/// Messages that are kept where all are to be.
const MOST: usize = 1000;

/// What goes with every message: its number, when it was sent (ns), and who sent it.
fn attachment(number: i64, gid: &[u8; GID]) -> Vec<u8> {
    let sent = system_time().as_nanos();
    [&number.to_le_bytes()[..], &sent.to_le_bytes()[..], &[GID as u8], gid].concat()
}

/// Number and sender of what came.
fn asked_by(attachment: &[u8]) -> Option<(i64, [u8; GID])> {
    let (number, rest) = attachment.split_first_chunk::<8>()?;
    Some((i64::from_le_bytes(*number), *rest.get(9..)?.first_chunk()?))
}
