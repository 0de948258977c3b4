//! `experiments.md`.

use super::{
    figure::{CONVERGENCE_FILE, sweep_file, swept},
    losses::losses,
    metric::Metric,
    paper,
    plan::{CONVERGENCE, SWEEPS, TABLES, Table, cell_key},
    protocol::{BORDER_PX, Protocol, SURE},
    results::{Cell, Results},
    row::{ROWS, Row},
    sequence::Sequence,
};
use crate::eval::Interval;
use std::fmt::Write;

/// The whole text; `command` made it.
pub(super) fn text(results: &Results, command: &str) -> String {
    let mut text = head(results, command);
    for table in TABLES {
        if let Some(lines) = table_text(table, results) {
            let _ = write!(text, "\n## {}\n\n{}\n\n{lines}", table.title, table.text);
        }
    }
    let lost = losses(results);
    if !lost.is_empty() {
        let _ = write!(
            text,
            "\n## Where ours loses\n\nEvery mean of the tables above in which \"ours\" is behind another row of its block, or \
             behind the paper's best, which was measured on other scenes. Differences scene by scene have intervals of their own: \
             scenes differ more than methods do.\n\n{lost}"
        );
    }
    text + &figures(results)
}

fn head(results: &Results, command: &str) -> String {
    let frames = match results.frames {
        Some(frames) => format!(", cut down to {frames} frames a sequence"),
        None => String::new(),
    };
    format!(
        "# Experiments\n\n\
         The tables and figures of section VI of Liao et al. 2020 on simulated scenes, written by\n\n\
         ```sh\n{command}\n```\n\n\
         Each figure is a mean over {}{frames}, ± the half width of its 95 % confidence interval: Student's t over the \
         means of the seeds, each of which is a mean over the objects of one random scene. A seed draws the scene, the way \
         through it and all noise. A mean without interval comes from one seed. `experiments.json` has the same figures for \
         machines, and `experiment --check` compares a new run with them.\n\n\
         - shape: 1 - IoU of the axis-aligned boxes round the oriented boxes, both moved to the origin; paper shape: the same \
         with the axis-aligned box of the ellipsoid itself, as the paper has it, in which even a perfect estimate of a turned \
         box has an error.\n\
         - trans: distance of the centres. rot: angle between the main axes seen from above; objects with a round footprint \
         have none. IoU: of the oriented boxes where they stand.\n\
         - found: objects with an estimate of those that count, over all seeds. Errors are means over the objects found.\n\
         - id switches: how often an object is joined to another object of the map than the time before. in 90 % region: share \
         of the objects inside the region that their covariance claims to hold 90 %; of the last pose: share of the runs.\n\
         - A box is near the border within {BORDER_PX} px; the detector is sure of a box above {SURE}, where the paper takes \
         YOLO's 0.95: the simulated detector gives large objects 0.90 ± 0.06 and small ones less.\n",
        results.seeds_in_words(),
    )
}

/// Nothing where no row of the table was run.
fn table_text(table: &Table, results: &Results) -> Option<String> {
    let mut text = String::from("| sequence | |");
    for metric in table.metrics {
        let _ = write!(text, " {} |", metric.title());
    }
    text.push_str(" found |\n| --- | --- |");
    text.push_str(&" --- |".repeat(table.metrics.len() + 1));
    text.push('\n');
    let mut lines = 0;
    for sequence in table.sequences {
        for (protocol, row, cell) in block(table, sequence, results) {
            let name = match table.protocols {
                [_] => row.name.to_owned(),
                _ if table.rows.len() == 1 => protocol.name.to_owned(),
                _ => format!("{}; {}", row.name, protocol.name),
            };
            let _ = writeln!(text, "| {} | {name} |{}", sequence.name, cells(table, cell));
            lines += 1;
        }
        let published = table.published.iter().filter(|(of, _)| of == sequence);
        for (_, block) in published {
            for (method, numbers) in &block.rows {
                let cells = published_cells(table, numbers);
                let _ = writeln!(text, "| *paper: {}* | *{method}* |{cells}", block.name);
            }
        }
    }
    (lines > 0).then_some(text)
}

