//! Slices of a map through its optimum, as heat maps with the quadratic's contours.

use ergo_map::JointAngles;
use nalgebra::Vector3;
use plotters::prelude::*;

use super::body;
use super::contour::{Field, Ring, lines, polygon};
use super::paint::{
    Area, Axis, Chart, LABELS, MARK, Outcome, TEXT, View, bold, canvas, centred, failed, font,
    ramp, write,
};
use super::side::side_name;
use super::study::MapStudy;
use crate::error::Error;

/// Distance between the points of a slice \[m\].
const STEP: f64 = 0.012;
/// Difference of score between two colours.
const BAND: f64 = 0.1;
/// Scores of the quadratic's contours.
const CONTOURS: [f64; 8] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0];

const BODY: RGBColor = RGBColor(90, 90, 90);
const TITLE_HEIGHT: u32 = 46;
const BAR_HEIGHT: i32 = 22;

/// Draws three slices through the optimum: sagittal (x-z), frontal (y-z) and horizontal (x-y).
/// Returns the picture as SVG.
///
/// Each slice shows `e_s` as a heat map, and the quadratic's contours within the region of the fit.
/// It also shows the acceptable region, the optimum, and the person standing upright.
///
/// # Errors
/// [`Error::Drawing`] if the picture cannot be drawn.
pub fn slices(study: &MapStudy) -> Result<String, Error> {
    let [sagittal, frontal, horizontal] = views(study);
    let (left, right) = (sagittal.size(), frontal.size());
    let width = left.0 + right.0;
    let height = TITLE_HEIGHT + left.1 + horizontal.size().1;
    canvas((width, height), |root| {
        let title = format!(
            "Ergonomics of the {} hand, stature {:.2} m",
            side_name(study.map.side()),
            study.map.stature()
        );
        write(root, title, (16, 24), &bold(24))?;
        let top = highest(study);
        draw_slice(root, (0, TITLE_HEIGHT), study, &sagittal, top)?;
        draw_slice(root, (left.0, TITLE_HEIGHT), study, &frontal, top)?;
        draw_slice(root, (left.0, TITLE_HEIGHT + left.1), study, &horizontal, top)?;
        let below = root.clone().shrink((0, TITLE_HEIGHT + left.1), (left.0, horizontal.size().1));
        draw_legend(&below, study, top)
    })
}

/// Returns the slices, each large enough for all nodes of the map.
fn views(study: &MapStudy) -> [View; 3] {
    let mut bounds = [(0.0_f64, 0.0_f64); 3];
    for node in study.map.nodes() {
        for (bound, x) in bounds.iter_mut().zip(node.position.iter()) {
            *bound = (bound.0.min(*x), bound.1.max(*x));
        }
    }
    let [x, y, z] = bounds.map(|(low, high)| (low - 0.05, high + 0.05));
    let at = study.optimum.hand;
    let axis = |index, sign, (low, high): (f64, f64)| Axis::new(index, sign, low, high);
    [
        View {
            title: format!("sagittal slice at y = {:.2} m", at.y),
            right: axis(0, 1.0, x),
            up: axis(2, 1.0, z),
        },
        View {
            title: format!("frontal slice at x = {:.2} m, from behind", at.x),
            right: axis(1, -1.0, y),
            up: axis(2, 1.0, z),
        },
        View {
            title: format!("horizontal slice at z = {:.2} m, from above", at.z),
            right: axis(1, -1.0, y),
            up: axis(0, 1.0, x),
        },
    ]
}

/// Returns the end of the colour scale: the map's highest score, rounded up.
fn highest(study: &MapStudy) -> f64 {
    let highest = study.map.nodes().map(|node| node.score).fold(0.5, f64::max);
    (2.0 * highest).ceil() / 2.0
}

