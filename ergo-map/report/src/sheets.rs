//! Completed sheets as a table with one sheet for each row: reading, scoring, and writing with the
//! scores appended.

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
