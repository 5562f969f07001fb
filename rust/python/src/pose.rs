//! What frames are made from, owned, so that the interpreter can be left.

use glam::DMat4;
use pyo3::prelude::*;
use turgor::Pose;

use crate::arrays;

/// One frame.
pub struct PoseData {
    matrices: Vec<DMat4>,
    object_from_armature: DMat4,
    shape_values: Vec<f64>,
    rest_positions: Option<Vec<[f32; 3]>>,
    strengths: Option<Vec<f64>>,
    target_scale: f64,
    added_offsets: Option<Vec<[f32; 3]>>,
    posed_positions: Option<Vec<[f32; 3]>>,
    is_fleshed: Option<Vec<bool>>,
    repair_folds: bool,
}

impl PoseData {
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    pub fn read(
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
    ) -> PyResult<Self> {
        Ok(Self {
            matrices: arrays::matrices(pose_matrices, "pose_matrices")?,
            object_from_armature: arrays::matrix(object_from_armature, "object_from_armature")?,
            shape_values: shape_values.map_or(Ok(Vec::new()), |v| arrays::numbers(v, "shape_values"))?,
            rest_positions: rest_positions.map(|p| arrays::float_rows(p, "rest_positions")).transpose()?,
            strengths: strengths.map(|s| arrays::numbers(s, "strengths")).transpose()?,
            target_scale,
            added_offsets: added_offsets.map(|o| arrays::float_rows(o, "added_offsets")).transpose()?,
            posed_positions: posed_positions.map(|p| arrays::float_rows(p, "posed_positions")).transpose()?,
            is_fleshed: fleshed,
            repair_folds,
        })
    }

    pub fn pose(&self) -> Pose<'_> {
        Pose {
            matrices: &self.matrices,
            object_from_armature: self.object_from_armature,
            shape_values: &self.shape_values,
            rest_positions: self.rest_positions.as_deref(),
            target_scale: self.target_scale,
            strengths: self.strengths.as_deref(),
            added_offsets: self.added_offsets.as_deref(),
            posed_positions: self.posed_positions.as_deref(),
            is_fleshed: self.is_fleshed.as_deref(),
            repair_folds: self.repair_folds,
        }
    }
}

/// Many frames: each array has a first axis of frames, or is the same for all.
pub struct PosesData {
    matrices: PerFrame<DMat4>,
    objects_from_armature: PerFrame<DMat4>,
    shape_values: PerFrame<f64>,
    rest_positions: Option<PerFrame<[f32; 3]>>,
    strengths: Option<PerFrame<f64>>,
    target_scales: PerFrame<f64>,
    added_offsets: Option<PerFrame<[f32; 3]>>,
    posed_positions: Option<PerFrame<[f32; 3]>>,
    is_fleshed: Option<Vec<bool>>,
    frame_count: usize,
}

