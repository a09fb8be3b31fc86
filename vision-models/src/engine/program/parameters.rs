//! The tensors that a network takes from a checkpoint, and what is right in them.

use crate::{Error, TensorSource};

use super::{Layer, slopes};

/// The tensors that a network takes from a checkpoint.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expected {
    tensors: Vec<(String, Vec<usize>)>,
    optional: Vec<String>,
}

/// Everything that makes a checkpoint another network's; see [`Error::Weights`].
#[derive(Clone, Debug)]
pub(crate) struct Misfit {
    pub(crate) missing: Vec<String>,
    pub(crate) surplus: Vec<String>,
    pub(crate) misshapen: Vec<String>,
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

    /// The names and shapes of the tensors that there must be.
    pub(crate) fn into_tensors(self) -> Vec<(String, Vec<usize>)> {
        self.tensors
    }

    /// Holds a checkpoint against what is expected.
    pub(crate) fn check(&self, tensors: &dyn TensorSource) -> Result<(), Misfit> {
        let mut missing = Vec::new();
        let mut misshapen = Vec::new();
        let mut known =
            self.optional.iter().map(String::as_str).collect::<std::collections::BTreeSet<_>>();
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
        let surplus: Vec<_> = tensors
            .names()
            .into_iter()
            .filter(|name| !known.contains(name))
            .map(String::from)
            .collect();
        if missing.is_empty() && surplus.is_empty() && misshapen.is_empty() {
            Ok(())
        } else {
            Err(Misfit { missing, surplus, misshapen })
        }
    }
}

/// The elements of a tensor that [`Expected::check`] has seen, all of them finite.
pub(in crate::engine) fn take(
    tensors: &mut dyn TensorSource,
    name: &str,
) -> Result<Vec<f32>, Error> {
    take_where(tensors, name, f32::is_finite, "a finite number")
}

/// The elements of a tensor, if `is_right` says so of each.
pub(in crate::engine) fn take_where(
    tensors: &mut dyn TensorSource,
    name: &str,
    is_right: impl Fn(f32) -> bool,
    expected: &'static str,
) -> Result<Vec<f32>, Error> {
    let promised = tensors.shape(name).map(<[usize]>::to_vec).unwrap_or_default();
    let tensor = tensors.take(name)?;
    if tensor.shape() != promised {
        return Err(Error::TensorSize { shape: promised, elements: tensor.data().len() });
    }
    // Nearly always all are right, and a fold over all is faster than a search.
    let all = tensor.data().iter().fold(true, |all, &value| all & is_right(value));
    if !all && let Some(at) = tensor.data().iter().position(|&value| !is_right(value)) {
        let (name, value) = (name.to_owned(), tensor.data()[at]);
        return Err(Error::Weight { name, index: index_of(at, &promised), value, expected });
    }
    Ok(tensor.into_data())
}

/// The index along each axis of the `at`-th element in C order.
fn index_of(mut at: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (place, &axis) in index.iter_mut().zip(shape).rev() {
        *place = at % axis;
        at /= axis;
    }
    index
}
