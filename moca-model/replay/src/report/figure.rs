//! Figure of a report, like that of the paper's Experiment 4. It has a column for each run: x, y and z of the end
//! effector with the shared workspace as a band, and the score below.

use std::{fmt::Display, ops::Range};

use ergo_map::ActionLevel;
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
    series::DashedLineSeries,
};

use super::{
    ReportError, RunLog,
    log::{Interval, Span},
};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

const COLUMN_WIDTH: u32 = 680;
const TITLE_HEIGHT: u32 = 46;
const PANEL_HEIGHT: u32 = 205;
const TIME_HEIGHT: u32 = 45;
const LEGEND_HEIGHT: u32 = 66;
const LEGEND_WIDTH: u32 = 1060;
const FONT: &str = "sans-serif";

const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);
const SHADE: RGBColor = RGBColor(255, 245, 217);
const SCORE: RGBColor = RGBColor(109, 40, 217);

/// Colours of the measured posture, by REBA's action levels.
const LEVELS: [(&str, RGBColor); 3] = [
    ("1 to 3", RGBColor(120, 190, 110)),
    ("4 to 7: action necessary", RGBColor(245, 175, 60)),
    ("8 and more: soon or now", RGBColor(210, 50, 45)),
];

/// Height of the strip of measured scores, as a share of the score's panel.
const STRIP: f64 = 0.045;

/// Axes of the end effector's position with their colours.
const AXES: [(&str, RGBColor); 3] =
    [("x", RGBColor(200, 55, 45)), ("y", RGBColor(30, 130, 70)), ("z", RGBColor(35, 95, 215))];

/// Draws the runs side by side with equal scales.
///
/// The upper panels show the desired (dashed) and actual (solid) position, with the shared workspace as a band. The
/// panel below shows the score `e_s`, shaded while the person works with the robot. A strip has the colour of the
/// person's measured REBA. Returns the figure as SVG.
///
/// # Errors
/// [`ReportError::Nothing`] without runs or with a run without ticks; [`ReportError::Figure`] if it cannot be drawn.
pub fn figure(runs: &[&RunLog]) -> Result<String, ReportError> {
    if runs.is_empty() || runs.iter().any(|run| run.intervals.is_empty()) {
        return Err(ReportError::Nothing);
    }
    let columns = u32::try_from(runs.len()).map_err(failed)?;
    let width = (COLUMN_WIDTH * columns).max(LEGEND_WIDTH);
    let height = TITLE_HEIGHT + 4 * PANEL_HEIGHT + TIME_HEIGHT + LEGEND_HEIGHT;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (columns, legend) = root.split_vertically(height - LEGEND_HEIGHT);
        let scales = Scales::of(runs);
        for (area, run) in columns.split_evenly((1, runs.len())).iter().zip(runs) {
            column(area, run, &scales)?;
        }
        draw_legend(&legend)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> ReportError {
    ReportError::Figure(error.to_string())
}

/// Scales of all runs.
struct Scales {
    time: Range<f64>,
    axes: [Range<f64>; 3],
    score: Range<f64>,
}

impl Scales {
    fn of(runs: &[&RunLog]) -> Self {
        let all = || runs.iter().flat_map(|run| &run.intervals);
        let time = range(all().flat_map(|interval| [interval.begin, interval.end]), 0.0);
        let extremes = |span: &Span| [span.low, span.high];
        let axes = [0, 1, 2].map(|axis: usize| {
            let curves = all().flat_map(move |interval| {
                [
                    &interval.desired,
                    &interval.actual,
                    &interval.workspace_min,
                    &interval.workspace_max,
                ]
                .into_iter()
                .flat_map(move |curve| extremes(&curve[axis]))
            });
            range(curves, 0.06)
        });
        let highest = range(all().map(|interval| interval.score.high), 0.0).end;
        Self { time, axes, score: 0.0..(1.15 * highest).max(0.5) }
    }
}

/// Returns the range of the finite values with a margin, as a fraction of the range; never empty.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return 0.0..1.0;
    }
    let margin = if high - low < 1e-6 { 0.05 } else { margin * (high - low) };
    low - margin..high + margin
}

