//! Box plot of the paper's figure on NASA-TLX: six scales with a box for each condition.

use std::fmt::Display;

use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};

use super::quartiles::Quartiles;
use super::questionnaire::Scale;
use super::study::WorkloadStudy;
use crate::error::Error;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

const SIZE: (u32, u32) = (900, 480);
const LEGEND_HEIGHT: u32 = 44;
const FONT: &str = "sans-serif";
const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);
/// Share of a scale's space that its boxes fill.
const FILLED: f64 = 0.76;
/// Largest length of whiskers, in box lengths (Tukey 1977).
const WHISKER: f64 = 1.5;
/// Colours that colour-blind people can distinguish (Okabe & Ito 2008).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(240, 228, 66),
    RGBColor(90, 90, 90),
];

/// Draws the ratings as SVG: median, quartiles, whiskers to the farthest rating within 1.5 box
/// lengths, and crosses beyond.
///
/// # Errors
/// [`Error::Drawing`] if the figure cannot be drawn.
pub fn figure(study: &WorkloadStudy) -> Result<String, Error> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (plot, legend) = root.split_vertically(SIZE.1 - LEGEND_HEIGHT);
        draw_boxes(&plot, study)?;
        draw_legend(&legend, study)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> Error {
    Error::Drawing { what: "figure", reason: error.to_string() }
}

fn draw_boxes(area: &Area<'_>, study: &WorkloadStudy) -> Result<(), Error> {
    let scales = Scale::ALL.len();
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(30)
        .y_label_area_size(56)
        .build_cartesian_2d(-0.5..scales as f64 - 0.5, -0.5..20.5)
        .map_err(failed)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .y_desc("rating (performance: 0 is perfect)")
        .y_labels(5)
        .x_labels(scales)
        .x_label_formatter(&|place| scale_at(*place))
        .y_label_formatter(&|rating| format!("{rating:.0}"))
        .label_style((FONT, 16).into_font().color(&TEXT))
        .axis_style(TEXT)
        .draw()
        .map_err(failed)?;
    let conditions = study.conditions();
    let width = FILLED / conditions.len() as f64;
    for (number, (condition, colour)) in conditions.iter().zip(COLOURS).enumerate() {
        for index in 0..scales {
            let middle = index as f64 - FILLED / 2.0 + (number as f64 + 0.5) * width;
            draw_box(&mut chart, middle, 0.4 * width, &condition.scale(index), colour)?;
        }
    }
    Ok(())
}

/// Returns the abbreviation of the scale at a place of the axis.
fn scale_at(place: f64) -> String {
    let near = Scale::ALL.into_iter().enumerate();
    let near = near.filter(|(index, _)| (*index as f64 - place).abs() < 1e-6);
    near.map(|(_, scale)| scale.abbreviation()).collect()
}

fn draw_box(
    chart: &mut Chart<'_, '_>,
    middle: f64,
    half: f64,
    ratings: &[f64],
    colour: RGBColor,
) -> Result<(), Error> {
    let quartiles = Quartiles::of(ratings);
    let Quartiles { lower, median, upper } = quartiles;
    let reach = WHISKER * quartiles.range();
    let inside = |rating: &f64| (lower - reach..=upper + reach).contains(rating);
    let within = || ratings.iter().copied().filter(|rating| inside(rating));
    let (low, high) = (within().fold(lower, f64::min), within().fold(upper, f64::max));
    let filled =
        Rectangle::new([(middle - half, lower), (middle + half, upper)], colour.mix(0.35).filled());
    chart.draw_series([filled]).map_err(failed)?;
    let line = |from: (f64, f64), to: (f64, f64), width: u32| {
        PathElement::new(vec![from, to], colour.stroke_width(width))
    };
    let level = |rating: f64, half: f64, width: u32| {
        line((middle - half, rating), (middle + half, rating), width)
    };
    let frame =
        Rectangle::new([(middle - half, lower), (middle + half, upper)], colour.stroke_width(2));
    chart.draw_series([frame]).map_err(failed)?;
    chart
        .draw_series([
            level(median, half, 4),
            line((middle, low), (middle, lower), 2),
            line((middle, upper), (middle, high), 2),
            level(low, 0.5 * half, 2),
            level(high, 0.5 * half, 2),
        ])
        .map_err(failed)?;
    let outside = ratings.iter().filter(|rating| !inside(rating));
    let crosses = outside.map(|rating| Cross::new((middle, *rating), 4, colour.stroke_width(2)));
    chart.draw_series(crosses).map_err(failed)?;
    Ok(())
}

fn draw_legend(area: &Area<'_>, study: &WorkloadStudy) -> Result<(), Error> {
    let style = (FONT, 16).into_font().color(&TEXT);
    let mut x = 70;
    for (condition, colour) in study.conditions().iter().zip(COLOURS) {
        let mark = Rectangle::new([(x, 12), (x + 16, 28)], colour.filled());
        area.draw(&mark).map_err(failed)?;
        let title = condition.title();
        area.draw(&Text::new(title.to_owned(), (x + 24, 12), style.clone())).map_err(failed)?;
        x += 54 + 9 * i32::try_from(title.chars().count()).map_err(failed)?;
    }
    Ok(())
}
