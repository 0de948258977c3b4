//! Where the row with everything on is not the best.

use super::{
    markdown::{block, number},
    metric::Metric,
    paper,
    plan::{TABLES, Table},
    results::{Cell, Results, difference},
    row::OURS,
    sequence::Sequence,
};
use crate::eval::Interval;

/// A line for each mean in which ours is behind, as far as the printed decimals show it; nothing where it leads
/// everywhere.
pub(super) fn losses(results: &Results) -> String {
    let mut lines: Vec<String> = Vec::new();
    for table in TABLES {
        for sequence in table.sequences {
            let found = against_rows(table, sequence, results)
                .into_iter()
                .chain(against_paper(table, sequence, results));
            // Two tables may show the same pair.
            for line in found {
                if !lines.contains(&line) {
                    lines.push(line);
                }
            }
        }
    }
    lines.into_iter().map(|line| format!("- {line}\n")).collect()
}

fn against_rows(table: &Table, sequence: &Sequence, results: &Results) -> Vec<String> {
    let mut lost = Vec::new();
    let lines: Vec<_> = block(table, sequence, results).collect();
    for (protocol, _, ours) in lines.iter().filter(|(_, row, _)| row.key == OURS) {
        let others = lines.iter().filter(|(p, row, _)| p == protocol && row.key != OURS);
        for (_, row, other) in others {
            for metric in table.metrics {
                let means = ours.metrics.get(metric).zip(other.metrics.get(metric));
                let Some((mean, best)) = means else { continue };
                if is_behind(mean.mean, best.mean, *metric) {
                    lost.push(format!(
                        "{}, {}: {}; \"{}\" has {}{}.",
                        sequence.name,
                        protocol.name,
                        ours_is(mean, *metric),
                        row.name,
                        number(Some(best), *metric),
                        on_the_same_scenes(difference(ours, other, *metric), *metric),
                    ));
                }
            }
        }
    }
    lost
}

fn against_paper(table: &Table, sequence: &Sequence, results: &Results) -> Vec<String> {
    let mut lost = Vec::new();
    for (_, published) in table.published.iter().filter(|(of, _)| of == sequence) {
        for (_, _, cell) in block(table, sequence, results).filter(|(_, row, _)| row.key == OURS) {
            lost.extend(
                (0..paper::METRICS.len())
                    .filter_map(|at| against_best(sequence, published, cell, at)),
            );
        }
    }
    lost
}

fn against_best(
    sequence: &Sequence,
    published: &paper::Block,
    cell: &Cell,
    at: usize,
) -> Option<String> {
    let metric = paper::METRICS[at];
    let ours = cell.metrics.get(&metric)?;
    let (method, numbers) = published.rows.iter().min_by(|a, b| a.1[at].total_cmp(&b.1[at]))?;
    is_behind(ours.mean, numbers[at], metric).then(|| {
        format!(
            "{}: {}; the paper's {method} has {:.*} ({}).",
            sequence.name,
            ours_is(ours, metric),
            metric.decimals(),
            numbers[at],
            published.name,
        )
    })
}

fn ours_is(ours: &Interval, metric: Metric) -> String {
    format!("{} is {}", metric.title(), number(Some(ours), metric))
}

/// Scenes differ more than methods do: what counts is the difference seed by seed.
fn on_the_same_scenes(difference: Option<Interval>, metric: Metric) -> String {
    let Some(difference) = difference else { return String::new() };
    let chance = match difference.half_width {
        Some(_) if difference.holds(0.0) => ", which may be chance",
        Some(_) => ", which is more than chance",
        None => "",
    };
    format!("; scene by scene it differs by {}{chance}", number(Some(&difference), metric))
}

/// By the decimals that are printed.
fn is_behind(ours: f64, other: f64, metric: Metric) -> bool {
    let scale = 10f64.powi(metric.decimals() as i32);
    let (ours, other) = ((ours * scale).round(), (other * scale).round());
    if metric.is_error() { ours > other } else { ours < other }
}
