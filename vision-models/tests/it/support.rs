//! Numbers that the tests of this crate and the script of the golden values generate equally.

use ndarray::{Array, Dimension, IntoDimension};
use vision_models::{Tensor, Tensors};

/// Returns the `index`-th number of a name, in [−1, 1): FNV-1a of the name, advanced by the index
/// and mixed as in SplitMix64 (G. Steele, D. Lea and C. Flood, OOPSLA 2014).
fn number(name_hash: u64, index: usize) -> f64 {
    let mut bits = name_hash.wrapping_add((index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 40) as f64 / f64::from(1 << 23) - 1.0
}

fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Returns an input of these sizes.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn input<D: Dimension>(shape: impl IntoDimension<Dim = D>) -> Array<f32, D> {
    let shape = shape.into_dimension();
    let values = (0..shape.size()).map(|index| number(hash("input"), index) as f32);
    Array::from_shape_vec(shape, values.collect()).unwrap()
}

/// Returns weights that keep the size of the activations similar from layer to layer.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn weights(parameters: Vec<(String, Vec<usize>)>) -> Tensors {
    let mut tensors = Tensors::new();
    for (name, shape) in parameters {
        let size: usize = shape.iter().product();
        let fan_in: usize = shape.iter().skip(1).product();
        let (scale, shift) = match name.rsplit_once('.').map(|(_, part)| part) {
            Some("weight") if shape.len() > 1 => ((6.0 / fan_in as f64).sqrt(), 0.0),
            Some("weight") => (0.25, 0.75),
            Some("running_var") => (0.5, 1.0),
            _ => (0.1, 0.0),
        };
        let hash = hash(&name);
        let values = (0..size).map(|index| (shift + scale * number(hash, index)) as f32).collect();
        tensors.insert(name, Tensor::new(shape, values).unwrap()).unwrap();
    }
    tensors
}
