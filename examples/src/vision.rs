//! What the programs `classify`, `infer`, `recognise` and `convert` are made of, and others that see.

pub mod choices;
pub mod classifier;
pub mod clip_stream;
pub mod clips;
pub mod errors;
pub mod folders;
pub mod npy;
pub mod results;
pub mod tensor_name;
pub mod top_k;
