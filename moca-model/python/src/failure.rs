//! Errors of the crates as Python exceptions with equal texts.

use percept_recording::RecordingError;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    ahqp,
    Error,
    PyValueError,
    "What was wrong, where, and what would be right."
);
pyo3::create_exception!(
    ahqp,
    InfeasibleError,
    Error,
    "Hard constraints contradict each other. `conflict` lists rows that cannot hold together."
);
pyo3::create_exception!(
    ahqp,
    UnfinishedError,
    Error,
    "The optimum was asked for, but the budget ran out before. `Solution.best` is how far it came."
);
pyo3::create_exception!(
    ahqp,
    FrameError,
    Error,
    "A camera frame counts as no data. The safety state knows of it, and the loop may go on."
);

/// Exception to raise. The crates' errors are converted to it.
#[derive(Debug)]
pub(crate) struct Failure(PyErr);

pub(crate) type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    pub(crate) fn value(text: impl Into<String>) -> Self {
        Self(PyValueError::new_err(text.into()))
    }

    pub(crate) fn type_of_argument(text: impl Into<String>) -> Self {
        Self(PyTypeError::new_err(text.into()))
    }

    pub(crate) fn runtime(text: impl Into<String>) -> Self {
        Self(PyRuntimeError::new_err(text.into()))
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        failure.0
    }
}

impl From<ahqp_core::Error> for Failure {
    fn from(error: ahqp_core::Error) -> Self {
        let text = error.to_string();
        Self(match error {
            ahqp_core::Error::Infeasible { .. } => InfeasibleError::new_err(text),
            ahqp_core::Error::Unfinished { .. } => UnfinishedError::new_err(text),
            _ => Error::new_err(text),
        })
    }
}

impl From<whole_body::Error> for Failure {
    fn from(error: whole_body::Error) -> Self {
        match error {
            whole_body::Error::Hierarchy(error) => error.into(),
            whole_body::Error::File { ref source, .. } => os_error(source.kind(), &error),
            error if error.is_unusable_limit() => Self(Error::new_err(format!(
                "{error} (ignore_unusable_limits=True takes it for unlimited)"
            ))),
            error => Self(Error::new_err(error.to_string())),
        }
    }
}

impl From<ergo_map::Error> for Failure {
    fn from(error: ergo_map::Error) -> Self {
        match error {
            ergo_map::Error::Io { kind, .. } => os_error(kind, &error),
            error => Self(Error::new_err(error.to_string())),
        }
    }
}

impl From<moca_model::Error> for Failure {
    fn from(error: moca_model::Error) -> Self {
        use hrsw_safety::Error as Unsafe;
        use moca_model::Error as Wrong;
        match error {
            Wrong::Robot(error) => error.into(),
            Wrong::Hierarchy(error) => error.into(),
            Wrong::Ergonomics(error) => error.into(),
            error @ (Wrong::Frame { .. }
            | Wrong::Body { .. }
            | Wrong::Safety(Unsafe::TooManyPeople { .. } | Unsafe::BodySpeed { .. })) => {
                Self(FrameError::new_err(error.to_string()))
            }
            error => Self(Error::new_err(error.to_string())),
        }
    }
}

impl From<vision_models::Error> for Failure {
    fn from(error: vision_models::Error) -> Self {
        let text = error.to_string();
        Self(match error {
            vision_models::Error::File { .. } => PyOSError::new_err(text),
            _ => Error::new_err(text),
        })
    }
}

impl From<simulated_people::Error> for Failure {
    fn from(error: simulated_people::Error) -> Self {
        Self(Error::new_err(error.to_string()))
    }
}

impl From<hrsw::Error> for Failure {
    fn from(error: hrsw::Error) -> Self {
        Self(Error::new_err(error.to_string()))
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self(error.into())
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Open { ref source, .. } | RecordingError::Io { ref source, .. } => {
                os_error(source.kind(), &error)
            }
            error => Self(Error::new_err(error.to_string())),
        }
    }
}

/// Checks that a file can be opened, for readers whose errors do not say why it cannot.
pub(crate) fn check_file(path: &std::path::Path) -> Result<()> {
    let refused =
        |error: std::io::Error| os_error(error.kind(), &format!("{}: {error}", path.display()));
    std::fs::File::open(path).map(drop).map_err(refused)
}

/// Returns `FileNotFoundError`, `PermissionError` or a similar exception, with the crate's text.
fn os_error(kind: std::io::ErrorKind, error: &impl ToString) -> Failure {
    use pyo3::exceptions::{PyFileNotFoundError, PyIsADirectoryError, PyPermissionError};
    let text = error.to_string();
    Failure(match kind {
        std::io::ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
        std::io::ErrorKind::PermissionDenied => PyPermissionError::new_err(text),
        std::io::ErrorKind::IsADirectory => PyIsADirectoryError::new_err(text),
        _ => PyOSError::new_err(text),
    })
}
