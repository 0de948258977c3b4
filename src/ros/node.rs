//! The node's life: it starts, runs until a signal, and leaves in order.

use super::{
    broadcast::{Broadcast, broadcast},
    clock,
    color::ColorImages,
    detecting::{Detecting, NewestImage},
    diagnostics::{Counts, Diagnostics},
    domain::{Domain, DomainError},
    finding::Finding,
    inbox::Inbox,
    initial_pose,
    jobs::Jobs,
    lifecycle::State,
    managed::serve_lifecycle,
    names::node_name,
    outputs::Outputs,
    parameters::Live,
    perceiver::Perceiver,
    problems::Problems,
    progress::Progress,
    qos,
    rosout::LogLines,
    services::{Orders, serve_map},
    status::Shared,
    subscriptions::{Inputs, Subscriptions},
    transport::Node,
    worker::{MapFiles, Worker},
};
use crate::{
    config::{NodeSettings, Parameters, RosArguments},
    mapping::SavedMap,
    msg::convert::FindBoxes,
    pipeline::{FrontEnd, ObjectSlam},
};
use std::{
    convert::Infallible,
    fmt::Display,
    future::{Future, pending},
    io,
    sync::Arc,
    thread,
    time::Duration,
};
use thiserror::Error;
use tokio::{
    runtime,
    signal::unix::{Signal, SignalKind, signal},
    sync::{Notify, oneshot, watch},
    task::LocalSet,
    time::{sleep, timeout},
};

/// Why the node does not run.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The node itself, a publisher or a subscription.
    #[error(transparent)]
    Create(#[from] NotCreated),
    /// The operating system.
    #[error("cannot start: {0}")]
    System(#[from] io::Error),
    /// The disk does not answer.
    #[error("the map was not saved within {0} s: the disk does not answer")]
    NotSaved(u64),
    /// The thread that owns the core ended by itself, which is a bug.
    #[error("the thread that builds the map has ended; its last words are above")]
    WorkerEnded,
}

/// A publisher, subscription or service that the middleware does not make, or a name that ROS 2 does not allow.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{what} cannot be created: {problem}")]
pub struct NotCreated {
    what: String,
    problem: String,
}

impl NotCreated {
    /// `what` is a topic, a service or a node; `problem` is what the middleware said.
    pub(super) fn new(what: &str, problem: impl Display) -> Self {
        Self { what: what.to_owned(), problem: problem.to_string() }
    }
}

/// Runs the node until SIGINT or SIGTERM, or until a service shuts it down. It begins with a map where it is given one. It publishes the log's
/// `lines` on `/rosout`. Where it is given a detector, it finds the boxes in the colour images itself.
///
/// # Errors
/// When it cannot start, or its worker ends.
pub fn run_node(
    domain: Domain,
    arguments: &RosArguments,
    parameters: Parameters,
    (at_start, files): (Option<SavedMap>, MapFiles),
    detector: Option<FindBoxes>,
    lines: LogLines,
) -> Result<(), NodeError> {
    let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
    let signals = {
        let _inside = runtime.enter();
        Signals::listen()?
    };
    let name = arguments.full_name();
    let node = Node::join(domain, node_name(arguments.namespace(), arguments.node())?)?;
    let tasks = LocalSet::new();
    let mut start = Start { node, arguments, tasks: &tasks };
    let (running, sinks) = start.everything(parameters, (at_start, files), detector)?;
    start.log(lines)?;
    tracing::info!("{name} runs in domain {}", domain.id);
    let outcome =
        runtime.block_on(tasks.run_until(running.until_stopped(signals, start.listen(sinks))));
    // Tasks with their subscriptions and publishers go before the node: otherwise others would believe it to be alive.
    let Start { node, .. } = start;
    drop(tasks);
    drop(runtime);
    drop(node);
    outcome
}

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
    node: Node,
    arguments: &'a RosArguments,
    tasks: &'a LocalSet,
}

