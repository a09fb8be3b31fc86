//! A figure of a confusion matrix, as in the paper: true classes as rows, percent of the row.

use std::fmt::Display;

use plotters::{coord::Shift, prelude::*};

use super::evaluation::percents;
use crate::error::Error;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

const FONT: &str = "sans-serif";
const TEXT: RGBColor = RGBColor(40, 40, 40);
const FULL: RGBColor = RGBColor(8, 69, 148);
/// Offset of a cell's number from its upper edge, as a share of the cell's size. The horizontal
/// offset is half of it.
const INSET: f64 = 0.28;

/// Draws counts as SVG: a row for each true class, a column for each given class, and in each cell
/// the percent of the row.
///
/// # Errors
/// An error if it cannot be drawn.
pub fn confusion_figure(
    title: &str,
    classes: &[String],
    confusion: &[Vec<u64>],
) -> Result<String, Error> {
    let count = i32::try_from(classes.len()).map_err(failed)?;
    let cell = (900 / count.max(1)).clamp(28, 120);
    let longest = classes.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let margin = 24 + 7 * i32::try_from(longest).map_err(failed)?;
    let (width, height) = (margin + count * cell + 20, 40 + count * cell + margin);
    let mut svg = String::new();
    {
        let size = (u32::try_from(width).map_err(failed)?, u32::try_from(height).map_err(failed)?);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let style = (FONT, 16).into_font().color(&TEXT);
        root.draw(&Text::new(title.to_owned(), (margin, 12), style)).map_err(failed)?;
        for (row, counts) in (0..).zip(confusion) {
            for (column, percent) in (0..).zip(percents(counts)) {
                let corner = (margin + column * cell, 40 + row * cell);
                draw_cell(&root, corner, cell, percent)?;
            }
        }
        draw_names(&root, classes, (margin, cell, count))?;
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

fn failed(error: impl Display) -> Error {
    Error::at("the figure", error)
}

fn draw_cell(area: &Area<'_>, corner: (i32, i32), cell: i32, percent: f64) -> Result<(), Error> {
    let opposite = (corner.0 + cell - 1, corner.1 + cell - 1);
    let square = Rectangle::new([corner, opposite], FULL.mix(percent / 100.0).filled());
    area.draw(&square).map_err(failed)?;
    if percent > 0.0 {
        let colour = if percent > 55.0 { WHITE } else { TEXT };
        let size = f64::from(cell) * 0.36;
        let style = (FONT, size.min(20.0)).into_font().color(&colour);
        #[expect(clippy::cast_possible_truncation, reason = "pixels")]
        let inset = (INSET * f64::from(cell)) as i32;
        let place = (corner.0 + inset / 2, corner.1 + inset);
        let number = if cell >= 60 { format!("{percent:.1}") } else { format!("{percent:.0}") };
        area.draw(&Text::new(number, place, style)).map_err(failed)?;
    }
    Ok(())
}

/// Draws the names of the classes beside the rows and below the columns.
fn draw_names(
    area: &Area<'_>,
    classes: &[String],
    (margin, cell, count): (i32, i32, i32),
) -> Result<(), Error> {
    let font = (FONT, 12).into_font();
    for (place, name) in (0..).zip(classes) {
        let style = font.clone().color(&TEXT);
        let y = 40 + place * cell + cell / 2 - 6;
        area.draw(&Text::new(name.clone(), (12, y), style)).map_err(failed)?;
        let style = font.clone().transform(FontTransform::Rotate90).color(&TEXT);
        let x = margin + place * cell + cell / 2 + 6;
        area.draw(&Text::new(name.clone(), (x, 48 + count * cell), style)).map_err(failed)?;
    }
    Ok(())
}
