//! The simulation behind the program `follow`: a recording, the controller at 1 kHz and the
//! simulated robot, closed in a loop.

mod comparison;
mod on_board;
mod run;
mod scenario;
mod scoring;
mod seen;
mod summary;
mod true_person;
mod work;
mod working_hand;

pub use comparison::Comparison;
pub use run::Run;
pub use scenario::{Delivery, Scenario};
pub use scoring::{HandScore, Scorer};
pub use summary::{MeasuredReba, Summary};
pub use true_person::TrueMotion;
