//! Normals at rest, evened out, as the pose carries them along: what even fields push along.

use super::{Coordinates, Workspace, ragged};
use crate::binding::Binding;
use crate::fields::patch_sums::Normals;
use crate::fields::supports::Supports;
use crate::numeric::lanes;
use crate::parallel::split::for_each_piece;

impl Workspace {
    /// Carries the normals along with the skin. What another deformer adds may turn it any way: fields then follow the gradient.
    pub(super) fn carry_normals(&mut self, binding: &Binding, supports: &Supports) {
        self.carries_normals = supports.is_even && self.added.is_empty() && !binding.normals().directions.is_empty();
        if !self.carries_normals {
            return;
        }
        let (patches, sites, palette, normals) = (&binding.patches, &binding.sites, &self.motions.palette, &binding.normals().directions);
        for_each_piece(patches.list.len(), ragged(&mut self.carried, &patches.slot_offsets), &|index, carried| {
            let patch = &patches.list[index];
            let [x, y, z] = carried.map(|row| row.values);
            for place in 0..patch.owned {
                let slot = patch.start + place;
                let normal = sites.mean(slot, |site| palette.carry(&sites.influences, site, normals[slot]));
                let length = lanes::to(normal).length();
                let unit = if length > 0.0 { lanes::scale(normal, length.recip()) } else { lanes::ZERO };
                (x[place], y[place], z[place]) = (unit[0] as f32, unit[1] as f32, unit[2] as f32);
            }
        });
    }

    /// Normals of all slots; `None` where fields follow the gradient.
    pub(super) fn carried<'a>(&'a self, binding: &'a Binding) -> Option<Normals<'a>> {
        carried(&self.carried, self.carries_normals, binding)
    }
}

/// The same, while other rows of the frame are written.
pub(super) fn carried<'a>(rows: &'a Coordinates, is_used: bool, binding: &'a Binding) -> Option<Normals<'a>> {
    is_used.then(|| Normals {
        directions: rows.each_ref().map(|row| &**row),
        inverse_gradients: &binding.normals().inverse_gradients,
    })
}
