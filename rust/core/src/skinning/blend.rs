//! Blend skinning that reproduces Blender's Armature modifier: linear and *Preserve Volume* dual quaternions.

use glam::{DAffine3, DMat4, DVec3};
use rayon::prelude::*;

use crate::error::{Error, Result, check_finite, check_indices, check_matrices, check_numbers, check_offsets};
use crate::numeric::lanes::{self, Columns, V4, add_scaled, affine, columns, linear, scale, sub, transform};
use crate::skinning::dual_quaternion::{Blend, DualQuaternion};
use crate::skinning::skeleton::Skeleton;

/// A vertex whose weights sum to this or less is left alone, as Blender does.
const WEIGHT_SUM_MIN: f64 = 1e-4;
/// Vertices per parallel piece, at least.
const CHUNK: usize = 1024;

/// How bones are blended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Weighted mean of matrices.
    Linear,
    /// Blender's *Preserve Volume*.
    DualQuaternion,
}

/// Influences of vertices on one skeleton, normalised. The *world bone*, index `bone_count`, never moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Influences {
    pub(crate) offsets: Vec<u32>,
    pub(crate) bones: Vec<u16>,
    pub(crate) weights: Vec<f64>,
    /// Per vertex, part of the motion that is applied; empty when 1 everywhere. Linear modes fold it into the weights.
    pub(crate) mask: Vec<f64>,
}

impl Influences {
    #[inline]
    pub(crate) fn of(&self, vertex: usize) -> (&[u16], &[f64]) {
        let range = self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize;
        (&self.bones[range.clone()], &self.weights[range])
    }

    #[inline]
    pub(crate) fn mask(&self, vertex: usize) -> f64 {
        self.mask.get(vertex).copied().unwrap_or(1.0)
    }

    pub(crate) fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    pub(crate) fn shrink(&mut self) {
        self.offsets.shrink_to_fit();
        self.bones.shrink_to_fit();
        self.weights.shrink_to_fit();
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(&*self.offsets) + size_of_val(&*self.bones) + size_of_val(&*self.weights) + size_of_val(&*self.mask)
    }
}

/// Weights of a mesh on a skeleton.
#[derive(Debug, Clone)]
pub struct Skinning {
    pub(crate) skeleton: Skeleton,
    pub(crate) mode: Mode,
    pub(crate) influences: Influences,
}

impl Skinning {
    /// Checks and normalises weights; rows keep Blender's stored order of groups.
    ///
    /// `vertex_mask` is the influence of the whole modifier per vertex.
    ///
    /// # Errors
    /// Lengths that do not match, bones out of range, weights that are negative or not finite.
    pub fn new(
        skeleton: Skeleton,
        offsets: &[i32],
        bones: &[i32],
        weights: &[f64],
        mode: Mode,
        vertex_mask: Option<&[f64]>,
    ) -> Result<Self> {
        check_offsets("weight_offsets", offsets, weights.len())?;
        if bones.len() != weights.len() {
            return Err(Error::Length { what: "weight_bones", found: bones.len(), needed: weights.len() });
        }
        check_indices("weight_bones", bones, skeleton.len())?;
        check_weights("weights", weights)?;
        let vertex_count = offsets.len() - 1;
        if let Some(mask) = vertex_mask {
            if mask.len() != vertex_count {
                return Err(Error::Length { what: "vertex_mask", found: mask.len(), needed: vertex_count });
            }
            check_weights("vertex_mask", mask)?;
        }
        let world = skeleton.len() as u16;
        let mut influences = Influences { offsets: vec![0], bones: Vec::new(), weights: Vec::new(), mask: Vec::new() };
        for vertex in 0..vertex_count {
            let range = offsets[vertex] as usize..offsets[vertex + 1] as usize;
            let sum: f64 = weights[range.clone()].iter().sum();
            let mask = vertex_mask.map_or(1.0, |mask| mask[vertex].min(1.0));
            let moves = sum > WEIGHT_SUM_MIN && mask > 0.0;
            let folded = if mode == Mode::Linear { mask } else { 1.0 };
            if moves {
                for i in range.filter(|&i| weights[i] > 0.0) {
                    influences.bones.push(bones[i] as u16);
                    influences.weights.push(weights[i] / sum * folded);
                }
            }
            let rest = if moves { 1.0 - folded } else { 1.0 };
            if rest > 0.0 {
                influences.bones.push(world);
                influences.weights.push(rest);
            }
            influences.offsets.push(influences.bones.len() as u32);
        }
        if let (Mode::DualQuaternion, Some(mask)) = (mode, vertex_mask) {
            influences.mask = mask.iter().map(|m| m.min(1.0)).collect();
        }
        Ok(Self { skeleton, mode, influences })
    }

