//! `/rosout`: what the node says, for `rqt_console` and `ros2 topic echo /rosout`.

use super::{
    node::NotCreated,
    qos,
    status::system_time,
    transport::{Node, Publisher},
};
use crate::msg::Message;
use ros2_client::{
    builtin_interfaces::Time,
    log::{Log, LogLevel},
};
use std::fmt::{Debug, Write};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tracing::{Event, Level, Subscriber, field::Visit};
use tracing_subscriber::{Layer, layer::Context};

impl Message for Log {
    const TYPE: &'static str = "rcl_interfaces/msg/Log";
}

/// Takes log lines to [`LogLines`].
pub struct LogLayer(Sender<Log>);

/// Log lines that wait for a node to publish them.
pub struct LogLines(Receiver<Log>);

/// A layer for a `tracing` subscriber, and where its lines come out. What is more than can wait is left out.
pub fn log_lines() -> (LogLayer, LogLines) {
    let (sender, receiver) = channel(MOST_LINES);
    (LogLayer(sender), LogLines(receiver))
}

const MOST_LINES: usize = 100;

impl<S: Subscriber> Layer<S> for LogLayer {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let about = event.metadata();
        let line = Log {
            stamp: Time::from_nanos(system_time().as_nanos()),
            level: level(*about.level()) as u8,
            // The node's name comes when it is published.
            name: String::new(),
            msg: said(event),
            file: about.file().unwrap_or_default().to_owned(),
            function: about.target().to_owned(),
            line: about.line().unwrap_or_default(),
        };
        // Whoever is not heard must not be waited for.
        let _ = self.0.try_send(line);
    }
}

fn level(level: Level) -> LogLevel {
    match level {
        Level::ERROR => LogLevel::Error,
        Level::WARN => LogLevel::Warn,
        Level::INFO => LogLevel::Info,
        Level::DEBUG | Level::TRACE => LogLevel::Debug,
    }
}

/// The words of an event.
pub(super) fn said(event: &Event<'_>) -> String {
    let mut text = Text::default();
    event.record(&mut text);
    text.0
}

#[derive(Default)]
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &tracing::field::Field, value: &dyn Debug) {
        if field.name() == "message" {
            // Writing into a string does not fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}

impl LogLines {
    /// Publishes them under the name of a logger, until it is cancelled.
    pub(super) fn publish(
        mut self,
        node: &mut Node,
        logger: String,
    ) -> Result<impl Future<Output = ()> + 'static, NotCreated> {
        let publisher: Publisher<Log> = node.publisher("/rosout", &qos::log(MOST_LINES))?;
        Ok(async move {
            while let Some(line) = self.0.recv().await {
                // A complaint would be the next line to be published.
                let _ = publisher.publish(Log { name: logger.clone(), ..line });
            }
        })
    }
}
