//! `turgor.Frame`, `turgor.Report`, `turgor.Measures` and `turgor.RefinementNeed`: what comes out.

use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays;

/// Result of one frame, object space.
#[pyclass(frozen, module = "turgor")]
pub struct Frame {
    pub positions: Vec<DVec3>,
    pub skinned: Vec<DVec3>,
    pub offsets: Vec<[f32; 3]>,
    pub report: turgor::Report,
}

#[pymethods]
impl Frame {
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, &self.positions)
    }

    #[getter]
    fn skinned<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, &self.skinned)
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        arrays::from_floats(py, &self.offsets)
    }

    #[getter]
    fn report(&self) -> Report {
        Report { inner: self.report.clone() }
    }
}

/// Figures of one frame.
#[pyclass(frozen, module = "turgor")]
pub struct Report {
    pub inner: turgor::Report,
}

#[pymethods]
impl Report {
    #[getter]
    fn skinned_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.skinned_volumes)
    }

    #[getter]
    fn flesh_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.flesh_volumes)
    }

    #[getter]
    fn target_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.target_volumes)
    }

    #[getter]
    fn corrected_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.corrected_volumes)
    }

    #[getter]
    fn joint_losses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.joint_losses)
    }

    #[getter]
    fn joint_regained<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.joint_regained)
    }

    #[getter]
    fn joint_displacements<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.joint_displacements)
    }

    #[getter]
    fn joint_is_capped<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.joint_is_capped)
    }

    #[getter]
    fn component_is_pinned<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.component_is_pinned)
    }

    #[getter]
    fn seam_gap(&self) -> f64 {
        self.inner.seam_gap
    }

    #[getter]
    fn max_displacement(&self) -> f64 {
        self.inner.max_displacement
    }

    #[getter]
    fn folds_found(&self) -> usize {
        self.inner.folds_found
    }

    #[getter]
    fn folds_left(&self) -> usize {
        self.inner.folds_left
    }

    #[getter]
    fn blocked_vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let vertices: Vec<i32> = self.inner.blocked_vertices.iter().map(|&vertex| vertex as i32).collect();
        arrays::from_numbers(py, &vertices)
    }

    #[getter]
    fn relative_error(&self) -> f64 {
        self.inner.relative_error()
    }
}

/// Figures of many frames.
#[pyclass(frozen, module = "turgor")]
pub struct Measures {
    pub reports: Vec<turgor::Report>,
    pub component_count: usize,
    pub joint_count: usize,
}

impl Measures {
    fn per_component<'py>(&self, py: Python<'py>, figures: impl Fn(&turgor::Report) -> &[f64]) -> Bound<'py, PyArray2<f64>> {
        arrays::from_table(py, &self.reports.iter().map(figures).collect::<Vec<&[f64]>>(), self.component_count)
    }

    fn per_joint<'py, T: numpy::Element + Copy>(
        &self,
        py: Python<'py>,
        figures: impl Fn(&turgor::Report) -> &[T],
    ) -> Bound<'py, PyArray2<T>> {
        arrays::from_table(py, &self.reports.iter().map(figures).collect::<Vec<&[T]>>(), self.joint_count)
    }
}

#[pymethods]
impl Measures {
    #[getter]
    fn skinned_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_component(py, |report| &report.skinned_volumes)
    }

    #[getter]
    fn flesh_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_component(py, |report| &report.flesh_volumes)
    }

    #[getter]
    fn target_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_component(py, |report| &report.target_volumes)
    }

    #[getter]
    fn corrected_volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_component(py, |report| &report.corrected_volumes)
    }

    #[getter]
    fn joint_losses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_joint(py, |report| &report.joint_losses)
    }

    #[getter]
    fn joint_regained<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.per_joint(py, |report| &report.joint_regained)
    }

    #[getter]
    fn joint_is_capped<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<bool>> {
        self.per_joint(py, |report| &report.joint_is_capped)
    }

    #[getter]
    fn max_displacements<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let displacements: Vec<f64> = self.reports.iter().map(|report| report.max_displacement).collect();
        arrays::from_numbers(py, &displacements)
    }
}

/// Where many poses ask for more vertices.
#[pyclass(frozen, module = "turgor")]
pub struct RefinementNeed {
    pub inner: turgor::RefinementNeed,
}

#[pymethods]
impl RefinementNeed {
    #[getter]
    fn gamma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        arrays::from_numbers(py, &self.inner.gamma)
    }

    #[getter]
    fn edge_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        arrays::from_numbers(py, &self.inner.edge_lengths)
    }
}
