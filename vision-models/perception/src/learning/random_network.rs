//! Networks with random weights.

use rand::RngCore;
use vision_models::{NetworkKind, Tensor, Tensors};

use crate::{error::Error, random::generator};

/// Weight of the last norm of a residual block. Activations then grow little over fifty blocks.
const RESIDUAL: f32 = 0.3;

/// Returns random weights of a network without a head. They are not trained, so the features are
/// random projections of the image.
///
/// Kernels have the variance of K. He, X. Zhang, S. Ren and J. Sun ("Delving deep into rectifiers",
/// ICCV 2015, equation 10), but a uniform distribution. Norms keep their input, except for the last
/// one of a residual block, which scales it.
///
/// # Errors
/// None known, since the shapes fit.
pub(crate) fn random_network(kind: NetworkKind, seed: u64) -> Result<Tensors, Error> {
    let mut tensors = Tensors::new();
    let parameters = kind.parameters(1);
    for (stream, (name, shape)) in (0..).zip(parameters) {
        if ["fc.", "cls_head.", "blocks.5."].iter().any(|head| name.starts_with(head)) {
            continue;
        }
        let count = shape.iter().product();
        let mut random = generator(seed, stream);
        let values = match (name.rsplit('.').next(), shape.len()) {
            (Some("weight"), 2..) => {
                let inputs: usize = shape.iter().skip(1).product();
                let bound = (6.0 / inputs as f32).sqrt();
                (0..count).map(|_| bound * symmetric(random.next_u32())).collect()
            }
            (Some("weight"), _) => {
                vec![if is_last_of_block(&name) { RESIDUAL } else { 1.0 }; count]
            }
            (Some("running_var"), _) => vec![1.0; count],
            _ => vec![0.0; count],
        };
        tensors.insert(name, Tensor::new(shape, values)?)?;
    }
    Ok(tensors)
}

/// Returns a number in [-1, 1) from the upper 24 bits, since tens of millions are needed.
fn symmetric(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 23) as f32 - 1.0
}

fn is_last_of_block(name: &str) -> bool {
    [".bn3.", ".conv3.bn.", ".norm_c."].iter().any(|norm| name.contains(norm))
}
