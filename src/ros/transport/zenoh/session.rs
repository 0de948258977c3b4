//! The connection to routers and other nodes.

use std::env;
use zenoh::{Config, Session, Wait};

/// Opens a session as the environment describes it: a file named by `ZENOH_SESSION_CONFIG_URI`, or what `rmw_zenoh` does
/// without one, and `key=value;...` of `ZENOH_CONFIG_OVERRIDE` over it.
pub(super) fn open() -> Result<Session, String> {
    let mut config = match variable("ZENOH_SESSION_CONFIG_URI") {
        Some(file) => Config::from_file(&file)
            .map_err(|e| format!("ZENOH_SESSION_CONFIG_URI names {file}: {}", said(&e)))?,
        None => with(Config::default(), "the default", DEFAULT)?,
    };
    if let Some(given) = variable("ZENOH_CONFIG_OVERRIDE") {
        let entries = given.split(';').map(str::trim).filter(|entry| !entry.is_empty());
        let entries: Vec<_> =
            entries.map(|entry| entry.split_once('=').unwrap_or((entry, ""))).collect();
        config = with(config, "ZENOH_CONFIG_OVERRIDE", &entries)?;
    }
    let session = zenoh::open(config).wait().map_err(|e| said(&e))?;
    let info = session.info();
    if info.routers_zid().wait().chain(info.peers_zid().wait()).next().is_none() {
        tracing::warn!(
            "no Zenoh router answers yet: start one with `ros2 run rmw_zenoh_cpp rmw_zenohd`, or name another \
             in ZENOH_CONFIG_OVERRIDE: connect/endpoints=[\"tcp/HOST:7447\"]"
        );
    }
    Ok(session)
}

/// Nodes meet at the router of their machine and then talk to each other. Publishers that keep messages for those who
/// come later need time stamps.
const DEFAULT: &[(&str, &str)] = &[
    ("mode", "\"peer\""),
    ("connect/endpoints", "[\"tcp/localhost:7447\"]"),
    ("listen/endpoints", "[\"tcp/localhost:0\"]"),
    ("scouting/multicast/enabled", "false"),
    ("timestamping/enabled", "true"),
    ("queries_default_timeout", "600000"),
];

fn with(mut config: Config, source: &str, entries: &[(&str, &str)]) -> Result<Config, String> {
    for (key, value) in entries {
        config.insert_json5(key.trim(), value.trim()).map_err(|_| {
            format!(
                "{source} has `{key}={value}`, which is no setting of Zenoh with a value in JSON5"
            )
        })?;
    }
    Ok(config)
}

/// What went wrong, without the place in Zenoh's source.
fn said(error: &zenoh::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at ") {
        Some((said, place)) if place.contains(".rs:") => said.to_owned(),
        _ => text,
    }
}

fn variable(name: &str) -> Option<String> {
    env::var(name).ok().filter(|text| !text.trim().is_empty())
}
