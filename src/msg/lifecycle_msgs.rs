//! The ROS package `lifecycle_msgs`: states of managed nodes, and the ways between them.

use crate::msg::{Message, Service};
use serde::{Deserialize, Serialize};

/// A state.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    /// 1 to 4 for those in which a node stays, 10 and above while it is on its way.
    pub id: u8,
    /// Its name.
    pub label: String,
}

/// A way from one state to another.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transition {
    /// 1 to 7 for those that can be asked for.
    pub id: u8,
    /// Its name. In a request it counts rather than the id, unless it is empty.
    pub label: String,
}

/// A transition with its ends.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionDescription {
    /// Which one.
    pub transition: Transition,
    /// Where it begins.
    pub start_state: State,
    /// Where it leads.
    pub goal_state: State,
}

/// A transition that a node has made.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionEvent {
    /// When (ns).
    pub timestamp: u64,
    /// Which one.
    pub transition: Transition,
    /// Where it began.
    pub start_state: State,
    /// Where it led.
    pub goal_state: State,
}

/// Declares that a type is a message of this package.
macro_rules! message {
    ($($name:ident)+) => {
        $(impl Message for $name {
            const TYPE: &'static str = concat!("lifecycle_msgs/msg/", stringify!($name));
        })+
    };
}

message!(State Transition TransitionDescription TransitionEvent);

/// Asks a node for a transition.
#[derive(Clone, Copy, Debug)]
pub struct ChangeState;

/// Which one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangeStateRequest {
    /// By its label or, without one, by its id.
    pub transition: Transition,
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangeStateResponse {
    /// Whether the node made it.
    pub success: bool,
}

impl Service for ChangeState {
    const TYPE: &'static str = "lifecycle_msgs/srv/ChangeState";
    type Request = ChangeStateRequest;
    type Response = ChangeStateResponse;
}

/// Nothing, as the generators of ROS 2 write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EmptyRequest {
    /// Always zero.
    pub structure_needs_at_least_one_member: u8,
}

/// Asks for the present state.
#[derive(Clone, Copy, Debug)]
pub struct GetState;

/// The answer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetStateResponse {
    /// The present state.
    pub current_state: State,
}

impl Service for GetState {
    const TYPE: &'static str = "lifecycle_msgs/srv/GetState";
    type Request = EmptyRequest;
    type Response = GetStateResponse;
}

/// Asks for the states that there are.
#[derive(Clone, Copy, Debug)]
pub struct GetAvailableStates;

/// The answer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetAvailableStatesResponse {
    /// All of them.
    pub available_states: Vec<State>,
}

impl Service for GetAvailableStates {
    const TYPE: &'static str = "lifecycle_msgs/srv/GetAvailableStates";
    type Request = EmptyRequest;
    type Response = GetAvailableStatesResponse;
}

/// Asks for transitions: those of the present state, or all, by the service's name.
#[derive(Clone, Copy, Debug)]
pub struct GetAvailableTransitions;

/// The answer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GetAvailableTransitionsResponse {
    /// With their ends.
    pub available_transitions: Vec<TransitionDescription>,
}

impl Service for GetAvailableTransitions {
    const TYPE: &'static str = "lifecycle_msgs/srv/GetAvailableTransitions";
    type Request = EmptyRequest;
    type Response = GetAvailableTransitionsResponse;
}
