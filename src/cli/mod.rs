//! The command line, a file a subcommand.

/// Prints a line. A reader that has seen enough and gone away is no reason to stop: `println!` would panic.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stdout(), $($text)*);
    }};
}

mod annotated;
mod completions;
mod config;
mod demo;
mod detect;
mod detector;
mod eval;
mod eval_table;
mod experiment;
mod export;
mod import;
mod inspect;
mod interruption;
#[cfg(feature = "ros")]
mod map_folder;
#[cfg(feature = "ros")]
mod node;
#[cfg(feature = "ros")]
mod play;
mod parameter_args;
mod recording;
mod replay;
mod report;
mod report_truth;
mod results;
mod show;
mod simulate;
mod simulate_settings;
mod streams;
mod timing;
mod viewer;

#[cfg(feature = "ros")]
use crate::ros::log_lines;
use clap::{Parser, Subcommand};
use std::{io::IsTerminal, process::ExitCode};
use tracing_subscriber::{
    Layer, Registry, filter::Targets, layer::SubscriberExt, util::SubscriberInitExt,
};

/// Object-level SLAM for indoor robots: from RGB-D frames and 2D boxes to a map of ellipsoids.
#[derive(Debug, Parser)]
#[command(name = "ellipsoid_slam", version, about, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Say more; twice: everything.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
}

#[derive(Debug, Subcommand)]
enum Command {
    Replay(replay::Args),
    #[cfg(feature = "ros")]
    Node(node::Args),
    Demo(demo::Args),
    #[cfg(feature = "ros")]
    Play(play::Args),
    Inspect(inspect::Args),
    Detect(detect::Args),
    Import(import::Args),
    Simulate(simulate::Args),
    Eval(eval::Args),
    Show(show::Args),
    Export(export::Args),
    Experiment(experiment::Args),
    Config(config::Args),
    Completions(completions::Args),
    Man(completions::ManArgs),
}

impl Command {
    /// How much is said where `-v` does not ask for more.
    fn level(&self) -> tracing::Level {
        match self {
            #[cfg(feature = "ros")]
            Self::Node(args) => args.level(),
            _ => tracing::Level::WARN,
        }
    }
}

/// What went wrong, with the exit status it has.
#[derive(Debug)]
enum Failure {
    /// The arguments ask for what must not be done: status 2.
    Usage(String),
    /// The work failed: status 1.
    Failed(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

type Outcome = Result<(), Failure>;

/// Where log lines go.
type LogLines = Box<dyn Layer<Registry> + Send + Sync>;

/// Our own words from `level` on, in `lines` and to whoever wants them `also`. DDS calls things errors that heal themselves: its words are for `-vv` only.
fn log(level: tracing::Level, also: Option<LogLines>, lines: LogLines) {
    let own = Targets::new().with_target(env!("CARGO_PKG_NAME"), level);
    let filter = match level {
        tracing::Level::DEBUG | tracing::Level::TRACE => {
            own.clone().with_default(tracing::Level::INFO)
        }
        _ => own.clone(),
    };
    let mut all = vec![lines.with_filter(filter).boxed()];
    all.extend(also.map(|also| also.with_filter(own).boxed()));
    tracing_subscriber::registry().with(all).init();
}

/// Lines on standard error, with colours where that is a terminal.
fn plain_lines() -> LogLines {
    let is_colored = std::env::var_os("NO_COLOR").is_none() && std::io::stderr().is_terminal();
    tracing_subscriber::fmt::layer().with_ansi(is_colored).with_writer(std::io::stderr).boxed()
}

/// Runs the program: 0 when done, 1 when the work failed, 2 for wrong usage.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let level = match cli.verbose {
        0 => cli.command.level(),
        1 => tracing::Level::INFO,
        _ => tracing::Level::DEBUG,
    };
    #[cfg(feature = "ros")]
    let (layer, lines) = log_lines();
    match &cli.command {
        #[cfg(feature = "ros")]
        Command::Node(args) => log(level, Some(layer.boxed()), args.log_lines()),
        _ => log(level, None, plain_lines()),
    }
    if !cli.command.ends_itself()
        && let Err(why) = interruption::clean_up_when_interrupted()
    {
        tracing::warn!("half-written files will stay when this is interrupted: {why}");
    }
    let outcome = match &cli.command {
        Command::Replay(args) => replay::run(args),
        #[cfg(feature = "ros")]
        Command::Node(args) => node::run(args, lines),
        Command::Demo(args) => demo::run(args),
        #[cfg(feature = "ros")]
        Command::Play(args) => play::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Detect(args) => detect::run(args),
        Command::Import(args) => import::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Eval(args) => eval::run(args),
        Command::Show(args) => show::run(args),
        Command::Export(args) => export::run(args),
        Command::Experiment(args) => experiment::run(args),
        Command::Config(args) => config::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => completions::write_manual(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(why)) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
        Err(Failure::Failed(error)) => {
            eprintln!("error: {}", sentence(&error));
            ExitCode::FAILURE
        }
    }
}

/// An error and what caused it. Some errors say already what the one below them says: it is not said twice.
fn sentence(error: &anyhow::Error) -> String {
    let mut said = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if said.is_empty() {
            said = cause;
        } else if !said.contains(&cause) {
            said = format!("{said}: {cause}");
        }
    }
    said
}
