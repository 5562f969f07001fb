//! `turgor.automatic_weights` and `turgor.Weights`.

use glam::DVec3;
use numpy::PyArray1;
use pyo3::prelude::*;
use turgor::Error;
use turgor::weights::{Bones, Plane, Surface, Symmetry, WeightRows, WeightSettings};

use crate::threads::detached;
use crate::{TurgorError, arrays, refused};

/// Weights of all meshes, and how they were found.
#[pyclass(frozen, module = "turgor")]
pub struct Weights {
    inner: turgor::weights::Weights,
    vertex_starts: Vec<i32>,
}

#[pymethods]
impl Weights {
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        arrays::from_numbers(py, &self.inner.rows.offsets)
    }

    #[getter]
    fn bones<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        arrays::from_numbers(py, &self.inner.rows.bones)
    }

    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.rows.weights)
    }

    #[getter]
    fn vertex_starts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        arrays::from_numbers(py, &self.vertex_starts)
    }

    #[getter]
    fn is_fallback<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.is_fallback)
    }

    #[getter]
    fn dimensions(&self) -> (usize, usize, usize) {
        self.inner.dims.into()
    }

    #[getter]
    fn voxel_size(&self) -> f64 {
        self.inner.voxel_size
    }

    #[getter]
    fn voxel_count(&self) -> usize {
        self.inner.voxel_count
    }

    #[getter]
    fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes
    }
}

/// One mesh, owned, so that the interpreter can be left.
struct MeshData {
    positions: Vec<DVec3>,
    face_offsets: Vec<i32>,
    face_corners: Vec<i32>,
}

impl MeshData {
    fn read(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (positions, offsets, corners): (Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>) = value
            .extract()
            .map_err(|_| TurgorError::new_err(format!("meshes: need (positions, face_offsets, face_corners) each, got {value}")))?;
        Ok(Self {
            positions: arrays::vectors(&positions, "positions")?,
            face_offsets: arrays::indices(&offsets, "face_offsets")?,
            face_corners: arrays::indices(&corners, "face_corners")?,
        })
    }
}

fn read_plane(value: &Bound<'_, PyAny>) -> PyResult<Plane> {
    let (point, normal): (Bound<'_, PyAny>, Bound<'_, PyAny>) =
        value.extract().map_err(|_| TurgorError::new_err(format!("symmetry_plane: need (point, normal), got {value}")))?;
    Ok(Plane { point: arrays::vector(&point, "symmetry_plane")?, normal: arrays::vector(&normal, "symmetry_plane")? })
}

fn read_rows(value: &Bound<'_, PyAny>) -> PyResult<WeightRows> {
    let (offsets, bones, weights): (Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>) =
        value.extract().map_err(|_| TurgorError::new_err(format!("locked_weights: need (offsets, bones, weights), got {value}")))?;
    Ok(WeightRows {
        offsets: arrays::indices(&offsets, "weight_offsets")?,
        bones: arrays::indices(&bones, "weight_bones")?,
        weights: arrays::numbers(&weights, "weights")?,
    })
}

#[pyfunction]
#[pyo3(signature = (
    meshes, bone_heads, bone_tails, *, bone_parents=None, resolution=None, falloff=12.0, smoothing=0.83, max_influences=Some(4),
    stiffness=None, is_solid=None, is_locked=None, locked_weights=None, symmetry_plane=None, mirrored_bones=None, progress=None
), text_signature = "(meshes, bone_heads, bone_tails, *, bone_parents=None, resolution=None, falloff=12.0, smoothing=0.83, \
    max_influences=4, stiffness=None, is_solid=None, is_locked=None, locked_weights=None, symmetry_plane=None, mirrored_bones=None, progress=None)")]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub fn automatic_weights(
    py: Python<'_>,
    meshes: &Bound<'_, PyAny>,
    bone_heads: &Bound<'_, PyAny>,
    bone_tails: &Bound<'_, PyAny>,
    bone_parents: Option<&Bound<'_, PyAny>>,
    resolution: Option<i64>,
    falloff: f64,
    smoothing: f64,
    max_influences: Option<i64>,
    stiffness: Option<&Bound<'_, PyAny>>,
    is_solid: Option<&Bound<'_, PyAny>>,
    is_locked: Option<&Bound<'_, PyAny>>,
    locked_weights: Option<&Bound<'_, PyAny>>,
    symmetry_plane: Option<&Bound<'_, PyAny>>,
    mirrored_bones: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Weights> {
    let meshes: Vec<MeshData> = meshes.try_iter()?.map(|mesh| MeshData::read(&mesh?)).collect::<PyResult<_>>()?;
    let is_solid = is_solid.map_or_else(|| Ok(vec![true; meshes.len()]), |solid| arrays::flags(solid, "is_solid"))?;
    if is_solid.len() != meshes.len() {
        return Err(refused(Error::Length { what: "is_solid", found: is_solid.len(), needed: meshes.len() }));
    }
    let (heads, tails) = (arrays::vectors(bone_heads, "bone_heads")?, arrays::vectors(bone_tails, "bone_tails")?);
    let parents = bone_parents.map(|parents| arrays::indices(parents, "bone_parents")).transpose()?;
    let stiffness = stiffness.map(|stiffness| arrays::numbers(stiffness, "stiffness")).transpose()?;
    let is_locked = is_locked.map(|locked| arrays::flags(locked, "is_locked")).transpose()?;
    let locked_weights = locked_weights.map(read_rows).transpose()?;
    let plane = symmetry_plane.map(read_plane).transpose()?;
    let partners = mirrored_bones.map(|bones| arrays::indices(bones, "mirrored_bones")).transpose()?;
    let progress = progress.map(|progress| progress.clone().unbind());
    let mut raised = None;
    // Called between pieces of work, never from a worker: the interpreter may be held elsewhere.
    let mut report = |part: f64| {
        let Some(progress) = &progress else { return true };
        Python::attach(|py| match progress.call1(py, (part,)).and_then(|answer| py.check_signals().map(|()| answer)) {
            Ok(answer) => answer.extract::<bool>(py).unwrap_or(true),
            Err(error) => {
                raised = Some(error);
                false
            }
        })
    };
    let surfaces: Vec<Surface> = meshes
        .iter()
        .zip(is_solid)
        .map(|(m, is_solid)| Surface { positions: &m.positions, face_offsets: &m.face_offsets, face_corners: &m.face_corners, is_solid })
        .collect();
    let bones = Bones {
        heads: &heads,
        tails: &tails,
        parents: parents.as_deref(),
        stiffness: stiffness.as_deref(),
        is_locked: is_locked.as_deref(),
    };
    let symmetry = plane.map(|plane| Symmetry { plane, partners: partners.as_deref() });
    let resolution = resolution.map(|voxels| arrays::count(voxels, "resolution")).transpose()?;
    let max_influences = max_influences.map(|influences| arrays::count(influences, "max_influences")).transpose()?;
    let settings = WeightSettings { resolution, falloff, smoothing, max_influences, symmetry };
    let result = detached(py, || turgor::weights::automatic_weights(&surfaces, &bones, locked_weights.as_ref(), &settings, &mut report));
    if let Some(error) = raised {
        return Err(error);
    }
    let inner = result?;
    let mut vertex_starts = vec![0];
    for mesh in &meshes {
        vertex_starts.push(vertex_starts[vertex_starts.len() - 1] + mesh.positions.len() as i32);
    }
    Ok(Weights { inner, vertex_starts })
}
