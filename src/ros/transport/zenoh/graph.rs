//! Who is there.

use super::keys::{self, NodeKey, Role, Said};
use crate::ros::{names::ros_type, transport::Offered};
use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use zenoh::{Result, Session, Wait, pubsub::Subscriber, sample::SampleKind};

/// The tokens there are in the domain.
#[derive(Clone)]
pub(in crate::ros) struct Graph {
    own: String,
    tokens: Arc<Mutex<BTreeSet<String>>>,
    _subscriber: Arc<Subscriber<()>>,
}

impl Graph {
    pub(super) fn listen(session: &Session, node: &NodeKey) -> Result<Self> {
        let tokens: Arc<Mutex<BTreeSet<String>>> = Arc::default();
        let heard = Arc::clone(&tokens);
        let subscriber = session
            .liveliness()
            .declare_subscriber(keys::all_tokens(node.domain))
            .history(true)
            .callback(move |sample| {
                let token = sample.key_expr().as_str();
                let mut tokens = lock(&heard);
                match sample.kind() {
                    SampleKind::Put => tokens.insert(token.to_owned()),
                    SampleKind::Delete => tokens.remove(token),
                };
            })
            .wait()?;
        Ok(Self { own: node.session.clone(), tokens, _subscriber: Arc::new(subscriber) })
    }

    /// Every publisher is paired with every subscription of the same type, whatever its quality of service.
    pub(in crate::ros) fn publishers(&self) -> Vec<Offered> {
        let publisher = |said: Said<'_>| {
            let (topic, type_name) = said.topic.filter(|_| said.role == Role::Publisher)?;
            let type_name = ros_type(type_name);
            Some(Offered { topic, type_name, best_effort: false, volatile: false })
        };
        let tokens = lock(&self.tokens);
        tokens.iter().filter_map(|token| publisher(Said::parse(token)?)).collect()
    }

    pub(in crate::ros) fn is_heard(&self, topic: &str) -> bool {
        self.any(|said| {
            said.role == Role::Subscription && said.topic.is_some_and(|(name, _)| name == topic)
        })
    }

    pub(in crate::ros) fn has_another(&self, full_name: &str) -> bool {
        self.any(|said| {
            said.role == Role::Node && said.session != self.own && said.node == full_name
        })
    }

    fn any(&self, is_it: impl Fn(Said<'_>) -> bool) -> bool {
        lock(&self.tokens).iter().filter_map(|token| Said::parse(token)).any(is_it)
    }
}

/// A set of tokens is whole at any time.
fn lock(tokens: &Mutex<BTreeSet<String>>) -> MutexGuard<'_, BTreeSet<String>> {
    tokens.lock().unwrap_or_else(PoisonError::into_inner)
}
