//! What a bag's streams lack: a camera or odometry that falls silent, a clock that goes back.

use crate::{pipeline::Input, time::Stamp};

/// Silence that is worth a word (s); a live node waits as long.
const SILENCE_S: f64 = 5.0;
/// Stamps of two topics may differ by the time that an image takes; more is a restart (s).
const JUMP_S: f64 = 1.0;

/// The streams that never pause while a robot is awake.
#[derive(Debug)]
pub(super) struct Streams {
    depth: Stream,
    odometry: Stream,
    /// The data's present.
    present: Option<Stamp>,
    /// The first jump back: from, to.
    jump: Option<(Stamp, Stamp)>,
    jumps: usize,
}

#[derive(Debug)]
struct Stream {
    what: &'static str,
    /// When its latest message was recorded.
    latest: Option<Stamp>,
    /// The longest time between two messages (s), and when it began.
    longest: Option<(f64, Stamp)>,
}

impl Default for Streams {
    fn default() -> Self {
        let stream = |what| Stream { what, latest: None, longest: None };
        Self {
            depth: stream("depth image"),
            odometry: stream("odometry"),
            present: None,
            jump: None,
            jumps: 0,
        }
    }
}

impl Streams {
    /// A message that was recorded at `logged`.
    pub(super) fn hear(&mut self, input: &Input, logged: Stamp) {
        let (stream, stamp) = match input {
            Input::Depth(depth) => (&mut self.depth, depth.stamp),
            Input::Odometry(odometry) => (&mut self.odometry, odometry.stamp),
            _ => return,
        };
        stream.hear(logged);
        let back_s = self.present.map_or(0.0, |present| present.seconds_since(stamp));
        if let Some(present) = self.present.filter(|_| back_s >= JUMP_S) {
            self.jump.get_or_insert((present, stamp));
            self.jumps += 1;
        }
        self.present = Some(stamp);
    }

    /// What was missing, as sentences; the last message of the bag was recorded at `end`.
    pub(super) fn warnings(&mut self, end: Stamp) -> Vec<String> {
        let mut warnings = Vec::new();
        for stream in [&mut self.depth, &mut self.odometry] {
            let Some(latest) = stream.latest else { continue };
            let silent_s = end.seconds_since(latest);
            if silent_s >= SILENCE_S {
                let what = stream.what;
                warnings.push(format!(
                    "no {what} came in the last {silent_s:.1} s of the bag, after {latest}"
                ));
            }
            if let Some((gap_s, from)) = stream.longest {
                let what = stream.what;
                warnings.push(format!("no {what} came for {gap_s:.1} s after {from}"));
            }
        }
        if let Some((from, to)) = self.jump {
            let back_s = from.seconds_since(to);
            let times = if self.jumps > 1 {
                format!("{} times, first ", self.jumps)
            } else {
                String::new()
            };
            warnings.push(format!(
                "the clock went back {times}by {back_s:.1} s at {from}: what waited for its partners was dropped, the map is kept"
            ));
        }
        warnings
    }
}

impl Stream {
    fn hear(&mut self, logged: Stamp) {
        if let Some(latest) = self.latest {
            let gap_s = logged.seconds_since(latest);
            if gap_s >= self.longest.map_or(SILENCE_S, |(longest, _)| longest) {
                self.longest = Some((gap_s, latest));
            }
        }
        self.latest = Some(logged);
    }
}
