//! The figures that the results give.

use super::{
    metric::Metric,
    plan::{CONVERGENCE, SWEEPS, Sweep, cell_key, swept_key},
    plot::{Curve, Panel, svg},
    results::Results,
    row::ROWS,
    sequence::Sequence,
    trial::{CURVE_METRICS, CURVE_VIEWS},
};
use crate::eval::Interval;

pub(super) const CONVERGENCE_FILE: &str = "experiments_views.svg";

/// The file of a sweep's figure.
pub(super) fn sweep_file(sweep: &Sweep) -> String {
    format!("experiments_{}.svg", sweep.key)
}

/// Every file that figures may be written to.
pub(super) fn files() -> impl Iterator<Item = String> {
    [CONVERGENCE_FILE.to_owned()].into_iter().chain(SWEEPS.iter().map(sweep_file))
}

/// Whether the values of a sweep were run.
pub(super) fn swept(sweep: &Sweep, results: &Results) -> bool {
    results.cells.keys().any(|key| key.contains(&format!("/{}=", sweep.key)))
}

/// Every figure as its file's name and text, as far as its rows were run.
pub(super) fn drawn(results: &Results) -> anyhow::Result<Vec<(String, String)>> {
    let mut figures = Vec::new();
    let panels = of_convergence(results);
    if panels.iter().any(|panel| !panel.curves.is_empty()) {
        figures.push((CONVERGENCE_FILE.to_owned(), svg(&panels, CONVERGENCE.sequences.len())?));
    }
    for sweep in SWEEPS.iter().filter(|sweep| swept(sweep, results)) {
        let panels = of_sweep(sweep, results);
        figures.push((sweep_file(sweep), svg(&panels, sweep.sequences.len())?));
    }
    Ok(figures)
}

/// A line of panels a metric, a panel a sequence.
fn grid(sequences: &[Sequence]) -> impl Iterator<Item = (Metric, &Sequence)> {
    CURVE_METRICS.into_iter().flat_map(|m| sequences.iter().map(move |sequence| (m, sequence)))
}

fn of_convergence(results: &Results) -> Vec<Panel> {
    let panel = |(metric, sequence): (Metric, &Sequence)| Panel {
        title: sequence.name.to_owned(),
        x_axis: "views of an object".to_owned(),
        y_axis: metric.title().to_owned(),
        is_logarithmic: false,
        x_range: (1.0, CURVE_VIEWS as f64),
        curves: (ROWS.iter().enumerate())
            .filter(|(_, row)| CONVERGENCE.rows.contains(&row.key))
            .filter_map(|(color, row)| {
                let key = cell_key(sequence, &CONVERGENCE.protocol, row.key);
                let curve = results.cells.get(&key)?.curves.get(&metric)?;
                let points =
                    (1..).zip(curve).filter_map(|(views, at)| Some((f64::from(views), (*at)?)));
                Some(Curve { name: row.name, color, is_dashed: false, points: points.collect() })
            })
            .collect(),
    };
    grid(CONVERGENCE.sequences).map(panel).collect()
}

fn of_sweep(sweep: &Sweep, results: &Results) -> Vec<Panel> {
    let range = (
        sweep.values.first().copied().unwrap_or(1.0),
        sweep.values.last().copied().unwrap_or(10.0),
    );
    let of_cell = |key: &str, metric| -> Option<Interval> {
        results.cells.get(key)?.metrics.get(&metric).copied()
    };
    let panel = |(metric, sequence): (Metric, &Sequence)| {
        let curve = |(color, row): (usize, &super::row::Row)| {
            let key = cell_key(sequence, &sweep.protocol, row.key);
            let is_dashed = row.key != sweep.row;
            let points = if is_dashed {
                let level = of_cell(&key, metric)?;
                vec![(range.0, level), (range.1, level)]
            } else {
                let at =
                    |value: &f64| Some((*value, of_cell(&swept_key(&key, sweep, *value), metric)?));
                sweep.values.iter().filter_map(at).collect()
            };
            Some(Curve { name: row.name, color, is_dashed, points })
        };
        let rows = ROWS.iter().enumerate();
        Panel {
            title: sequence.name.to_owned(),
            x_axis: sweep.axis.to_owned(),
            y_axis: metric.title().to_owned(),
            is_logarithmic: true,
            x_range: range,
            curves: rows
                .filter(|(_, row)| row.key == sweep.row || sweep.references.contains(&row.key))
                .filter_map(curve)
                .collect(),
        }
    };
    grid(sweep.sequences).map(panel).collect()
}
