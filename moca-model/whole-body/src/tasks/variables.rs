//! Variables beside q̇.

use std::ops::Range;
use std::sync::Arc;

use crate::robot::model::Model;

/// The layout of a stack's variables: q̇, and variables that tasks trade against it.
///
/// ```
/// use whole_body::tasks::VariableLayout;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="hinge" type="continuous"><parent link="base"/><child link="tip"/></joint>
/// #   </robot>"#, &Description::default())?;
/// let mut layout = VariableLayout::new(&model); // q̇ alone
/// let desired = layout.add("desired twist", 6);
/// assert_eq!((desired.range(), layout.len()), (1..7, 7));
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct VariableLayout {
    names: Vec<Arc<str>>,
}

/// A range of variables beside q̇, as [`VariableLayout::add`] and
/// [`IkBuilder::variables`](crate::ik::IkBuilder::variables) return it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variables {
    range: Range<usize>,
}

impl VariableLayout {
    /// Creates a layout with q̇ of a robot, named by its joints.
    pub fn new(model: &Model) -> Self {
        Self { names: model.velocity_names().into_iter().map(Arc::from).collect() }
    }

    /// Adds `count` variables behind the present ones. Errors name them after `name`.
    pub fn add(&mut self, name: &str, count: usize) -> Variables {
        let first = self.names.len();
        self.names.extend((0..count).map(|index| format!("{name} {index}").into()));
        Variables { range: first..self.names.len() }
    }

    /// The number of variables.
    #[expect(clippy::len_without_is_empty, reason = "a robot has a joint")]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    pub(crate) fn names(&self) -> &[Arc<str>] {
        &self.names
    }
}

impl Variables {
    /// The range of their indices in rows, quadratics and solutions.
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }
}
