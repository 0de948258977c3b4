//! `eval`: a result against the truth.

use super::{
    Outcome,
    eval_table::{csv, print_table},
    recording::refuse_existing,
};
use crate::{
    eval::{GroundTruth, ObjectScores, TrajectoryScores, evaluate, evaluate_trajectory},
    io::{read_map, read_trajectory, write_atomically},
    report::estimated,
};
use anyhow::{Context, ensure};
use clap::Parser;
use serde::Serialize;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Measure a replay's map and trajectory against the truth.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// The folder that replay wrote.
    result: PathBuf,
    /// The true objects.
    #[arg(long, value_name = "FILE.gt.json")]
    ground_truth: PathBuf,
    /// The true poses of the base frame.
    #[arg(long, value_name = "FILE.tum")]
    trajectory: Option<PathBuf>,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
    /// Write a line an object.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Overwrite an existing CSV file.
    #[arg(long)]
    force: bool,
}

/// Everything that was measured.
#[derive(Debug, Serialize)]
pub(super) struct Evaluation {
    pub(super) objects: ObjectScores,
    /// Only where true poses were given.
    pub(super) trajectory: Option<TrajectoryScores>,
}

pub(super) fn run(args: &Args) -> Outcome {
    if let Some(path) = &args.csv {
        refuse_existing(&[path], args.force)?;
    }
    let evaluation = evaluate_files(&args.result, &args.ground_truth, args.trajectory.as_deref())?;
    if let Some(path) = &args.csv {
        write_atomically(path, csv(&evaluation.objects).as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    if args.json {
        say!("{}", serde_json::to_string_pretty(&evaluation)?);
    } else {
        print_table(&evaluation);
    }
    Ok(())
}

fn evaluate_files(
    result: &Path,
    ground_truth: &Path,
    trajectory: Option<&Path>,
) -> anyhow::Result<Evaluation> {
    let map_file = result.join("map.json");
    let map = read_map(&text_of(&map_file)?).with_context(|| map_file.display().to_string())?;
    let truth = read_ground_truth(ground_truth)?;
    ensure!(
        map.frame_id == truth.frame_id,
        "the map is in the frame \"{}\", the true objects are in \"{}\"",
        map.frame_id,
        truth.frame_id
    );
    let trajectory = match trajectory {
        None => None,
        Some(path) => {
            let estimate = read_trajectory(&result.join("trajectory.tum"))?;
            Some(evaluate_trajectory(&estimate, &read_trajectory(path)?)?)
        }
    };
    Ok(Evaluation { objects: evaluate(&estimated(&map), &truth), trajectory })
}

fn text_of(path: &Path) -> anyhow::Result<String> {
    fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

/// The true objects of a file.
pub(super) fn read_ground_truth(path: &Path) -> anyhow::Result<GroundTruth> {
    GroundTruth::from_json(&text_of(path)?).with_context(|| path.display().to_string())
}
