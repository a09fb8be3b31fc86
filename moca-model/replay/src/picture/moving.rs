//! SVG animation by SMIL, SVG's own means. It runs wherever pictures are shown, and needs no script.

use nalgebra::{Vector2, Vector3};

use super::figures::{Figure, Outline, figures, workspace};
use super::moments::{Moment, together};
use super::sheet::{EYE, PLOTS, SCALE, SCENE, TOP, axis, begin, plots, scene_begin, title};
use super::view::View;
use crate::recorded::{Replay, ReplayError};

/// Longest part of the run that is shown, from the time at which person and robot begin to work together \[s\].
const SHOWN: f64 = 12.0;
/// Time between two pictures \[s\]. Positions between them are interpolated linearly.
const STEP: f64 = 0.3;

/// Draws the beginning of the longest interval of working together as an endless loop, with the posture that is scored.
/// All runs are side by side, with their scores under one cursor. Returns the picture as SVG.
///
/// # Errors
/// [`ReplayError::Nothing`] without runs or with a run without samples.
pub fn animation(replays: &[&Replay]) -> Result<String, ReplayError> {
    if replays.is_empty() || replays.iter().any(|replay| replay.samples.is_empty()) {
        return Err(ReplayError::Nothing);
    }
    let (from, to) = together(replays);
    let to = to.min(from + SHOWN);
    let mut times = vec![from];
    while let Some(next) = times.last().map(|last| last + STEP).filter(|next| *next <= to) {
        times.push(next);
    }
    let last = times.last().copied().unwrap_or(from);
    let seconds = (last - from).max(STEP);
    let scenes = SCENE[0] * replays.len() as f64;
    let mut svg = vec![begin(scenes + PLOTS, TOP + SCENE[1])];
    for (index, replay) in replays.iter().enumerate() {
        let left = SCENE[0] * index as f64;
        svg.push(title(left, index, &replay.title));
        svg.push(scene(replay, &times, left, seconds));
    }
    let plots = plots(scenes, [from, last]);
    for plot in &plots {
        let ([_, top, _, height], ends) = (plot.place, [from, last].map(|time| plot.x(time)));
        svg.push(plot.draw(replays));
        svg.push(format!(
            "<path d=\"M0 {top}v{height}\" stroke=\"#1b2129\" stroke-width=\"1.2\">\
             <animateTransform attributeName=\"transform\" type=\"translate\" \
             values=\"{:.1};{:.1}\" dur=\"{seconds:.2}s\" repeatCount=\"indefinite\"/></path>\n",
            ends[0], ends[1],
        ));
    }
    svg.push(axis(&plots));
    svg.push("</svg>\n".to_owned());
    Ok(svg.concat())
}

/// Draws the scene of a run. The eye follows person and tool.
fn scene(replay: &Replay, times: &[f64], left: f64, seconds: f64) -> String {
    let middle = Vector2::from(SCENE) * 0.5;
    let moments: Vec<Moment<'_>> = times.iter().map(|time| Moment::at(replay, *time)).collect();
    let targets = smooth(&moments);
    let views: Vec<View> =
        targets.iter().map(|target| View::new(*target, EYE, SCALE, middle)).collect();
    let pictures: Vec<Vec<Figure>> =
        moments.iter().zip(&views).map(|(moment, view)| figures(moment, view)).collect();
    // Figures appear and vanish with a body that is not always known. Only the figures that are always there are drawn.
    let count = pictures.iter().map(Vec::len).min().unwrap_or(0);
    let nearness = |index: usize| -> f64 {
        pictures.iter().filter_map(|figures| figures.get(index)).map(|figure| figure.nearness).sum()
    };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| nearness(*a).total_cmp(&nearness(*b)));
    let mut svg = vec![scene_begin(left), floor(&views, &targets, seconds)];
    for index in order {
        let frames: Vec<&Figure> =
            pictures.iter().filter_map(|figures| figures.get(index)).collect();
        svg.push(element(&format!("f{left:.0}-{index}"), &frames, seconds));
    }
    let edges = moments.iter().zip(&views).map(|(moment, view)| {
        let edges = workspace(moment, view);
        let line = |[from, to]: &[Vector2<f64>; 2]| {
            format!("M{:.0} {:.0}L{:.0} {:.0}", from.x, from.y, to.x, to.y)
        };
        edges.iter().map(line).collect::<String>()
    });
    let values = edges.collect::<Vec<_>>();
    svg.push(format!(
        "<path stroke=\"#0f8f8c\" stroke-width=\"1.6\" fill=\"none\" d=\"{}\">{}</path>\n</svg>\n",
        values.first().map_or("", String::as_str),
        animate("d", &values, seconds, false),
    ));
    svg.concat()
}

