//! Services: requests become commands for the worker.

use super::{
    inbox::Inbox,
    names::parsed,
    node::{NodeError, NotCreated},
    qos,
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
use ros2_client::{Node, Server, ServiceMapping, ServiceTypeName};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::sync::Arc;
use tokio::{sync::oneshot, task::LocalSet};

/// A request or response as ros2-client wants it: on the wire it is what it holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
struct Wire<T>(T);

impl<T: Serialize + DeserializeOwned> ros2_client::Message for Wire<T> {}

/// Starts the services of the map.
pub(super) fn serve_map(
    node: &mut Node,
    arguments: &RosArguments,
    inbox: &Arc<Inbox>,
    tasks: &LocalSet,
) -> Result<(), NodeError> {
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
) -> Result<(), NodeError>
where
    S::Request: Clone + 'static,
    S::Response: 'static,
    F: Future<Output = S::Response> + 'static,
{
    let mut parts = S::TYPE.split('/');
    let (package, kind) = (parts.next().unwrap_or_default(), parts.next_back().unwrap_or_default());
    let server: Server<Wire<S::Request>, Wire<S::Response>> = node
        .create_server(
            ServiceMapping::Enhanced,
            &parsed(name)?,
            &ServiceTypeName::new(package, kind),
            qos::service(),
            qos::service(),
        )
        .map_err(|e| NotCreated::new(name, e))?;
    let name = name.to_owned();
    tasks.spawn_local(async move {
        loop {
            match server.async_receive_request().await {
                Ok((id, Wire(request))) => {
                    let response = Wire(answer(request).await);
                    if !fits(&response) {
                        tracing::error!("{name}: the answer is larger than RustDDS can send");
                        continue;
                    }
                    if let Err(e) = server.async_send_response(id, response).await {
                        tracing::warn!("{name}: the answer was not sent: {e}");
                    }
                }
                Err(e) => tracing::warn!("{name}: a request cannot be read: {e}"),
            }
        }
    });
    Ok(())
}

/// Whether an answer can be sent. RustDDS 0.15 garbles what it has to cut into fragments if it says at the same time
/// which request it answers (a stray byte before the inline QoS of `DATA_FRAG`), so answers must fit into one datagram.
pub(super) fn fits(answer: &impl Serialize) -> bool {
    encoded_len(answer).is_some_and(|bytes| bytes <= LARGEST_ANSWER)
}

const LARGEST_ANSWER: usize = 1100;

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
