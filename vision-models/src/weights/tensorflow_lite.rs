//! Files of TensorFlow Lite: their tensors and operators.

mod constant;
mod schema;
mod sparse;

use crate::error::Error;
use crate::excerpt::Excerpt;

use super::budget::Budget;
use super::error::refused;
pub(crate) use constant::Constant;
pub(crate) use schema::is_tensorflow_lite;
use schema::{Table, Tables};

/// Largest number of operands. No operator has more.
const MOST_OPERANDS: usize = 64;

/// A file of TensorFlow Lite, in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Model<'a> {
    codes: Tables<'a>,
    tensors: Tables<'a>,
    operators: Tables<'a>,
    buffers: Tables<'a>,
    main: Table<'a>,
}

/// An operator with its tensors.
#[derive(Clone, Debug)]
pub(crate) struct Operator<'a> {
    /// Number in `BuiltinOperator`.
    pub(crate) code: i32,
    /// The tensors that it reads. Missing ones are `None`.
    pub(crate) inputs: Vec<Option<usize>>,
    /// The tensors that it writes.
    pub(crate) outputs: Vec<usize>,
    options: Option<Table<'a>>,
}

/// The description of a tensor.
#[derive(Clone, Debug)]
pub(crate) struct TensorHead {
    pub(crate) shape: Vec<usize>,
    /// Number in `TensorType`.
    pub(crate) element: u8,
    /// The buffer of its elements, or 0 if there is none.
    pub(crate) buffer: usize,
}

impl<'a> Model<'a> {
    /// Opens a file.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the bytes are no such file, or inconsistent.
    pub(crate) fn of(file: &'a [u8]) -> Result<Self, Error> {
        if !is_tensorflow_lite(file) {
            return Err(refused("not a file of TensorFlow Lite", "bytes 4 to 7 are not \"TFL3\""));
        }
        let model = Table::root(file)?;
        let version: u32 = model.number(0, "version")?;
        if version != 3 {
            return Err(refused("version", format_args!("{version}: only 3 is known")));
        }
        let graphs = model.tables(2, "subgraphs")?;
        if graphs.len() != 1 {
            let problem = format!("there are {}: only one is read", graphs.len());
            return Err(refused("subgraphs", problem));
        }
        let main = graphs.get(0, "subgraph")?;
        Ok(Self {
            codes: model.tables(1, "operator codes")?,
            tensors: main.tables(0, "tensors")?,
            operators: main.tables(3, "operators")?,
            buffers: model.tables(4, "buffers")?,
            main,
        })
    }

    /// Charges the memory of the tensors and operators. A file can list the same table many times.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the budget is exceeded.
    pub(crate) fn pay(&self, budget: &mut Budget) -> Result<(), Error> {
        budget.take(self.tensors.len().saturating_mul(TENSOR_COST))?;
        budget.take(self.operators.len().saturating_mul(OPERATOR_COST))
    }

    /// Returns the number of tensors.
    pub(crate) fn tensors(&self) -> usize {
        self.tensors.len()
    }

    /// Returns the number of operators.
    pub(crate) fn operators(&self) -> usize {
        self.operators.len()
    }

    /// Returns the input tensors of the network.
    pub(crate) fn inputs(&self) -> Result<Vec<usize>, Error> {
        self.indices(&self.main, 1, "inputs")
    }

    /// Returns the output tensors of the network.
    pub(crate) fn outputs(&self) -> Result<Vec<usize>, Error> {
        self.indices(&self.main, 2, "outputs")
    }

