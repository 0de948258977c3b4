//! Services: requests become commands for the worker.

use super::{
    inbox::Inbox,
    jobs::Jobs,
    node::NotCreated,
    object_services::serve_objects,
    outputs::Known,
    status::Shared,
    transport::{Node, Server},
    worker::{Command, MapFiles},
};
use crate::{
    config::{Parameters, RosArguments},
    msg::{
        Service,
        cdr::encoded_len,
        ellipsoid_slam::{LoadMap, LoadMapResponse, QueryObjects, SaveMap, SaveMapResponse},
        std_srvs::{SetBool, SetBoolResponse, Trigger, TriggerResponse},
    },
    publication::query_objects,
};
use serde::Serialize;
use std::{future::ready, sync::Arc, thread, time::Duration};
use tokio::{
    sync::{oneshot, watch},
    task::LocalSet,
    time::timeout,
};

/// The way from services to the threads that work.
#[derive(Clone)]
pub(super) struct Orders {
    pub(super) inbox: Arc<Inbox>,
    pub(super) jobs: Arc<Jobs>,
    pub(super) files: MapFiles,
    /// The map as it was after the latest image.
    pub(super) known: watch::Receiver<Arc<Known>>,
    pub(super) status: Shared,
    pub(super) map_frame: String,
    pub(super) parameters: watch::Receiver<Parameters>,
}

/// Starts the services of the map.
pub(super) fn serve_map(
    node: &mut Node,
    arguments: &RosArguments,
    orders: &Orders,
    tasks: &LocalSet,
) -> Result<(), NotCreated> {
    let name = |service: &str| arguments.resolve(&format!("~/{service}"));
    let on = orders.clone();
    serve::<Trigger, _>(node, &name("reset"), tasks, move |_| {
        let done = on.begin_anew(Command::Reset);
        async {
            answered(done.get().await, |success, message| TriggerResponse { success, message })
        }
    })?;
    let on = orders.clone();
    serve::<SetBool, _>(node, &name("pause"), tasks, move |request| {
        let paused = request.data;
        on.inbox.pause(paused);
        let done = on.ask(|answer| Command::Pause(paused, answer));
        async {
            answered(done.get().await, |success, message| SetBoolResponse { success, message })
        }
    })?;
    let on = orders.clone();
    serve::<SaveMap, _>(node, &name("save_map"), tasks, move |request| {
        let saved = on.clone().save(request.path);
        async move { answered(saved.await, |success, message| SaveMapResponse { success, message }) }
    })?;
    let on = orders.clone();
    serve::<LoadMap, _>(node, &name("load_map"), tasks, move |request| {
        let loaded = on.clone().load(request.path);
        async move {
            match loaded.await {
                Ok(objects) => LoadMapResponse { success: true, message: String::new(), objects },
                Err(message) => LoadMapResponse { success: false, message, objects: 0 },
            }
        }
    })?;
    let on = orders.clone();
    serve::<QueryObjects, _>(node, &name("query_objects"), tasks, move |request| {
        let known = on.known.borrow().clone();
        let header = (on.status.present(), on.map_frame.as_str());
        ready(query_objects(&request, &known.objects[..], known.view.as_ref(), header))
    })?;
    serve_objects(node, arguments, orders, tasks)
}

impl Orders {
    /// Gives the worker an order, and waits until it has done it.
    pub(super) fn ask<T>(&self, order: impl FnOnce(oneshot::Sender<T>) -> Command) -> Done<T> {
        let (answer, done) = oneshot::channel();
        self.jobs.order(order(answer));
        Done(done)
    }

    /// Gives the worker an order that nobody waits for.
    pub(super) fn tell(&self, order: Command) {
        self.jobs.order(order);
    }

    /// The same for an order after which the images that wait are of no use: they are of another map or state.
    pub(super) fn begin_anew<T>(
        &self,
        order: impl FnOnce(oneshot::Sender<T>) -> Command,
    ) -> Done<T> {
        let (answer, done) = oneshot::channel();
        self.inbox.drop_images();
        self.jobs.begin_anew(order(answer));
        Done(done)
    }

    async fn save(self, name: String) -> Result<Result<String, String>, String> {
        let maps = self.ask(Command::Maps).get().await?;
        let save = self.files.save;
        in_time("saving", move || save(&name, &maps)).await
    }

    /// How many objects the map has that was loaded.
    async fn load(self, name: String) -> Result<u32, String> {
        let load = Arc::clone(&self.files.load);
        let saved = in_time("loading", move || load(&name)).await??;
        let count = u32::try_from(saved.objects.len()).unwrap_or(u32::MAX);
        self.begin_anew(|answer| Command::Begin(saved, answer)).get().await??;
        Ok(count)
    }
}

/// What the worker will have done.
pub(super) struct Done<T>(oneshot::Receiver<T>);

impl<T> Done<T> {
    /// Waits for it.
    pub(super) async fn get(self) -> Result<T, String> {
        self.0.await.map_err(|_| STOPPING.to_owned())
    }
}

/// Works with a file on a thread of its own: a disk may not answer, and neither the map nor other services wait for it.
async fn in_time<T: Send + 'static>(
    what: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, String> {
    let (give, done) = oneshot::channel();
    thread::Builder::new()
        .name("files".into())
        // Who asked may have given up by then.
        .spawn(move || drop(give.send(work())))
        .map_err(|why| format!("{what}: {why}"))?;
    match timeout(FILE_TIME, done).await {
        Ok(done) => done.map_err(|_| format!("{what} has failed; the log says why")),
        Err(_) => Err(format!("{what} takes longer than {} s: given up", FILE_TIME.as_secs())),
    }
}

/// Answers the requests of one service, one after the other.
pub(super) fn serve<S: Service, F>(
    node: &mut Node,
    name: &str,
    tasks: &LocalSet,
    mut answer: impl FnMut(S::Request) -> F + 'static,
) -> Result<(), NotCreated>
where
    F: Future<Output = S::Response> + 'static,
{
    let server: Server<S> = node.server(name)?;
    let (name, most) = (name.to_owned(), node.largest_answer());
    tasks.spawn_local(async move {
        loop {
            match server.receive().await {
                Ok((id, request)) => {
                    let response = answer(request).await;
                    if !fits(&response, most) {
                        tracing::error!("{name}: the answer is larger than can be sent");
                        continue;
                    }
                    if let Err(why) = server.answer(id, response).await {
                        tracing::warn!("{name}: the answer was not sent: {why}");
                    }
                }
                Err(why) => tracing::warn!("{name}: a request cannot be read: {why}"),
            }
        }
    });
    Ok(())
}

/// Whether an answer has at most so many bytes.
pub(super) fn fits(answer: &impl Serialize, most: usize) -> bool {
    encoded_len(answer).is_some_and(|bytes| bytes <= most)
}

/// The response: what was done, or why not.
fn answered<R>(
    answer: Result<Result<String, String>, String>,
    response: impl FnOnce(bool, String) -> R,
) -> R {
    match answer {
        Ok(Ok(done)) => response(true, done),
        Ok(Err(why)) | Err(why) => response(false, why),
    }
}

/// How long a file may take.
const FILE_TIME: Duration = Duration::from_secs(10);
const STOPPING: &str = "the node is being stopped";
