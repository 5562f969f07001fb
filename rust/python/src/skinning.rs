//! `turgor.Skeleton` and `turgor.Skinning`.

use numpy::PyArray2;
use pyo3::prelude::*;
use turgor::Mode;

use crate::threads::detached;
use crate::{TurgorError, arrays, refused};

/// Bones at rest.
#[pyclass(frozen, module = "turgor")]
pub struct Skeleton {
    inner: turgor::Skeleton,
}

#[pymethods]
impl Skeleton {
    #[new]
    #[pyo3(signature = (parents, rest_matrices, segments=None))]
    fn new(parents: &Bound<'_, PyAny>, rest_matrices: &Bound<'_, PyAny>, segments: Option<Vec<bool>>) -> PyResult<Self> {
        let parents = arrays::indices(parents, "parents")?;
        let rest = arrays::matrices(rest_matrices, "rest_matrices")?;
        let skeleton = turgor::Skeleton::new(&parents, &rest).map_err(refused)?;
        let inner = match segments {
            Some(segments) => skeleton.with_segments(&segments).map_err(refused)?,
            None => skeleton,
        };
        Ok(Self { inner })
    }

    #[getter]
    fn bone_count(&self) -> usize {
        self.inner.len()
    }
}

/// Blend skinning that reproduces Blender's Armature modifier.
#[pyclass(frozen, module = "turgor")]
pub struct Skinning {
    pub inner: turgor::Skinning,
}

#[pymethods]
impl Skinning {
    #[new]
    #[pyo3(signature = (skeleton, weight_offsets, weight_bones, weights, mode="linear", vertex_mask=None))]
    fn new(
        skeleton: &Skeleton,
        weight_offsets: &Bound<'_, PyAny>,
        weight_bones: &Bound<'_, PyAny>,
        weights: &Bound<'_, PyAny>,
        mode: &str,
        vertex_mask: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mode = match mode {
            "linear" => Mode::Linear,
            "dual_quaternion" => Mode::DualQuaternion,
            _ => return Err(TurgorError::new_err(format!("mode: need \"linear\" or \"dual_quaternion\", got {mode:?}"))),
        };
        let offsets = arrays::indices(weight_offsets, "weight_offsets")?;
        let bones = arrays::indices(weight_bones, "weight_bones")?;
        let weights = arrays::numbers(weights, "weights")?;
        let mask = vertex_mask.map(|mask| arrays::numbers(mask, "vertex_mask")).transpose()?;
        let skinning = turgor::Skinning::new(skeleton.inner.clone(), &offsets, &bones, &weights, mode, mask.as_deref());
        Ok(Self { inner: skinning.map_err(refused)? })
    }

    #[getter]
    fn vertex_count(&self) -> usize {
        self.inner.vertex_count()
    }

    #[pyo3(signature = (positions, pose_matrices, object_from_armature=None))]
    fn deform<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        pose_matrices: &Bound<'py, PyAny>,
        object_from_armature: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions = arrays::vectors(positions, "positions")?;
        let pose = arrays::matrices(pose_matrices, "pose_matrices")?;
        let object = arrays::matrix(object_from_armature, "object_from_armature")?;
        let skinned = detached(py, || self.inner.deform(&positions, &pose, &object))?;
        Ok(arrays::from_vectors(py, &skinned))
    }
}
