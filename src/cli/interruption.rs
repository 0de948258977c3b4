//! What is done before a signal ends the program.

use super::Command;
use crate::io::remove_unfinished;
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    iterator::Signals,
    low_level::emulate_default_handler,
};
use std::{io, thread};

/// From now on, who interrupts the program finds no half-written files. It still ends at once, by the signal.
pub(super) fn clean_up_when_interrupted() -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    thread::Builder::new().name("signals".into()).spawn(move || {
        for signal in signals.forever() {
            remove_unfinished();
            // Does not return for these; a process that cannot end itself goes on.
            let _ = emulate_default_handler(signal);
        }
    })?;
    Ok(())
}

impl Command {
    /// Whether it does something itself when it is interrupted.
    pub(super) fn ends_itself(&self) -> bool {
        match self {
            #[cfg(feature = "ros")]
            Self::Node(_) | Self::Play(_) => true,
            _ => false,
        }
    }
}