fn column(area: &Area<'_>, run: &RunLog, scales: &Scales) -> Result<(), ReportError> {
    let (title, panels) = area.split_vertically(TITLE_HEIGHT);
    let style = (FONT, 22).into_font().color(&TEXT);
    title.draw(&Text::new(run.title().to_owned(), (82, 16), style)).map_err(failed)?;
    let (positions, score) = panels.split_vertically(3 * PANEL_HEIGHT);
    for (axis, area) in positions.split_evenly((3, 1)).iter().enumerate() {
        position_panel(area, run, axis, scales)?;
    }
    score_panel(&score, run, scales)
}

fn position_panel(
    area: &Area<'_>,
    run: &RunLog,
    axis: usize,
    scales: &Scales,
) -> Result<(), ReportError> {
    let (name, colour) = AXES[axis];
    let range = scales.axes[axis].clone();
    let mut chart = panel(area, &format!("{name} (m)"), "", scales.time.clone(), range.clone())?;
    for band in bands(&run.intervals, axis, &range) {
        chart.draw_series([Polygon::new(band, colour.mix(0.16))]).map_err(failed)?;
    }
    let actual = curve(&run.intervals, |interval| &interval.actual[axis]);
    let desired = curve(&run.intervals, |interval| &interval.desired[axis]);
    chart.draw_series(LineSeries::new(actual, colour.stroke_width(3))).map_err(failed)?;
    let dashes = DashedLineSeries::new(desired, 7, 5, TEXT.stroke_width(1));
    chart.draw_series(dashes).map_err(failed)?;
    Ok(())
}

fn score_panel(area: &Area<'_>, run: &RunLog, scales: &Scales) -> Result<(), ReportError> {
    let top = scales.score.end;
    let mut chart =
        panel(area, "score e_s", "time (s)", scales.time.clone(), scales.score.clone())?;
    let shades = collaborations(&run.intervals)
        .into_iter()
        .map(|(begin, end)| Rectangle::new([(begin, 0.0), (end, top)], SHADE.filled()));
    chart.draw_series(shades).map_err(failed)?;
    let strips = measured(&run.intervals).into_iter().map(|(begin, end, colour)| {
        Rectangle::new([(begin, 0.0), (end, STRIP * top)], colour.filled())
    });
    chart.draw_series(strips).map_err(failed)?;
    let score = curve(&run.intervals, |interval| &interval.score);
    chart.draw_series(LineSeries::new(score, SCORE.stroke_width(2))).map_err(failed)?;
    if let Some(mean) = run.collaboration.score_mean() {
        let reba = run.collaboration.reba_max;
        let text = format!("while collaborating: mean e_s {mean:.2}, highest REBA {reba}");
        let style = (FONT, 15).into_font().color(&TEXT);
        chart
            .plotting_area()
            .draw(&Text::new(
                text,
                (scales.time.start + 0.01 * span(&scales.time), 0.985 * top),
                style,
            ))
            .map_err(failed)?;
    }
    Ok(())
}

fn span(range: &Range<f64>) -> f64 {
    range.end - range.start
}

/// Draws an empty chart with grid, labels and units.
fn panel<'a, 'b>(
    area: &'a Area<'b>,
    name: &str,
    below: &str,
    time: Range<f64>,
    values: Range<f64>,
) -> Result<Chart<'a, 'b>, ReportError> {
    let decimals = if span(&values) < 0.5 { 2 } else { 1 };
    let mut chart = ChartBuilder::on(area)
        .margin_left(8)
        .margin_right(22)
        .margin_top(8)
        .margin_bottom(if below.is_empty() { 4 } else { 0 })
        .x_label_area_size(if below.is_empty() { 20 } else { 50 })
        .y_label_area_size(72)
        .build_cartesian_2d(time, values)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .x_desc(below)
        .y_desc(name)
        .x_labels(9)
        .y_labels(6)
        .x_label_formatter(&|time| format!("{time:.0}"))
        // Avoids "-0.0".
        .y_label_formatter(&|value| format!("{:.decimals$}", (value * 1e6).round() / 1e6 + 0.0))
        .label_style((FONT, 15).into_font().color(&TEXT))
        .axis_desc_style((FONT, 17).into_font().color(&TEXT))
        .axis_style(TEXT.mix(0.7))
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .draw()
        .map_err(failed)?;
    Ok(chart)
}

