//! A person's map with its report and its pictures.

mod assessment;
mod body;
mod contour;
mod manikin;
mod paint;
mod report;
mod side;
mod slices;
mod study;

pub use assessment::Assessment;
pub use manikin::manikin;
pub use report::MapReport;
pub use slices::slices;
pub use study::{ACCEPTABLE, Acceptable, MapStudy};
