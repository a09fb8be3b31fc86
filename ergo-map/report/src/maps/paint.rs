//! Common elements of the pictures: fonts, colours, and axes to scale.

use std::fmt::Display;
use std::ops::Range;

use plotters::coord::{Shift, types::RangedCoordf64};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::Error;

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(super) type Outcome<T = ()> = Result<T, Error>;

const FONT: &str = "sans-serif";
pub(super) const TEXT: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(232, 232, 232);

/// Space for the numbers and the name of an axis, to the left of the chart and below it.
pub(super) const LABELS: (u32, u32) = (72, 50);
/// Space for the title of a chart, and to its right.
const TITLE: u32 = 30;
const MARGIN: u32 = 24;
/// Pixels per metre.
pub(super) const SCALE: f64 = 280.0;

pub(super) fn failed(error: impl Display) -> Error {
    Error::Drawing { what: "picture", reason: error.to_string() }
}

/// Draws on a white canvas. Returns the picture as SVG.
pub(super) fn canvas(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Outcome) -> Outcome<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        draw(&root)?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Returns the colour of a share from 0, good and light, to 1, bad and dark. The scale is Magma
/// without its darkest end (Smith and van der Walt, CC0). Its lightness changes evenly, and
/// colour-blind people can read it.
pub(super) fn ramp(share: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 8] = [
        [252.0, 253.0, 191.0],
        [254.0, 194.0, 135.0],
        [251.0, 135.0, 97.0],
        [229.0, 80.0, 100.0],
        [181.0, 54.0, 122.0],
        [129.0, 37.0, 129.0],
        [79.0, 18.0, 123.0],
        [28.0, 16.0, 68.0],
    ];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let index = (place as usize).min(STOPS.len() - 2);
    let part = place - index as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let mixed =
        |k: usize| (STOPS[index][k] * (1.0 - part) + STOPS[index + 1][k] * part).round() as u8;
    RGBColor(mixed(0), mixed(1), mixed(2))
}

/// Colour of marks, which differs from every colour of the ramp.
pub(super) const MARK: RGBColor = RGBColor(0, 95, 200);

/// Returns black or white, whichever is readable on a colour.
pub(super) fn ink_on(colour: RGBColor) -> &'static RGBColor {
    let RGBColor(r, g, b) = colour;
    let luminance = 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    if luminance > 130.0 { &BLACK } else { &WHITE }
}

pub(super) fn font(size: u32) -> TextStyle<'static> {
    (FONT, size).into_font().color(&TEXT)
}

pub(super) fn bold(size: u32) -> TextStyle<'static> {
    (FONT, size).into_font().style(FontStyle::Bold).color(&TEXT)
}

pub(super) fn centred(style: &TextStyle<'static>) -> TextStyle<'static> {
    style.pos(Pos::new(HPos::Center, VPos::Center))
}

/// Writes a text whose left end is at `at`, vertically centred.
pub(super) fn write(
    area: &Area<'_>,
    text: impl Into<String>,
    at: (i32, i32),
    style: &TextStyle<'static>,
) -> Outcome {
    let style = style.pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(text.into(), at, style)).map_err(failed)
}

/// Two axes of space in a picture: one to the right, and one up.
#[derive(Debug, Clone)]
pub(super) struct View {
    pub(super) title: String,
    pub(super) right: Axis,
    pub(super) up: Axis,
}

/// An axis of the person's frame with its visible range.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Index of the axis: 0 x, 1 y, 2 z.
    pub(super) index: usize,
    /// Sign of the axis: -1 if it points against the picture's direction.
    pub(super) sign: f64,
    /// Visible range \[m\] in the direction of the picture.
    pub(super) range: Range<f64>,
}

impl Axis {
    /// Creates an axis with the range from `low` to `high`.
    pub(super) fn new(index: usize, sign: f64, low: f64, high: f64) -> Self {
        let range = if sign > 0.0 { low..high } else { -high..-low };
        Self { index, sign, range }
    }

    /// Returns the coordinate of a point along the axis, in the direction of the picture.
    pub(super) fn of(&self, point: &nalgebra::Vector3<f64>) -> f64 {
        point.get(self.index).map_or(f64::NAN, |value| self.sign * value)
    }

    fn name(&self) -> &'static str {
        ["x, forward (m)", "y, left (m)", "z, up (m)"].get(self.index).copied().unwrap_or("")
    }

    /// Returns the length in the picture.
    pub(super) fn pixels(&self) -> u32 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let pixels = (SCALE * (self.range.end - self.range.start)).round().max(1.0) as u32;
        pixels
    }
}

impl View {
    /// Returns the position of a point in the picture.
    pub(super) fn of(&self, point: &nalgebra::Vector3<f64>) -> (f64, f64) {
        (self.right.of(point), self.up.of(point))
    }

    /// Returns the size of the chart with its labels and its title.
    pub(super) fn size(&self) -> (u32, u32) {
        (LABELS.0 + self.right.pixels() + MARGIN, TITLE + self.up.pixels() + LABELS.1)
    }

    /// Creates an empty chart to scale. `at` is its upper left corner, including labels.
    pub(super) fn chart<'a>(
        &self,
        root: &Area<'a>,
        at: (u32, u32),
        draw: impl FnOnce(&mut Chart<'_, 'a>) -> Outcome,
    ) -> Outcome {
        let area = root.clone().shrink(at, self.size());
        #[allow(clippy::cast_possible_wrap)]
        write(&area, &self.title, (LABELS.0 as i32, 14), &bold(19))?;
        let mut chart = ChartBuilder::on(&area)
            .margin_right(MARGIN)
            .margin_top(TITLE)
            .margin_left(6)
            .x_label_area_size(LABELS.1)
            .y_label_area_size(LABELS.0 - 6)
            .build_cartesian_2d(self.right.range.clone(), self.up.range.clone())
            .map_err(failed)?;
        // Adding zero avoids "-0.0".
        let number = |axis: &Axis, value: f64| {
            format!("{:.1}", (axis.sign * value * 10.0).round() / 10.0 + 0.0)
        };
        chart
            .configure_mesh()
            .x_desc(self.right.name())
            .y_desc(self.up.name())
            .x_labels(7)
            .y_labels(10)
            .x_label_formatter(&|value| number(&self.right, *value))
            .y_label_formatter(&|value| number(&self.up, *value))
            .label_style(font(16))
            .axis_desc_style(font(17))
            .axis_style(TEXT.mix(0.7))
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .draw()
            .map_err(failed)?;
        draw(&mut chart)
    }
}
