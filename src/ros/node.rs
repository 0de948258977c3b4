//! The node's life: it starts, runs until a signal, and leaves in order.

use super::{
    broadcast::broadcast,
    clock,
    color::ColorImages,
    diagnostics::{Counts, Diagnostics},
    inbox::Inbox,
    names::{NameError, node_name},
    outputs::Outputs,
    parameters::Live,
    participant::{DdsDomain, DomainError},
    perceiver::{MOST_JOBS, Perceiver},
    problems::Problems,
    qos,
    rosout::LogLines,
    same_name::SameName,
    services::serve_map,
    status::Shared,
    subscriptions::{Listening, Subscriptions},
    topic::Ends,
    worker::{MapFiles, Worker},
};
use crate::{
    config::{NodeSettings, Parameters, RosArguments},
    pipeline::{FrontEnd, ObjectSlam},
};
use ros2_client::{Context, Node, NodeOptions};
use std::{
    fmt::Display,
    io,
    sync::{Arc, mpsc},
    thread,
    time::Duration,
};
use thiserror::Error;
use tokio::{
    runtime,
    signal::unix::{Signal, SignalKind, signal},
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
    #[error(transparent)]
    Create(#[from] NotCreated),
    /// The operating system.
    #[error("cannot start: {0}")]
    System(#[from] io::Error),
    /// The thread that owns the core ended by itself, which is a bug.
    #[error("the thread that builds the map has ended; its last words are above")]
    WorkerEnded,
}

/// A node, publisher, subscription or service that DDS does not make.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{what} cannot be created: {problem}")]
pub struct NotCreated {
    what: String,
    problem: String,
}

impl NotCreated {
    /// `what` is a topic, a service or a node; `problem` is what DDS said.
    pub(super) fn new(what: &str, problem: impl Display) -> Self {
        Self { what: what.to_owned(), problem: problem.to_string() }
    }
}

/// Runs the node until SIGINT or SIGTERM. It publishes the log's `lines` on `/rosout`.
///
/// # Errors
/// When it cannot start, or its worker ends.
pub fn run_node(
    domain: DdsDomain,
    arguments: &RosArguments,
    parameters: Parameters,
    files: MapFiles,
    lines: LogLines,
) -> Result<(), NodeError> {
    let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
    let signals = {
        let _inside = runtime.enter();
        Signals::listen()?
    };
    let context = domain.join()?;
    let name = arguments.full_name();
    let node = context
        .new_node(
            node_name(arguments.namespace(), arguments.node())?,
            NodeOptions::new().start_parameter_services(false).enable_rosout(false),
        )
        .map_err(|e| NotCreated::new(&name, e))?;
    let tasks = LocalSet::new();
    let mut start = Start { context: &context, node, arguments, tasks: &tasks };
    let running = start.everything(parameters, files)?;
    start.log(lines)?;
    tracing::info!("{name} runs in domain {}", domain.id);
    let outcome = runtime.block_on(tasks.run_until(running.until_stopped(signals)));
    // Tasks with their subscriptions and publishers go first, then the node, then the context: otherwise others would
    // believe the node to be alive. The context stops sending when it goes, also what it was given before.
    let Start { node, .. } = start;
    drop(tasks);
    drop(node);
    drop(runtime);
    thread::sleep(GOODBYE);
    outcome
}

/// Time for the last words to be sent, and once more where they were lost.
const GOODBYE: Duration = Duration::from_millis(500);

/// What ends the node in order, also while it still starts.
struct Signals {
    interrupt: Signal,
    terminate: Signal,
}

impl Signals {
    fn listen() -> io::Result<Self> {
        let interrupt = signal(SignalKind::interrupt())?;
        Ok(Self { interrupt, terminate: signal(SignalKind::terminate())? })
    }
}

/// What parts of the node are made from.
struct Start<'a> {
    context: &'a Context,
    node: Node,
    arguments: &'a RosArguments,
    tasks: &'a LocalSet,
}

/// A node that has started.
struct Running {
    inbox: Arc<Inbox>,
    worker: thread::JoinHandle<()>,
    ended: oneshot::Receiver<()>,
}

/// Most depth images that wait for the one before them to be worked on.
const MOST_DEPTH: usize = 10;

impl Start<'_> {
    fn everything(
        &mut self,
        parameters: Parameters,
        files: MapFiles,
    ) -> Result<Running, NodeError> {
        let arguments = self.arguments;
        let status = Shared::default();
        let inbox = Arc::new(Inbox::new(MOST_DEPTH));
        let live = Live::new(parameters.clone(), Arc::clone(&inbox));
        let (correction, corrected) = watch::channel(None);
        let color = ColorImages::default();
        let own = parameters.node.clone();
        let (give, jobs) = mpsc::sync_channel(MOST_JOBS);
        let front_end = FrontEnd::new(parameters.slam.clone());
        let perceiver = Perceiver::new(front_end, Arc::clone(&inbox), give);
        let worker = Worker {
            slam: ObjectSlam::new(parameters.slam.clone()),
            parameters,
            outputs: Outputs::create(self.ends(), arguments, &own, correction, color.clone())?,
            jobs,
            status: status.clone(),
            files,
        };
        let tf = self.ends().publisher(&arguments.resolve("/tf"), qos::tf())?;
        self.tasks.spawn_local(broadcast(tf, corrected, status.clone(), live.watch()));
        live.serve(&mut self.node, arguments, self.tasks)?;
        serve_map(&mut self.node, arguments, &inbox, self.tasks)?;
        if own.use_sim_time {
            self.tasks.spawn_local(clock::follow(self.ends(), status.clone())?);
        }
        let listening = self.subscriptions(&own, &inbox, &status, color)?;
        self.diagnostics(listening, &inbox, &status)?;
        thread::Builder::new().name("perception".into()).spawn(move || perceiver.run())?;
        let (ends, ended) = oneshot::channel();
        let worker = thread::Builder::new().name("slam".into()).spawn(move || {
            // Dropped when the worker ends, however it ends.
            let _ends: oneshot::Sender<()> = ends;
            worker.run();
        })?;
        Ok(Running { inbox, worker, ended })
    }

    fn ends(&mut self) -> Ends<'_> {
        Ends { context: self.context, node: &mut self.node }
    }

    fn subscriptions(
        &mut self,
        own: &NodeSettings,
        inbox: &Arc<Inbox>,
        status: &Shared,
        color: ColorImages,
    ) -> Result<Vec<Listening>, NodeError> {
        let mut subscriptions = Subscriptions {
            ends: Ends { context: self.context, node: &mut self.node },
            arguments: self.arguments,
            inbox,
            status,
            tasks: self.tasks,
            listening: Vec::new(),
        };
        subscriptions.all(own)?;
        if own.publish.debug_image {
            subscriptions.color(own, color)?;
        }
        Ok(subscriptions.listening)
    }

    fn log(&mut self, lines: LogLines) -> Result<(), NodeError> {
        let logger = self.arguments.logger();
        self.tasks.spawn_local(lines.publish(self.ends(), logger)?);
        Ok(())
    }

    fn diagnostics(
        &mut self,
        listening: Vec<Listening>,
        inbox: &Arc<Inbox>,
        status: &Shared,
    ) -> Result<(), NodeError> {
        let topic = self.arguments.resolve("/diagnostics");
        let name = self.arguments.full_name();
        let diagnostics = Diagnostics {
            publisher: self.ends().publisher(&topic, qos::stream(10))?,
            node: name.clone(),
            participant: self.context.domain_participant(),
            listening,
            same_name: SameName::listen(self.context, &mut self.node, name)?,
            inbox: Arc::clone(inbox),
            status: status.clone(),
            problems: Problems::default(),
            before: Counts::default(),
        };
        self.tasks.spawn_local(diagnostics.run());
        Ok(())
    }
}

impl Running {
    async fn until_stopped(self, mut signals: Signals) -> Result<(), NodeError> {
        tokio::select! {
            _ = signals.interrupt.recv() => tracing::info!("interrupted"),
            _ = signals.terminate.recv() => tracing::info!("terminated"),
            _ = self.ended => return Err(NodeError::WorkerEnded),
        }
        self.inbox.close();
        self.worker.join().map_err(|_| NodeError::WorkerEnded)
    }
}
