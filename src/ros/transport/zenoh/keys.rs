//! The key expressions of `rmw_zenoh`.

use ros2_client::{
    NodeName, QosProfile,
    qos::{Durability, History, Reliability},
};
use sha2::{Digest, Sha256};
use zenoh::{Result, Session, Wait, liveliness::LivelinessToken};

/// Below it is said who is there.
const ADMIN_SPACE: &str = "@ros2_lv";
/// In place of the hash of a type of which no definition is known: ROS 2 does not receive such messages.
const NO_HASH: &str = "RIHS01_0000000000000000000000000000000000000000000000000000000000000000";

/// The hash of a type in keys. Humble has none.
pub(super) fn hash_of_distribution(hash: Option<String>) -> String {
    if cfg!(any(feature = "jazzy", feature = "kilted", feature = "lyrical")) {
        hash.unwrap_or_else(|| NO_HASH.to_owned())
    } else {
        "TypeHashNotSupported".to_owned()
    }
}

/// All that is said of nodes in a domain.
pub(super) fn all_tokens(domain: u16) -> String {
    format!("{ADMIN_SPACE}/{domain}/**")
}

/// What the keys of a node and of its ends are made from.
pub(super) struct NodeKey {
    pub(super) domain: u16,
    pub(super) session: String,
    namespace: String,
    name: String,
}

/// What a token tells of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Node,
    Publisher,
    Subscription,
    Server,
}

impl Role {
    const ALL: [Self; 4] = [Self::Node, Self::Publisher, Self::Subscription, Self::Server];

    fn letters(self) -> &'static str {
        match self {
            Self::Node => "NN",
            Self::Publisher => "MP",
            Self::Subscription => "MS",
            Self::Server => "SS",
        }
    }
}

/// A publisher, a subscription or a service.
pub(super) struct End {
    /// Where messages go.
    pub(super) key: String,
    /// The same, whatever the type's hash.
    pub(super) key_of_any_hash: String,
    /// What is said of it.
    token: String,
}

impl NodeKey {
    pub(super) fn new(domain: u16, session: String, name: &NodeName) -> Self {
        let (namespace, name) = (name.namespace().to_owned(), name.base_name().to_owned());
        Self { domain, session, namespace, name }
    }

    /// The node's own token.
    pub(super) fn token(&self) -> String {
        self.said_of(0, Role::Node)
    }

    /// An end with a number of its own, given the name of its topic, its type and the type's hash.
    pub(super) fn end(
        &self,
        number: u64,
        role: Role,
        [name, type_name, hash]: [&str; 3],
        qos: &QosProfile,
    ) -> End {
        let key = format!("{}/{}/{type_name}", self.domain, name.trim_matches('/'));
        let (said, name, qos) = (self.said_of(number, role), without_slashes(name), encoded(qos));
        End {
            token: format!("{said}/{name}/{type_name}/{hash}/{qos}"),
            key_of_any_hash: format!("{key}/*"),
            key: format!("{key}/{hash}"),
        }
    }

    fn said_of(&self, number: u64, role: Role) -> String {
        let Self { domain, session, namespace, name } = self;
        let (role, namespace) = (role.letters(), without_slashes(namespace));
        format!("{ADMIN_SPACE}/{domain}/{session}/0/{number}/{role}/%/{namespace}/{name}")
    }
}

impl End {
    /// Tells others of it, for as long as the token lives.
    pub(super) fn announce(&self, session: &Session) -> Result<LivelinessToken> {
        session.liveliness().declare_token(self.token.as_str()).wait()
    }

    /// Sixteen bytes that name it.
    pub(super) fn gid(&self) -> [u8; GID] {
        let digest = Sha256::digest(&self.token);
        std::array::from_fn(|at| digest[at])
    }
}

/// Length of an identifier (bytes).
pub(super) const GID: usize = 16;

/// A token, read.
pub(super) struct Said<'a> {
    pub(super) session: &'a str,
    pub(super) role: Role,
    pub(super) node: String,
    /// Topic and type; nothing for a node.
    pub(super) topic: Option<(String, &'a str)>,
}

impl<'a> Said<'a> {
    /// Nothing for what is of no use here.
    pub(super) fn parse(token: &'a str) -> Option<Self> {
        let parts: Vec<&str> = token.split('/').collect();
        let [ADMIN_SPACE, _, session, _, _, role, _, namespace, name, rest @ ..] = parts.as_slice()
        else {
            return None;
        };
        let role = Role::ALL.into_iter().find(|known| known.letters() == *role)?;
        let namespace = namespace.replace('%', "/");
        let topic = match rest {
            [topic, type_name, ..] => Some((topic.replace('%', "/"), *type_name)),
            _ => None,
        };
        let node = format!("{}/{name}", namespace.trim_end_matches('/'));
        Some(Self { session, role, node, topic })
    }
}

/// Tokens have no empty parts, and no slashes in them.
fn without_slashes(name: &str) -> String {
    if name.is_empty() { "%".to_owned() } else { name.replace('/', "%") }
}

/// Quality of service: what differs from the default, and the depth.
fn encoded(qos: &QosProfile) -> String {
    let reliability = if qos.reliability == Reliability::BestEffort { "2" } else { "" };
    let durability = if qos.durability == Durability::TransientLocal { "1" } else { "" };
    let (history, depth) = match qos.history {
        History::KeepLast { depth } => ("", depth),
        History::KeepAll => ("2", 0),
    };
    format!("{reliability}:{durability}:{history},{depth}:,:,:,,")
}
