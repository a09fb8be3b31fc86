//! Report of a run: a table of every tick, and figures.
//!
//! ```
//! use moca_replay::report::{RunLog, TickRow, TickTable, figure};
//!
//! let row = TickRow { time: 0.001, score: 0.3, reba: 2, collaborating: true, ..TickRow::default() };
//! let mut table = TickTable::new(Vec::new(), &[])?;
//! table.write(&row)?;
//! let text = String::from_utf8(table.finish()?).expect("ASCII");
//! assert!(text.starts_with("time_s,desired_x_m,"));
//!
//! let mut on = RunLog::new("With ergonomics");
//! on.push(&row);
//! assert!(figure(&[&on])?.contains("With ergonomics"));
//! # Ok::<(), moca_replay::report::ReportError>(())
//! ```

mod error;
mod figure;
mod log;
mod row;
mod table;

pub use error::ReportError;
pub use figure::figure;
pub use log::RunLog;
pub use row::{TickRow, Together};
pub use table::{MOCA_COLUMNS, TickTable};
