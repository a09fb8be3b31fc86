//! Classes of plain fields, and words that stand for variants.

use ergo_map::{Mode, Side};

use crate::failure::{Failure, Result};

/// Defines a class of fields with defaults, which its constructor takes as keywords.
macro_rules! keyword_class {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty = $default:tt,)* }) => {
        $(#[$doc])*
        #[pyo3::pyclass(frozen, get_all, eq, module = "ahqp.ergo")]
        #[derive(Debug, Clone, PartialEq)]
        pub(crate) struct $name {
            $($(#[$field_doc])* pub(crate) $field: $type,)*
        }

        #[pyo3::pymethods]
        impl $name {
            #[new]
            #[pyo3(signature = (*, $($field = $default),*))]
            #[allow(clippy::too_many_arguments)] // keywords of Python
            fn new($($field: $type),*) -> Self {
                Self { $($field),* }
            }

            fn __repr__(&self) -> String {
                let fields = [$(format!("{}={:?}", stringify!($field), self.$field)),*];
                format!("{}({})", stringify!($name), fields.join(", "))
            }
        }
    };
}

pub(super) use keyword_class;

/// Reads one of the given words.
pub(crate) fn word<T: Copy>(name: &str, value: &str, words: &[(&str, T)]) -> Result<T> {
    words.iter().find(|(word, _)| *word == value).map(|(_, found)| *found).ok_or_else(|| {
        let words: Vec<_> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let known = words.join(", ");
        Failure::value(format!("{name} is \"{value}\"; it must be one of {known}"))
    })
}

pub(crate) fn side(value: &str) -> Result<Side> {
    word("side", value, &[("left", Side::Left), ("right", Side::Right)])
}

pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

pub(super) fn mode(value: &str) -> Result<Mode> {
    word("mode", value, &[("graded", Mode::Graded), ("faithful", Mode::FAITHFUL)])
}