/// A node that has started.
struct Running {
    inbox: Arc<Inbox>,
    jobs: Arc<Jobs>,
    /// Told when a service asks for the end.
    stop: Arc<Notify>,
    detecting: Option<Detecting>,
    worker: thread::JoinHandle<()>,
    ended: oneshot::Receiver<()>,
}

/// Where inputs go.
struct Sinks {
    settings: NodeSettings,
    inbox: Arc<Inbox>,
    status: Shared,
    inputs: Inputs,
    /// To a detector of our own.
    detected: Option<Arc<NewestImage>>,
    /// To be drawn into.
    drawn: Option<ColorImages>,
}

/// Most depth images that wait for the one before them to be worked on.
const MOST_DEPTH: usize = 10;

impl Start<'_> {
    fn everything(
        &mut self,
        parameters: Parameters,
        (at_start, files): (Option<SavedMap>, MapFiles),
        detector: Option<FindBoxes>,
    ) -> Result<(Running, Sinks), NodeError> {
        let arguments = self.arguments;
        let status = Shared::default();
        let inbox = Arc::new(Inbox::new(MOST_DEPTH));
        let state = begin(parameters.node.lifecycle.autostart, &status, &inbox);
        let jobs = Arc::new(Jobs::default());
        let live = Live::new(parameters.clone(), Arc::clone(&inbox), Arc::clone(&jobs));
        let (correction, corrected) = watch::channel(Broadcast::default());
        let color = ColorImages::default();
        let own = parameters.node.clone();
        let front_end = FrontEnd::new(parameters.slam.clone());
        let perceiver = Perceiver::new(front_end, Arc::clone(&inbox), Arc::clone(&jobs));
        let (tell, known) = watch::channel(Arc::default());
        let worker = Worker {
            slam: ObjectSlam::new(parameters.slam.clone()),
            parameters,
            outputs: Outputs::create(&mut self.node, arguments, &own, correction, color.clone())?,
            jobs: Arc::clone(&jobs),
            status: status.clone(),
            state,
            at_start,
            save: Arc::clone(&files.save),
            known: tell,
        };
        let tf = self.node.publisher(&arguments.resolve("/tf"), &qos::tf())?;
        self.tasks.spawn_local(broadcast(tf, corrected, status.clone(), live.watch()));
        live.serve(&mut self.node, arguments, self.tasks)?;
        let orders = Orders {
            inbox: Arc::clone(&inbox),
            jobs: Arc::clone(&jobs),
            files,
            known,
            status: status.clone(),
            map_frame: own.map_frame.clone(),
            parameters: live.watch(),
        };
        let stop = self.services(orders)?;
        if own.use_sim_time {
            self.tasks.spawn_local(clock::follow(&mut self.node, status.clone())?);
        }
        let detecting = detector.map(|find| Detecting::start(find, &own, &inbox, &status));
        let detecting = detecting.transpose()?;
        let sinks = Sinks {
            inbox: Arc::clone(&inbox),
            status,
            inputs: Inputs::default(),
            detected: detecting.as_ref().map(Detecting::newest),
            drawn: own.publish.debug_image.then_some(color),
            settings: own,
        };
        self.diagnostics(&sinks)?;
        thread::Builder::new().name("perception".into()).spawn(move || perceiver.run())?;
        let (ends, ended) = oneshot::channel();
        let worker = thread::Builder::new().name("slam".into()).spawn(move || {
            // Dropped when the worker ends, however it ends.
            let _ends: oneshot::Sender<()> = ends;
            worker.run();
        })?;
        Ok((Running { inbox, jobs, stop, detecting, worker, ended }, sinks))
    }

    /// What others ask of the map and of the node; the answer is told when they ask for its end.
    fn services(&mut self, orders: Orders) -> Result<Arc<Notify>, NotCreated> {
        let stop = Arc::default();
        serve_map(&mut self.node, self.arguments, &orders, self.tasks)?;
        serve_lifecycle(&mut self.node, self.arguments, &orders, &stop, self.tasks)?;
        self.tasks.spawn_local(initial_pose::listen(&mut self.node, self.arguments, orders)?);
        Ok(stop)
    }

    /// Finds the topics that nobody named, and subscribes. It ends only where that fails.
    async fn listen(&mut self, sinks: Sinks) -> Result<Infallible, NodeError> {
        let Sinks { settings, inbox, status, inputs, detected, drawn } = &sinks;
        let (topics, detects) = (&settings.topics, detected.is_some());
        let finding = Finding::new(&mut self.node, topics, self.arguments, detects)?;
        let sources = finding.find(inputs).await;
        let mut subscriptions = Subscriptions {
            node: &mut self.node,
            arguments: self.arguments,
            inbox,
            status,
            tasks: self.tasks,
            detected: detected.clone(),
            drawn: drawn.clone(),
            inputs,
        };
        subscriptions.all(settings, &sources)?;
        if sources.roles.odometry.is_none()
            && let Some(topic) = finding.odometry().await
        {
            subscriptions.odometry(&topic, settings.qos.odometry)?;
        }
        pending().await
    }

    fn log(&mut self, lines: LogLines) -> Result<(), NodeError> {
        let logger = self.arguments.logger();
        self.tasks.spawn_local(lines.publish(&mut self.node, logger)?);
        Ok(())
    }

    fn diagnostics(&mut self, sinks: &Sinks) -> Result<(), NodeError> {
        let topic = self.arguments.resolve("/diagnostics");
        let name = self.arguments.full_name();
        let diagnostics = Diagnostics {
            publisher: self.node.publisher(&topic, &qos::stream(10))?,
            node: name,
            inputs: Inputs::clone(&sinks.inputs),
            graph: self.node.graph()?,
            inbox: Arc::clone(&sinks.inbox),
            status: sinks.status.clone(),
            problems: Problems::default(),
            before: Counts::default(),
            progress: Progress::default(),
        };
        self.tasks.spawn_local(diagnostics.run());
        Ok(())
    }
}

