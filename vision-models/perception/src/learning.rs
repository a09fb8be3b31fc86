//! Shared by the training of surfaces and actions: networks for features, features on disk, parts
//! of a data set, and metrics.

pub mod backbone;
pub mod cache;
pub mod confusion_figure;
pub mod cutting;
pub mod description;
pub mod digest;
pub mod evaluation;
mod random_network;
pub mod split;
pub mod twins;
