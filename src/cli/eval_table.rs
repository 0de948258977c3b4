//! What was measured, as a table for people and as CSV.

use super::eval::Evaluation;
use crate::eval::{Calibration, Match, ObjectScores, Statistics, TrajectoryScores};
use std::fmt::Write;

/// A heading, and a line for each true object that counts and for each false one.
pub(super) fn csv(scores: &ObjectScores) -> String {
    let lines = csv_lines(scores).into_iter().map(|line| line + "\n");
    format!("{CSV_HEADING}\n{}", lines.collect::<String>())
}

/// The names of the columns of [`csv_lines`].
pub(super) const CSV_HEADING: &str = "true_id,true_label,id,label,translation_m,rotation_deg,shape,paper_shape,iou,nees,nees_dimensions,duplicate_of";

/// A line for each true object that counts and for each false one.
pub(super) fn csv_lines(scores: &ObjectScores) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = |cells: &[String]| lines.push(cells.join(","));
    let blank = String::new;
    for m in &scores.matches {
        let mut cells =
            vec![m.true_id.to_string(), quoted(&m.true_label), m.id.to_string(), quoted(&m.label)];
        let e = m.error;
        let numbers = [e.shape, e.paper_shape, e.iou].map(|v| v.to_string());
        cells.extend([e.translation_m.to_string(), number_or_blank(e.rotation_deg)]);
        cells.extend(numbers);
        cells.push(number_or_blank(m.normalised.map(|n| n.nees)));
        cells.push(m.normalised.map(|n| n.dimensions.to_string()).unwrap_or_default());
        cells.push(blank());
        line(&cells);
    }
    for m in &scores.missed {
        let mut cells = vec![m.true_id.to_string(), quoted(&m.true_label)];
        cells.resize_with(CSV_COLUMNS, blank);
        line(&cells);
    }
    for f in &scores.false_objects {
        let mut cells = vec![blank(), blank(), f.id.to_string(), quoted(&f.label)];
        cells.resize_with(CSV_COLUMNS - 1, blank);
        cells.push(f.duplicate_of.map(|id| id.to_string()).unwrap_or_default());
        line(&cells);
    }
    lines
}

const CSV_COLUMNS: usize = 12;

fn number_or_blank(value: Option<f64>) -> String {
    value.map(|v| v.to_string()).unwrap_or_default()
}

/// A label as CSV wants it (RFC 4180).
fn quoted(label: &str) -> String {
    if label.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", label.replace('"', "\"\""))
    } else {
        label.to_owned()
    }
}

pub(super) fn print_table(evaluation: &Evaluation) {
    let scores = &evaluation.objects;
    say!(
        "{:>4} {:<16} {:>4} {:<16} {:>9} {:>10} {:>6} {:>11} {:>5} {:>9}",
        "true",
        "",
        "map",
        "",
        "trans [m]",
        "rot [deg]",
        "shape",
        "paper shape",
        "IoU",
        "NEES/dim"
    );
    for m in &scores.matches {
        say!("{}", match_line(m));
    }
    say!(
        "{:<43} {:>9} {:>10} {:>6} {:>11} {:>5} {:>9}",
        format!("mean of {}", scores.matches.len()),
        cell(scores.translation_m, 3),
        cell(scores.rotation_deg, 1),
        cell(scores.shape, 3),
        cell(scores.paper_shape, 3),
        cell(scores.iou, 3),
        cell(scores.calibration.mean_nees_per_dimension, 1),
    );
    for m in &scores.missed {
        say!("missed: {} {}", m.true_id, m.true_label);
    }
    for f in &scores.false_objects {
        let why = f.duplicate_of.map(|id| format!(", a duplicate of {id}")).unwrap_or_default();
        say!("false:  {} {}{why}", f.id, f.label);
    }
    say!("{}", summary(scores).trim_end());
    if let Some(trajectory) = &evaluation.trajectory {
        print_trajectory(trajectory);
    }
}

fn match_line(m: &Match) -> String {
    let e = m.error;
    format!(
        "{:>4} {:<16} {:>4} {:<16} {:>9.3} {:>10} {:>6.3} {:>11.3} {:>5.3} {:>9}",
        m.true_id,
        m.true_label,
        m.id,
        m.label,
        e.translation_m,
        cell(e.rotation_deg, 1),
        e.shape,
        e.paper_shape,
        e.iou,
        cell(m.normalised.map(|n| n.nees / n.dimensions as f64), 1),
    )
}

fn summary(scores: &ObjectScores) -> String {
    let mut text = String::new();
    let percent = |value: Option<f64>| cell(value.map(|v| 100.0 * v), 0);
    let _ = writeln!(
        text,
        "precision {} %, recall {} % ({} of {} true objects, {} in the map), {} duplicates, {} % of labels right, \
         {} without a main axis",
        percent(scores.precision),
        percent(scores.recall),
        scores.matches.len(),
        scores.true_objects,
        scores.map_objects,
        scores.duplicates,
        percent(scores.label_agreement),
        scores.rotation_left_out,
    );
    let _ = writeln!(text, "covariance   objects  NEES/dim  in 50 %  in 90 %  in 99 %");
    let parts: [(&str, &Calibration); 4] = [
        ("heading", &scores.heading_calibration),
        ("centre", &scores.center_calibration),
        ("size", &scores.size_calibration),
        ("all", &scores.calibration),
    ];
    for (name, part) in parts {
        let mean = cell(part.mean_nees_per_dimension, 2);
        let within = [part.within_50, part.within_90, part.within_99].map(percent);
        let [a, b, c] = within;
        let _ = writeln!(text, "{name:<12} {:>7}  {mean:>8}  {a:>7}  {b:>7}  {c:>7}", part.objects);
    }
    text
}

fn print_trajectory(scores: &TrajectoryScores) {
    say!("trajectory of {} poses      rmse     mean   median      max", scores.poses);
    let line = |name: &str, s: &Statistics| {
        say!("{name:<24} {:>8.4} {:>8.4} {:>8.4} {:>8.4}", s.rmse, s.mean, s.median, s.max);
    };
    line("ATE [m]", &scores.ate_m);
    line("ATE, aligned [m]", &scores.aligned_ate_m);
    line("RPE [m]", &scores.rpe_m);
    line("RPE [deg]", &scores.rpe_deg);
}

fn cell(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.decimals$}"))
}
