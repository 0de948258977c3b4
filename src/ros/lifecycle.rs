//! The states of a managed node and the ways between them, with the ids and labels of `rcl_lifecycle`.

/// A state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// There is no map; nothing is perceived.
    #[default]
    Unconfigured = 1,
    /// The map stays as it is; nothing is perceived.
    Inactive = 2,
    /// Images become a map.
    Active = 3,
    /// The node ends.
    Finalized = 4,
    /// On the way to inactive.
    Configuring = 10,
    /// On the way to unconfigured.
    CleaningUp = 11,
    /// On the way to finalized.
    ShuttingDown = 12,
    /// On the way to active.
    Activating = 13,
    /// On the way to inactive.
    Deactivating = 14,
}

/// A way from one state to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// Its number on the wire.
    pub id: u8,
    /// Its name on the wire.
    pub label: &'static str,
    /// Where it begins.
    pub from: State,
    /// Where it leads.
    pub to: State,
}

/// The transitions that can be asked for. They lead to states in which a node is on its way.
pub const REQUESTS: [Transition; 7] = {
    use State::*;
    [
        transition(1, "configure", Unconfigured, Configuring),
        transition(2, "cleanup", Inactive, CleaningUp),
        transition(3, "activate", Inactive, Activating),
        transition(4, "deactivate", Active, Deactivating),
        transition(5, "shutdown", Unconfigured, ShuttingDown),
        transition(6, "shutdown", Inactive, ShuttingDown),
        transition(7, "shutdown", Active, ShuttingDown),
    ]
};

/// The transitions that follow by themselves, to states in which a node stays.
pub const ARRIVALS: [Transition; 5] = {
    use State::*;
    [
        transition(10, ARRIVED, Configuring, Inactive),
        transition(20, ARRIVED, CleaningUp, Unconfigured),
        transition(30, ARRIVED, Activating, Active),
        transition(40, ARRIVED, Deactivating, Inactive),
        transition(50, ARRIVED, ShuttingDown, Finalized),
    ]
};

const ARRIVED: &str = "transition_success";

const fn transition(id: u8, label: &'static str, from: State, to: State) -> Transition {
    Transition { id, label, from, to }
}

/// The two transitions that a request leads through, which names the first by its label or, where that is empty, by its id.
/// Nothing where there is none from this state.
pub fn ways(from: State, label: &str, id: u8) -> Option<[Transition; 2]> {
    let is_meant = |way: &&Transition| {
        way.from == from && if label.is_empty() { way.id == id } else { way.label == label }
    };
    let first = REQUESTS.iter().find(is_meant)?;
    let second = ARRIVALS.iter().find(|way| way.from == first.to)?;
    Some([*first, *second])
}

impl State {
    /// All states.
    pub const ALL: [Self; 9] = [
        Self::Unconfigured,
        Self::Inactive,
        Self::Active,
        Self::Finalized,
        Self::Configuring,
        Self::CleaningUp,
        Self::ShuttingDown,
        Self::Activating,
        Self::Deactivating,
    ];

    /// Its number on the wire.
    pub const fn id(self) -> u8 {
        self as u8
    }

    /// Its name on the wire.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Unconfigured => "unconfigured",
            Self::Inactive => "inactive",
            Self::Active => "active",
            Self::Finalized => "finalized",
            Self::Configuring => "configuring",
            Self::CleaningUp => "cleaningup",
            Self::ShuttingDown => "shuttingdown",
            Self::Activating => "activating",
            Self::Deactivating => "deactivating",
        }
    }
}
