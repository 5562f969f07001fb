//! One frame: pose, skin, losses, fields, residual. Buffers are made once and nothing is remembered; only what a frame brings
//! along and the repair of folds allocate what grows with the mesh.

mod added;
mod body;
mod buffers;
mod carried;
mod flesh;
mod joint_field;
mod linear_step;
mod local;
mod mask;
mod offsets;
mod pass;
mod places;
mod posed;
mod refinement;
mod repair;
mod residual;
mod restore;
mod scratch;
mod sequential;
mod simultaneous;
mod skin;
mod solved;
mod targets;

use std::sync::Arc;

use glam::DMat4;

use self::buffers::{Losses, Posed, Skinned, Solution, Staged, Targets};
pub use self::joint_field::JointField;
pub(crate) use self::mask::Mask;
use self::pass::Pass;
pub use self::refinement::RefinementNeed;
pub(crate) use self::refinement::{Details, Needs};
use self::solved::Solved;
use crate::binding::Binding;
use crate::error::Result;
use crate::fields::joint::Joint;
use crate::fields::supports::Supports;
use crate::flesh::shape::Shape;
use crate::numeric::lanes::V4;
use crate::report::Report;

/// One frame's input.
#[derive(Debug, Clone, Copy)]
pub struct Pose<'a> {
    /// Per bone pose · rest⁻¹, armature space.
    pub matrices: &'a [DMat4],
    /// Armature space to object space.
    pub object_from_armature: DMat4,
    /// Value of each shape key; missing ones count as 0.
    pub shape_values: &'a [f64],
    /// Per vertex, object space: the body of this frame, in place of the bound rest positions with shape keys mixed in. Losses and
    /// volumes at rest are its own; topology, weights and how far joints reach stay as bound.
    pub rest_positions: Option<&'a [[f32; 3]]>,
    /// Factor on the target volume.
    pub target_scale: f64,
    /// Strength of each bone's joint, in place of its setting.
    pub strengths: Option<&'a [f64]>,
    /// Per vertex, object space: what another deformer adds to the skin before its volume is looked at.
    pub added_offsets: Option<&'a [[f32; 3]]>,
    /// Per vertex, object space: where other deformers leave the skin, in place of offsets that they add. What lies farther from
    /// the frame's own skin than rounding takes it was moved by them.
    pub posed_positions: Option<&'a [[f32; 3]]>,
    /// Per bone, whether that deformer moves its flesh: what skinning loses there is not missing.
    pub is_fleshed: Option<&'a [bool]>,
    /// Whether folds of the correction are repaired.
    pub repair_folds: bool,
}

impl<'a> Pose<'a> {
    /// A pose with armature and object in one space, no shape keys, and the rest volume as target.
    pub fn new(matrices: &'a [DMat4]) -> Self {
        Self {
            matrices,
            object_from_armature: DMat4::IDENTITY,
            shape_values: &[],
            rest_positions: None,
            target_scale: 1.0,
            strengths: None,
            added_offsets: None,
            posed_positions: None,
            is_fleshed: None,
            repair_folds: false,
        }
    }
}

/// Buffers of one frame, one to a phase: a phase reads those of phases before it and writes its own.
#[derive(Debug, Clone)]
pub struct Workspace {
    posed: Posed,
    flesh: Shape,
    skinned: Skinned,
    staged: Staged,
    losses: Losses,
    targets: Targets,
    solution: Solution,
    pub(crate) mask: Option<Arc<Mask>>,
    pub(crate) report: Report,
}

/// What no frame changes.
#[derive(Clone, Copy)]
pub(crate) struct Bound<'a> {
    pub binding: &'a Binding,
    pub supports: &'a Supports,
    /// One per joint of the tree.
    pub settings: &'a [Joint],
}

/// What is to be solved. The same from when the targets are known until the frame is done, but where folds are repaired.
#[derive(Clone, Copy)]
struct Problem<'a> {
    bound: Bound<'a>,
    mask: Option<&'a Mask>,
    flesh: &'a Shape,
    skinned: &'a Skinned,
    targets: &'a Targets,
}

impl Workspace {
    pub(crate) fn new(bound: Bound) -> Self {
        Self {
            posed: Posed::new(bound),
            flesh: Shape::default(),
            skinned: Skinned::new(bound),
            staged: Staged::new(bound),
            losses: Losses::new(bound),
            targets: Targets::new(bound),
            solution: Solution::new(bound),
            mask: None,
            report: Report::new(bound.binding.components.len(), bound.binding.motions.tree.len()),
        }
    }

    /// Heap memory that grows with the mesh.
    pub fn memory_bytes(&self) -> usize {
        self.posed.memory_bytes()
            + self.flesh.memory_bytes()
            + self.skinned.memory_bytes()
            + self.staged.memory_bytes()
            + self.targets.memory_bytes()
            + self.solution.memory_bytes()
    }

    /// Poses, skins and measures: all that is known before anything is corrected.
    pub(crate) fn skin(&mut self, bound: Bound, pose: &Pose, keep_bone_scale: bool) -> Result<()> {
        let Self { posed, flesh, skinned, staged, losses, targets, solution, mask, .. } = self;
        let binding = bound.binding;
        let posed = posed.set(binding, pose, keep_bone_scale)?;
        let flesh = flesh::shape(flesh, mask, bound, pose, posed);
        // First: it is little, and helpers are on their way.
        losses.measure_forms(binding, posed, flesh);
        skinned.carry_normals(bound, posed, flesh);
        let (skinned, staged) = skinned.skin(binding, posed, flesh, staged.start(binding, posed), &mut solution.gradient);
        losses.gather(binding, posed, flesh, staged);
        targets.weigh(binding, posed, flesh, skinned, staged);
        let losses = losses.share_flesh(binding, flesh, &targets.components);
        targets.measure(bound, pose, (posed, flesh, skinned, losses));
        Ok(())
    }

    /// Corrects what was skinned.
    pub(crate) fn correct(&mut self, bound: Bound, is_sequential: bool, repair_folds: bool) {
        let Self { posed, flesh, skinned, losses, targets, solution, mask, report, .. } = self;
        let problem = Problem { bound, mask: mask.as_deref(), flesh, skinned, targets };
        solution.correct_simultaneously(problem);
        if is_sequential {
            solution.correct_sequentially(problem);
        }
        solution.remove_residual(problem, Pass::All);
        solution.repair_folds(problem, posed, repair_folds, report);
        solution.correction.fill_report(problem, posed, losses, report);
    }

    /// The frame, as far as it was computed.
    pub(crate) fn solved<'a>(&'a self, binding: &'a Binding) -> Solved<'a> {
        Solved { binding, posed: &self.posed, flesh: &self.flesh, skinned: &self.skinned, correction: &self.solution.correction }
    }

    /// How bones move in the frame.
    #[cfg(test)]
    pub(crate) fn motions(&self) -> &crate::skinning::motions::Motions {
        &self.posed.motions
    }

    fn problem<'a>(&'a self, bound: Bound<'a>) -> Problem<'a> {
        Problem { bound, mask: self.mask.as_deref(), flesh: &self.flesh, skinned: &self.skinned, targets: &self.targets }
    }
}

/// The number, or 0 where single precision cannot hold it: a shell flattened to nothing has no field.
fn in_single_precision(number: f64) -> f64 {
    if number.abs() < f64::from(f32::MAX) { number } else { 0.0 }
}

/// The same in double precision.
#[inline(always)]
fn widened(v: [f32; 4]) -> V4 {
    v.map(f64::from)
}
