//! `config`: the effective configuration.

use super::{Outcome, parameter_args::ParameterArgs};
use crate::config::{parameters_to_yaml, reference};
use clap::Parser;

/// Print the effective configuration, commented.
#[derive(Debug, Parser)]
pub(super) struct Args {
    #[command(flatten)]
    parameters: ParameterArgs,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
    /// Print the reference of all settings instead: docs/configuration.md.
    #[arg(long, exclusive = true)]
    markdown: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    if args.markdown {
        say!("{}", reference()?.trim_end());
        return Ok(());
    }
    let parameters = args.parameters.load()?;
    if args.json {
        say!("{}", serde_json::to_string_pretty(&parameters.tree()?)?);
    } else {
        say!("{}", parameters_to_yaml(&parameters)?.trim_end());
    }
    Ok(())
}
