//! The tensors that a network takes from a checkpoint, and the check of them.

use std::collections::BTreeSet;

use crate::error::Error;
use crate::excerpt::Excerpt;
use crate::weights::{TensorSource, unfilled};

use super::{Layer, fit::Behind, slopes};

/// The tensors that a network takes from a checkpoint.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expected {
    tensors: Vec<(String, Vec<usize>)>,
    optional: Vec<String>,
}

/// Differences between a checkpoint and a network; see [`Error::Weights`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Misfit {
    pub(crate) missing: Vec<String>,
    pub(crate) surplus: Vec<String>,
    pub(crate) misshapen: Vec<String>,
}

impl Misfit {
    fn count(&self) -> usize {
        self.missing.len() + self.surplus.len() + self.misshapen.len()
    }

    /// Returns the one with fewer differences, or `self` if they are equal.
    pub(crate) fn or_smaller(self, other: Self) -> Self {
        if other.count() < self.count() { other } else { self }
    }
}

impl Expected {
    pub(crate) fn convolution(&mut self, layer: &Layer) {
        let convolution = &layer.convolution;
        let outputs = convolution.outputs;
        self.tensors.push((format!("{}.weight", convolution.name), layer.kernel_shape()));
        if convolution.bias {
            self.tensors.push((format!("{}.bias", convolution.name), vec![outputs]));
        }
        if let Some(norm) = &convolution.norm {
            for part in ["weight", "bias", "running_mean", "running_var"] {
                self.tensors.push((format!("{}.{part}", norm.name), vec![outputs]));
            }
            self.optional.push(format!("{}.num_batches_tracked", norm.name));
        }
        if let Some((name, shared)) = slopes(&convolution.activation) {
            self.tensors.push((name, vec![if shared { 1 } else { outputs }]));
        }
    }

    pub(crate) fn linear(&mut self, name: &str, inputs: usize, outputs: usize) {
        self.tensors.push((format!("{name}.weight"), vec![outputs, inputs]));
        self.tensors.push((format!("{name}.bias"), vec![outputs]));
    }

    /// Returns the names and shapes of the required tensors.
    pub(crate) fn into_tensors(self) -> Vec<(String, Vec<usize>)> {
        self.tensors
    }

    /// Compares the tensors of a prefix with the expected ones. Returns the full names of other
    /// tensors that may be left out: counters, and outside the prefix all tensors that are no
    /// weights of a layer.
    pub(crate) fn check(&self, tensors: Behind<'_>) -> Result<Vec<String>, Misfit> {
        let mut missing = Vec::new();
        let mut misshapen = Vec::new();
        let mut known = self.optional.iter().map(String::as_str).collect::<BTreeSet<_>>();
        for (name, shape) in &self.tensors {
            known.insert(name);
            match tensors.shape(name) {
                None => missing.push(format!("{name} {shape:?}")),
                Some(found) if found != shape.as_slice() => {
                    misshapen.push(format!("{name} {found:?} instead of {shape:?}"));
                }
                Some(_) => {}
            }
        }
        let inside = tensors.names().filter(|name| !known.contains(name));
        let (mut left_out, mut surplus): (Vec<_>, Vec<_>) =
            inside.map(|name| tensors.whole(name)).partition(|name| tensors.is_counter(name));
        let (buffers, weights): (Vec<_>, Vec<_>) =
            tensors.outside().map(str::to_owned).partition(|name| tensors.is_buffer(name));
        left_out.extend(buffers);
        surplus.extend(weights);
        if missing.is_empty() && surplus.is_empty() && misshapen.is_empty() {
            Ok(left_out)
        } else {
            Err(Misfit { missing, surplus, misshapen })
        }
    }

    /// Returns the name of a tensor that every checkpoint of this network has.
    pub(crate) fn first(&self) -> Option<&str> {
        self.tensors.first().map(|(name, _)| name.as_str())
    }
}

/// Returns the elements of a tensor that [`Expected::check`] has checked. All must be finite.
pub(in crate::engine) fn take(
    tensors: &mut dyn TensorSource,
    name: &str,
) -> Result<Vec<f32>, Error> {
    take_where(tensors, name, f32::is_finite, "a finite number")
}

/// Returns the elements of a tensor if `is_right` is true for each of them.
pub(in crate::engine) fn take_where(
    tensors: &mut dyn TensorSource,
    name: &str,
    is_right: impl Fn(f32) -> bool,
    expected: &'static str,
) -> Result<Vec<f32>, Error> {
    let promised = tensors.shape(name).map(<[usize]>::to_vec).unwrap_or_default();
    let tensor = tensors.take(name)?;
    if tensor.shape() != promised {
        return Err(unfilled(&promised, tensor.data().len()));
    }
    // Nearly always all elements are right, and a fold over all is faster than a search.
    let all = tensor.data().iter().fold(true, |all, &value| all & is_right(value));
    if !all && let Some(at) = tensor.data().iter().position(|&value| !is_right(value)) {
        let index = index_of(at, &promised);
        let place = format!("tensor \"{}\": element {index:?}", Excerpt(name));
        return Err(Error::value(&place, tensor.data()[at], expected));
    }
    Ok(tensor.into_data())
}

/// Returns the index along each axis of the `at`-th element in C order.
fn index_of(mut at: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (place, &axis) in index.iter_mut().zip(shape).rev() {
        *place = at % axis;
        at /= axis;
    }
    index
}
