//! `turgor.Mesh`, `turgor.Component` and `turgor.correct`.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use turgor::{Status, Target};

use crate::joint::read_shares;
use crate::threads::detached;
use crate::{TurgorError, arrays};

/// A surface at rest.
#[pyclass(frozen, module = "turgor")]
pub struct Mesh {
    pub inner: Arc<turgor::Mesh>,
}

/// One connected shell of a mesh.
#[pyclass(frozen, module = "turgor")]
pub struct Component {
    inner: turgor::Component,
}

#[pymethods]
impl Component {
    #[getter]
    fn status(&self) -> &'static str {
        match self.inner.status {
            Status::Closed => "closed",
            Status::Capped => "capped",
            Status::Sheet => "sheet",
            Status::Flat => "flat",
            Status::NonManifold => "non_manifold",
            Status::NotOrientable => "not_orientable",
        }
    }

    #[getter]
    fn is_sound(&self) -> bool {
        self.inner.is_sound()
    }

    #[getter]
    fn rest_volume(&self) -> f64 {
        self.inner.rest_volume
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count
    }

    #[getter]
    fn face_count(&self) -> usize {
        self.inner.face_count
    }

    #[getter]
    fn boundary_edge_count(&self) -> usize {
        self.inner.boundary_edge_count
    }

    #[getter]
    fn flipped_face_count(&self) -> usize {
        self.inner.flipped_face_count
    }
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (rest_positions, face_offsets, face_corners, weld_tolerance=1e-6))]
    fn new(
        py: Python<'_>,
        rest_positions: &Bound<'_, PyAny>,
        face_offsets: &Bound<'_, PyAny>,
        face_corners: &Bound<'_, PyAny>,
        weld_tolerance: f64,
    ) -> PyResult<Self> {
        let rest = arrays::vectors(rest_positions, "rest_positions")?;
        let offsets = arrays::indices(face_offsets, "face_offsets")?;
        let corners = arrays::indices(face_corners, "face_corners")?;
        let mesh = detached(py, || turgor::Mesh::new(rest, &offsets, &corners, weld_tolerance))?;
        Ok(Self { inner: Arc::new(mesh) })
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.rest().len()
    }

    #[getter]
    fn welded_count(&self) -> usize {
        self.inner.topology().point_count
    }

    #[getter]
    fn components(&self) -> Vec<Component> {
        self.inner.topology().components.iter().map(|c| Component { inner: c.clone() }).collect()
    }

    #[getter]
    fn vertex_components<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let topology = self.inner.topology();
        let of_vertex = topology.point_of_vertex.iter().map(|&point| topology.component_of_point[point as usize]);
        let indices: Vec<i32> = of_vertex.map(|component| i32::try_from(component).unwrap_or(-1)).collect();
        arrays::from_numbers(py, &indices)
    }

    #[getter]
    fn rest_positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, self.inner.rest())
    }

    fn volume(&self, py: Python<'_>, positions: &Bound<'_, PyAny>) -> PyResult<f64> {
        let positions = arrays::vectors(positions, "positions")?;
        Ok(detached(py, || self.inner.component_volumes(&positions))?.iter().sum())
    }

    fn component_volumes<'py>(&self, py: Python<'py>, positions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let positions = arrays::vectors(positions, "positions")?;
        Ok(arrays::from_numbers(py, &detached(py, || self.inner.component_volumes(&positions))?))
    }

    fn volume_gradient<'py>(&self, py: Python<'py>, positions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions = arrays::vectors(positions, "positions")?;
        Ok(arrays::from_vectors(py, &detached(py, || self.inner.volume_gradient(&positions))?))
    }
}

/// The bare formula.
#[pyfunction]
#[pyo3(signature = (mesh, positions, target_volume, gamma, frame=None, shares=None), text_signature = "(mesh, positions, target_volume, gamma, frame=None, shares='auto')")]
pub fn correct<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    positions: &Bound<'py, PyAny>,
    target_volume: &Bound<'py, PyAny>,
    gamma: &Bound<'py, PyAny>,
    frame: Option<&Bound<'py, PyAny>>,
    shares: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let positions = arrays::vectors(positions, "positions")?;
    let gamma = arrays::numbers(gamma, "gamma")?;
    let axes = match frame.map(|frame| arrays::vectors(frame, "frame")).transpose()?.as_deref() {
        None => None,
        Some(&[a, b, c]) if [a, b, c].iter().all(|e: &DVec3| e.is_finite()) => Some([a, b, c]),
        Some(rows) => return Err(TurgorError::new_err(format!("frame: need three finite rows e0, e1, e2, got {} rows", rows.len()))),
    };
    let shares = read_shares(shares)?;
    let targets;
    let target = if let Some(total) = arrays::number(target_volume) {
        Target::Total(total)
    } else {
        targets = arrays::numbers(target_volume, "target_volume")?;
        Target::PerComponent(&targets)
    };
    let corrected = detached(py, || mesh.inner.correct(&positions, target, &gamma, axes, shares))?;
    Ok(arrays::from_vectors(py, &corrected))
}
