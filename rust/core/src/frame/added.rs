//! What another deformer adds to the skin before its volume is looked at.

use glam::{DAffine3, DVec3};

use crate::binding::Binding;
use crate::error::{Error, Result, check_rows};
use crate::numeric::lanes::{self, V4};

/// Offsets of vertices, armature space; empty where nothing is added.
#[derive(Debug, Clone, Default)]
pub(super) struct Added {
    of_vertex: Vec<[f32; 3]>,
}

impl Added {
    pub fn is_empty(&self) -> bool {
        self.of_vertex.is_empty()
    }

    /// Whether any offset is not 0.
    pub fn moves_anything(&self) -> bool {
        self.of_vertex.iter().any(|offset| *offset != [0.0; 3])
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.of_vertex)
    }

    /// Of a point: the mean over its vertices.
    #[inline]
    pub fn of_slot(&self, binding: &Binding, slot: usize) -> V4 {
        let coincident = binding.vertices_of_slot().row(slot);
        let sum = coincident.iter().fold(lanes::ZERO, |sum, &vertex| lanes::add(sum, self.at(vertex as usize)));
        lanes::scale(sum, 1.0 / coincident.len().max(1) as f64)
    }

    /// Of a vertex; 0 where nothing is added.
    pub fn of_vertex(&self, vertex: usize) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { lanes::to(self.at(vertex)) }
    }

    #[inline]
    fn at(&self, vertex: usize) -> V4 {
        let [x, y, z] = self.of_vertex[vertex].map(f64::from);
        [x, y, z, 0.0]
    }

    /// Takes offsets in object space, and returns their mean in armature space.
    pub fn set(&mut self, binding: &Binding, offsets: Option<&[[f32; 3]]>, object: &DAffine3) -> Result<DVec3> {
        self.of_vertex.clear();
        let Some(offsets) = offsets else { return Ok(DVec3::ZERO) };
        let bound = binding.slot_of_vertex.len();
        if offsets.len() != bound {
            return Err(Error::Length { what: "added_offsets", found: offsets.len(), needed: bound });
        }
        check_rows("added_offsets", offsets)?;
        let to_armature = object.matrix3.inverse().as_mat3();
        self.of_vertex.extend(offsets.iter().map(|&offset| (to_armature * glam::Vec3::from(offset)).to_array()));
        let sum: DVec3 = (0..bound).map(|vertex| self.of_vertex(vertex)).sum();
        Ok(sum / bound.max(1) as f64)
    }
}
