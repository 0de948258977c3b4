//! Topics that nobody named, found as `inspect` finds those of a bag: by type and name.

use super::{
    node::NotCreated,
    subscriptions::Inputs,
    transport::{Graph, Node},
};
use crate::{
    config::{RosArguments, TopicSettings},
    topics::{Assigned, Choice, Remap, Role, Roles, Topic, choose, given_to_node},
};
use std::{collections::BTreeMap, time::Duration};
use tokio::time::sleep;

/// Looks for what others publish.
pub(super) struct Finding {
    graph: Graph,
    given: Vec<Remap>,
    namespace: String,
    /// Names that begin with this are our own.
    own: String,
    /// A detector of our own finds the boxes.
    detects: bool,
}

/// The topics that the node listens to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sources {
    pub(super) roles: Roles,
    /// Types of those that were found: those that were named have the type that the settings say.
    pub(super) types: BTreeMap<String, String>,
}

/// How often others are looked for.
const LOOK_AGAIN: Duration = Duration::from_millis(500);
/// So many looks in a row must find the same: what is better may be announced a moment later.
const SETTLED: usize = 4;
/// Most topics that are listed.
const MOST_LISTED: usize = 40;

impl Finding {
    pub(super) fn new(
        node: &mut Node,
        settings: &TopicSettings,
        arguments: &RosArguments,
        detects: bool,
    ) -> Result<Self, NotCreated> {
        Ok(Self {
            graph: node.graph()?,
            given: given_to_node(settings, arguments),
            namespace: arguments.namespace().to_owned(),
            own: format!("{}/", arguments.full_name()),
            detects,
        })
    }

    /// A topic for each role, as soon as everything that is needed is there. Until then `inputs` says what is missing.
    pub(super) async fn find(&self, inputs: &Inputs) -> Sources {
        // Objects in space are looked for where there is no depth only.
        let mut others = Role::ALL.iter().filter(|role| **role != Role::Detections3d);
        let all_named = others.all(|role| self.given.iter().any(|g| g.role == *role));
        let (mut before, mut looks): (Option<Sources>, usize) = (None, 0);
        loop {
            let topics = self.published();
            let Assigned { roles, missing, choices } = self.choose(&topics);
            inputs.borrow_mut().missing =
                (!missing.is_empty()).then(|| not_found(&missing, &topics));
            let sources = Sources { roles, types: types_of(&choices, &topics) };
            looks = if before.as_ref() == Some(&sources) { looks + 1 } else { 0 };
            if missing.is_empty() && (all_named || looks >= SETTLED) {
                choices.iter().for_each(say);
                return sources;
            }
            before = Some(sources);
            sleep(LOOK_AGAIN).await;
        }
    }

    /// Waits for odometry where nobody published any so far and nothing else was named.
    pub(super) async fn odometry(&self) -> Option<String> {
        if self.given.iter().any(|given| given.role == Role::Odometry) {
            return None;
        }
        loop {
            let choices = self.choose(&self.published()).choices;
            if let Some(found) = choices.iter().find(|choice| choice.role == Role::Odometry) {
                say(found);
                return Some(found.topic.clone());
            }
            sleep(LOOK_AGAIN).await;
        }
    }

    fn choose(&self, topics: &[Topic]) -> Assigned {
        let assigned = choose(topics, &self.given, &self.namespace);
        if self.detects { assigned.for_detector() } else { assigned }
    }

    /// What others publish, by name.
    fn published(&self) -> Vec<Topic> {
        let offered = self.graph.publishers().into_iter();
        let topics: BTreeMap<String, String> = offered
            .filter(|offered| !offered.topic.starts_with(&self.own))
            .map(|offered| (offered.topic, offered.type_name))
            .collect();
        let topic = |(name, type_name)| Topic {
            name,
            type_name,
            encoding: "cdr".into(),
            // As many as will come.
            messages: u64::MAX,
            format: None,
        };
        topics.into_iter().map(topic).collect()
    }
}

fn types_of(choices: &[Choice], topics: &[Topic]) -> BTreeMap<String, String> {
    let chosen = |topic: &&Topic| choices.iter().any(|choice| choice.topic == topic.name);
    topics.iter().filter(chosen).map(|t| (t.name.clone(), t.type_name.clone())).collect()
}

fn say(choice: &Choice) {
    tracing::info!("{} comes from {choice}", choice.role);
}

/// What is missing, and what there is.
fn not_found(missing: &[Role], topics: &[Topic]) -> String {
    let roles: Vec<&str> = missing.iter().map(|role| role.name()).collect();
    let listed: Vec<String> = topics
        .iter()
        .take(MOST_LISTED)
        .map(|topic| format!("{} ({})", topic.name, topic.type_name))
        .collect();
    let there = if listed.is_empty() { "nothing".to_owned() } else { listed.join(", ") };
    format!(
        "no topic is found for {}: name one with `-r {}:=/topic` or in the section `topics`; published is {there}",
        roles.join(", "),
        roles.first().unwrap_or(&"depth"),
    )
}
