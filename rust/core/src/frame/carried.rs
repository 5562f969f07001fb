//! Normals at rest, evened out, as the pose carries them along: what even fields push along.

use super::buffers::{Posed, Skinned};
use super::places::ragged;
use super::{Bound, Problem};
use crate::fields::patch_sums::Normals;
use crate::flesh::shape::Shape;
use crate::numeric::lanes;
use crate::parallel::split::for_each_piece;

impl Skinned {
    /// Carries the normals along with the skin. What another deformer adds may turn it any way: fields then follow the gradient.
    pub(super) fn carry_normals(&mut self, bound: Bound, posed: &Posed, flesh: &Shape) {
        let Bound { binding, supports, .. } = bound;
        let carried = &mut self.carried;
        carried.is_used = supports.is_even && posed.added.is_empty() && !binding.normals().directions.is_empty();
        if !carried.is_used {
            return;
        }
        let (patches, sites, palette) = (&binding.patches, &binding.sites, &posed.motions.palette);
        let normals = &binding.normals().directions;
        for_each_piece(patches.list.len(), ragged(&mut carried.rows, &patches.slot_offsets), &|index, carried| {
            let patch = &patches.list[index];
            let [x, y, z] = carried.map(|row| row.values);
            for place in 0..patch.owned {
                let slot = patch.start + place;
                let normal = sites.mean(slot, |site| palette.carry(&sites.influences, site, normals[slot]));
                let normal = lanes::to(normal) + flesh.turned(slot);
                let unit = normal.normalize_or_zero().as_vec3();
                (x[place], y[place], z[place]) = (unit.x, unit.y, unit.z);
            }
        });
    }
}

impl<'a> Problem<'a> {
    /// Normals of all slots; `None` where fields follow the gradient.
    pub(super) fn normals(&self) -> Option<Normals<'a>> {
        let carried = &self.skinned.carried;
        carried.is_used.then(|| Normals {
            directions: carried.rows.each_ref().map(|row| &**row),
            inverse_gradients: &self.bound.binding.normals().inverse_gradients,
        })
    }
}
