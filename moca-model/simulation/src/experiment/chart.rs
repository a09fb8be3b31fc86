//! Charts of panels with points and lines, side by side.

use std::fmt::Display;
use std::ops::Range;

use plotters::{coord::Shift, prelude::*};

use crate::error::Error;

const SIZE: (u32, u32) = (520, 420);
const LEGEND_HEIGHT: u32 = 34;
const FONT: &str = "sans-serif";
const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);

/// Colours that colour-blind people can distinguish (Okabe & Ito 2008).
const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(90, 90, 90)];

/// The drawing style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    /// A dot for each point.
    Dots,
    /// A line through dots.
    Line,
}

/// Points of one colour.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: &'static str,
    pub(super) style: Style,
    pub(super) points: Vec<(f64, f64)>,
}

/// A chart.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    pub(super) title: &'static str,
    pub(super) x: &'static str,
    pub(super) y: &'static str,
    pub(super) series: Vec<Series>,
    /// True to draw the line of equal x and y, with the same scale on both axes.
    pub(super) diagonal: bool,
}

/// Draws panels side by side as SVG. Values that are not finite are left out.
pub(super) fn chart(panels: &[Panel]) -> Result<String, Error> {
    let count = u32::try_from(panels.len()).unwrap_or(u32::MAX);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (SIZE.0 * count, SIZE.1)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
            let (plot, legend) = area.split_vertically(SIZE.1 - LEGEND_HEIGHT);
            draw(&plot, panel)?;
            draw_legend(&legend, panel)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> Error {
    Error::Figure(error.to_string())
}

/// The range from zero to a little above the largest value.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let largest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    0.0..if largest > 0.0 { 1.08 * largest } else { 1.0 }
}

/// The range around all values.
fn extent(values: impl Iterator<Item = f64>) -> Range<f64> {
    let values = values.filter(|value| value.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.0..1.0;
    }
    let margin = 0.05 * (high - low).max(0.1);
    low - margin..high + margin
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Error> {
    let points = || panel.series.iter().flat_map(|series| series.points.iter().copied());
    let (mut x, mut y) = (extent(points().map(|(x, _)| x)), range(points().map(|(_, y)| y)));
    if panel.diagonal {
        x = range(points().flat_map(|(x, y)| [x, y]));
        y = x.clone();
    }
    let end = x.end;
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .caption(panel.title, (FONT, 19).into_font().color(&TEXT))
        .x_label_area_size(44)
        .y_label_area_size(58)
        .build_cartesian_2d(x, y)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .x_desc(panel.x)
        .y_desc(panel.y)
        .x_labels(8)
        .y_labels(6)
        .x_label_formatter(&|value| format!("{value:.2}"))
        .y_label_formatter(&|value| format!("{value:.2}"))
        .label_style((FONT, 14).into_font().color(&TEXT))
        .axis_desc_style((FONT, 16).into_font().color(&TEXT))
        .axis_style(TEXT)
        .draw()
        .map_err(failed)?;
    if panel.diagonal {
        let line = PathElement::new([(0.0, 0.0), (end, end)], TEXT.mix(0.4).stroke_width(1));
        chart.draw_series([line]).map_err(failed)?;
    }
    for (series, colour) in panel.series.iter().zip(COLOURS) {
        let finite = |point: &&(f64, f64)| point.0.is_finite() && point.1.is_finite();
        let points: Vec<_> = series.points.iter().filter(finite).copied().collect();
        if series.style == Style::Line {
            let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2));
            chart.draw_series(line).map_err(failed)?;
        }
        let dots = points.into_iter().map(|point| Circle::new(point, 3, colour.mix(0.7).filled()));
        chart.draw_series(dots).map_err(failed)?;
    }
    Ok(())
}

fn draw_legend(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Error> {
    let style = (FONT, 15).into_font().color(&TEXT);
    let mut x = 70;
    for (series, colour) in panel.series.iter().zip(COLOURS) {
        area.draw(&Rectangle::new([(x, 6), (x + 14, 20)], colour.filled())).map_err(failed)?;
        area.draw(&Text::new(series.name, (x + 20, 6), style.clone())).map_err(failed)?;
        x += 46 + 8 * i32::try_from(series.name.chars().count()).unwrap_or_default();
    }
    Ok(())
}
