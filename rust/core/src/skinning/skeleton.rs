//! Bones at rest.

use glam::{DAffine3, DMat4, DVec3};

use crate::error::{Error, Result, check_matrices};
use crate::numeric::lanes::affine;

/// Bones at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    pub(super) parents: Vec<Option<u32>>,
    pub(super) rest: Vec<DAffine3>,
    /// Whether each bone is a segment of the one above.
    pub(super) is_segment: Vec<bool>,
}

impl Skeleton {
    /// `parents`: index or -1 per bone, in any order; `rest_matrices`: armature space.
    ///
    /// # Errors
    /// Lengths that differ, parents out of range or in a cycle, matrices that are not finite, or too large, more than 32,000 bones.
    pub fn new(parents: &[i32], rest_matrices: &[DMat4]) -> Result<Self> {
        if parents.len() != rest_matrices.len() {
            return Err(Error::Length { what: "rest_matrices", found: rest_matrices.len(), needed: parents.len() });
        }
        if parents.len() > 32_000 {
            return Err(Error::Value { what: "number of bones", found: parents.len() as f64, needed: "at most 32000" });
        }
        check_matrices("rest_matrices", rest_matrices)?;
        if let Some(row) = parents.iter().position(|&p| p < -1 || p >= parents.len() as i32) {
            return Err(Error::Index { what: "parents", row, found: i64::from(parents[row]), limit: parents.len() });
        }
        let parents: Vec<Option<u32>> = parents.iter().map(|&p| u32::try_from(p).ok()).collect();
        // Per bone, the last one from which a walk upwards came by: one that comes back to itself never ends.
        let mut walked = vec![u32::MAX; parents.len()];
        for bone in 0..parents.len() as u32 {
            let mut next = Some(bone);
            while let Some(ancestor) = next.filter(|&a| walked[a as usize] == u32::MAX) {
                walked[ancestor as usize] = bone;
                next = parents[ancestor as usize];
            }
            if next.is_some_and(|met| walked[met as usize] == bone) {
                return Err(Error::Cycle { bone: bone as usize });
            }
        }
        let is_segment = vec![false; parents.len()];
        Ok(Self { parents, rest: rest_matrices.iter().map(affine).collect(), is_segment })
    }

    /// Bones that are segments of the one above make one *bone group* with it, which bends: where the segments stand to each
    /// other is how it bends, no more meant than a turn. Without segments each bone is a group.
    ///
    /// # Errors
    /// Another number than of bones; a segment without a parent.
    pub fn with_segments(self, is_segment: &[bool]) -> Result<Self> {
        if is_segment.len() != self.len() {
            return Err(Error::Length { what: "segments", found: is_segment.len(), needed: self.len() });
        }
        if let Some(row) = (0..self.len()).find(|&bone| is_segment[bone] && self.parents[bone].is_none()) {
            return Err(Error::Index { what: "parents of segments", row, found: -1, limit: self.len() });
        }
        Ok(Self { is_segment: is_segment.to_vec(), ..self })
    }

    /// The first bone of its group: the one whose segment this is, or itself.
    pub(super) fn bone_group(&self, bone: u32) -> u32 {
        std::iter::successors(Some(bone), |&b| self.parents[b as usize].filter(|_| self.is_segment[b as usize])).last().unwrap_or(bone)
    }

    /// Number of bones.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// True without bones.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    pub(crate) fn rest(&self) -> &[DAffine3] {
        &self.rest
    }

    pub(super) fn head(&self, bone: u32) -> DVec3 {
        self.rest[bone as usize].translation
    }

    /// Unit vector along a bone, its own y; zero where that has no length.
    pub(super) fn direction(&self, bone: u32) -> DVec3 {
        self.rest[bone as usize].matrix3.y_axis.normalize_or_zero()
    }

    /// Bones above a bone, from below.
    pub(super) fn ancestors(&self, bone: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(self.parents[bone as usize], |&b| self.parents[b as usize])
    }
}