/// Returns a curve through the extremes of every interval, without those that are not finite.
fn curve(intervals: &[Interval], of: impl Fn(&Interval) -> &Span) -> Vec<(f64, f64)> {
    let points = intervals.iter().flat_map(|interval| {
        let span = of(interval);
        let middle = f64::midpoint(interval.begin, interval.end);
        let [first, second] = span.in_order();
        // A flat stretch needs one point.
        let second = Some((middle, second)).filter(|_| span.high - span.low > 2e-4);
        [Some((interval.begin, first)), second].into_iter().flatten()
    });
    points.filter(|(_, value)| value.is_finite()).collect()
}

/// Returns the outlines of the workspace on one axis, one for each stretch of time with a workspace. They are cut to
/// the range that is drawn.
fn bands(intervals: &[Interval], axis: usize, range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let there = |interval: &Interval| {
        let (low, high) = (interval.workspace_min[axis].low, interval.workspace_max[axis].high);
        !low.is_nan() && !high.is_nan()
    };
    intervals
        .chunk_by(|one, next| there(one) == there(next))
        .filter(|stretch| stretch.first().is_some_and(there))
        .map(|stretch| {
            let cut = |value: f64| value.clamp(range.start, range.end);
            let lower = stretch
                .iter()
                .map(|interval| (interval.begin, cut(interval.workspace_min[axis].low)));
            let upper = stretch
                .iter()
                .map(|interval| (interval.begin, cut(interval.workspace_max[axis].high)));
            lower.chain(upper.rev()).collect()
        })
        .collect()
}

/// Returns the begin and end of each stretch in which the person works with the robot \[s\].
fn collaborations(intervals: &[Interval]) -> Vec<(f64, f64)> {
    intervals
        .chunk_by(|one, next| one.collaborating == next.collaborating)
        .filter_map(|stretch| Some((stretch.first()?, stretch.last()?)))
        .filter(|(first, _)| first.collaborating)
        .map(|(first, last)| (first.begin, last.end))
        .collect()
}

/// Returns the colour of a measured REBA score.
fn level(reba: u8) -> RGBColor {
    let [(_, low), (_, medium), (_, high)] = LEVELS;
    match ActionLevel::of(reba) {
        ActionLevel::None | ActionLevel::MayBeNecessary => low,
        ActionLevel::Necessary => medium,
        ActionLevel::NecessarySoon | ActionLevel::NecessaryNow => high,
    }
}

/// Returns the begin and end of each stretch with a measured posture of one colour \[s\].
fn measured(intervals: &[Interval]) -> Vec<(f64, f64, RGBColor)> {
    let colour = |interval: &Interval| interval.reba_measured.map(level);
    intervals
        .chunk_by(|one, next| colour(one) == colour(next))
        .filter_map(|stretch| {
            let (first, last) = (stretch.first()?, stretch.last()?);
            Some((first.begin, last.end, colour(first)?))
        })
        .collect()
}

