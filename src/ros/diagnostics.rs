//! `/diagnostics`, once a second: rates, ages, what was dropped and why, and what is wrong.

use super::{
    discovery,
    inbox::{Inbox, Overflow},
    problems::{Problem, Problems},
    progress::Progress,
    status::{Shared, Status, now},
    subscriptions::Inputs,
    topic::send,
    transport::{Graph, Publisher},
};
use crate::{
    msg::{
        convert::header,
        diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    },
    pipeline::Calibration,
};
use std::{
    collections::BTreeMap,
    sync::Arc,
    time::{Duration, Instant},
};
use tokio::time::{MissedTickBehavior, interval};

/// Looks after the node.
pub(super) struct Diagnostics {
    pub(super) publisher: Publisher<DiagnosticArray>,
    pub(super) node: String,
    pub(super) inputs: Inputs,
    pub(super) graph: Graph,
    pub(super) inbox: Arc<Inbox>,
    pub(super) status: Shared,
    pub(super) problems: Problems,
    pub(super) before: Counts,
    pub(super) progress: Progress,
}

/// What had been counted the last time.
#[derive(Debug, Default)]
pub(super) struct Counts {
    at: Option<Instant>,
    /// Since when each topic has had publishers.
    published: BTreeMap<String, Instant>,
    received: BTreeMap<String, u64>,
    skipped: BTreeMap<(String, &'static str), u64>,
    dropped: BTreeMap<&'static str, u64>,
    overflow: Overflow,
    jumps: u64,
}

/// A topic that has been silent for so long is a problem.
const SILENT: Duration = Duration::from_secs(5);
/// Publishers need this time to be found.
const PATIENCE: Duration = Duration::from_secs(3);
/// Reasons that come with every start: the first images come before the first odometry.
const STARTING: [&str; 3] = ["no_camera_info", "no_odometry", "no_transform"];

impl Diagnostics {
    /// Publishes until it is cancelled.
    pub(super) async fn run(mut self) {
        let started = now();
        let mut ticks = interval(Duration::from_secs(1));
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            ticks.tick().await;
            let now = now();
            if now - started < PATIENCE {
                continue;
            }
            let found = self.look(now);
            self.problems.note(found, now);
            {
                let inputs = self.inputs.borrow();
                let seen = (&inputs.listening[..], self.before.overflow.depth);
                self.progress.say(seen, &self.status.lock(), now);
            }
            let array = self.report(now);
            send(&self.publisher, array);
        }
    }

    /// What is wrong now.
    fn look(&mut self, now: Instant) -> Vec<Problem> {
        let inputs = self.inputs.borrow();
        let mut found = discovery::problems(&inputs.listening, &self.graph.publishers());
        let missing = inputs.missing.iter();
        found.extend(missing.map(|what| Problem::new("no_topic", "", what.clone())));
        if self.graph.has_another(&self.node) {
            found.push(discovery::same_name(&self.node));
        }
        let overflow = self.inbox.dropped();
        let status = self.status.lock();
        found.extend(
            status
                .calibration
                .sentences()
                .into_iter()
                .map(|what| Problem::new("calibration", "", what)),
        );
        for input in inputs.listening.iter().filter(|input| input.needed) {
            let topic = &input.topic;
            if found.iter().any(|problem| problem.what.contains(topic)) {
                self.before.published.remove(topic);
                continue;
            }
            let published = *self.before.published.entry(topic.clone()).or_insert(now);
            let latest = status.inputs.get(topic).and_then(|known| known.latest);
            if now - latest.map_or(published, |latest| latest.max(published)) > SILENT {
                let what = format!("{topic} ({}) has a publisher, but nothing comes", input.role);
                found.push(Problem::new("silent", topic, what));
            }
        }
        for (topic, reason, count, latest) in status.skipped.iter() {
            let before = self.before.skipped.insert((topic.to_owned(), reason), count);
            if count > before.unwrap_or(0) {
                found.push(Problem::new(reason, topic, latest.to_string()));
            }
        }
        for (reason, (count, why)) in &status.dropped {
            let before = self.before.dropped.insert(reason, *count).unwrap_or(0);
            // A few are dropped until the first of everything has come.
            let first = STARTING.contains(reason) && *count <= 3;
            if *count > before && !first {
                found.push(Problem::new(reason, "", why.clone()));
            }
        }
        if overflow.depth > self.before.overflow.depth {
            let what = format!(
                "{} depth images came while the ones before were worked on, and were dropped",
                overflow.depth - self.before.overflow.depth
            );
            found.push(Problem::new("overflow", "", what));
        }
        if let Some(jump) = &status.jump
            && jump.count > self.before.jumps
        {
            self.before.jumps = jump.count;
            found.push(Problem::new("time_jumped_back", &jump.topic, jump.what()));
        }
        self.before.overflow = overflow;
        found
    }

