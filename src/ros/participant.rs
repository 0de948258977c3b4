//! Which network a process takes part in, from the variables that all of ROS 2 reads.

use ros2_client::{Context, dds::rustdds::DomainParticipantBuilder};
use std::{env, net::Ipv4Addr};
use thiserror::Error;

/// The network that ROS 2's environment variables describe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DdsDomain {
    /// `ROS_DOMAIN_ID`.
    pub id: u16,
    /// Nothing leaves this machine: `ROS_LOCALHOST_ONLY=1` or `ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`.
    pub local_only: bool,
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
    /// DDS did not start.
    #[error("DDS does not start in domain {id}: {problem}")]
    NotStarted {
        /// The domain.
        id: u16,
        /// What it said.
        problem: String,
    },
}

/// Ports of higher domains would not fit 16 bits.
const LAST_DOMAIN: u16 = 232;

impl DdsDomain {
    /// From the environment.
    ///
    /// # Errors
    /// When a variable has a value that cannot be honoured.
    pub fn from_environment() -> Result<Self, DomainError> {
        let value = |name| env::var(name).ok().filter(|text| !text.is_empty());
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
        Ok(Self { id, local_only })
    }

    /// Takes part in the network.
    pub(super) fn join(self) -> Result<Context, DomainError> {
        let failed = |problem: String| DomainError::NotStarted { id: self.id, problem };
        let mut builder = DomainParticipantBuilder::new(self.id);
        if self.local_only {
            builder = builder.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let participant = builder.build().map_err(|e| failed(e.to_string()))?;
        Context::from_domain_participant(participant).map_err(|e| failed(e.to_string()))
    }
}
