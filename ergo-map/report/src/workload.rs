//! NASA-TLX questionnaires: their scores, comparisons of conditions with the same subjects, and the
//! box plot (the paper's Experiment 5).

mod comparison;
mod condition;
mod figure;
mod quartiles;
mod questionnaire;
mod signed_rank;
mod study;

pub use comparison::{Comparison, Tested};
pub use condition::Condition;
pub use figure::figure;
pub use quartiles::Quartiles;
pub use questionnaire::{Questionnaire, Scale};
pub use signed_rank::SignedRank;
pub use study::WorkloadStudy;
