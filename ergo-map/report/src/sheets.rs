//! Filled-in sheets as a table, one a row: read, scored and written with the scores behind.

mod column;
mod form;
mod header;
mod lines;
mod reba;
mod rula;
mod sheet;
mod table;

pub use column::{Cell, Column};
pub use header::Unknown;
pub use sheet::{Elsewhere, Sheet};
pub use table::SheetTable;
