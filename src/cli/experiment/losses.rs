//! Where the row with everything on is not the best.

use super::{
    markdown::{block, number},
    metric::Metric,
    paper,
    plan::{TABLES, Table},
    results::{Cell, Results},
    row::OURS,
    sequence::Sequence,
};
use std::fmt::Write;

/// A line for each mean in which ours is behind; nothing where it leads everywhere.
pub(super) fn losses(results: &Results) -> String {
    let mut text = String::new();
    for table in TABLES {
        for sequence in table.sequences {
            against_rows(table, sequence, results, &mut text);
            against_paper(table, sequence, results, &mut text);
        }
    }
    text
}

fn against_rows(table: &Table, sequence: &Sequence, results: &Results, text: &mut String) {
    let lines: Vec<_> = block(table, sequence, results).collect();
    for (protocol, _, ours) in lines.iter().filter(|(_, row, _)| row.key == OURS) {
        let others = lines.iter().filter(|(p, row, _)| p == protocol && row.key != OURS);
        for (_, row, other) in others {
            for metric in table.metrics {
                let both = ours.metrics.get(metric).zip(other.metrics.get(metric));
                let Some((ours, other)) = both else { continue };
                if !is_worse(ours.mean, other.mean, *metric) {
                    continue;
                }
                let overlap = if ours.overlaps(other) { "overlap" } else { "do not overlap" };
                let _ = writeln!(
                    text,
                    "- {}, {}: {} is {}, and {} with \"{}\"; the intervals {overlap}.",
                    table.title,
                    sequence.name,
                    metric.title(),
                    number(Some(ours), *metric),
                    number(Some(other), *metric),
                    row.name,
                );
            }
        }
    }
}

fn against_paper(table: &Table, sequence: &Sequence, results: &Results, text: &mut String) {
    let blocks = table.published.iter().filter(|(of, _)| of == sequence);
    for (_, published) in blocks {
        for (_, _, cell) in block(table, sequence, results).filter(|(_, row, _)| row.key == OURS) {
            for (at, metric) in paper::METRICS.into_iter().enumerate() {
                against_best(table, published, cell, (at, metric), text);
            }
        }
    }
}

fn against_best(
    table: &Table,
    published: &paper::Block,
    cell: &Cell,
    (at, metric): (usize, Metric),
    text: &mut String,
) {
    let best = published.rows.iter().min_by(|a, b| a.1[at].total_cmp(&b.1[at]));
    let Some(((method, numbers), ours)) = best.zip(cell.metrics.get(&metric)) else { return };
    if is_worse(ours.mean, numbers[at], metric) {
        let _ = writeln!(
            text,
            "- {}: {} is {}; the paper's {method} has {:.*} ({}).",
            table.title,
            metric.title(),
            number(Some(ours), metric),
            metric.decimals(),
            numbers[at],
            published.name,
        );
    }
}

fn is_worse(ours: f64, other: f64, metric: Metric) -> bool {
    if metric.is_error() { ours > other } else { ours < other }
}
