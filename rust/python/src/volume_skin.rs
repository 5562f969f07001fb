//! `turgor.VolumeSkin`.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use turgor::{Fields, Options, Solver, Workspace, Workspaces};

use crate::joint::{Joint, JointField, bone_index};
use crate::mesh::Mesh;
use crate::pose::{PerFrame, PoseData, PosesData};
use crate::report::{Frame, Measures, RefinementNeed, Report};
use crate::skinning::Skinning;
use crate::threads::detached;
use crate::{TurgorError, arrays, refused};

/// A bound character.
#[pyclass(frozen, module = "turgor")]
pub struct VolumeSkin {
    inner: turgor::VolumeSkin,
    mesh: Arc<turgor::Mesh>,
    /// Buffers of calls that have ended, for the next ones; a mask does not change them.
    workspaces: Arc<Workspaces>,
}

fn solver(name: &str) -> PyResult<Solver> {
    match name {
        "simultaneous" => Ok(Solver::Simultaneous),
        "sequential" => Ok(Solver::Sequential),
        _ => Err(TurgorError::new_err(format!("solver: need \"simultaneous\" or \"sequential\", got {name:?}"))),
    }
}

fn fields(name: &str) -> PyResult<Fields> {
    match name {
        "plain" => Ok(Fields::Plain),
        "even" => Ok(Fields::Even),
        _ => Err(TurgorError::new_err(format!("fields: need \"plain\" or \"even\", got {name:?}"))),
    }
}

fn joint_settings(joints: Option<Vec<PyRef<'_, Joint>>>) -> Vec<turgor::Joint> {
    joints.unwrap_or_default().iter().map(|joint| joint.inner.clone()).collect()
}

impl VolumeSkin {
    fn wrap(inner: turgor::VolumeSkin, mesh: Arc<turgor::Mesh>) -> Self {
        Self { inner, mesh, workspaces: Arc::default() }
    }

    /// Computes something in a workspace, without the interpreter.
    fn in_workspace<T: Send>(&self, py: Python<'_>, compute: impl FnOnce(&mut Workspace) -> turgor::Result<T> + Send) -> PyResult<T> {
        detached(py, || {
            let mut workspace = self.workspaces.borrow(&self.inner);
            let result = compute(&mut workspace);
            self.workspaces.release(workspace);
            result
        })
    }

    fn write(&self, py: Python<'_>, pose: &PoseData, offsets: &mut [[f32; 3]]) -> PyResult<Report> {
        let inner = self.in_workspace(py, |workspace| self.inner.deform(&pose.pose(), workspace, offsets).cloned())?;
        Ok(Report { inner })
    }

    fn check_rows(&self, found: usize) -> PyResult<()> {
        let needed = self.mesh.rest().len();
        if found == needed {
            return Ok(());
        }
        Err(refused(turgor::Error::VertexCount { found, bound: needed }))
    }
}

