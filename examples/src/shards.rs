//! Many independent cases on many machines. Each machine computes a shard of them and writes the results to a file. The
//! program `merge` computes from these files what one machine would have printed.
//!
//! A program with shards numbers its cases from 0, each with a seed of its own. It computes those that
//! [`Shard::contains`], and writes a [`Part`]. Its output is a function of all results in the order of the cases, so
//! that it does not depend on the number of shards.
//!
//! ```
//! use std::collections::BTreeMap;
//!
//! use examples::shards::{Merged, Part, Shard};
//!
//! let squares = |shard: Shard| Part {
//!     program: "squares".to_owned(),
//!     job: 10_u64,
//!     shard,
//!     cases: 10,
//!     results: shard.of(10).map(|case| (case, case * case)).collect::<BTreeMap<_, _>>(),
//!     times: (),
//! };
//! let parts = ["2/3", "1/3", "3/3"].map(|shard| shard.parse().map(squares));
//! let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
//! let Merged { results, .. } = Merged::of(parts)?;
//! assert_eq!(results, [0, 1, 4, 9, 16, 25, 36, 49, 64, 81]);
//! # Ok::<(), examples::shards::ShardError>(())
//! ```

mod error;
mod merged;
mod options;
mod part;
mod shard;

pub use error::ShardError;
pub use merged::Merged;
pub use options::ShardOptions;
pub use part::{Part, program_of};
pub use shard::Shard;
