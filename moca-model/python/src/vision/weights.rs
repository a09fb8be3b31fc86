//! Weights of networks from files and from arrays.

use std::collections::BTreeSet;
use std::path::PathBuf;

use numpy::ndarray::IxDyn;
use numpy::{PyArrayDescrMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vision_models::{Checkpoint, Error, NetworkKind, Options, Tensor, TensorSource, Tensors};

use super::arrays::{flat, floats};
use crate::arrays::real;
use crate::failure::{Failure, Result, check_file};

/// The weights of a network.
pub(super) enum Weights {
    /// A file, whose tensors are read on demand.
    File(Box<Checkpoint>),
    /// The arrays of a state dict, and the names of those with integers.
    Given { tensors: Tensors, counters: BTreeSet<String> },
}

impl Weights {
    /// Reads a state dict, or opens the file of a path.
    pub(super) fn read(weights: &Bound<'_, PyAny>) -> Result<Self> {
        let Ok(dict) = weights.cast::<PyDict>() else {
            let path: PathBuf = weights.extract().map_err(|_| {
                Failure::type_of_argument("weights must be a path, or a dict of names to arrays")
            })?;
            check_file(&path)?;
            let opened = weights.py().detach(|| Checkpoint::open(&path));
            return Ok(Self::File(Box::new(opened.map_err(|error| in_file(&path, error))?)));
        };
        let (mut tensors, mut counters) = (Tensors::new(), BTreeSet::new());
        for (name, values) in dict {
            let name: String = name.extract()?;
            if real(&name, &values)?.dtype().kind() != b'f' {
                counters.insert(name.clone());
            }
            let values = floats::<IxDyn>(&name, &values, "of any shape")?;
            let shape = values.shape().to_vec();
            tensors.insert(name, Tensor::new(shape, flat(values))?)?;
        }
        Ok(Self::Given { tensors, counters })
    }

    /// Returns the network that has these weights, by its form. `choose` takes it if it is of the wanted kind.
    pub(super) fn kind<T>(
        &self,
        wanted: &str,
        choose: impl FnOnce(NetworkKind) -> Option<T>,
    ) -> Result<T> {
        let found = NetworkKind::of(self);
        if let Some(form) = found.and_then(choose) {
            return Ok(form);
        }
        let problem = found.map_or_else(
            || format!("no network that is known has these tensors; give those of {wanted}"),
            |found| format!("they are those of {found}; give those of {wanted}"),
        );
        Err(Error::Malformed { what: "weights".to_owned(), problem }.into())
    }
}

impl TensorSource for Weights {
    fn names(&self) -> Vec<&str> {
        match self {
            Self::File(file) => TensorSource::names(&**file),
            Self::Given { tensors, .. } => TensorSource::names(tensors),
        }
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        match self {
            Self::File(file) => file.shape(name),
            Self::Given { tensors, .. } => tensors.shape(name),
        }
    }

    fn is_counter(&self, name: &str) -> bool {
        match self {
            Self::File(file) => file.is_counter(name),
            Self::Given { counters, .. } => counters.contains(name),
        }
    }

    fn take(&mut self, name: &str) -> std::result::Result<Tensor, Error> {
        match self {
            Self::File(file) => file.take(name),
            Self::Given { tensors, .. } => TensorSource::take(tensors, name),
        }
    }
}

/// Options with so many threads.
pub(super) fn options(threads: usize) -> Options {
    Options { threads, ..Options::default() }
}

/// Adds a file's name to the errors of its contents.
pub(super) fn in_file(path: &std::path::Path, error: Error) -> Error {
    match error {
        Error::Checkpoint { place, problem } => {
            Error::Checkpoint { place: format!("{}: {place}", path.display()), problem }
        }
        Error::Malformed { what, problem } => {
            Error::Malformed { what: format!("{}: {what}", path.display()), problem }
        }
        other => other,
    }
}
