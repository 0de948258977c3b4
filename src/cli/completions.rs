//! `completions` and `man`: what shells and manuals know of this program.

use super::{Cli, Outcome};
use anyhow::Context;
use clap::{CommandFactory, Parser};
use clap_complete::Shell;
use std::{fs, path::PathBuf};

/// Print a script with which a shell completes this program's commands and options.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// The shell.
    shell: Shell,
}

/// Write manual pages, one a command.
#[derive(Debug, Parser)]
pub(super) struct ManArgs {
    /// Folder for them.
    folder: PathBuf,
}

pub(super) fn run(args: &Args) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), env!("CARGO_PKG_NAME"), &mut script);
    say!("{}", String::from_utf8_lossy(&script).trim_end());
    Ok(())
}

pub(super) fn write_manual(args: &ManArgs) -> Outcome {
    let cannot = || format!("cannot write manual pages into {}", args.folder.display());
    fs::create_dir_all(&args.folder).with_context(cannot)?;
    clap_mangen::generate_to(Cli::command(), &args.folder).with_context(cannot)?;
    Ok(())
}
