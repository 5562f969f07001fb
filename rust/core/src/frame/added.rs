//! What others do to the skin before its volume is looked at: offsets that are added to it, or the places where it is left.

use glam::{DAffine3, DVec3};

use crate::binding::Binding;
use crate::error::{Error, LARGEST, Result, check_rows};
use crate::numeric::lanes::{self, Columns, V4};

/// Part of the largest coordinate up to which skin in single precision and our own are the same.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Per vertex; empty where nothing is done.
#[derive(Debug, Clone, Default)]
pub(super) struct Added {
    /// Offsets in armature space, or positions in object space.
    of_vertex: Vec<[f32; 3]>,
    /// Of positions: to armature space, about the palette's origin.
    places: Option<Columns>,
    /// Offsets that are not larger are left by rounding.
    pub rounding: f64,
}

impl Added {
    pub fn is_empty(&self) -> bool {
        self.of_vertex.is_empty()
    }

    /// Whether it is given where the skin is, not how far it is moved.
    pub fn is_posed(&self) -> bool {
        self.places.is_some()
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.of_vertex)
    }

    /// Of a point, the mean over its vertices: where it is when posed, else how far it is moved.
    #[inline]
    pub fn of_slot(&self, binding: &Binding, slot: usize) -> V4 {
        let coincident = binding.vertices_of_slot().row(slot);
        let sum = coincident.iter().fold(lanes::ZERO, |sum, &vertex| lanes::add(sum, self.at(vertex as usize)));
        let mean = lanes::scale(sum, 1.0 / coincident.len().max(1) as f64);
        self.places.as_ref().map_or(mean, |places| lanes::transform(places, mean))
    }

    /// Offset of a vertex; 0 where nothing is added.
    pub fn of_vertex(&self, vertex: usize) -> DVec3 {
        if self.is_empty() || self.is_posed() { DVec3::ZERO } else { lanes::to(self.at(vertex)) }
    }

    /// Where a vertex is posed, about the palette's origin.
    #[inline]
    pub fn place_of_vertex(&self, vertex: usize) -> Option<V4> {
        self.places.as_ref().map(|places| lanes::transform(places, self.at(vertex)))
    }

    #[inline]
    fn at(&self, vertex: usize) -> V4 {
        let [x, y, z] = self.of_vertex[vertex].map(f64::from);
        [x, y, z, 0.0]
    }

    /// Sets what is added to the skin, and returns the origin that is near to it; that of the skin is `origin`.
    pub fn set(
        &mut self,
        binding: &Binding,
        offsets: Option<&[[f32; 3]]>,
        posed: Option<&[[f32; 3]]>,
        origin: DVec3,
        object: &DAffine3,
    ) -> Result<DVec3> {
        self.of_vertex.clear();
        (self.places, self.rounding) = (None, 0.0);
        let (what, given) = match (offsets, posed) {
            (None, None) => return Ok(origin),
            (Some(_), Some(_)) => return Err(Error::Both { one: "added_offsets", other: "posed_positions" }),
            (Some(offsets), None) => ("added_offsets", offsets),
            (None, Some(posed)) => ("posed_positions", posed),
        };
        let bound = binding.slot_of_vertex.len();
        if given.len() != bound {
            return Err(Error::Length { what, found: given.len(), needed: bound });
        }
        check_rows(what, given)?;
        let armature_from_object = object.inverse();
        if posed.is_some() {
            return self.set_places(given, armature_from_object);
        }
        let to_armature = armature_from_object.matrix3.as_mat3();
        self.of_vertex.extend(given.iter().map(|&offset| (to_armature * glam::Vec3::from(offset)).to_array()));
        let sum: DVec3 = (0..bound).map(|vertex| self.of_vertex(vertex)).sum();
        Ok(origin + sum / bound.max(1) as f64)
    }

    /// Returns the mean place.
    fn set_places(&mut self, posed: &[[f32; 3]], armature_from_object: DAffine3) -> Result<DVec3> {
        let (mut sum, mut reach) = ([0.0; 3], [0.0f32; 3]);
        for row in posed {
            for axis in 0..3 {
                sum[axis] += f64::from(row[axis]);
                reach[axis] = reach[axis].max(row[axis].abs());
            }
        }
        let reach = DVec3::from_array(reach.map(f64::from));
        let m = armature_from_object.matrix3;
        let in_armature = m.x_axis.abs() * reach.x + m.y_axis.abs() * reach.y + m.z_axis.abs() * reach.z;
        let farthest = (in_armature + armature_from_object.translation.abs()).max_element();
        // What is no number is too far too.
        if !(0.0..=LARGEST).contains(&farthest) {
            return Err(Error::Value { what: "reach of posed_positions", found: farthest, needed: "up to 1e15 in the armature's space" });
        }
        self.rounding = ROUNDING * farthest;
        self.of_vertex.extend_from_slice(posed);
        let origin = armature_from_object.transform_point3(DVec3::from_array(sum) / posed.len().max(1) as f64);
        let places = DAffine3 { translation: armature_from_object.translation - origin, ..armature_from_object };
        self.places = Some(lanes::columns(&places));
        Ok(origin)
    }
}