    /// Returns the operator of this number.
    pub(crate) fn operator(&self, index: usize) -> Result<Operator<'a>, Error> {
        let operator = self.operators.get(index, "operator")?;
        let code: u32 = operator.number(0, "operator code of an operator")?;
        let code = self.codes.get(code as usize, "operator code")?;
        // Codes above 127 are in a later field. The first field is then 127.
        let first: i8 = code.number(0, "operator code")?;
        let later: i32 = code.number(3, "operator code")?;
        let inputs = operator.numbers::<i32>(1, "inputs of an operator")?;
        if inputs.len() > MOST_OPERANDS {
            let problem = format!("{} operands, at most {MOST_OPERANDS} are read", inputs.len());
            return Err(refused(format_args!("operator {index}"), problem));
        }
        let inputs = inputs.iter().map(|tensor| match tensor {
            -1 => Ok(None),
            tensor => self.index(tensor).map(Some),
        });
        Ok(Operator {
            code: later.max(first.into()),
            inputs: inputs.collect::<Result<_, _>>()?,
            outputs: self.indices(&operator, 2, "outputs of an operator")?,
            options: operator.table(4, "options of an operator")?,
        })
    }

    /// Returns the description of the tensor of this number.
    pub(crate) fn head(&self, index: usize) -> Result<TensorHead, Error> {
        let tensor = self.tensors.get(index, "tensor")?;
        let axes = tensor.numbers::<i32>(0, "shape of a tensor")?;
        let refuse = |problem: String| refused(format_args!("tensor {index}"), problem);
        if axes.len() > super::shape::MAX_AXES {
            return Err(refuse(format!("it has {} axes", axes.len())));
        }
        let axis =
            |axis: i32| usize::try_from(axis).map_err(|_| refuse(format!("an axis of {axis}")));
        let buffer: u32 = tensor.number(2, "buffer of a tensor")?;
        Ok(TensorHead {
            shape: axes.iter().map(axis).collect::<Result<_, _>>()?,
            element: tensor.number::<i8>(1, "type of a tensor")?.cast_unsigned(),
            buffer: buffer as usize,
        })
    }

    /// Returns the name of the tensor of this number, for errors.
    pub(crate) fn name(&self, index: usize) -> String {
        let name = self.tensors.get(index, "tensor").and_then(|tensor| tensor.bytes(3, "name"));
        let name = String::from_utf8_lossy(name.unwrap_or_default()).into_owned();
        format!("tensor {index} \"{}\"", Excerpt(&name))
    }

    /// Returns the elements of a constant, or none for a computed tensor.
    fn elements(&self, head: &TensorHead) -> Result<&'a [u8], Error> {
        if head.buffer == 0 {
            return Ok(&[]);
        }
        self.buffers.get(head.buffer, "buffer")?.bytes(0, "data of a buffer")
    }

    fn index(&self, tensor: i32) -> Result<usize, Error> {
        let index = usize::try_from(tensor).ok().filter(|&index| index < self.tensors.len());
        let problem = format!("there are {} of them", self.tensors.len());
        index.ok_or_else(|| refused(format_args!("tensor {tensor}"), problem))
    }

    fn indices(
        &self,
        table: &Table<'a>,
        field: usize,
        name: &'static str,
    ) -> Result<Vec<usize>, Error> {
        let tensors = table.numbers::<i32>(field, name)?;
        if tensors.is_empty() || tensors.len() > MOST_OPERANDS {
            let problem = format!("{} tensors: from 1 to {MOST_OPERANDS} are read", tensors.len());
            return Err(refused(name, problem));
        }
        tensors.iter().map(|tensor| self.index(tensor)).collect()
    }
}

/// Bytes that are kept for a tensor and for an operator.
const TENSOR_COST: usize = 128;
const OPERATOR_COST: usize = 1024;

impl Operator<'_> {
    /// Returns a field of the options, or its default if the field or the options are missing.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if the field lies outside the file.
    pub(crate) fn option(&self, field: usize, kind: OptionKind) -> Result<i32, Error> {
        let name = "option of an operator";
        let Some(options) = &self.options else { return Ok(0) };
        match kind {
            OptionKind::Byte => options.number::<i8>(field, name).map(i32::from),
            OptionKind::Word => options.number(field, name),
        }
    }
}

/// Storage type of an option.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OptionKind {
    /// A boolean or a value of an enumeration.
    Byte,
    /// A number.
    Word,
}