fn draw_slice(root: &Area<'_>, at: (u32, u32), study: &MapStudy, view: &View, top: f64) -> Outcome {
    let optimum = study.optimum.hand;
    let place = |u: f64, v: f64| {
        let mut point = optimum;
        for (axis, value) in [(&view.right, u), (&view.up, v)] {
            if let Some(coordinate) = point.get_mut(axis.index) {
                *coordinate = axis.sign * value;
            }
        }
        point
    };
    let sampled = |of: &dyn Fn(&Vector3<f64>) -> f64| {
        Field::sampled(&view.right.range, &view.up.range, STEP, |u, v| of(&place(u, v)))
    };
    let score = |hand: &Vector3<f64>| study.map.sample(hand).map_or(f64::NAN, |s| s.score);
    let map = sampled(&score);
    let unacceptable = sampled(&|hand| -score(hand));
    let fitted = sampled(&|hand| {
        let inside = study.fit.domain.contains(hand) && study.map.contains(hand);
        if inside { study.quadratic.value(hand) } else { f64::NAN }
    });

    view.chart(root, at, |chart| {
        for (level, colour) in bands(top) {
            let area = polygon(&map.outlines(level));
            if !area.is_empty() {
                chart.draw_series([Polygon::new(area, colour.filled())]).map_err(failed)?;
            }
        }
        draw_body(chart, study, view)?;
        draw_fit_region(chart, study, view)?;
        let contours = CONTOURS.map(|level| (level, lines(&fitted.outlines(level))));
        for (_, lines) in &contours {
            draw_contour(chart, lines)?;
        }
        for ring in unacceptable.outlines(-study.acceptable.score) {
            draw_outline(chart, &ring, MARK.stroke_width(3))?;
        }
        for (level, lines) in &contours {
            label_contour(chart, *level, lines)?;
        }
        chart.draw_series(optimum_mark(&view.of(&optimum))).map_err(failed)?;
        Ok(())
    })
}

/// Iterates over the colours from good to bad, each with the lowest score of its band.
fn bands(top: f64) -> impl Iterator<Item = (f64, RGBColor)> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let count = (top / BAND).round() as u32;
    (0..count).map(move |k| {
        // A score of zero belongs to the first band in spite of rounding.
        let level = if k == 0 { -1.0 } else { BAND * f64::from(k) };
        (level, ramp((f64::from(k) + 0.5) / f64::from(count)))
    })
}

/// Draws the person standing upright, as a silhouette.
fn draw_body(chart: &mut Chart<'_, '_>, study: &MapStudy, view: &View) -> Outcome {
    let upright = body::pieces(&study.person, study.map.side(), &JointAngles::default())?;
    let silhouette = body::silhouette(&upright, view, STEP);
    let area = Polygon::new(polygon(&silhouette), WHITE.mix(0.25).filled());
    chart.draw_series([area]).map_err(failed)?;
    for ring in silhouette {
        draw_outline(chart, &ring, BODY.stroke_width(1))?;
    }
    Ok(())
}

fn draw_outline(chart: &mut Chart<'_, '_>, ring: &Ring, style: ShapeStyle) -> Outcome {
    let closed: Vec<_> = ring.iter().chain(ring.first()).map(|vertex| vertex.at).collect();
    chart.draw_series([PathElement::new(closed, style)]).map_err(failed)?;
    Ok(())
}

fn draw_fit_region(chart: &mut Chart<'_, '_>, study: &MapStudy, view: &View) -> Outcome {
    let (a, b) = (view.of(study.fit.domain.min()), view.of(study.fit.domain.max()));
    let corners = [a, (b.0, a.1), b, (a.0, b.1), a];
    let dashes = DashedLineSeries::new(corners, 6, 5, TEXT.stroke_width(1));
    chart.draw_series(dashes).map_err(failed)?;
    Ok(())
}

/// Draws a contour with a light rim, so that it is visible on every colour.
fn draw_contour(chart: &mut Chart<'_, '_>, lines: &[Vec<(f64, f64)>]) -> Outcome {
    for line in lines {
        for style in [WHITE.mix(0.6).stroke_width(3), BLACK.stroke_width(1)] {
            chart.draw_series([PathElement::new(line.clone(), style)]).map_err(failed)?;
        }
    }
    Ok(())
}

/// Writes the score of a contour at the highest point of its longest stretch.
fn label_contour(chart: &Chart<'_, '_>, level: f64, lines: &[Vec<(f64, f64)>]) -> Outcome {
    let length = |line: &Vec<(f64, f64)>| -> f64 {
        line.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum()
    };
    let longest = lines.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
    // A stretch that is too short would disappear behind its number.
    let longest = longest.into_iter().filter(|line| length(line) > 0.1);
    let Some(at) = longest.flatten().copied().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Ok(());
    };
    let text = format!("{level}");
    let half = i32::try_from(text.len()).unwrap_or(4) * 4 + 2;
    let label = EmptyElement::at(at)
        + Rectangle::new([(-half, -8), (half, 8)], WHITE.mix(0.85).filled())
        + Text::new(text, (0, 0), centred(&font(15)));
    chart.plotting_area().draw(&label).map_err(failed)
}

