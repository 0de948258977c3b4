//! Profiles of quality of service.

use crate::config::Qos;
use ros2_client::{
    QosProfile,
    qos::{Durability, History, WhenFull},
};
use std::time::Duration;

/// Of an input.
pub(super) fn input(qos: Qos, depth: usize) -> QosProfile {
    let profile = QosProfile::subscription_default().history(History::KeepLast { depth });
    match qos {
        Qos::SensorData => profile,
        Qos::Reliable => profile.reliability_reliable(WhenFull::DEFAULT),
    }
}

/// Of `/tf`, as tf2 has it.
pub(super) fn tf() -> QosProfile {
    stream(TF_DEPTH)
}

/// Of `/tf_static`, as tf2 has it: what was said before one came is what matters.
pub(super) fn tf_static() -> QosProfile {
    stream(TF_DEPTH).durability(Durability::TransientLocal)
}

/// Of a stream of outputs.
pub(super) fn stream(depth: usize) -> QosProfile {
    QosProfile::publisher_default().history(History::KeepLast { depth })
}

/// Of an output that holds all there is: who comes later gets the last one.
pub(super) fn latched() -> QosProfile {
    stream(1).durability(Durability::TransientLocal)
}

/// Of log lines, as rcl has it but for the depth: who comes later gets the latest.
pub(super) fn log(depth: usize) -> QosProfile {
    let lifespan = Some(Duration::from_secs(10));
    stream(depth).durability(Durability::TransientLocal).lifespan(lifespan)
}

/// Of services.
pub(super) fn service() -> QosProfile {
    stream(10)
}

/// Messages of `/tf` kept until they are read.
const TF_DEPTH: usize = 100;
