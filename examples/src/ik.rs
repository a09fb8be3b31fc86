//! Any robot along a path: the motion, what is recorded of it, and its picture.

mod figure;
mod path;
mod record;
mod robot;
mod run;
mod table;

pub use figure::figure;
pub use path::{Path, PathError, Shape};
pub use record::{Record, Summary};
pub use robot::{BaseKind, RobotOptions};
pub use run::Run;
pub use table::table;
