//! The values of a pickle, as far as a state dict needs them.

use std::rc::Rc;

use crate::weights::element::ElementType;

/// The index of a value among all values of a pickle. Values refer to each other by their index. A
/// value that occurs many times is therefore stored once, and no depth of nesting can exhaust the
/// stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::weights) struct Id(pub(super) usize);

/// A Python value.
#[derive(Debug)]
pub(in crate::weights) enum Value {
    Bool(bool),
    Int(i64),
    Text(Rc<str>),
    Tuple(Vec<Id>),
    List(Vec<Id>),
    Dict(Vec<(Id, Id)>),
    Global(Global),
    Storage(Rc<Storage>),
    Tensor(Box<View>),
    /// Any other value. It is not used.
    Inert,
}

/// The names that have a meaning. All other names in a pickle are ignored, and these are
/// interpreted here, not called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::weights) enum Global {
    OrderedDict,
    RebuildTensor,
    RebuildParameter,
    RebuildFromType,
    Storage(ElementType),
}

impl Global {
    pub(super) fn from_name(module: &str, name: &str) -> Option<Self> {
        match (module, name) {
            ("collections", "OrderedDict") => Some(Self::OrderedDict),
            ("torch._utils", "_rebuild_tensor" | "_rebuild_tensor_v2") => Some(Self::RebuildTensor),
            ("torch._utils", "_rebuild_parameter" | "_rebuild_parameter_with_state") => {
                Some(Self::RebuildParameter)
            }
            ("torch._tensor", "_rebuild_from_type_v2") => Some(Self::RebuildFromType),
            ("torch", class) => ElementType::from_storage_class(class).map(Self::Storage),
            _ => None,
        }
    }
}

/// The memory of which tensors are views.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::weights) struct Storage {
    pub(in crate::weights) key: Rc<str>,
    pub(in crate::weights) element: ElementType,
    pub(in crate::weights) elements: usize,
}

/// A tensor: the position of its elements in a storage.
#[derive(Clone, Debug)]
pub(in crate::weights) struct View {
    pub(in crate::weights) storage: Rc<Storage>,
    pub(in crate::weights) offset: usize,
    pub(in crate::weights) shape: Vec<usize>,
    pub(in crate::weights) strides: Vec<usize>,
}
