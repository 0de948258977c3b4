//! `experiment`: the tables and figures of the paper's section VI on simulated scenes.
//!
//! `plan.rs` says which there are, `row.rs` what is compared, `protocol.rs` under which conditions.

mod check;
mod figure;
mod losses;
mod markdown;
mod metric;
mod page;
mod paper;
mod plan;
mod plot;
mod protocol;
mod results;
mod row;
mod sequence;
mod trial;

use self::{
    plan::{Case, SEQUENCES, cases},
    protocol::Protocol,
    results::{Cell, Results},
    row::{ROWS, Row},
    sequence::Sequence,
    trial::Trial,
};
use crate::{
    cli::{
        Failure, Outcome,
        eval_table::{CSV_HEADING, csv_lines},
        recording::refuse_existing,
    },
    io::write_atomically,
};
use anyhow::{Context, anyhow};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Make the tables and figures of the paper's section VI on simulated scenes: minutes, and the same bytes each time.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// How many random scenes a figure is averaged over.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Only these rows, with commas between them; a wrong one is answered with all that there are.
    #[arg(long, value_name = "ROWS", value_delimiter = ',', value_parser = row::row)]
    rows: Vec<&'static Row>,
    /// Only these sequences, by their keys.
    #[arg(long, value_name = "SEQUENCES", value_delimiter = ',', value_parser = sequence::sequence)]
    sequences: Vec<Sequence>,
    /// Only these protocols, by their keys.
    #[arg(long, value_name = "PROTOCOLS", value_delimiter = ',', value_parser = protocol::protocol)]
    protocols: Vec<Protocol>,
    /// The first seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    first_seed: u64,
    /// So many frames a sequence [default: what suits the trajectory].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=10_000))]
    frames: Option<u64>,
    /// Folder for experiments.md, experiments.json, the plots, and experiments.html, which has all of them to look at.
    #[arg(long, short, value_name = "DIR", default_value = "docs")]
    output: PathBuf,
    /// Overwrite earlier results.
    #[arg(long)]
    force: bool,
    /// Print the results as JSON, too.
    #[arg(long)]
    json: bool,
    /// Write a line an object of every trial, too, as `eval --csv` does.
    #[arg(long, value_name = "FILE")]
    objects: Option<PathBuf>,
    /// Write nothing; say which means lie outside the intervals of an earlier experiments.json.
    #[arg(long, value_name = "FILE", conflicts_with = "force")]
    check: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Outcome {
    let kept = match &args.check {
        Some(file) => Some(read_results(file, args)?),
        None => {
            let files: Vec<PathBuf> = files(&args.output).collect();
            refuse_existing(&files.iter().map(PathBuf::as_path).collect::<Vec<_>>(), args.force)?;
            None
        }
    };
    if let Some(file) = &args.objects {
        refuse_existing(&[file], args.force)?;
    }
    let trials = run_all(args)?;
    if let Some(file) = &args.objects {
        write_atomically(file, objects_csv(&trials, args.first_seed).as_bytes())
            .with_context(|| format!("cannot write {}", file.display()))?;
    }
    let results = results_of(trials, args);
    if args.json {
        say!("{}", results.json()?.trim_end());
    }
    match kept {
        Some(kept) => report_check(&results, &kept),
        None => write(args, &results),
    }
}

fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let texts = ["experiments.md", "experiments.json", "experiments.html"].map(str::to_owned);
    texts.into_iter().chain(figure::files()).map(|name| folder.join(name))
}

fn read_results(file: &Path, args: &Args) -> Result<Results, Failure> {
    let name = file.display();
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {name}"))?;
    let kept: Results =
        serde_json::from_str(&text).with_context(|| format!("{name} holds no results"))?;
    if kept.frames != frames(args) {
        let of = |frames: Option<usize>| frames.map_or("all".to_owned(), |n| n.to_string());
        return Err(Failure::Usage(format!(
            "{name} was made with {} frames a sequence, this run has {}; see --frames",
            of(kept.frames),
            of(frames(args)),
        )));
    }
    Ok(kept)
}

fn frames(args: &Args) -> Option<usize> {
    args.frames.map(|frames| frames as usize)
}

