//! Inference engine for this crate's networks and for your own.
//!
//! A [`Graph`] lists the layers and the names of their weights. [`Network::load`] takes the weights
//! from a checkpoint and plans the forward pass. [`Network::infer`] runs it. The networks of this
//! crate are such graphs.
//!
//! | layer | |
//! |---|---|
//! | [`Graph::convolution`] | [`Convolution`]: of images or clips, strided, dilated, grouped, depthwise, transposed; bias, batch norm, [`Activation`] |
//! | [`Graph::residual`] | a convolution plus an activation |
//! | [`Graph::max_pool`] | |
//! | [`Graph::concatenation`] | |
//! | [`Graph::resize`] | bilinear interpolation |
//! | [`Graph::reshape`] | |
//! | [`Graph::classify`] | pooled features and a linear layer |
//!
//! Every activation has frames, rows and columns. An image is a clip of one frame.
//! `examples/own_network.rs` builds a network for object detection from these layers.

// Views are small. They are passed by value, as usual with ndarray.
#![allow(clippy::needless_pass_by_value)]

mod graph;
mod head;
mod input;
mod layer;
mod lowering;
mod memory;
mod network;
mod options;
mod packed;
mod plan;
mod program;
mod scores;
mod session;
mod shapes;
mod threads;
mod validation;

pub use crate::kernels::{Alignment, Waiting, Window};
pub use graph::{Frames, Graph, Value};
pub use head::Pooling;
pub(crate) use input::{too_large, too_small, wrong_input};
pub use layer::{Activation, Convolution};
pub(crate) use lowering::lower;
pub(crate) use network::check_finite;
pub use network::{Inference, Network};
pub use options::Options;
pub(crate) use plan::Plan;
pub(crate) use program::{Fit, Fitted, Misfit, Program};
pub use scores::Scores;
pub(crate) use session::{Session, copy_frame};
pub use threads::{ThreadSettings, Threads};
