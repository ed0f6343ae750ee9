//! Exceptions.

use kinora::LoadError;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

create_exception!(
    kinora,
    SequenceError,
    PyValueError,
    "A sequence with mistakes, or one that cannot be read.\n\n\
     Its text shows all mistakes, each with its lines and what would be right. `path`, `line`, `column` and `field` are \
     those of the first mistake; `line` and `column` count from 1, and what is unknown is None. `faults` lists all \
     mistakes as dicts with these keys and `message`."
);

create_exception!(
    kinora,
    RenderError,
    PyRuntimeError,
    "A frame that cannot be rendered, or a file that cannot be written."
);

/// The exception for a sequence that could not be loaded.
pub fn not_loaded(py: Python<'_>, error: &LoadError) -> PyErr {
    let exception = SequenceError::new_err(error.render(false));
    match with_places(py, &exception, error) {
        Ok(()) => exception,
        Err(failure) => failure,
    }
}

fn with_places(py: Python<'_>, exception: &PyErr, error: &LoadError) -> PyResult<()> {
    let faults = match error {
        LoadError::Faults(faults) => faults.places(),
        LoadError::Unreadable { .. } => Vec::new(),
    };
    let value = exception.value(py);
    let path = match (faults.first(), error) {
        (Some(first), _) => Some(first.file.clone()),
        (None, LoadError::Unreadable { path, .. }) => Some(path.to_string_lossy().into_owned()),
        (None, LoadError::Faults(_)) => None,
    };
    value.setattr("path", path)?;
    value.setattr("line", faults.first().map(|first| first.line))?;
    value.setattr("column", faults.first().map(|first| first.column))?;
    value.setattr("field", faults.first().and_then(|first| first.field.clone()))?;
    let dicts = faults.into_iter().map(|fault| {
        let dict = PyDict::new(py);
        dict.set_item("path", fault.file)?;
        dict.set_item("line", fault.line)?;
        dict.set_item("column", fault.column)?;
        dict.set_item("field", fault.field)?;
        dict.set_item("message", fault.message)?;
        Ok(dict)
    });
    value.setattr("faults", dicts.collect::<PyResult<Vec<_>>>()?)
}

/// The exception for a run that failed.
pub fn not_rendered(error: &kinora::RenderError) -> PyErr {
    RenderError::new_err(error.to_string())
}

/// The exception for a wrong argument.
pub fn wrong_value(why: impl ToString) -> PyErr {
    PyValueError::new_err(why.to_string())
}

/// The exception for an argument that does not exist.
pub fn wrong_type(why: impl ToString) -> PyErr {
    PyTypeError::new_err(why.to_string())
}
