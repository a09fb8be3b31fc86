//! What the programs `reba` and `ergo_map` are made of: sheets as a table, and a person's map with
//! its report and its pictures.

mod assessment;
mod body;
mod built_map;
mod contour;
mod error;
mod manikin;
mod map_report;
mod paint;
mod saved_map;
mod slices;
mod study;
mod table;

use ergo_map::Side;

pub use assessment::Assessment;
pub use built_map::build_map;
pub use error::ErgonomicsError;
pub use manikin::manikin;
pub use map_report::MapReport;
pub use saved_map::read_map;
pub use slices::slices;
pub use study::{ACCEPTABLE, Acceptable, MapStudy};
pub use table::{Cell, Column, Extent, Sheet, SheetTable, TableError, Unknown};

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}