    /// Number of vertices the weights are for.
    pub fn vertex_count(&self) -> usize {
        self.influences.len()
    }

    /// Bones the weights refer to.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// Skinned positions, object space.
    ///
    /// # Errors
    /// Wrong lengths, values that are not finite, an object matrix without inverse.
    pub fn deform(&self, positions: &[DVec3], pose: &[DMat4], object_from_armature: &DMat4) -> Result<Vec<DVec3>> {
        if positions.len() != self.vertex_count() {
            return Err(Error::VertexCount { found: positions.len(), bound: self.vertex_count() });
        }
        check_finite("positions", positions)?;
        let mut channels = vec![DAffine3::IDENTITY; self.skeleton.len()];
        check_pose(pose, &mut channels)?;
        let object = check_object(object_from_armature)?;
        let mut palette = Palette::new(self.mode, channels.len() + 1);
        palette.place(object.inverse(), DVec3::ZERO);
        for (bone, channel) in channels.iter().enumerate() {
            palette.set(bone, &self.skeleton.rest()[bone], channel, None);
        }
        palette.set(channels.len(), &DAffine3::IDENTITY, &DAffine3::IDENTITY, None);
        let skin =
            |(vertex, &p): (usize, &DVec3)| object.transform_point3(lanes::to(palette.skin(&self.influences, vertex, lanes::from(p))));
        let result: Vec<DVec3> = positions.par_iter().enumerate().with_min_len(CHUNK).map(skin).collect();
        if result.iter().all(|p| p.is_finite()) { Ok(result) } else { Err(Error::Beyond { what: "positions" }) }
    }
}

pub(crate) fn check_weights(what: &'static str, weights: &[f64]) -> Result<()> {
    check_numbers(what, weights)?;
    match weights.iter().find(|&&w| w < 0.0) {
        Some(&found) => Err(Error::Value { what, found, needed: "weights of 0 or more" }),
        None => Ok(()),
    }
}

/// Takes pose matrices as affine maps.
pub(crate) fn check_pose(pose: &[DMat4], channels: &mut [DAffine3]) -> Result<()> {
    if pose.len() != channels.len() {
        return Err(Error::BoneCount { found: pose.len(), bound: channels.len() });
    }
    check_matrices("pose_matrices", pose)?;
    for (channel, matrix) in channels.iter_mut().zip(pose) {
        *channel = affine(matrix);
    }
    Ok(())
}

pub(crate) fn check_object(object_from_armature: &DMat4) -> Result<DAffine3> {
    check_matrices("object_from_armature", std::slice::from_ref(object_from_armature))?;
    let object = affine(object_from_armature);
    let m = object.matrix3;
    let determinant = m.determinant();
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    if determinant.abs() <= 1e-12 * size || !object.inverse().is_finite() {
        return Err(Error::Singular { determinant });
    }
    Ok(object)
}

/// Motions of one frame, by index: bones, the world bone, and whatever a solver adds.
#[derive(Debug, Clone)]
pub(crate) struct Palette {
    pub mode: Mode,
    /// Rest position to armature space.
    armature_from_rest: DAffine3,
    armature_columns: Columns,
    /// Subtracted from skinned positions: sums are taken about it.
    pub origin: DVec3,
    linear: Vec<Columns>,
    dual: Vec<DualQuaternion>,
}

impl Palette {
    pub fn new(mode: Mode, count: usize) -> Self {
        Self {
            mode,
            armature_from_rest: DAffine3::IDENTITY,
            armature_columns: columns(&DAffine3::IDENTITY),
            origin: DVec3::ZERO,
            linear: vec![columns(&DAffine3::IDENTITY); count],
            dual: vec![DualQuaternion::IDENTITY; if mode == Mode::DualQuaternion { count } else { 0 }],
        }
    }

    /// Where rest positions lie, and the origin of results: before any motion is set.
    pub fn place(&mut self, armature_from_rest: DAffine3, origin: DVec3) {
        self.armature_from_rest = armature_from_rest;
        self.armature_columns = columns(&armature_from_rest);
        self.origin = origin;
    }

