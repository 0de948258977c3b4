//! The node's life: it starts, runs until a signal, and leaves in order.

use super::{
    broadcast::broadcast,
    inbox::Inbox,
    names::{Identity, NameError},
    outputs::{Outputs, publisher},
    participant::{DdsDomain, DomainError},
    qos,
    status::Shared,
    subscriptions::Subscriptions,
    worker::Worker,
};
use crate::{
    config::NodeSettings,
    pipeline::{ObjectSlam, Settings},
};
use ros2_client::{CreateError, Node, NodeOptions};
use std::{io, sync::Arc, thread};
use thiserror::Error;
use tokio::{
    runtime,
    signal::unix::{SignalKind, signal},
    sync::{oneshot, watch},
    task::LocalSet,
};

/// Why the node does not run.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// A name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// The node itself, a publisher or a subscription.
    #[error("{what} cannot be created: {problem}")]
    Create {
        /// A topic, or the node.
        what: String,
        /// What DDS said.
        problem: String,
    },
    /// The operating system.
    #[error("cannot start: {0}")]
    System(#[from] io::Error),
    /// The thread that owns the core ended by itself, which is a bug.
    #[error("the thread that builds the map has ended; its last words are above")]
    WorkerEnded,
}

impl NodeError {
    pub(super) fn create(what: &str, problem: CreateError) -> Self {
        Self::Create { what: what.to_owned(), problem: problem.to_string() }
    }
}

/// Runs the node until SIGINT or SIGTERM.
///
/// # Errors
/// When it cannot start, or its worker ends.
pub fn run_node(
    domain: DdsDomain,
    identity: &Identity,
    settings: &Settings,
    own: &NodeSettings,
) -> Result<(), NodeError> {
    let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
    let context = domain.join()?;
    // Variables are dropped in reverse order: tasks with their subscriptions and publishers first, then the node,
    // then the context. Otherwise others would believe the node to be alive.
    let mut node = context
        .new_node(identity.node_name()?, NodeOptions::new().start_parameter_services(false))
        .map_err(|e| NodeError::Create { what: identity.full_name(), problem: e.to_string() })?;
    let tasks = LocalSet::new();
    let running = Running::start(&mut node, identity, settings, own, &tasks)?;
    tracing::info!("{} runs in domain {}", identity.full_name(), domain.id);
    runtime.block_on(tasks.run_until(running.until_stopped()))
}

/// A node that has started.
struct Running {
    inbox: Arc<Inbox>,
    worker: thread::JoinHandle<()>,
    ended: oneshot::Receiver<()>,
}

impl Running {
    fn start(
        node: &mut Node,
        identity: &Identity,
        settings: &Settings,
        own: &NodeSettings,
        tasks: &LocalSet,
    ) -> Result<Self, NodeError> {
        let status = Shared::default();
        let inbox = Arc::new(Inbox::new(own.queue_size));
        let (correction, corrected) = watch::channel(None);
        let worker = Worker {
            slam: ObjectSlam::new(settings.clone()),
            settings: settings.clone(),
            outputs: Outputs::create(node, identity, own)?,
            inbox: Arc::clone(&inbox),
            status: status.clone(),
            correction,
            paused: false,
        };
        let (ends, ended) = oneshot::channel();
        let worker = thread::Builder::new().name("slam".into()).spawn(move || {
            // Dropped when the worker ends, however it ends.
            let _ends: oneshot::Sender<()> = ends;
            worker.run();
        })?;
        if own.publish_tf {
            let tf = publisher(node, "/tf", qos::stream(qos::TF_DEPTH))?;
            let frame = own.map_frame.clone();
            tasks.spawn_local(broadcast(tf, corrected, status.clone(), frame, own.tf_rate_hz));
        }
        let mut subscriptions = Subscriptions {
            node,
            identity,
            inbox: &inbox,
            status: &status,
            tasks,
            listening: Vec::new(),
        };
        subscriptions.all(own)?;
        Ok(Self { inbox, worker, ended })
    }

    async fn until_stopped(self) -> Result<(), NodeError> {
        let (mut interrupt, mut terminate) =
            (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?);
        tokio::select! {
            _ = interrupt.recv() => tracing::info!("interrupted"),
            _ = terminate.recv() => tracing::info!("terminated"),
            _ = self.ended => return Err(NodeError::WorkerEnded),
        }
        self.inbox.close();
        self.worker.join().map_err(|_| NodeError::WorkerEnded)
    }
}