fn optimum_mark<C: Clone>(at: &C) -> [Circle<C, i32>; 3] {
    [(9, WHITE), (7, MARK), (3, WHITE)]
        .map(|(radius, colour)| Circle::new(at.clone(), radius, colour.filled()))
}

/// Draws the colour scale, the legend of the lines, and the most important figures.
fn draw_legend(area: &Area<'_>, study: &MapStudy, top: f64) -> Outcome {
    #[allow(clippy::cast_possible_wrap)]
    let (x, width) = (LABELS.0 as i32, bar_width(area));
    let mut y = 18;
    write(area, "score e_s (0 good)", (x, y), &bold(17))?;
    y += 18;
    let at = |score: f64| {
        #[allow(clippy::cast_possible_truncation)]
        let pixel = x + (score / top * f64::from(width)).round() as i32;
        pixel
    };
    for (level, colour) in bands(top) {
        let level = level.max(0.0);
        let corners = [(at(level), y), (at(level + BAND), y + BAR_HEIGHT)];
        area.draw(&Rectangle::new(corners, colour.filled())).map_err(failed)?;
    }
    let frame = Rectangle::new([(x, y), (at(top), y + BAR_HEIGHT)], TEXT.stroke_width(1));
    area.draw(&frame).map_err(failed)?;
    let limit = at(study.acceptable.score.min(top));
    let mark =
        PathElement::new([(limit, y - 4), (limit, y + BAR_HEIGHT + 4)], MARK.stroke_width(3));
    area.draw(&mark).map_err(failed)?;
    y += BAR_HEIGHT + 12;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    for half in 0..=(2.0 * top) as u32 {
        let score = 0.5 * f64::from(half);
        let text = Text::new(format!("{score}"), (at(score), y), centred(&font(15)));
        area.draw(&text).map_err(failed)?;
    }

    y += 30;
    for circle in optimum_mark(&(x + 17, y)) {
        area.draw(&circle).map_err(failed)?;
    }
    let text = format!("optimum of the quadratic, e_s {:.2}", study.optimum.map_score);
    write(area, text, (x + 44, y), &font(16))?;
    y += 26;
    let entries = [
        (MARK.stroke_width(3), format!("acceptable: e_s up to {}", study.acceptable.score)),
        (BLACK.stroke_width(1), "the quadratic's contours".to_owned()),
        (BODY.stroke_width(1), "the person standing upright".to_owned()),
    ];
    for (style, text) in entries {
        area.draw(&PathElement::new([(x, y), (x + 34, y)], style)).map_err(failed)?;
        write(area, text, (x + 44, y), &font(16))?;
        y += 26;
    }
    for dash in 0..3 {
        let ends = [(x + 12 * dash, y), (x + 12 * dash + 8, y)];
        area.draw(&PathElement::new(ends, TEXT.stroke_width(1))).map_err(failed)?;
    }
    write(area, "region of the fit", (x + 44, y), &font(16))?;
    y += 26;
    let square = Rectangle::new([(x, y - 8), (x + 34, y + 8)], TEXT.mix(0.5).stroke_width(1));
    area.draw(&square).map_err(failed)?;
    write(area, "out of reach, or inside the trunk", (x + 44, y), &font(16))?;
    y += 34;
    for text in figures(study) {
        write(area, text, (x, y), &font(16))?;
        y += 23;
    }
    Ok(())
}

fn bar_width(area: &Area<'_>) -> i32 {
    let (width, _) = area.dim_in_pixel();
    i32::try_from(width.saturating_sub(LABELS.0 + 30)).unwrap_or(300)
}

fn figures(study: &MapStudy) -> Vec<String> {
    let (fit, reba) = (&study.fit, &study.optimum.reba);
    let mut lines = vec![
        format!("REBA {} at the optimum, action level {}", reba.reba, reba.action_level.number()),
        format!(
            "fit: R² {:.3}, RMSE {:.3}, Spearman's ρ {:.3}",
            fit.r_squared, fit.rmse, fit.spearman
        ),
    ];
    if let Some(regret) = fit.regret {
        lines.push(format!(
            "regret {:.3}, in boxes up to {:.3} (95 %)",
            regret.at_optimum, regret.boxes_p95
        ));
    }
    lines
}
