//! Bags in SQLite as rosbag2 writes them.

use ellipsoid_slam::io::RawMessage;
use rusqlite::{Connection, params};
use std::{collections::BTreeMap, path::Path};

/// The tables of rosbag2.
pub(crate) const TABLES: &str = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, \
    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL); \
    CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL); \
    CREATE INDEX timestamp_idx ON messages (timestamp ASC);";

/// Writes a bag with what `pack` makes of each message.
pub(crate) fn write_sqlite(path: &Path, messages: &[RawMessage], pack: impl Fn(&[u8]) -> Vec<u8>) {
    let mut database = Connection::open(path).unwrap();
    database.execute_batch(TABLES).unwrap();
    let writing = database.transaction().unwrap();
    let mut ids: BTreeMap<&str, i64> = BTreeMap::new();
    for message in messages {
        let next = ids.len() as i64 + 1;
        let id = *ids.entry(&message.topic).or_insert(next);
        if id == next {
            writing
                .execute(
                    "INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')",
                    params![id, &*message.topic, &*message.type_name],
                )
                .unwrap();
        }
        writing
            .execute(
                "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)",
                params![id, message.log_time.as_nanos(), pack(&message.data)],
            )
            .unwrap();
    }
    writing.commit().unwrap();
}
