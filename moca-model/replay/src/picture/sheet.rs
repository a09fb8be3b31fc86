//! Still: the scene of each run at one time, with the plots beside it.

use nalgebra::{Vector2, Vector3};

use super::colours::{DASHES, RUNS};
use super::curves::Plot;
use super::figures::{Figure, Outline, figures, workspace};
use super::moments::{Moment, together};
use super::view::View;
use crate::recorded::{Replay, ReplayError};

/// Size of a scene \[pixels\].
pub(super) const SCENE: [f64; 2] = [330.0, 400.0];
/// Height of the titles \[pixels\].
pub(super) const TOP: f64 = 40.0;
/// Width of the plots \[pixels\].
pub(super) const PLOTS: f64 = 380.0;
/// Direction of the eye from the target: turn and rise \[rad\].
pub(super) const EYE: [f64; 2] = [-0.95, 0.36];
/// Pixels per metre.
pub(super) const SCALE: f64 = 162.0;

/// Returns the beginning of an SVG: its size, background and fonts.
pub(super) fn begin(width: f64, height: f64) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"system-ui,sans-serif\" fill=\"#1b2129\">\n\
         <style>text{{font-size:14px}}.b{{font-weight:600}}.s{{font-size:12px;fill:#5a6572}}\
         .e{{text-anchor:end}}.m{{text-anchor:middle}}.c{{stroke-linecap:round;fill:none}}\
         .u{{fill:none}}.p{{stroke:#1f2a36;stroke-opacity:.35;stroke-width:.8;stroke-linejoin:round}}</style>\n\
         <rect width=\"{width}\" height=\"{height}\" rx=\"12\" fill=\"#f5f7f9\"/>\n"
    )
}

/// Draws the scene of each run after a fifth of the longest interval of working together, with the posture that is
/// scored. The score and REBA of all runs are plotted beside it. Returns the picture as SVG.
///
/// # Errors
/// [`ReplayError::Nothing`] without runs or with a run without samples.
pub fn still(replays: &[&Replay]) -> Result<String, ReplayError> {
    let Some(first) = replays.first() else { return Err(ReplayError::Nothing) };
    if replays.iter().any(|replay| replay.samples.is_empty()) {
        return Err(ReplayError::Nothing);
    }
    let (from, to) = together(replays);
    let time = from + 0.2 * (to - from);
    let scenes = SCENE[0] * replays.len() as f64;
    let (width, height) = (scenes + PLOTS, TOP + SCENE[1]);
    let mut svg = vec![begin(width, height)];
    for (index, replay) in replays.iter().enumerate() {
        let left = SCENE[0] * index as f64;
        svg.push(title(left, index, &replay.title));
        let moment = Moment::at(replay, time);
        let Some(target) = moment.middle() else { continue };
        let view = View::new(target, EYE, SCALE, Vector2::from(SCENE) * 0.5);
        svg.push(scene_begin(left));
        svg.push(floor(&view, &target, 1.5));
        svg.push(drawn(&moment, &view));
        svg.push("</svg>\n".to_owned());
        svg.push(format!(
            "<text x=\"{:.0}\" y=\"{:.0}\" class=\"s m\">e_s {:.2}, REBA {:.0}</text>\n",
            left + 0.5 * SCENE[0],
            TOP + SCENE[1] - 12.0,
            moment.series("e_s"),
            moment.series("REBA predicted"),
        ));
    }
    let times = first.samples.times();
    let span = [times.first(), times.last()].map(|time| time.copied().unwrap_or_default());
    let plots = plots(scenes, span);
    for plot in &plots {
        svg.push(plot.draw(replays));
        let ([_, top, _, height], x) = (plot.place, plot.x(time));
        svg.push(format!(
            "<path d=\"M{x:.1} {top}v{height}\" stroke=\"#1b2129\" stroke-width=\"1.2\"/>\n"
        ));
    }
    svg.push(axis(&plots));
    svg.push("</svg>\n".to_owned());
    Ok(svg.concat())
}

/// Draws the name of a run above its scene, with its line style in the plots.
pub(super) fn title(left: f64, index: usize, title: &str) -> String {
    let (colour, dashes) = (RUNS[index % RUNS.len()], DASHES[index % DASHES.len()]);
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<path d=\"M{:.0} 24h26\" stroke=\"{colour}\" stroke-width=\"3\" stroke-dasharray=\"{dashes}\"/>\
         <text x=\"{:.0}\" y=\"29\" class=\"b\">{title}</text>\n",
        left + 20.0,
        left + 54.0,
    )
}

