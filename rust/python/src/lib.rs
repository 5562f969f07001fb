//! The Python border of `turgor`: checks and copies arrays, detaches from the interpreter, wraps results. No mathematics.

mod arrays;
mod fault;
mod fleshing;
mod joint;
mod mesh;
mod pose;
mod report;
mod skinning;
mod spine;
mod threads;
mod volume_skin;
mod weights;

use pyo3::prelude::*;

pyo3::create_exception!(turgor, TurgorError, pyo3::exceptions::PyValueError, "What was found, what is needed, what to do.");

pyo3::create_exception!(turgor, CancelledError, pyo3::exceptions::PyException, "A progress callback returned False: nothing was changed.");

pyo3::create_exception!(
    turgor,
    FaultError,
    TurgorError,
    "A fault of the engine itself, where and why; there is no result. Please report it."
);

/// Engine errors become `turgor.TurgorError`, being cancelled a `turgor.CancelledError`.
#[allow(clippy::needless_pass_by_value, reason = "what map_err hands over")]
fn refused(error: turgor::Error) -> PyErr {
    let text = error.to_string();
    if error == turgor::Error::Cancelled { CancelledError::new_err(text) } else { TurgorError::new_err(text) }
}

/// Panics, for tests of what becomes of a fault.
#[pyfunction]
fn _fault(py: Python<'_>, message: &str) -> PyResult<()> {
    threads::detached(py, || panic!("{message}"))
}

/// The compiled engine.
#[pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::_fault;
    #[pymodule_export]
    use super::CancelledError;
    #[pymodule_export]
    use super::FaultError;
    #[pymodule_export]
    use super::TurgorError;
    #[pymodule_export]
    use super::fleshing::{Fleshing, FleshingReport, Validity, flesh};
    #[pymodule_export]
    use super::joint::{Joint, JointField};
    #[pymodule_export]
    use super::mesh::{Component, Mesh, correct};
    #[pymodule_export]
    use super::report::{Frame, Measures, RefinementNeed, Report};
    #[pymodule_export]
    use super::skinning::{Skeleton, Skinning};
    #[pymodule_export]
    use super::spine::{ClosestPoints, Spine, SpineFrames};
    #[pymodule_export]
    use super::volume_skin::VolumeSkin;
    #[pymodule_export]
    use super::weights::{Weights, automatic_weights};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::threads::remember_process();
        super::fault::remember();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
