//! What the programs `reba` and `ergo_map` are made of: the columns of assessors' sheets, and a
//! person's map with its report and its pictures.

mod assessment;
mod body;
mod built_map;
mod contour;
mod error;
mod manikin;
mod map_report;
mod paint;
mod reba;
mod rula;
mod saved_map;
mod slices;
mod study;

use ergo_map::Side;

pub use assessment::Assessment;
pub use built_map::build_map;
pub use error::ErgonomicsError;
pub use manikin::manikin;
pub use map_report::MapReport;
pub use saved_map::read_map;
pub use slices::slices;
pub use study::{ACCEPTABLE, Acceptable, MapStudy};

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}