/// Returns the two plots beside scenes of this width.
pub(super) fn plots(scenes: f64, time: [f64; 2]) -> [Plot<'static>; 2] {
    let place = |top: f64| [scenes + 44.0, top, PLOTS - 70.0, 140.0];
    [
        Plot { title: "e_s of the posture, 0 is good", column: "e_s", place: place(62.0), time },
        Plot { title: "REBA of the posture", column: "REBA predicted", place: place(248.0), time },
    ]
}

/// Draws the time axis below the last plot.
pub(super) fn axis(plots: &[Plot<'_>]) -> String {
    let Some(plot) = plots.last() else { return String::new() };
    let ([_, top, _, height], [begin, end]) = (plot.place, plot.time);
    let step =
        [1.0, 2.0, 5.0, 10.0, 20.0, 60.0].into_iter().find(|step| (end - begin) / step < 8.0);
    let step = step.unwrap_or(300.0);
    let mut svg = Vec::new();
    let mut time = (begin / step).ceil() * step;
    while time <= end {
        svg.push(format!(
            "<text x=\"{:.1}\" y=\"{:.0}\" class=\"s m\">{time:.0}{}</text>\n",
            plot.x(time),
            top + height + 20.0,
            if time + step > end { " s" } else { "" },
        ));
        time += step;
    }
    svg.concat()
}

/// Begins a nested picture, which cuts off everything outside it.
pub(super) fn scene_begin(left: f64) -> String {
    let [width, height] = SCENE;
    format!("<svg x=\"{left}\" y=\"{TOP}\" width=\"{width}\" height=\"{height}\">\n")
}

/// Draws lines half a metre apart, up to `reach` from a place \[m\].
#[expect(clippy::cast_possible_truncation, reason = "some metres")]
pub(super) fn floor(view: &View, around: &Vector3<f64>, reach: f64) -> String {
    let middle = [around.x, around.y].map(|value| (2.0 * value).round() * 0.5);
    let count = (2.0 * reach).ceil() as i32;
    let reach = 0.5 * f64::from(count);
    let mut path = Vec::new();
    for step in -count..=count {
        let by = 0.5 * f64::from(step);
        for [from, to] in [[[by, -reach], [by, reach]], [[-reach, by], [reach, by]]] {
            let [from, to] =
                [from, to].map(|[x, y]| view.at(&Vector3::new(middle[0] + x, middle[1] + y, 0.0)));
            path.push(format!("M{:.0} {:.0}L{:.0} {:.0}", from.x, from.y, to.x, to.y));
        }
    }
    format!("<path d=\"{}\" stroke=\"#dbe1e7\" fill=\"none\"/>\n", path.concat())
}

/// Draws robot, person and workspace at a moment.
fn drawn(moment: &Moment<'_>, view: &View) -> String {
    let mut figures = figures(moment, view);
    figures.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    let mut svg = Vec::new();
    for figure in &figures {
        svg.push(element(figure));
    }
    let edges = workspace(moment, view);
    let lines = edges
        .iter()
        .map(|[from, to]| format!("M{:.1} {:.1}L{:.1} {:.1}", from.x, from.y, to.x, to.y));
    svg.push(format!(
        "<path d=\"{}\" stroke=\"#0f8f8c\" stroke-width=\"1.6\" fill=\"none\"/>\n",
        lines.collect::<String>()
    ));
    svg.concat()
}

/// Draws a figure with an outline, which separates it from others.
fn element(Figure { outline, colour, .. }: &Figure) -> String {
    let path = outline.path();
    match outline {
        Outline::Line { width, round, .. } => {
            let class = if *round { "c" } else { "u" };
            format!(
                "<path class=\"{class}\" d=\"{path}\" stroke=\"#44505d\" stroke-width=\"{:.1}\"/>\
                 <path class=\"{class}\" d=\"{path}\" stroke=\"{colour}\" stroke-width=\"{width:.1}\"/>\n",
                width + 1.8,
            )
        }
        Outline::Polygon(_) => format!("<path class=\"p\" d=\"{path}\" fill=\"{colour}\"/>\n"),
    }
}