fn draw_legend(area: &Area<'_>) -> Result<(), ReportError> {
    let style = (FONT, 16).into_font().color(&TEXT);
    let (y, wide) = (16, 34);
    let [(_, red), (_, green), (_, blue)] = AXES;
    let text = |text: &'static str, x| Text::new(text, (x + wide + 8, y - 7), style.clone());
    let line = |x, from: i32, to: i32, style: ShapeStyle| {
        PathElement::new([(x + from, y), (x + to, y)], style)
    };

    // Three short strokes, one in the colour of each axis.
    let x = 82;
    for (part, colour) in (0..).zip([red, green, blue]) {
        area.draw(&line(x, 12 * part, 12 * part + 10, colour.stroke_width(3))).map_err(failed)?;
    }
    area.draw(&text("actual position", x)).map_err(failed)?;
    let x = 260;
    for part in 0..3 {
        area.draw(&line(x, 12 * part, 12 * part + 7, TEXT.stroke_width(1))).map_err(failed)?;
    }
    area.draw(&text("desired position", x)).map_err(failed)?;
    let x = 450;
    for (part, colour) in (0..).zip([red, green, blue]) {
        let corners = [(x + 12 * part, y - 7), (x + 12 * part + 11, y + 7)];
        area.draw(&Rectangle::new(corners, colour.mix(0.16).filled())).map_err(failed)?;
    }
    area.draw(&text("shared workspace (HRSW)", x)).map_err(failed)?;
    let x = 710;
    area.draw(&line(x, 0, wide, SCORE.stroke_width(2))).map_err(failed)?;
    area.draw(&text("ergonomics score", x)).map_err(failed)?;
    let x = 900;
    let corners = [(x, y - 7), (x + wide, y + 7)];
    area.draw(&Rectangle::new(corners, SHADE.filled())).map_err(failed)?;
    area.draw(&text("collaborating", x)).map_err(failed)?;

    let y = y + 26;
    let text = |text: &'static str, x| Text::new(text, (x, y - 7), style.clone());
    area.draw(&text("the person's posture as measured, REBA", 82)).map_err(failed)?;
    for ((name, colour), x) in LEVELS.into_iter().zip([392, 512, 752]) {
        let corners = [(x, y - 4), (x + wide, y + 4)];
        area.draw(&Rectangle::new(corners, colour.filled())).map_err(failed)?;
        area.draw(&text(name, x + wide + 8)).map_err(failed)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::report::TickRow;

    /// A minute in which the workspace moves and the end effector follows it.
    fn run(title: &str, score: f64) -> RunLog {
        let mut log = RunLog::new(title);
        for tick in 0..60_000_u32 {
            let time = 1e-3 * f64::from(tick);
            let moved = (time - 15.0).clamp(0.0, 6.0) * 0.2;
            let middle = [0.8 + moved, -0.3 * (0.2 * time).sin(), 1.05];
            let there = time > 4.0;
            let bound = |half: f64| middle.map(|x| if there { x + half } else { f64::NAN });
            let collaborating = (7.0..50.0).contains(&time) && !(9.0..12.0).contains(&time);
            log.push(&TickRow {
                time,
                desired: middle.map(|x| x + 0.05 * (0.7 * time).sin()),
                actual: middle.map(|x| x + 0.05 * (0.7 * time - 0.05).sin()),
                workspace_min: bound(-0.15),
                workspace_max: bound(0.15),
                score: if collaborating {
                    score * (1.3 + (0.5 * time).cos() * 0.3)
                } else {
                    score * 2.0
                },
                reba: 3,
                reba_measured: (time > 5.0).then_some(if time < 20.0 { 5 } else { 2 }),
                collaborating,
                ..TickRow::default()
            });
        }
        log
    }

    #[test]
    fn figure_is_labelled_and_small() {
        let (on, off) = (run("Ergonomics on", 0.25), run("Ergonomics off", 1.1));
        let svg = figure(&[&on, &off]).unwrap();
        for text in [
            "Ergonomics on",
            "Ergonomics off",
            "x (m)",
            "y (m)",
            "z (m)",
            "score e_s",
            "time (s)",
            "desired position",
            "shared workspace",
            "highest REBA 3",
            "REBA",
        ] {
            assert!(svg.contains(text), "no \"{text}\"");
        }
        // A strip for each colour, and a sample of each in the legend.
        for (colour, count) in [("#78BE6E", 3), ("#F5AF3C", 3), ("#D2322D", 1)] {
            assert_eq!(svg.matches(colour).count(), count, "{colour}");
        }
        assert!(svg.len() < 1_000_000, "{} bytes", svg.len());
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn run_without_or_with_boundless_workspace_is_drawn() {
        for bound in [f64::NAN, f64::INFINITY] {
            let mut log = RunLog::new("odd");
            for tick in 0..10 {
                log.push(&TickRow {
                    time: f64::from(tick),
                    score: f64::NAN,
                    workspace_min: [-bound; 3],
                    workspace_max: [bound; 3],
                    ..TickRow::default()
                });
            }
            let svg = figure(&[&log]).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
        }
    }

    #[test]
    fn nothing_is_not_drawn() {
        assert!(matches!(figure(&[]), Err(ReportError::Nothing)));
        assert!(matches!(figure(&[&RunLog::new("empty")]), Err(ReportError::Nothing)));
    }
}
