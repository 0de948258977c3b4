//! Log lines as ROS 2 nodes write them: `[INFO] [1712345678.123456789] [ellipsoid_slam]: text`.

use super::{rosout::said, status::system_time};
use std::{env, fmt, io::IsTerminal};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::{
    fmt::{FmtContext, FormatEvent, FormatFields, format::Writer},
    registry::LookupSpan,
};

/// The form of the lines of a logger.
pub struct LogForm {
    logger: String,
    colored: bool,
}

impl LogForm {
    /// For a logger that writes to standard error.
    pub fn of(logger: String) -> Self {
        Self { logger, colored: is_colored() }
    }
}

/// Whether lines on standard error have colours: on a terminal, unless the environment says otherwise.
pub fn is_colored() -> bool {
    match env::var("RCUTILS_COLORIZED_OUTPUT").as_deref() {
        Ok("0") => false,
        Ok("1") => true,
        _ => env::var_os("NO_COLOR").is_none() && std::io::stderr().is_terminal(),
    }
}

impl<S, N> FormatEvent<S, N> for LogForm
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        _: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        let (severity, color) = match *event.metadata().level() {
            Level::ERROR => ("ERROR", "\x1b[31m"),
            Level::WARN => ("WARN", "\x1b[33m"),
            Level::INFO => ("INFO", ""),
            Level::DEBUG | Level::TRACE => ("DEBUG", "\x1b[32m"),
        };
        let color = if self.colored { color } else { "" };
        let end = if color.is_empty() { "" } else { "\x1b[0m" };
        let (logger, nanos) = (&self.logger, system_time().as_nanos());
        let (seconds, rest) = (nanos / 1_000_000_000, nanos % 1_000_000_000);
        let text = said(event);
        writeln!(writer, "{color}[{severity}] [{seconds}.{rest:09}] [{logger}]: {text}{end}")
    }
}
