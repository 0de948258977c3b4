//! Services of a managed node: whoever calls them moves it from state to state.

use super::{
    lifecycle::{ARRIVALS, REQUESTS, State, Transition, ways},
    node::NotCreated,
    qos,
    services::{Orders, serve},
    topic::send,
    transport::{Node, Publisher},
    worker::Command,
};
use crate::{
    config::RosArguments,
    msg::lifecycle_msgs::{
        self as wire, ChangeState, ChangeStateResponse, GetAvailableStates,
        GetAvailableStatesResponse, GetAvailableTransitions, GetAvailableTransitionsResponse,
        GetState, GetStateResponse, TransitionDescription, TransitionEvent,
    },
};
use std::{future::ready, rc::Rc, sync::Arc};
use tokio::{sync::Notify, task::LocalSet};

/// Does what a manager asks for.
struct Managed {
    orders: Orders,
    events: Publisher<TransitionEvent>,
    stop: Arc<Notify>,
}

/// Starts the services; `stop` is told when the node is to end.
pub(super) fn serve_lifecycle(
    node: &mut Node,
    arguments: &RosArguments,
    orders: &Orders,
    stop: &Arc<Notify>,
    tasks: &LocalSet,
) -> Result<(), NotCreated> {
    let name = |service: &str| arguments.resolve(&format!("~/{service}"));
    let status = orders.status.clone();
    serve::<GetState, _>(node, &name("get_state"), tasks, move |_| {
        ready(GetStateResponse { current_state: status.lock().state.into() })
    })?;
    serve::<GetAvailableStates, _>(node, &name("get_available_states"), tasks, |_| {
        let available_states = State::ALL.into_iter().map(Into::into).collect();
        ready(GetAvailableStatesResponse { available_states })
    })?;
    let status = orders.status.clone();
    serve::<GetAvailableTransitions, _>(
        node,
        &name("get_available_transitions"),
        tasks,
        move |_| {
            let state = status.lock().state;
            ready(described(REQUESTS.iter().filter(|way| way.from == state)))
        },
    )?;
    serve::<GetAvailableTransitions, _>(node, &name("get_transition_graph"), tasks, |_| {
        ready(described(REQUESTS.iter().chain(&ARRIVALS)))
    })?;
    let events = node.publisher(&name("transition_event"), &qos::stream(EVENTS))?;
    let managed = Rc::new(Managed { orders: orders.clone(), events, stop: Arc::clone(stop) });
    serve::<ChangeState, _>(node, &name("change_state"), tasks, move |request| {
        let managed = Rc::clone(&managed);
        async move {
            let outcome = managed.change(&request.transition).await;
            if let Err(why) = &outcome {
                tracing::warn!("change_state: {why}");
            }
            ChangeStateResponse { success: outcome.is_ok() }
        }
    })
}

impl Managed {
    async fn change(&self, asked: &wire::Transition) -> Result<(), String> {
        let wire::Transition { id, label } = asked;
        let from = self.orders.status.lock().state;
        let Some([first, second]) = ways(from, label, *id) else {
            let asked = if label.is_empty() { id.to_string() } else { format!("`{label}`") };
            return Err(format!("no transition {asked} begins at `{}`", from.label()));
        };
        self.enter(second.to).await?;
        tracing::info!("{}: the node is {}", first.label, second.to.label());
        let now = self.orders.status.lock().ros_time();
        let timestamp = u64::try_from(now.as_nanos()).unwrap_or_default();
        for way in [&first, &second] {
            let TransitionDescription { transition, start_state, goal_state } = way.into();
            send(&self.events, TransitionEvent { timestamp, transition, start_state, goal_state });
        }
        Ok(())
    }

    async fn enter(&self, state: State) -> Result<(), String> {
        let orders = &self.orders;
        if state == State::Finalized {
            // The worker ends in the state that it is in, as with a signal.
            orders.status.lock().state = state;
            self.stop.notify_one();
            return Ok(());
        }
        orders.inbox.activate(state == State::Active);
        orders.begin_anew(|answer| Command::Enter(state, answer)).get().await?.map(drop)
    }
}

fn described<'a>(ways: impl Iterator<Item = &'a Transition>) -> GetAvailableTransitionsResponse {
    GetAvailableTransitionsResponse { available_transitions: ways.map(Into::into).collect() }
}

impl From<State> for wire::State {
    fn from(state: State) -> Self {
        Self { id: state.id(), label: state.label().to_owned() }
    }
}

impl From<&Transition> for TransitionDescription {
    fn from(way: &Transition) -> Self {
        let transition = wire::Transition { id: way.id, label: way.label.to_owned() };
        Self { transition, start_state: way.from.into(), goal_state: way.to.into() }
    }
}

/// Events kept for a reader that has to ask again.
const EVENTS: usize = 10;
