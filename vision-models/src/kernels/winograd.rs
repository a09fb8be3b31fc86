//! Winograd's minimal filtering: fewer multiplications for kernels of length three.
//!
//! A. Lavin and S. Gray, "Fast algorithms for convolutional neural networks", CVPR 2016:
//! Y = Aᵀ [(G g Gᵀ) ⊙ (Bᵀ d B)] A. The products of all tiles at one point form a matrix product.

mod driver;
mod lines;
mod transform;

pub(crate) use driver::Winograd;
pub(crate) use lines::Tiling;
