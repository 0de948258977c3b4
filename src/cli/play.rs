//! `play`: a bag's messages on ROS 2.

use super::{Failure, Outcome, timing::now};
use crate::{
    io::BagReader,
    ros::{Domain, Player},
};
use clap::Parser;
use std::{path::PathBuf, thread, time::Duration};

/// Publish a bag's messages on ROS 2, so that nobody needs a ROS installation to try the node.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` or `.db3` file or a rosbag2 folder.
    bag: PathBuf,
    /// How much faster than it was recorded.
    #[arg(long, value_name = "R", default_value_t = 1.0)]
    rate: f64,
    /// Publish the recording's time on /clock, for nodes with use_sim_time.
    #[arg(long)]
    clock: bool,
    /// Begin again at the end, until interrupted.
    #[arg(long = "loop")]
    again: bool,
    /// Only these topics.
    #[arg(long, value_name = "TOPIC,...", value_delimiter = ',')]
    topics: Vec<String>,
    /// How long to wait for somebody who listens before beginning.
    #[arg(long, value_name = "SECONDS", default_value_t = 3.0)]
    wait: f64,
}

pub(super) fn run(args: &Args) -> Outcome {
    if !(args.rate.is_finite() && args.rate > 0.0) {
        return Err(Failure::Usage("--rate must be above zero".into()));
    }
    let bag = BagReader::open(&args.bag)?;
    let wanted = |name: &String| args.topics.is_empty() || args.topics.contains(name);
    if let Some(name) =
        args.topics.iter().find(|name| bag.topics().iter().all(|t| t.name != **name))
    {
        return Err(Failure::Usage(format!("{} has no topic {name}", args.bag.display())));
    }
    let topics = bag.topics().iter().filter(|topic| topic.encoding == "cdr" && wanted(&topic.name));
    let topics = topics.map(|topic| (topic.name.as_str(), topic.type_name.as_str()));
    let player = Player::new(Domain::from_environment()?, topics, args.clock)?;
    let heard = player.wait_for_listeners(Duration::from_secs_f64(args.wait.clamp(0.0, 3600.0)));
    if heard == 0 {
        eprintln!("warning: nobody listens to any of the bag's topics yet");
    }
    loop {
        let sent = play_once(args, &bag, &player)?;
        say!("{}: {sent} messages published", args.bag.display());
        if !args.again {
            break;
        }
    }
    // Readers that ask for a lost message again need its publisher.
    thread::sleep(Duration::from_millis(500));
    Ok(())
}

fn play_once(args: &Args, bag: &BagReader, player: &Player) -> anyhow::Result<u64> {
    let started = now();
    let Some((first, _)) = bag.time_range() else { return Ok(0) };
    let mut sent = 0;
    let mut told = first;
    for message in bag.messages().only(player.topics()) {
        let due =
            Duration::from_secs_f64((message.log_time.seconds_since(first) / args.rate).max(0.0));
        thread::sleep(due.saturating_sub(started.elapsed()));
        if sent == 0 || message.log_time.seconds_since(told) >= CLOCK_STEP_S {
            told = message.log_time;
            player.tell_time(told);
        }
        match player.publish(&message.topic, &message.data) {
            Ok(()) => sent += 1,
            Err(e) => tracing::warn!("{e}"),
        }
    }
    Ok(sent)
}

/// `/clock` goes on in steps of the recording's time (s).
const CLOCK_STEP_S: f64 = 0.005;
