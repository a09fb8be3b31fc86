//! Rows that the caller writes in place.

use super::input::TaskInput;
use super::rows::TaskRows;
use super::task::{Limit, Task};
use crate::error::Error;
use crate::robot::model::Model;

/// Rows over q̇ and further variables that the caller writes into the problem's data, without a copy in between. They
/// bound nothing at first, and hold until they are written again. Examples are the distances and shared workspaces of
/// other crates.
///
/// A block is the only task among the rows that its level minimises, or among the constraints of its level.
///
/// ```
/// use whole_body::{
///     Data, stack::{Budget, TaskLevel, TaskStack}, tasks::{RowBlock, VariableLayout},
/// };
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="hinge" type="continuous"><parent link="base"/><child link="tip"/></joint>
/// #   </robot>"#, &Description::default())?;
/// let mut level = TaskLevel::new("rows");
/// let block = level.push("rows", RowBlock::new(1));
/// let mut stack =
///     TaskStack::new(&model, &VariableLayout::new(&model), vec![level], Default::default())?;
/// stack.block_mut(block)?.set_row(0, &[2.0], 0.6, f64::INFINITY)?; // 2 q̇ ≥ 0.6 rad/s
/// stack.write(&mut Data::new(&model).pose(&model, &[0.0])?, &[0.0], 1e-3)?;
/// assert!((stack.solve(Budget::default())?.best()[0] - 0.3).abs() < 1e-12);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct RowBlock {
    count: usize,
}

impl RowBlock {
    /// Creates a block of this many rows, which [`TaskStack::block_mut`](crate::stack::TaskStack::block_mut) gives.
    pub fn new(count: usize) -> Self {
        Self { count }
    }
}

impl Task for RowBlock {
    fn dimension(&self, _model: &Model) -> usize {
        self.count
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn writes_all(&self, _variables: usize) -> bool {
        true
    }

    fn write(
        &mut self,
        _input: &mut TaskInput<'_, '_>,
        _rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        Ok(())
    }
}

/// Rows that do not admit rest are widened until they do.
impl Limit for RowBlock {}