/// Runs every case on every seed. A sequence is rendered once and kept while all its cases run on it.
fn run_all(args: &Args) -> anyhow::Result<Trials> {
    let rows: Vec<&'static Row> =
        ROWS.iter().filter(|row| args.rows.is_empty() || is_asked_for(row, args)).collect();
    let plan = SEQUENCES.map(|sequence| {
        let mut cases = cases(sequence, &rows);
        cases.retain(|_| is_among(&sequence, &args.sequences));
        cases.retain(|case| is_among(&case.protocol, &args.protocols));
        (sequence, cases)
    });
    let steps: usize = plan.iter().map(|(_, cases)| cases.len() + 1).sum();
    let progress = ProgressBar::new(args.seeds * steps as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg} {eta}") {
        progress.set_style(style);
    }
    let mut trials = Trials::new();
    for seed in args.first_seed..args.first_seed + args.seeds {
        for (sequence, cases) in plan.iter().filter(|(_, cases)| !cases.is_empty()) {
            progress.set_message(format!("{}, seed {seed}", sequence.name));
            let rendered = sequence.rendered(seed, frames(args))?;
            progress.inc(1);
            // In parallel, but each trial by itself and collected in order: the same bytes on any number of cores.
            let of_case = |case: &Case| {
                let trial = trial::run(&rendered, &case.protocol, case.row, case.settings());
                progress.inc(1);
                trial
            };
            let finished: Vec<Trial> = cases.par_iter().map(of_case).collect();
            for (case, trial) in cases.iter().zip(finished) {
                trials.entry(case.key()).or_insert((*case, Vec::new())).1.push(trial);
            }
        }
    }
    progress.finish_and_clear();
    Ok(trials)
}

/// By the key of the case, seed after seed.
type Trials = BTreeMap<String, (Case, Vec<Trial>)>;

fn results_of(trials: Trials, args: &Args) -> Results {
    let cells = trials.into_iter().map(|(key, (case, trials))| {
        let cell = Cell::of(&trials);
        (key, if case.has_curve() { cell } else { cell.without_curves() })
    });
    Results { seeds: args.seeds, frames: frames(args), cells: cells.collect() }
}

/// A line an object of each trial that has a map.
fn objects_csv(trials: &Trials, first_seed: u64) -> String {
    let mut text = format!("case,seed,{CSV_HEADING}\n");
    for (key, (_, trials)) in trials {
        for (seed, trial) in (first_seed..).zip(trials) {
            for line in trial.objects.iter().flat_map(csv_lines) {
                text += &format!("{key},{seed},{line}\n");
            }
        }
    }
    text
}

/// Whether one is asked for, or nothing in particular is.
fn is_among<T: PartialEq>(one: &T, asked: &[T]) -> bool {
    asked.is_empty() || asked.contains(one)
}

fn is_asked_for(row: &Row, args: &Args) -> bool {
    args.rows.iter().any(|asked| asked.key == row.key)
}

fn write(args: &Args, results: &Results) -> Outcome {
    fs::create_dir_all(&args.output)
        .with_context(|| format!("cannot create the folder {}", args.output.display()))?;
    let mut texts = figure::drawn(results)?;
    let text = markdown::text(results, &command(args));
    texts.push(("experiments.html".to_owned(), page::html(&text, &texts)));
    texts.push(("experiments.json".to_owned(), results.json()?));
    texts.push(("experiments.md".to_owned(), text));
    for (name, text) in texts {
        let path = args.output.join(name);
        write_atomically(&path, text.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    if !args.json {
        let path = args.output.join("experiments.md");
        say!("{} cases on {}: {}", results.cells.len(), results.seeds_in_words(), path.display());
    }
    Ok(())
}

/// The command that makes the same results again. Where they are written does not change them.
fn command(args: &Args) -> String {
    let mut command = format!("cargo run --release -- experiment --seeds {}", args.seeds);
    if !args.rows.is_empty() {
        let keys: Vec<&str> = args.rows.iter().map(|row| row.key).collect();
        command += &format!(" --rows {}", keys.join(","));
    }
    let keys = |keys: Vec<&str>| keys.join(",");
    if !args.sequences.is_empty() {
        command +=
            &format!(" --sequences {}", keys(args.sequences.iter().map(|s| s.key).collect()));
    }
    if !args.protocols.is_empty() {
        command +=
            &format!(" --protocols {}", keys(args.protocols.iter().map(|p| p.key).collect()));
    }
    if args.first_seed != 1 {
        command += &format!(" --first-seed {}", args.first_seed);
    }
    if let Some(frames) = args.frames {
        command += &format!(" --frames {frames}");
    }
    command + " --force"
}

fn report_check(fresh: &Results, kept: &Results) -> Outcome {
    let comparison = check::compare(fresh, kept);
    for difference in &comparison.differences {
        say!("{difference}");
    }
    let (outside, compared) = (comparison.differences.len(), comparison.compared);
    if outside > 0 {
        let why = anyhow!("{outside} of {compared} means are not as they were");
        return Err(Failure::Failed(why));
    }
    say!("all {compared} means lie in the intervals that were kept");
    Ok(())
}