/// The state that the node begins in. Who is active by itself has been configured before anybody could see it.
fn begin(autostart: bool, status: &Shared, inbox: &Inbox) -> State {
    let state = if autostart { State::Active } else { State::Unconfigured };
    status.lock().state = state;
    inbox.activate(autostart);
    if !autostart {
        tracing::info!("it waits for change_state: lifecycle.autostart is false");
    }
    state
}

impl Running {
    async fn until_stopped(
        mut self,
        mut signals: Signals,
        listening: impl Future<Output = Result<Infallible, NodeError>>,
    ) -> Result<(), NodeError> {
        tokio::select! {
            _ = signals.interrupt.recv() => tracing::info!("interrupted"),
            _ = signals.terminate.recv() => tracing::info!("terminated"),
            () = self.stop.notified() => {
                tracing::info!("shut down");
                sleep(ANSWERING).await;
            }
            _ = &mut self.ended => return Err(NodeError::WorkerEnded),
            Err(failed) = listening => return Err(failed),
        }
        if let Some(detecting) = self.detecting {
            detecting.stop();
        }
        self.inbox.close();
        self.jobs.end_within(BACKLOG);
        match timeout(SAVING, self.ended).await {
            Ok(_) => self.worker.join().map_err(|_| NodeError::WorkerEnded),
            Err(_) => Err(NodeError::NotSaved(SAVING.as_secs())),
        }
    }
}

/// How long the answer to the service that ends the node may take to go out.
const ANSWERING: Duration = Duration::from_millis(100);
/// How long messages that came before the end are worked on: those that wait longer are dropped for the map.
const BACKLOG: Duration = Duration::from_millis(500);
/// How long the end may take: launchers kill after ten seconds.
const SAVING: Duration = Duration::from_secs(8);
