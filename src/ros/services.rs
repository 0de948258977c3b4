//! Services: requests become commands for the worker.

use super::{
    inbox::Inbox,
    node::NotCreated,
    transport::{Node, Server},
    worker::Command,
};
use crate::{
    config::RosArguments,
    msg::{
        Service,
        cdr::encoded_len,
        ellipsoid_slam::{
            LoadMap, LoadMapResponse, QueryObjects, QueryObjectsResponse, SaveMap, SaveMapResponse,
        },
        std_srvs::{SetBool, SetBoolResponse, Trigger, TriggerResponse},
    },
};
use serde::Serialize;
use std::sync::Arc;
use tokio::{sync::oneshot, task::LocalSet};

/// Starts the services of the map.
pub(super) fn serve_map(
    node: &mut Node,
    arguments: &RosArguments,
    inbox: &Arc<Inbox>,
    tasks: &LocalSet,
) -> Result<(), NotCreated> {
    let name = |service: &str| arguments.resolve(&format!("~/{service}"));
    let worker = Arc::clone(inbox);
    serve::<Trigger, _>(node, &name("reset"), tasks, move |_| {
        let answer = ask(&worker, Command::Reset);
        async { answered(answer.await, |success, message| TriggerResponse { success, message }) }
    })?;
    let worker = Arc::clone(inbox);
    serve::<SetBool, _>(node, &name("pause"), tasks, move |request| {
        let answer = ask(&worker, |answer| Command::Pause(request.data, answer));
        async { answered(answer.await, |success, message| SetBoolResponse { success, message }) }
    })?;
    let worker = Arc::clone(inbox);
    serve::<SaveMap, _>(node, &name("save_map"), tasks, move |request| {
        let answer = ask(&worker, |answer| Command::Save(request.path, answer));
        async { answered(answer.await, |success, message| SaveMapResponse { success, message }) }
    })?;
    let worker = Arc::clone(inbox);
    serve::<LoadMap, _>(node, &name("load_map"), tasks, move |request| {
        let answer = ask(&worker, |answer| Command::Load(request.path, answer));
        async {
            match answer.await.unwrap_or_else(|_| Err(STOPPING.into())) {
                Ok(objects) => LoadMapResponse { success: true, message: String::new(), objects },
                Err(message) => LoadMapResponse { success: false, message, objects: 0 },
            }
        }
    })?;
    let worker = Arc::clone(inbox);
    serve::<QueryObjects, _>(node, &name("query_objects"), tasks, move |request| {
        let answer = ask(&worker, |answer| Command::Query(Box::new(request), answer));
        async {
            answer.await.unwrap_or_else(|_| QueryObjectsResponse {
                message: STOPPING.into(),
                ..QueryObjectsResponse::default()
            })
        }
    })
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

/// Gives the worker an order; the answer comes when it has done it.
fn ask<T>(
    worker: &Inbox,
    order: impl FnOnce(oneshot::Sender<T>) -> Command,
) -> oneshot::Receiver<T> {
    let (answer, answered) = oneshot::channel();
    worker.order(order(answer));
    answered
}

/// The response: what was done, or why not.
fn answered<R>(
    answer: Result<Result<String, String>, oneshot::error::RecvError>,
    response: impl FnOnce(bool, String) -> R,
) -> R {
    match answer {
        Ok(Ok(done)) => response(true, done),
        Ok(Err(why)) => response(false, why),
        Err(_) => response(false, STOPPING.into()),
    }
}

const STOPPING: &str = "the node is being stopped";