impl PosesData {
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    pub fn read(
        pose_matrices: &Bound<'_, PyAny>,
        object_from_armature: Option<&Bound<'_, PyAny>>,
        shape_values: Option<&Bound<'_, PyAny>>,
        rest_positions: Option<&Bound<'_, PyAny>>,
        strengths: Option<&Bound<'_, PyAny>>,
        target_scale: Option<&Bound<'_, PyAny>>,
        added_offsets: Option<&Bound<'_, PyAny>>,
        posed_positions: Option<&Bound<'_, PyAny>>,
        fleshed: Option<Vec<bool>>,
    ) -> PyResult<Self> {
        let (matrices, shape) = arrays::numbers_and_shape(pose_matrices, "pose_matrices", "(F, B, 4, 4)", |shape| {
            shape.len() == 4 && shape[2..] == [4, 4] || shape == [0]
        })?;
        let frames = shape[0];
        let objects = object_from_armature.map(|value| {
            let (objects, shape) =
                arrays::numbers_and_shape(value, "object_from_armature", &format!("(4, 4) or ({frames}, 4, 4)"), |shape| {
                    shape == [4, 4] || shape == [frames, 4, 4]
                })?;
            Ok::<_, PyErr>(PerFrame::new(arrays::from_rows(&objects), (shape.len() == 3).then_some(frames)))
        });
        let rows = |value, what, letter| {
            let (values, shape) = arrays::numbers_and_shape(value, what, &format!("({letter},) or ({frames}, {letter})"), |shape| {
                shape.len() == 1 || shape.len() == 2 && shape[0] == frames
            })?;
            Ok::<_, PyErr>(PerFrame::new(values, (shape.len() == 2).then_some(frames)))
        };
        let vertices = |value, what| {
            let (rows, is_per_frame) = arrays::float_rows_of_frames(value, what, frames)?;
            Ok::<_, PyErr>(PerFrame::new(rows, is_per_frame.then_some(frames)))
        };
        Ok(Self {
            matrices: PerFrame::new(arrays::from_rows(&matrices), Some(frames)),
            objects_from_armature: objects.unwrap_or_else(|| Ok(PerFrame::new(vec![DMat4::IDENTITY], None)))?,
            shape_values: shape_values.map_or_else(|| Ok(PerFrame::new(Vec::new(), None)), |values| rows(values, "shape_values", "K"))?,
            rest_positions: rest_positions.map(|value| vertices(value, "rest_positions")).transpose()?,
            strengths: strengths.map(|values| rows(values, "strengths", "B")).transpose()?,
            target_scales: PerFrame::numbers(target_scale, "target_scale", frames)?,
            added_offsets: added_offsets.map(|value| vertices(value, "added_offsets")).transpose()?,
            posed_positions: posed_positions.map(|value| vertices(value, "posed_positions")).transpose()?,
            is_fleshed: fleshed,
            frame_count: frames,
        })
    }

    pub fn poses(&self) -> Vec<Pose<'_>> {
        (0..self.frame_count)
            .map(|frame| Pose {
                object_from_armature: self.objects_from_armature.of(frame)[0],
                shape_values: self.shape_values.of(frame),
                rest_positions: self.rest_positions.as_ref().map(|positions| positions.of(frame)),
                strengths: self.strengths.as_ref().map(|strengths| strengths.of(frame)),
                target_scale: self.target_scales.of(frame)[0],
                added_offsets: self.added_offsets.as_ref().map(|offsets| offsets.of(frame)),
                posed_positions: self.posed_positions.as_ref().map(|positions| positions.of(frame)),
                is_fleshed: self.is_fleshed.as_deref(),
                ..Pose::new(self.matrices.of(frame))
            })
            .collect()
    }
}

/// Values of each of some frames, or the same for all.
pub struct PerFrame<T> {
    values: Vec<T>,
    /// How many there are to a frame; `None`: all of them to every frame.
    stride: Option<usize>,
}

impl<T> PerFrame<T> {
    fn new(values: Vec<T>, frames: Option<usize>) -> Self {
        let stride = frames.map(|frames| values.len() / frames.max(1));
        Self { values, stride }
    }

    pub fn of(&self, frame: usize) -> &[T] {
        match self.stride {
            Some(stride) => &self.values[frame * stride..(frame + 1) * stride],
            None => &self.values,
        }
    }
}

impl PerFrame<f64> {
    /// A number for each of so many frames, or one for all; 1 when none is given.
    pub fn numbers(value: Option<&Bound<'_, PyAny>>, what: &str, frames: usize) -> PyResult<Self> {
        let Some(value) = value else { return Ok(Self::new(vec![1.0], None)) };
        // An array of one number would pass for a number.
        if value.len().is_err() {
            return Ok(Self::new(vec![value.extract::<f64>()?], None));
        }
        let needed = format!("one number or ({frames},)");
        let (values, _) = arrays::numbers_and_shape(value, what, &needed, |shape| shape == [frames])?;
        Ok(Self::new(values, Some(frames)))
    }
}
