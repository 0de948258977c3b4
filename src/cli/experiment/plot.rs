//! Curves with their intervals as SVG.

use crate::eval::Interval;
use anyhow::anyhow;
use plotters::{
    coord::{
        Shift,
        ranged1d::{Ranged, ValueFormatter},
        types::RangedCoordf64,
    },
    prelude::*,
};

/// One system of axes.
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x_axis: String,
    pub(super) y_axis: String,
    pub(super) is_logarithmic: bool,
    pub(super) x_range: (f64, f64),
    pub(super) curves: Vec<Curve>,
}

/// A line with a band around it; a dashed one has none.
pub(super) struct Curve {
    pub(super) name: &'static str,
    /// The same in all panels.
    pub(super) color: usize,
    pub(super) is_dashed: bool,
    pub(super) points: Vec<(f64, Interval)>,
}

const PANEL_SIZE: (u32, u32) = (460, 260);
const FONT: &str = "sans-serif";
/// Colours that the colour-blind can tell apart (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];

/// The panels, `columns` in a line.
pub(super) fn svg(panels: &[Panel], columns: usize) -> anyhow::Result<String> {
    let lines = panels.len().div_ceil(columns);
    let (width, height) = PANEL_SIZE;
    let size = (width * u32::try_from(columns)?, height * u32::try_from(lines)?);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        area.fill(&WHITE).map_err(|e| anyhow!("cannot draw: {e}"))?;
        let areas = area.split_evenly((lines, columns));
        for (index, (panel, area)) in panels.iter().zip(areas).enumerate() {
            // All panels have the same curves: the first one says which is which.
            draw(panel, &area, index == 0)
                .map_err(|e| anyhow!("cannot draw {}: {e}", panel.title))?;
        }
        area.present().map_err(|e| anyhow!("cannot draw: {e}"))?;
    }
    Ok(text)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b, X> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, RangedCoordf64>>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

fn draw(panel: &Panel, area: &Area<'_>, has_legend: bool) -> Drawn {
    let top = top(panel);
    let mut builder = ChartBuilder::on(area);
    builder.caption(&panel.title, (FONT, 15));
    builder.margin(8).margin_right(16).x_label_area_size(36).y_label_area_size(56);
    let (from, to) = panel.x_range;
    if panel.is_logarithmic {
        let mut chart = builder.build_cartesian_2d((from..to).log_scale(), 0.0..top)?;
        fill(panel, top, has_legend, &mut chart)
    } else {
        let mut chart = builder.build_cartesian_2d(from..to, 0.0..top)?;
        fill(panel, top, has_legend, &mut chart)
    }
}

/// The highest value that is shown: wide intervals of few seeds must not flatten the curves.
fn top(panel: &Panel) -> f64 {
    let points = || panel.curves.iter().flat_map(|curve| &curve.points).map(|(_, at)| at);
    let highest = points().map(high).fold(0.0, f64::max);
    let highest_mean = points().map(|at| at.mean).fold(0.0, f64::max);
    let top = 1.05 * highest.min(2.0 * highest_mean);
    if top > 0.0 { top } else { 1.0 }
}

fn fill<'a, 'b: 'a, X>(
    panel: &Panel,
    top: f64,
    has_legend: bool,
    chart: &mut Chart<'a, 'b, X>,
) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .x_desc(&panel.x_axis)
        .y_desc(&panel.y_axis)
        .light_line_style(TRANSPARENT)
        .label_style((FONT, 12))
        .x_label_formatter(&|at| short(*at))
        .y_label_formatter(&|at| short(*at))
        .draw()?;
    for curve in &panel.curves {
        draw_curve(curve, top, chart)?;
    }
    if has_legend {
        chart
            .configure_series_labels()
            .label_font((FONT, 12))
            .background_style(WHITE.mix(0.7))
            .position(SeriesLabelPosition::UpperRight)
            .draw()?;
    }
    Ok(())
}

fn draw_curve<X>(curve: &Curve, top: f64, chart: &mut Chart<'_, '_, X>) -> Drawn
where
    X: Ranged<ValueType = f64>,
{
    let color = COLORS[curve.color % COLORS.len()];
    let line: Vec<(f64, f64)> = curve.points.iter().map(|(x, y)| (*x, y.mean)).collect();
    let drawn = if curve.is_dashed {
        chart.draw_series(DashedLineSeries::new(line, 6, 4, color.stroke_width(2)))?
    } else {
        let upper = curve.points.iter().map(|(x, y)| (*x, high(y).min(top)));
        let lower = curve.points.iter().rev().map(|(x, y)| (*x, low(y)));
        let band: Vec<(f64, f64)> = upper.chain(lower).collect();
        chart.draw_series([Polygon::new(band, color.mix(0.15))])?;
        chart.draw_series(LineSeries::new(line, color.stroke_width(2)))?
    };
    let style = color.stroke_width(2);
    drawn.label(curve.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
    Ok(())
}

fn high(at: &Interval) -> f64 {
    at.mean + at.half_width.unwrap_or(0.0)
}

/// No error is negative, even if an interval says so.
fn low(at: &Interval) -> f64 {
    (at.mean - at.half_width.unwrap_or(0.0)).max(0.0)
}

/// Three digits are enough for an axis.
fn short(value: f64) -> String {
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let decimals = (2.0 - magnitude).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_three_digits_and_no_idle_zeros() {
        let cases = [
            (0.0, "0"),
            (0.05, "0.05"),
            (0.30000000000000004, "0.3"),
            (12.5, "12.5"),
            (40.0, "40"),
            (1e5, "100000"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }
}
