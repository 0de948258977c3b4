//! `export`: the map for other programs.

use super::Outcome;
use crate::io::{MapFormat, export_map, load_saved_map, write_atomically};
use anyhow::Context;
use clap::{Parser, ValueEnum};
use std::path::PathBuf;

/// Write a map in a form that other programs read.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// A map.json, or the folder of a result.
    map: PathBuf,
    /// The form: a table, a coloured mesh, footprints, or a world for Gazebo.
    #[arg(long, value_name = "FORM")]
    format: Form,
    /// The file to write; without it, it is printed.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    Csv,
    Ply,
    Geojson,
    Sdf,
}

pub(super) fn run(args: &Args) -> Outcome {
    let path = if args.map.is_dir() { args.map.join("map.json") } else { args.map.clone() };
    let map = load_saved_map(&path).with_context(|| path.display().to_string())?;
    let format = match args.format {
        Form::Csv => MapFormat::Csv,
        Form::Ply => MapFormat::Ply,
        Form::Geojson => MapFormat::GeoJson,
        Form::Sdf => MapFormat::Sdf,
    };
    let text = export_map(&map, format);
    let Some(output) = &args.output else {
        say!("{}", text.trim_end());
        return Ok(());
    };
    write_atomically(output, text.as_bytes())
        .with_context(|| format!("cannot write {}", output.display()))?;
    say!("{}: {} objects", output.display(), map.objects.len());
    Ok(())
}