    /// Sets a motion: `channel` = pose · rest⁻¹ in armature space, its rotation on the side of motion `reference`.
    pub fn set(&mut self, index: usize, rest: &DAffine3, channel: &DAffine3, reference: Option<usize>) {
        let mut motion = *channel;
        if self.mode == Mode::DualQuaternion {
            let own = DualQuaternion::new(rest, channel);
            self.dual[index] = reference.map_or(own, |r| own.aligned_with(&self.dual[r]));
            motion = self.dual[index].to_affine();
        }
        let mut whole = motion * self.armature_from_rest;
        whole.translation -= self.origin;
        self.linear[index] = columns(&whole);
    }

    /// Puts the rotation of a motion on the side of another's: the same motion.
    pub fn align(&mut self, index: usize, reference: usize) {
        if self.mode == Mode::DualQuaternion {
            self.dual[index] = self.dual[index].aligned_with(&self.dual[reference]);
        }
    }

    /// Rest position to (armature space − origin) of a point that follows one motion alone.
    #[inline(always)]
    pub fn alone(&self, index: usize) -> &Columns {
        &self.linear[index]
    }

    #[inline(always)]
    pub fn dual(&self, index: usize) -> &DualQuaternion {
        &self.dual[index]
    }

    /// Rotation of a motion.
    #[inline(always)]
    pub fn rotation(&self, index: usize) -> V4 {
        self.dual.get(index).map_or(DualQuaternion::IDENTITY.rotation, |dual| dual.rotation)
    }

    /// Rest position to armature space.
    pub fn armature_from_rest(&self) -> DAffine3 {
        self.armature_from_rest
    }

    /// Armature space from that of rest positions.
    #[inline(always)]
    pub fn armature_columns(&self) -> &Columns {
        &self.armature_columns
    }

    /// A rest position in armature space.
    #[inline(always)]
    pub fn in_armature(&self, p: V4) -> V4 {
        transform(&self.armature_columns, p)
    }

    /// Skins one vertex. Result in armature space − origin.
    #[inline(always)]
    pub fn skin(&self, influences: &Influences, vertex: usize, p: V4) -> V4 {
        let (bones, weights) = influences.of(vertex);
        if let [bone] = bones {
            let moved = transform(&self.linear[usize::from(*bone)], p);
            return if influences.mask.is_empty() { moved } else { self.masked(influences.mask(vertex), p, moved) };
        }
        match self.mode {
            Mode::Linear => {
                let mut sum = [lanes::ZERO; 4];
                for (&bone, &weight) in bones.iter().zip(weights) {
                    let m = &self.linear[usize::from(bone)];
                    for i in 0..4 {
                        sum[i] = add_scaled(sum[i], m[i], weight);
                    }
                }
                transform(&sum, p)
            }
            Mode::DualQuaternion => {
                let x = self.in_armature(p);
                let mut blend = Blend::NONE;
                for (&bone, &weight) in bones.iter().zip(weights) {
                    blend.add(&self.dual[usize::from(bone)], weight, x);
                }
                self.masked(influences.mask(vertex), p, sub(blend.transform(x), lanes::from(self.origin)))
            }
        }
    }

    /// Turns a direction at rest as one vertex is turned, its length between. Result in armature space.
    #[inline(always)]
    pub fn carry(&self, influences: &Influences, vertex: usize, direction: V4) -> V4 {
        let (bones, weights) = influences.of(vertex);
        let mask = influences.mask(vertex);
        let still = || linear(&self.armature_columns, direction);
        let moved = match self.mode {
            _ if bones.len() == 1 => linear(&self.linear[usize::from(bones[0])], direction),
            Mode::Linear => {
                let mut sum = [lanes::ZERO; 4];
                for (&bone, &weight) in bones.iter().zip(weights) {
                    let m = &self.linear[usize::from(bone)];
                    for i in 0..3 {
                        sum[i] = add_scaled(sum[i], m[i], weight);
                    }
                }
                linear(&sum, direction)
            }
            Mode::DualQuaternion => {
                let mut blend = Blend::NONE;
                for (&bone, &weight) in bones.iter().zip(weights) {
                    blend.add(&self.dual[usize::from(bone)], weight, lanes::ZERO);
                }
                blend.turn(still())
            }
        };
        if mask == 1.0 { moved } else { add_scaled(scale(still(), 1.0 - mask), moved, mask) }
    }

    /// Part of the way from where the armature leaves a point alone to `moved`.
    #[inline(always)]
    pub fn masked(&self, mask: f64, p: V4, moved: V4) -> V4 {
        if mask == 1.0 {
            return moved;
        }
        let still = sub(self.in_armature(p), lanes::from(self.origin));
        add_scaled(still, sub(moved, still), mask)
    }
}
