//! What discovery knows of the publishers of the inputs, and what is wrong with them.

use super::{problems::Problem, subscriptions::Listening};
use ros2_client::{
    dds::rustdds::{discovery::DiscoveredWriterData, policy},
    qos::{Durability, Reliability},
};

/// Why messages of the inputs do not arrive, as far as discovery tells.
///
/// RustDDS pairs publishers and subscriptions by the topic's name alone, so a wrong type is looked for here.
pub(super) fn problems(inputs: &[Listening], writers: &[DiscoveredWriterData]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for input in inputs {
        let (topic, role) = (&input.topic, input.role);
        let dds_name = format!("rt{topic}");
        let mut publishers =
            writers.iter().filter(|w| w.publication_topic_data.topic_name == dds_name).peekable();
        if publishers.peek().is_none() && input.needed {
            let what = format!("nobody publishes {topic} ({role}, {})", input.type_name);
            problems.push(Problem::new("no_publisher", topic, what));
        }
        for publisher in publishers {
            let offered = &publisher.publication_topic_data;
            let type_name = ros_type(&offered.type_name);
            if type_name != input.type_name {
                let wanted = input.type_name;
                let what =
                    format!("{topic} is published as {type_name}, but {role} needs {wanted}");
                problems.push(Problem::new("wrong_type", topic, what));
            }
            problems.extend(mismatch(input, offered.reliability, offered.durability));
        }
    }
    problems
}

/// What is asked for and not offered (DDS 1.4, 2.2.3: requested and offered).
fn mismatch(
    input: &Listening,
    reliability: Option<policy::Reliability>,
    durability: Option<policy::Durability>,
) -> Option<Problem> {
    let best_effort = reliability == Some(policy::Reliability::BestEffort);
    let volatile = matches!(durability, None | Some(policy::Durability::Volatile));
    let (asked, offered) = if best_effort && input.qos.reliability != Reliability::BestEffort {
        ("reliable", "best effort")
    } else if volatile && input.qos.durability == Durability::TransientLocal {
        ("transient local", "volatile")
    } else {
        return None;
    };
    let what = format!(
        "the quality of service of {} does not match: {} asks for {asked}, its publisher offers {offered}",
        input.topic, input.role
    );
    Some(Problem::new("incompatible_qos", &input.topic, what))
}

/// `package/msg/Name` of a DDS type name.
fn ros_type(dds: &str) -> String {
    let name = dds.replace("::dds_::", "/").replace("::", "/");
    name.strip_suffix('_').unwrap_or(&name).to_owned()
}