    fn report(&mut self, now: Instant) -> DiagnosticArray {
        let problems: Vec<String> = self.problems.iter().map(|(_, what)| what.to_owned()).collect();
        let elapsed = self.before.at.replace(now).map_or(1.0, |at| (now - at).as_secs_f64());
        let status = self.status.lock();
        let mut values = Vec::new();
        for input in &self.inputs.borrow().listening {
            let known = status.inputs.get(&input.topic).cloned().unwrap_or_default();
            let before =
                self.before.received.insert(input.topic.clone(), known.received).unwrap_or(0);
            let rate = (known.received - before) as f64 / elapsed;
            let age = known
                .latest
                .map_or("never".into(), |at| format!("{:.1} s ago", (now - at).as_secs_f64()));
            values.push((input.topic.clone(), format!("{rate:.1} Hz, {age}")));
        }
        let inputs = self.status_of("inputs", &problems, values);
        let mapping = self.status_of("mapping", &[], mapping(&status, self.before.overflow));
        let stamp = status.ros_time();
        DiagnosticArray { header: header(stamp, ""), status: vec![inputs, mapping] }
    }

    fn status_of(
        &self,
        part: &str,
        problems: &[String],
        values: Vec<(String, String)>,
    ) -> DiagnosticStatus {
        let values = values.into_iter().map(|(key, value)| KeyValue { key, value }).collect();
        let level = if problems.is_empty() { DiagnosticStatus::OK } else { DiagnosticStatus::WARN };
        let message = if problems.is_empty() { "works".into() } else { problems.join("; ") };
        let (node, hardware_id) = (self.node.trim_start_matches('/'), String::new());
        DiagnosticStatus { level, name: format!("{node}: {part}"), message, hardware_id, values }
    }
}

/// What the worker has done.
fn mapping(status: &Status, overflow: Overflow) -> Vec<(String, String)> {
    let milliseconds = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1e3);
    let mut values = vec![
        ("objects", status.objects.to_string()),
        ("keyframes", status.keyframes.to_string()),
        ("frames", status.frames.to_string()),
        ("latest keyframe", milliseconds(status.keyframe_time)),
        ("longest keyframe", milliseconds(status.longest_keyframe)),
        ("paused", status.paused.to_string()),
        ("state", status.state.label().to_owned()),
        ("dropped: overflow", overflow.depth.to_string()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect::<Vec<_>>();
    let Calibration { roll_rad, pitch_rad, stamp_offset_s, .. } = status.calibration;
    values.extend([
        ("camera lower than TF".into(), format!("{:.1} deg", pitch_rad.to_degrees())),
        ("camera leaning to the right of TF".into(), format!("{:.1} deg", roll_rad.to_degrees())),
        ("odometry later than images".into(), format!("{:.0} ms", 1e3 * stamp_offset_s)),
    ]);
    let unrecognised = status.unrecognised.iter();
    values.extend(
        unrecognised.map(|why| ("loaded map".into(), format!("not recognised yet: {why}"))),
    );
    let dropped = status.dropped.iter();
    values.extend(dropped.map(|(reason, (n, _))| (format!("dropped: {reason}"), n.to_string())));
    let skipped = status.skipped.iter();
    values.extend(
        skipped.map(|(topic, reason, n, _)| (format!("skipped: {reason} {topic}"), n.to_string())),
    );
    values
}