#[pymethods]
impl VolumeSkin {
    #[new]
    #[pyo3(signature = (mesh, skinning, joints=None, *, solver="simultaneous", keep_bone_scale=true, fields="plain", shape_deltas=None, object_from_armature=None))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn new(
        py: Python<'_>,
        mesh: &Mesh,
        skinning: &Skinning,
        joints: Option<Vec<PyRef<'_, Joint>>>,
        solver: &str,
        keep_bone_scale: bool,
        fields: &str,
        shape_deltas: Option<&Bound<'_, PyAny>>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let options = Options { solver: self::solver(solver)?, keep_bone_scale, fields: self::fields(fields)? };
        let deltas: Vec<Vec<DVec3>> = shape_deltas.map_or(Ok(Vec::new()), |d| arrays::vector_rows(d, "shape_deltas"))?;
        let object = arrays::matrix(object_from_armature, "object_from_armature")?;
        let joints = joint_settings(joints);
        let mesh = Arc::clone(&mesh.inner);
        let inner =
            detached(py, || turgor::VolumeSkin::bind(mesh.topology(), mesh.rest(), &skinning.inner, &joints, options, &deltas, &object))?;
        Ok(Self::wrap(inner, mesh))
    }

    #[getter]
    fn mesh(&self) -> Mesh {
        Mesh { inner: Arc::clone(&self.mesh) }
    }

    #[getter]
    fn joint_bones<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let bones: Vec<i32> = self.inner.joint_bones().iter().map(|&bone| bone as i32).collect();
        arrays::from_numbers(py, &bones)
    }

    #[getter]
    fn joint_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, self.inner.joint_lengths())
    }

    #[getter]
    fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes()
    }

    #[pyo3(signature = (joints, *, solver=None, keep_bone_scale=None, fields=None))]
    fn with_joints(
        &self,
        py: Python<'_>,
        joints: Option<Vec<PyRef<'_, Joint>>>,
        solver: Option<&str>,
        keep_bone_scale: Option<bool>,
        fields: Option<&str>,
    ) -> PyResult<Self> {
        let bound = self.inner.options();
        let options = Options {
            solver: solver.map_or(Ok(bound.solver), self::solver)?,
            keep_bone_scale: keep_bone_scale.unwrap_or(bound.keep_bone_scale),
            fields: fields.map_or(Ok(bound.fields), self::fields)?,
        };
        let joints = joint_settings(joints);
        let inner = detached(py, || self.inner.with_joints(&joints, options))?;
        Ok(Self::wrap(inner, Arc::clone(&self.mesh)))
    }

    #[pyo3(signature = (mask))]
    fn with_mask(&self, py: Python<'_>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mask = mask.map(|mask| arrays::floats(mask, "mask")).transpose()?;
        let inner = detached(py, || self.inner.with_mask(mask.as_deref()))?;
        Ok(Self { inner, mesh: Arc::clone(&self.mesh), workspaces: Arc::clone(&self.workspaces) })
    }

    #[pyo3(signature = (pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None, repair_folds=false))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn deform(
        &self,
        py: Python<'_>,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: f64,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
        repair_folds: bool,
    ) -> PyResult<Frame> {
        let pose = PoseData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
            repair_folds,
        )?;
        let mut offsets = vec![[0.0; 3]; self.mesh.rest().len()];
        let (report, (skinned, positions)) = self.in_workspace(py, |workspace| {
            let report = self.inner.deform(&pose.pose(), workspace, &mut offsets)?.clone();
            Ok((report, self.inner.positions(workspace)))
        })?;
        Ok(Frame { positions, skinned, offsets, report })
    }

    #[pyo3(signature = (offsets, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None, repair_folds=false))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn deform_into(
        &self,
        py: Python<'_>,
        offsets: &Bound<'_, PyAny>,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: f64,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
        repair_folds: bool,
    ) -> PyResult<Report> {
        let pose = PoseData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
            repair_folds,
        )?;
        arrays::with_rows_mut(offsets, "offsets", |rows| {
            self.check_rows(rows.len())?;
            self.write(py, &pose, rows)
        })
    }

    #[pyo3(signature = (offsets_address, vertex_count, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None, repair_folds=false))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn deform_into_address(
        &self,
        py: Python<'_>,
        offsets_address: i64,
        vertex_count: i64,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: f64,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
        repair_folds: bool,
    ) -> PyResult<Report> {
        let pose = PoseData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
            repair_folds,
        )?;
        let (offsets_address, vertex_count) =
            (arrays::count(offsets_address, "offsets_address")?, arrays::count(vertex_count, "vertex_count")?);
        self.check_rows(vertex_count)?;
        if vertex_count == 0 {
            return self.write(py, &pose, &mut []);
        }
        if offsets_address == 0 || !offsets_address.is_multiple_of(align_of::<f32>()) {
            return Err(TurgorError::new_err(format!(
                "offsets_address: need the address of {vertex_count} rows of float32, got {offsets_address:#x}"
            )));
        }
        // SAFETY: the caller promises `vertex_count` rows of three floats, alive and unaliased during the call.
        let rows = unsafe { std::slice::from_raw_parts_mut(offsets_address as *mut [f32; 3], vertex_count) };
        self.write(py, &pose, rows)
    }

    #[pyo3(signature = (bone, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn joint_field(
        &self,
        py: Python<'_>,
        bone: i64,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: f64,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
    ) -> PyResult<JointField> {
        let bone = bone_index(bone)?;
        let pose = PoseData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
            false,
        )?;
        let inner = self.in_workspace(py, |workspace| self.inner.joint_field(bone, &pose.pose(), workspace))?;
        Ok(JointField { inner })
    }

    #[pyo3(
        signature = (pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=None, added_offsets=None, posed_positions=None, fleshed=None),
        text_signature = "($self, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn measure(
        &self,
        py: Python<'_>,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: Option<&Bound<'_, PyAny>>,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
    ) -> PyResult<Measures> {
        let poses = PosesData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
        )?;
        let reports = detached(py, || self.inner.measure(&poses.poses(), &self.workspaces))?;
        let component_count = self.mesh.topology().components.len();
        Ok(Measures { reports, component_count, joint_count: self.inner.joint_bones().len() })
    }

    #[pyo3(
        signature = (pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=None, added_offsets=None, posed_positions=None, fleshed=None),
        text_signature = "($self, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn refinement_need(
        &self,
        py: Python<'_>,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: Option<&Bound<'_, PyAny>>,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
    ) -> PyResult<RefinementNeed> {
        let data = PosesData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
        )?;
        let inner = detached(py, || self.inner.refinement_need(&data.poses(), &self.workspaces))?;
        Ok(RefinementNeed { inner })
    }

    #[pyo3(
        signature = (pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=None, added_offsets=None, posed_positions=None, fleshed=None, effect=None, repair_folds=false, fold_counts=None, positions=None),
        text_signature = "($self, pose_matrices, *, object_from_armature=None, shape_values=None, rest_positions=None, strengths=None, target_scale=1.0, added_offsets=None, posed_positions=None, fleshed=None, effect=1.0, repair_folds=False, fold_counts=None, positions=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn deform_many<'py>(
        &self,
        py: Python<'py>,
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: Option<&Bound<'_, PyAny>>,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
        effect: Option<&Bound<'_, PyAny>>,
        repair_folds: bool,
        fold_counts: Option<&Bound<'_, PyAny>>,
        positions: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let data = PosesData::read(
            pose_matrices,
            object_from_armature,
            shape_values,
            rest_positions,
            strengths,
            target_scale,
            added_offsets,
            posed_positions,
            fleshed,
        )?;
        let mut poses = data.poses();
        for pose in &mut poses {
            pose.repair_folds = repair_folds;
        }
        let per_frame = PerFrame::numbers(effect, "effect", poses.len())?;
        let effects: Vec<f64> = (0..poses.len()).map(|frame| per_frame.of(frame)[0]).collect();
        let positions = arrays::frames(py, positions, "positions", (poses.len(), self.mesh.rest().len()))?;
        let write = || {
            arrays::with_frames_mut(&positions, "positions", |rows| {
                detached(py, || self.inner.deform_many(&poses, &effects, rows, &self.workspaces))
            })
        };
        match fold_counts {
            None => drop(write()?),
            Some(counts) => arrays::with_numbers_mut(counts, "fold_counts", (poses.len(), 3), |rows| {
                for (row, folds) in rows.chunks_exact_mut(3).zip(write()?) {
                    row.copy_from_slice(&[folds.found, folds.left, folds.blocked].map(|count| count as i32));
                }
                Ok(())
            })?,
        }
        Ok(positions)
    }
}
