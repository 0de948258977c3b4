//! What is wrong, said once and then rarely, for as long as it is wrong.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

/// Something that the user should know, and can often mend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Problem {
    /// A short, stable key.
    pub(super) kind: &'static str,
    /// The topic, or whatever else it is about.
    about: String,
    /// A sentence that names it.
    pub(super) what: String,
}

impl Problem {
    pub(super) fn new(kind: &'static str, about: &str, what: String) -> Self {
        Self { kind, about: about.to_owned(), what }
    }
}

/// The problems there are at present.
#[derive(Debug, Default)]
pub(super) struct Problems {
    current: BTreeMap<(&'static str, String), Lasting>,
}

#[derive(Debug)]
struct Lasting {
    what: String,
    said: Instant,
    seen: Instant,
}

/// A problem that lasts is said again after this time.
const SAY_AGAIN: Duration = Duration::from_secs(60);
/// What was counted once stays in diagnostics for this time, so that one who looks sees it.
const LINGER: Duration = Duration::from_secs(10);

impl Problems {
    /// Notes what is wrong now and logs what is new, lasts for long, or is over.
    pub(super) fn note(&mut self, found: Vec<Problem>, now: Instant) {
        for Problem { kind, about, what } in found {
            match self.current.get_mut(&(kind, about.clone())) {
                None => {
                    tracing::warn!("{what}");
                    self.current.insert((kind, about), Lasting { what, said: now, seen: now });
                }
                Some(lasting) => {
                    lasting.seen = now;
                    lasting.what = what;
                    if now - lasting.said >= SAY_AGAIN {
                        tracing::warn!("still: {}", lasting.what);
                        lasting.said = now;
                    }
                }
            }
        }
        self.current.retain(|_, lasting| {
            let lasts = now - lasting.seen < LINGER;
            if !lasts {
                tracing::info!("no longer: {}", lasting.what);
            }
            lasts
        });
    }

    /// Kind and sentence of each.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.current.iter().map(|((kind, _), lasting)| (*kind, lasting.what.as_str()))
    }
}
