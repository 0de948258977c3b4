//! What discovery knows of the publishers of the inputs, and what is wrong with them.

use super::{problems::Problem, subscriptions::Listening, transport::Offered};
use ros2_client::qos::{Durability, Reliability};

/// Why messages of the inputs do not arrive, as far as discovery tells.
///
/// RustDDS pairs publishers and subscriptions by the topic's name alone, so a wrong type is looked for here.
pub(super) fn problems(inputs: &[Listening], known: &[Offered]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for input in inputs {
        let (topic, role) = (&input.topic, input.role);
        let mut publishers = known.iter().filter(|offered| offered.topic == *topic).peekable();
        if publishers.peek().is_none() && input.needed {
            let what = format!("nobody publishes {topic} ({role}, {})", input.type_name);
            problems.push(Problem::new("no_publisher", topic, what));
        }
        for offered in publishers {
            if offered.type_name != input.type_name {
                let (given, wanted) = (&offered.type_name, input.type_name);
                let what = format!("{topic} is published as {given}, but {role} needs {wanted}");
                problems.push(Problem::new("wrong_type", topic, what));
            }
            problems.extend(mismatch(input, offered));
        }
    }
    problems
}

/// What is asked for and not offered (DDS 1.4, 2.2.3: requested and offered).
fn mismatch(input: &Listening, offered: &Offered) -> Option<Problem> {
    let (asked, offered) =
        if offered.best_effort && input.qos.reliability != Reliability::BestEffort {
            ("reliable", "best effort")
        } else if offered.volatile && input.qos.durability == Durability::TransientLocal {
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

/// What to say of another node of our own name.
pub(super) fn same_name(name: &str) -> Problem {
    let what = format!(
        "another node is called {name} too: services and parameters may reach the wrong one; \
         give one another name with `-r __node:=NAME`"
    );
    Problem::new("same_name", name, what)
}
