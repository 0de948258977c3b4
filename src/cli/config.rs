//! `config`: the effective configuration.

use super::{Outcome, replay::load_parameters};
use crate::config::parameters_to_yaml;
use clap::Parser;
use std::path::PathBuf;

/// Print the effective configuration, commented.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// A parameter file to lay over the defaults.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let parameters = load_parameters(args.config.as_deref())?;
    if args.json {
        say!("{}", serde_json::to_string_pretty(&parameters.tree()?)?);
    } else {
        say!("{}", parameters_to_yaml(&parameters)?.trim_end());
    }
    Ok(())
}
