//! What could not be used of the messages, counted by topic and reason.

use super::convert::ConvertError;
use std::collections::BTreeMap;
use thiserror::Error;

/// A message, or a part of one, that was left out.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{topic}: {why}")]
pub struct Skipped {
    /// Topic.
    pub topic: String,
    /// Why.
    pub why: ConvertError,
}

impl Skipped {
    /// A short, stable key for counting.
    pub fn reason(&self) -> &'static str {
        self.why.reason()
    }
}

/// How many messages, boxes and transforms were left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkipCount {
    by_reason: BTreeMap<(String, &'static str), (u64, Skipped)>,
}

impl SkipCount {
    /// Notes one more.
    pub fn add(&mut self, skipped: Skipped) {
        let key = (skipped.topic.clone(), skipped.reason());
        self.by_reason.entry(key).or_insert((0, skipped)).0 += 1;
    }

    /// Topic, reason, how many, and the first of them; by topic and reason.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &'static str, u64, &Skipped)> {
        let entries = self.by_reason.iter();
        entries.map(|((topic, reason), (count, first))| (topic.as_str(), *reason, *count, first))
    }

    /// How many were left out in all.
    pub fn total(&self) -> u64 {
        self.by_reason.values().map(|(count, _)| count).sum()
    }
}
