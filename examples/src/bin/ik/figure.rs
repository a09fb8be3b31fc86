//! The picture of a run: joints within their ranges, errors, and the motion from the front and from the side.

use std::{fmt::Display, ops::Range};

use anyhow::{Result, anyhow, ensure};
use nalgebra::Vector3;
use plotters::{coord::Shift, prelude::*};

use crate::record::{Record, Tick};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const SIZE: (u32, u32) = (1100, 900);
const FONT: &str = "sans-serif";
const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);
const ROBOT: RGBColor = RGBColor(150, 160, 180);
const TARGET: RGBColor = RGBColor(200, 55, 45);
const ACTUAL: RGBColor = RGBColor(35, 95, 215);
/// Largest number of points of a curve.
const POINTS: usize = 400;

/// Draws the picture as SVG.
///
/// # Errors
/// A run without ticks, or one that cannot be drawn.
pub(crate) fn figure(record: &Record) -> Result<String> {
    ensure!(!record.ticks.is_empty(), "there is no tick to draw");
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (curves, views) = root.split_vertically(540);
        let [joints, position, orientation] = &curves.split_evenly((3, 1))[..] else {
            return Err(anyhow!("the picture has no room"));
        };
        draw_joints(joints, record)?;
        let ticks = thinned(&record.ticks);
        let errors = |error: fn(&Tick) -> f64| -> Vec<(f64, f64)> {
            ticks.iter().map(|tick| (tick.time, error(tick))).collect()
        };
        let millimetres = errors(|tick| 1e3 * tick.position_error);
        draw_curves(position, "position error (mm)", &[(millimetres, ACTUAL)], None)?;
        let angles = errors(|tick| 1e3 * tick.orientation_error);
        draw_curves(orientation, "orientation error (mrad)", &[(angles, ACTUAL)], None)?;
        let (front, side) = views.split_horizontally(SIZE.0 / 2);
        draw_view(&front, "front: y, z (m)", record, 1)?;
        draw_view(&side, "side: x, z (m)", record, 0)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> anyhow::Error {
    anyhow!("the picture cannot be drawn: {error}")
}

fn thinned(ticks: &[Tick]) -> Vec<&Tick> {
    ticks.iter().step_by(ticks.len().div_ceil(POINTS)).collect()
}

/// Draws all joints from the lower end of their ranges, 0, to the upper end, 1; grey where a limit stops one.
fn draw_joints(area: &Area<'_>, record: &Record) -> Result<()> {
    let ticks = thinned(&record.ticks);
    let finite = record.ranges.iter().enumerate();
    let curves: Vec<_> = finite
        .filter(|(_, (lower, upper))| (upper - lower).is_finite())
        .map(|(joint, (lower, upper))| {
            let curve = ticks
                .iter()
                .map(|tick| (tick.time, (tick.positions[joint] - lower) / (upper - lower)));
            let HSLColor(hue, saturation, light) = HSLColor(joint as f64 * 0.618 % 1.0, 0.7, 0.45);
            let (red, green, blue) = HSLColor(hue, saturation, light).rgb();
            (curve.collect(), RGBColor(red, green, blue))
        })
        .collect();
    draw_curves(
        area,
        "joints within their ranges; shaded: a limit is active",
        &curves,
        Some(&ticks),
    )
}

fn draw_curves(
    area: &Area<'_>,
    title: &str,
    curves: &[(Vec<(f64, f64)>, RGBColor)],
    shaded: Option<&[&Tick]>,
) -> Result<()> {
    let all = || curves.iter().flat_map(|(curve, _)| curve);
    let times = range(all().map(|point| point.0).chain([0.0]));
    let values = range(all().map(|point| point.1).chain([0.0]));
    let values = if shaded.is_some() { -0.02..1.02 } else { 0.0..1.1 * values.end.max(1e-6) };
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 16).into_font().color(&TEXT))
        .margin(6)
        .x_label_area_size(26)
        .y_label_area_size(64)
        .build_cartesian_2d(times, values.clone())
        .map_err(failed)?;
    chart.configure_mesh().light_line_style(WHITE).bold_line_style(GRID).draw().map_err(failed)?;
    let pairs = shaded.unwrap_or(&[]).windows(2).filter(|pair| pair[0].limited > 0);
    let corners = pairs.map(|pair| [(pair[0].time, values.start), (pair[1].time, values.end)]);
    let shade = corners.map(|corners| Rectangle::new(corners, GRID.filled()));
    chart.draw_series(shade).map_err(failed)?;
    for (curve, colour) in curves {
        chart.draw_series(LineSeries::new(curve.iter().copied(), *colour)).map_err(failed)?;
    }
    Ok(())
}

/// Draws the robot at some times, the path and the motion of the frame along it, over `axis` and z.
fn draw_view(area: &Area<'_>, title: &str, record: &Record, axis: usize) -> Result<()> {
    let seen = |place: &Vector3<f64>| (place[axis], place.z);
    let places = || record.poses.iter().flatten().map(seen);
    let ways = || record.ticks.iter().map(|tick| seen(&tick.target));
    let across = range(places().chain(ways()).map(|point| point.0));
    let up = range(places().chain(ways()).map(|point| point.1));
    // Both axes have the same scale.
    let half = 0.55 * (across.end - across.start).max(up.end - up.start).max(0.1);
    let around = |range: Range<f64>| {
        let middle = 0.5 * (range.start + range.end);
        middle - half..middle + half
    };
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 16).into_font().color(&TEXT))
        .margin(6)
        .margin_left(60)
        .margin_right(60)
        .x_label_area_size(26)
        .y_label_area_size(54)
        .build_cartesian_2d(around(across), around(up))
        .map_err(failed)?;
    chart.configure_mesh().light_line_style(WHITE).bold_line_style(GRID).draw().map_err(failed)?;
    for pose in &record.poses {
        let line = LineSeries::new(pose.iter().map(seen), ROBOT.stroke_width(2));
        chart.draw_series(line).map_err(failed)?;
        let joints = pose.iter().map(|place| Circle::new(seen(place), 2, ROBOT.filled()));
        chart.draw_series(joints).map_err(failed)?;
    }
    let ticks = thinned(&record.ticks);
    let target = ticks.iter().map(|tick| seen(&tick.target));
    chart.draw_series(LineSeries::new(target, TARGET)).map_err(failed)?;
    let actual = ticks.iter().map(|tick| seen(&tick.actual));
    chart.draw_series(LineSeries::new(actual, ACTUAL)).map_err(failed)?;
    Ok(())
}

fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low < high { low..high } else { low.min(0.0)..high.max(0.0) + 1.0 }
}
