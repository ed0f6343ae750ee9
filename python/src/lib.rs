//! The module `kinora._kinora` of the wheel. The Python files beside it are what users import.
//!
//! In: sequences as files or texts, options of `render` as keywords. Out: frames as bytes, files, exceptions.
//! Uses the library; holds no rules of its own.

mod errors;
mod sequence;
mod watch;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `kinora` with these arguments; the first one is the program's name. Returns the exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| kinora::cli::main_with(arguments))
}

#[pymodule]
fn _kinora(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SequenceError", module.py().get_type::<errors::SequenceError>())?;
    module.add("RenderError", module.py().get_type::<errors::RenderError>())?;
    module.add_class::<sequence::Sequence>()?;
    module.add_function(wrap_pyfunction!(main, module)?)
}
