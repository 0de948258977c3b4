//! Points in time, as the data carries them.

use std::fmt;

/// A point in time in nanoseconds since the epoch of the data's own clock.
///
/// The core never reads a clock: every stamp comes with a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stamp(i64);

impl Stamp {
    /// From nanoseconds since the epoch.
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// From seconds since the epoch, rounded to the nanosecond.
    ///
    /// Numbers beyond what 64 bits of nanoseconds hold saturate.
    pub fn from_secs(secs: f64) -> Self {
        // By parts: a product would be wrong by a hundred nanoseconds, and a file that is read and written drift.
        let whole = secs.floor();
        let nanos = ((secs - whole) * 1e9).round() as i64;
        Self((whole as i64).saturating_mul(NANOS).saturating_add(nanos))
    }

    /// Nanoseconds since the epoch.
    pub const fn as_nanos(self) -> i64 {
        self.0
    }

    /// Seconds since the epoch; good to about 0.2 microseconds for present-day stamps.
    pub fn as_secs(self) -> f64 {
        self.0.div_euclid(NANOS) as f64 + self.0.rem_euclid(NANOS) as f64 / NANOS as f64
    }

    /// `self - earlier` in seconds, exact to the nanosecond for spans of hours.
    pub fn seconds_since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 * 1e-9
    }

    /// This stamp moved by `secs` seconds.
    pub fn shifted(self, secs: f64) -> Self {
        Self(self.0.saturating_add((secs * 1e9).round() as i64))
    }
}

impl fmt::Display for Stamp {
    /// Seconds with nine decimals, as TUM files and ROS tools write them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let nanos = self.0.unsigned_abs();
        write!(f, "{sign}{}.{:09}", nanos / 1_000_000_000, nanos % 1_000_000_000)
    }
}

/// A second.
const NANOS: i64 = 1_000_000_000;