/// The lines of a sequence that were run.
pub(super) fn block<'a>(
    table: &'a Table,
    sequence: &'a Sequence,
    results: &'a Results,
) -> impl Iterator<Item = (&'a Protocol, &'static Row, &'a Cell)> {
    table.protocols.iter().flat_map(move |protocol| {
        let rows = ROWS.iter().filter(|row| table.rows.contains(&row.key));
        rows.filter_map(move |row| {
            let key = cell_key(sequence, protocol, row.key);
            Some((protocol, row, results.cells.get(&key)?))
        })
    })
}

fn cells(table: &Table, cell: &Cell) -> String {
    let mut text = String::new();
    for metric in table.metrics {
        let _ = write!(text, " {} |", number(cell.metrics.get(metric), *metric));
    }
    let _ = write!(text, " {} of {} |", cell.found, cell.true_objects);
    text
}

fn published_cells(table: &Table, numbers: &[f64; 3]) -> String {
    let mut text = String::new();
    for metric in table.metrics {
        match paper::METRICS.iter().position(|published| published == metric) {
            Some(at) => {
                let _ = write!(text, " *{:.*}* |", metric.decimals(), numbers[at]);
            }
            None => text.push_str(" |"),
        }
    }
    text + " |"
}

/// A mean with its interval.
pub(super) fn number(interval: Option<&Interval>, metric: Metric) -> String {
    let decimals = metric.decimals();
    match interval {
        None => "-".to_owned(),
        Some(Interval { mean, half_width: None, .. }) => format!("{mean:.decimals$}"),
        Some(Interval { mean, half_width: Some(half), .. }) => {
            format!("{mean:.decimals$} ± {half:.decimals$}")
        }
    }
}

fn figures(results: &Results) -> String {
    let mut text = String::new();
    if results.cells.values().any(|cell| !cell.curves.is_empty()) {
        let _ = write!(
            text,
            "\n## Figure 6: error against the number of views\n\n\
             The error of the map after each box of an object that the detector reported; the paper's protocol. An object \
             with fewer views keeps its last error, so every point is about the same objects. Bands are the intervals. The \
             paper finds QuadricSLAM settled after about 25 views and DwB after about 10, close to its first estimate.\n\n\
             ![error against the number of views]({CONVERGENCE_FILE})\n\n{}",
            convergence_text(results)
        );
    }
    for sweep in SWEEPS.iter().filter(|sweep| swept(sweep, results)) {
        let _ = write!(
            text,
            "\n## Like figure 7: error against {}\n\n{} Dashed: {}.\n\n![error against {}]({})\n",
            sweep.axis,
            sweep.text,
            names(sweep.references),
            sweep.axis,
            sweep_file(sweep)
        );
    }
    text
}

fn names(keys: &[&str]) -> String {
    let names = ROWS.iter().filter(|row| keys.contains(&row.key)).map(|row| row.name);
    names.collect::<Vec<_>>().join(", ")
}

/// Some points of the curves as a table.
fn convergence_text(results: &Results) -> String {
    const VIEWS: [usize; 5] = [1, 3, 10, 25, 40];
    let mut text = String::from("| sequence | | |");
    for views in VIEWS {
        let _ = write!(text, " {views} |");
    }
    text.push_str("\n| --- | --- | --- |");
    text.push_str(&" --- |".repeat(VIEWS.len()));
    text.push('\n');
    for sequence in CONVERGENCE.sequences {
        for row in ROWS.iter().filter(|row| CONVERGENCE.rows.contains(&row.key)) {
            let key = cell_key(sequence, &CONVERGENCE.protocol, row.key);
            let curves = results.cells.get(&key).map(|cell| &cell.curves);
            for (metric, curve) in curves.into_iter().flatten() {
                let _ = write!(text, "| {} | {} | {} |", sequence.name, row.name, metric.title());
                for views in VIEWS {
                    let at = curve.get(views - 1).and_then(Option::as_ref);
                    let _ = write!(text, " {} |", number(at, *metric));
                }
                text.push('\n');
            }
        }
    }
    text
}
