//! Services: requests become commands for the worker.

use super::{
    inbox::Inbox,
    names::parsed,
    node::NodeError,
    qos,
    worker::{Answer, Command},
};
use crate::{
    config::RosArguments,
    msg::{
        Service,
        ellipsoid_slam::{LoadMap, LoadMapResponse, SaveMap, SaveMapResponse},
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
pub(super) struct Wire<T>(pub(super) T);

impl<T: Serialize + DeserializeOwned> ros2_client::Message for Wire<T> {}

/// Starts all services of the map.
pub(super) fn serve_map(
    node: &mut Node,
    arguments: &RosArguments,
    inbox: &Arc<Inbox>,
    tasks: &LocalSet,
) -> Result<(), NodeError> {
    let name = |service: &str| arguments.resolve(&format!("~/{service}"));
    let ask = |inbox: &Arc<Inbox>| {
        let inbox = Arc::clone(inbox);
        move |order: fn(Answer) -> Command| ask(&inbox, order)
    };
    let worker = ask(inbox);
    let answer = move |_| {
        let answer = worker(Command::Reset);
        async move {
            let (success, message) = outcome(answer.await, "the map is empty");
            TriggerResponse { success, message }
        }
    };
    serve::<Trigger, _>(node, &name("reset"), tasks, answer)?;
    let queue = Arc::clone(inbox);
    serve::<SetBool, _>(node, &name("pause"), tasks, move |request| {
        let paused = request.data;
        let answer = ask_with(&queue, |answer| Command::Pause(paused, answer));
        async move {
            let said = if paused { "paused" } else { "going on" };
            let (success, message) = outcome(answer.await, said);
            SetBoolResponse { success, message }
        }
    })?;
    let queue = Arc::clone(inbox);
    serve::<SaveMap, _>(node, &name("save_map"), tasks, move |request| {
        let answer = ask_with(&queue, |answer| Command::Save(request.path, answer));
        async move {
            let (success, message) = outcome(answer.await, "");
            SaveMapResponse { success, message }
        }
    })?;
    let queue = Arc::clone(inbox);
    serve::<LoadMap, _>(node, &name("load_map"), tasks, move |request| {
        let answer = ask_with(&queue, |answer| Command::Load(request.path, answer));
        async move {
            let (success, message) = outcome(answer.await, "");
            LoadMapResponse { success, message, objects: 0 }
        }
    })
}
