//! Which network a process takes part in, from the variables that all of ROS 2 reads.

use std::env;
use thiserror::Error;

/// The network that ROS 2's environment variables describe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Domain {
    /// `ROS_DOMAIN_ID`.
    pub id: u16,
    /// Nothing leaves this machine: `ROS_LOCALHOST_ONLY=1` or `ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`. Zenoh has its
    /// own settings for that.
    pub local_only: bool,
    /// `RMW_IMPLEMENTATION`.
    pub middleware: Middleware,
}

/// What carries the messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Middleware {
    /// DDS, for each of ROS 2's DDS implementations.
    #[default]
    Dds,
    /// Zenoh as `rmw_zenoh_cpp` speaks it.
    Zenoh,
}

/// Why there is no access to the network.
#[derive(Debug, Error)]
pub enum DomainError {
    /// A domain id that DDS does not have.
    #[error("ROS_DOMAIN_ID is `{given}`, but it must be a number from 0 to {LAST_DOMAIN}")]
    BadId {
        /// What the variable says.
        given: String,
    },
    /// A discovery range that is not known here.
    #[error(
        "ROS_AUTOMATIC_DISCOVERY_RANGE is `{given}`; SUBNET and LOCALHOST are supported here, \
         OFF and SYSTEM_DEFAULT are not"
    )]
    UnknownRange {
        /// What the variable says.
        given: String,
    },
    /// Zenoh is asked for and not there.
    #[error(
        "RMW_IMPLEMENTATION asks for Zenoh, but this program was built without it: build it with `--features zenoh`"
    )]
    WithoutZenoh,
    /// Security is asked for and not there.
    #[error(
        "ROS_SECURITY_ENABLE is true and ROS_SECURITY_STRATEGY is Enforce, but this program has no security (SROS 2): it does \
         not start without it; without Enforce it takes part unprotected"
    )]
    WithoutSecurity,
    /// A middleware that did not start.
    #[error("{middleware} does not start in domain {id}: {problem}")]
    NotStarted {
        /// DDS or Zenoh.
        middleware: &'static str,
        /// The domain.
        id: u16,
        /// What it said.
        problem: String,
    },
}

/// Ports of higher domains would not fit 16 bits.
const LAST_DOMAIN: u16 = 232;

impl Domain {
    /// From the environment.
    ///
    /// # Errors
    /// When a variable has a value that cannot be honoured.
    pub fn from_environment() -> Result<Self, DomainError> {
        let value = |name| env::var(name).ok().filter(|text| !text.is_empty());
        // As rcl reads them: anything else means that security may be missing.
        let is_secured = value("ROS_SECURITY_ENABLE").is_some_and(|enable| enable == "true");
        if is_secured && value("ROS_SECURITY_STRATEGY").is_some_and(|it| it == "Enforce") {
            return Err(DomainError::WithoutSecurity);
        }
        let id = match value("ROS_DOMAIN_ID") {
            None => 0,
            Some(given) => match given.parse() {
                Ok(id) if id <= LAST_DOMAIN => id,
                _ => return Err(DomainError::BadId { given }),
            },
        };
        // The older variable wins where both are set, as in rcl.
        let local_only = match value("ROS_LOCALHOST_ONLY").as_deref() {
            Some("1") => true,
            _ => match value("ROS_AUTOMATIC_DISCOVERY_RANGE").as_deref() {
                None | Some("SUBNET") => false,
                Some("LOCALHOST") => true,
                Some(given) => return Err(DomainError::UnknownRange { given: given.into() }),
            },
        };
        let middleware = match value("RMW_IMPLEMENTATION").as_deref() {
            Some("rmw_zenoh_cpp") => Middleware::Zenoh,
            _ => Middleware::Dds,
        };
        Ok(Self { id, local_only, middleware })
    }
}