/// Returns the points that the eye looks at, averaged over neighbours so that the view does not shake.
fn smooth(moments: &[Moment<'_>]) -> Vec<Vector3<f64>> {
    let targets: Vec<Option<Vector3<f64>>> = moments.iter().map(Moment::middle).collect();
    let smooth = (0..targets.len()).map(|index| {
        let near = targets.iter().enumerate().filter(|(other, _)| other.abs_diff(index) <= 4);
        let known: Vec<Vector3<f64>> = near.filter_map(|(_, target)| *target).collect();
        known.iter().sum::<Vector3<f64>>() / known.len().max(1) as f64
    });
    smooth.collect()
}

/// Draws the floor, which moves relative to the eye.
fn floor(views: &[View], targets: &[Vector3<f64>], seconds: f64) -> String {
    let (Some(first), Some(target)) = (views.first(), targets.first()) else {
        return String::new();
    };
    let reach = targets.iter().map(|other| (other - target).norm()).fold(0.0, f64::max) + 1.5;
    let here = first.at(target);
    let values: Vec<String> = views
        .iter()
        .map(|view| view.at(target) - here)
        .map(|by| format!("{:.1} {:.1}", by.x, by.y))
        .collect();
    format!(
        "<g>{}<animateTransform attributeName=\"transform\" type=\"translate\" values=\"{}\" \
         dur=\"{seconds:.2}s\" repeatCount=\"indefinite\"/></g>\n",
        super::sheet::floor(first, target, reach),
        values.join(";"),
    )
}

/// Draws a figure with an outline. Its path is defined once, and drawn dark and then in its colour.
fn element(name: &str, frames: &[&Figure], seconds: f64) -> String {
    let Some(figure) = frames.first() else { return String::new() };
    let paths: Vec<String> = frames.iter().map(|frame| frame.outline.path()).collect();
    let colours: Vec<String> = frames.iter().map(|frame| frame.colour.clone()).collect();
    let path = paths.first().map_or("", String::as_str);
    let (colour, moves) = (&figure.colour, animate("d", &paths, seconds, false));
    match &figure.outline {
        Outline::Line { width, round, .. } => {
            let class = if *round { "c" } else { "u" };
            format!(
                "<defs><path id=\"{name}\" d=\"{path}\">{moves}</path></defs>\
                 <g class=\"{class}\"><use href=\"#{name}\" stroke=\"#44505d\" stroke-width=\"{:.1}\"/>\
                 <use href=\"#{name}\" stroke=\"{colour}\" stroke-width=\"{width:.1}\">{}</use></g>\n",
                width + 1.8,
                animate("stroke", &colours, seconds, true),
            )
        }
        Outline::Polygon(_) => format!(
            "<path class=\"p\" d=\"{path}\" fill=\"{colour}\">{moves}{}</path>\n",
            animate("fill", &colours, seconds, true),
        ),
    }
}

/// Returns the animation of an attribute, in jumps or linear in between. The text is empty if the attribute does not
/// change.
fn animate(attribute: &str, values: &[String], seconds: f64, jumps: bool) -> String {
    if values.windows(2).all(|pair| pair[0] == pair[1]) {
        return String::new();
    }
    let mode = if jumps { " calcMode=\"discrete\"" } else { "" };
    format!(
        "<animate attributeName=\"{attribute}\" values=\"{}\"{mode} dur=\"{seconds:.2}s\" \
         repeatCount=\"indefinite\"/>",
        values.join(";")
    )
}
