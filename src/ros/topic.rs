//! How messages are sent.

use super::transport::{NotSent, Publisher};
use crate::msg::Message;

/// Publishes; a subscriber that is too slow must not stop the node.
pub(super) fn send<M: Message>(publisher: &Publisher<M>, message: M) {
    match publisher.publish(message) {
        Ok(()) => (),
        Err(NotSent::NoRoom(_)) => tracing::debug!("a subscriber missed a {}", M::TYPE),
        Err(NotSent::Failed(why)) => tracing::debug!("a {} was not sent: {why}", M::TYPE),
    }
}

/// A topic whose last message holds all there is: as long as a slow subscriber leaves no room for it, it waits for that
/// or for a newer one.
pub(super) struct Latched<M: Message> {
    publisher: Publisher<M>,
    waiting: Option<M>,
}

impl<M: Message> Latched<M> {
    pub(super) fn new(publisher: Publisher<M>) -> Self {
        Self { publisher, waiting: None }
    }

    pub(super) fn send(&mut self, message: M) {
        self.waiting = Some(message);
        self.send_waiting();
    }

    pub(super) fn send_waiting(&mut self) {
        let Some(message) = self.waiting.take() else { return };
        match self.publisher.publish(message) {
            Ok(()) => (),
            Err(NotSent::NoRoom(message)) => self.waiting = Some(message),
            Err(NotSent::Failed(why)) => tracing::debug!("a {} was not sent: {why}", M::TYPE),
        }
    }
}
