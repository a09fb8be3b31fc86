//! A picture of posture scores along time.

use std::{fmt::Display, ops::Range};

use plotters::{coord::Shift, prelude::*};

use super::posture::FilmedPosture;
use crate::error::Error;

const SIZE: (u32, u32) = (1000, 420);
const FONT: &str = "sans-serif";
const TEXT: RGBColor = RGBColor(40, 40, 40);
const LINE: RGBColor = RGBColor(20, 40, 90);
const SECOND: RGBColor = RGBColor(150, 90, 160);

/// REBA's scores by what their action levels ask for, from the first to the last.
const LEVELS: [(u8, u8, RGBColor); 3] = [
    (1, 3, RGBColor(214, 236, 208)),
    (4, 7, RGBColor(252, 232, 197)),
    (8, 15, RGBColor(248, 209, 206)),
];

/// Draws the scores of REBA along a film as SVG, over the colours of their action levels, and those of RULA as a thin
/// line. Where nothing was seen there is a gap.
///
/// # Errors
/// [`Error::Unfit`] if it cannot be drawn.
pub fn score_figure(title: &str, postures: &[FilmedPosture]) -> Result<String, Error> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        draw(&root, title, postures)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> Error {
    Error::at("the picture of the scores", error)
}

fn draw(
    root: &DrawingArea<SVGBackend<'_>, Shift>,
    title: &str,
    postures: &[FilmedPosture],
) -> Result<(), Error> {
    let begin = postures.first().map_or(0.0, |first| first.time);
    let end = postures.last().map_or(1.0, |last| last.time).max(begin + 1e-3);
    let highest = postures.iter().filter_map(|posture| posture.scores);
    let highest = highest.map(|(scores, _)| scores.reba.reba.max(scores.rula.rula)).max();
    let top = f64::from(highest.unwrap_or(1).max(7)) + 0.8;
    let time: Range<f64> = begin..end;
    let mut chart = ChartBuilder::on(root)
        .caption(title, (FONT, 18).into_font().color(&TEXT))
        .margin(14)
        .x_label_area_size(40)
        .y_label_area_size(50)
        .build_cartesian_2d(time, 0.5..top)
        .map_err(failed)?;
    for (least, most, colour) in LEVELS {
        let [low, high] = [f64::from(least) - 0.5, f64::from(most) + 0.5];
        if low < top {
            let band = Rectangle::new([(begin, low), (end, high.min(top))], colour.filled());
            chart.draw_series([band]).map_err(failed)?;
        }
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("time (s)")
        .y_desc("REBA (bold), RULA (thin)")
        .y_labels(8)
        .y_label_formatter(&|score| format!("{score:.0}"))
        .label_style((FONT, 15).into_font().color(&TEXT))
        .axis_style(TEXT)
        .draw()
        .map_err(failed)?;
    for pieces in postures.split(|posture| posture.scores.is_none()) {
        let line = |score: fn(&FilmedPosture) -> Option<u8>| {
            pieces
                .iter()
                .filter_map(move |posture| Some((posture.time, f64::from(score(posture)?))))
        };
        let rula = line(|posture| posture.scores.map(|(scores, _)| scores.rula.rula));
        let reba = line(|posture| posture.scores.map(|(scores, _)| scores.reba.reba));
        chart.draw_series(LineSeries::new(rula, SECOND.stroke_width(1))).map_err(failed)?;
        chart.draw_series(LineSeries::new(reba, LINE.stroke_width(3))).map_err(failed)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ergo_map::ActionLevel;

    /// Each colour is one of action levels that ask for the same.
    #[test]
    fn colours_change_where_action_levels_do() {
        for ((_, last, _), (first, _, _)) in LEVELS.iter().zip(&LEVELS[1..]) {
            assert_eq!(last + 1, *first);
            assert_ne!(ActionLevel::of(*last), ActionLevel::of(*first));
        }
    }
}
