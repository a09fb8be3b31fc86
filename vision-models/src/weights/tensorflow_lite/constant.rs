//! Constants in a file of TensorFlow Lite.

use crate::error::Error;
use crate::weights::budget::Budget;
use crate::weights::element::ElementType;
use crate::weights::error::refused;
use crate::weights::shape::elements;

use super::{Model, TensorHead, sparse};

/// A tensor whose elements are in the file.
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) tensor: usize,
    pub(crate) shape: Vec<usize>,
    element: ElementType,
}

impl Constant {
    /// Returns the constant of a tensor, or `None` for a computed tensor. The budget is charged for
    /// its elements.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if one of these is wrong:
    /// - The budget is exceeded.
    /// - The elements have a type that no layer has.
    /// - The number of elements is not the shape's.
    pub(crate) fn of(
        model: &Model<'_>,
        tensor: usize,
        budget: &mut Budget,
    ) -> Result<Option<Self>, Error> {
        let TensorHead { shape, element, buffer } = model.head(tensor)?;
        if buffer == 0 {
            return Ok(None);
        }
        let refuse = |problem: String| refused(model.name(tensor), problem);
        let head = TensorHead { shape: Vec::new(), element, buffer };
        let bytes = model.elements(&head)?;
        if bytes.is_empty() {
            return Ok(None);
        }
        let element = match element {
            0 => ElementType::F32,
            1 => ElementType::F16,
            2 => ElementType::I32,
            other => {
                let problem =
                    format!("elements of type {other}: only float32, float16 and int32 are read");
                return Err(refuse(problem));
            }
        };
        let all = elements(&shape).unwrap_or(usize::MAX);
        budget.take(all.saturating_mul(size_of::<f32>()))?;
        let table = model.tensors.get(tensor, "tensor")?;
        let count = match table.table(6, "sparsity")? {
            Some(sparsity) => {
                let stored = bytes.len() / element.size();
                sparse::check(&sparsity, &shape, stored).map_err(refuse)?
            }
            None => all,
        };
        if count.checked_mul(element.size()) != Some(bytes.len()) {
            let problem = format!("shape {shape:?} and {} bytes of {element}", bytes.len());
            return Err(refuse(problem));
        }
        Ok(Some(Self { tensor, shape, element }))
    }

    /// Returns the number of elements, including the zeros of a sparse tensor.
    pub(crate) fn elements(&self) -> usize {
        elements(&self.shape).unwrap_or(usize::MAX)
    }

    /// Returns the elements, in order.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if positions of a sparse tensor lie outside it.
    pub(crate) fn read(&self, model: &Model<'_>) -> Result<Vec<f32>, Error> {
        let head = model.head(self.tensor)?;
        let bytes = model.elements(&head)?;
        let mut values = Vec::with_capacity(bytes.len() / self.element.size());
        self.element.decode(bytes, &mut values);
        let table = model.tensors.get(self.tensor, "tensor")?;
        match table.table(6, "sparsity")? {
            None => Ok(values),
            Some(sparsity) => sparse::spread(&sparsity, &self.shape, &values)
                .map_err(|problem| refused(model.name(self.tensor), problem)),
        }
    }

    /// Returns a few integers, such as a shape.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the elements have another type or number.
    pub(crate) fn whole<const COUNT: usize>(
        &self,
        model: &Model<'_>,
    ) -> Result<[i32; COUNT], Error> {
        let head = model.head(self.tensor)?;
        let bytes = model.elements(&head)?;
        let numbers = bytes.as_chunks().0.iter().map(|&bytes| i32::from_le_bytes(bytes));
        let numbers: Option<[i32; COUNT]> = (self.element == ElementType::I32
            && bytes.len() == COUNT * size_of::<i32>())
        .then(|| numbers.collect::<Vec<_>>().try_into().ok())
        .flatten();
        let problem = format!(
            "{} bytes of {}, where {COUNT} whole numbers are read",
            bytes.len(),
            self.element
        );
        numbers.ok_or_else(|| refused(model.name(self.tensor), problem))
    }
}
