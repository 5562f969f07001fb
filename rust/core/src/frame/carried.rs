//! Normals at rest, evened out, as the pose carries them along: what even fields push along.

use super::buffers::{ComponentField, Fields, Gradient, Posed, Skinned};
use super::places::ragged;
use super::scratch::{Scratch, with_scratch};
use super::simultaneous::import_gradient;
use super::{Bound, Problem};
use crate::fields::patch_sums::{self, FieldRows, Normals};
use crate::flesh::shape::Shape;
use crate::flesh::smoothstep;
use crate::numeric::lanes;
use crate::parallel::split::for_each_piece;

/// What a shell adds along its normals over what it would add along its gradient: below the first it follows the gradient,
/// from the second on its normals.
const EVENNESS: [f64; 2] = [0.2, 0.5];

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

impl Fields {
    /// How far each shell's even fields have to follow its gradient: skinning may turn a shell over, and its normals not along.
    pub(super) fn weigh_gradient(&mut self, problem: Problem, swept: &mut Gradient) {
        let Problem { bound: Bound { binding, .. }, skinned, .. } = problem;
        for state in &mut self.components {
            (state.evenness, state.gradient_share) = ([0.0; 2], 0.0);
        }
        if !skinned.carried.is_used {
            return;
        }
        let (patches, sources) = (&binding.patches, &swept.sources);
        let (rows, fields) = (ragged(&mut swept.rows, &patches.slot_offsets), &*self.components);
        for_each_piece(patches.list.len(), (rows, &mut *self.evenness), &|index, (gradient, evenness)| {
            let slots = patches.list[index].start..patches.slot_offsets[index + 1] as usize;
            let normals = problem.normals(fields, index);
            with_scratch(|Scratch { first, fields: FieldRows { directions, volumes, lengths, .. }, .. }| {
                let mut gradient = gradient.map(|row| row.values);
                import_gradient(binding, index, sources, first, &mut gradient);
                let gradient = gradient.map(|row| &*row);
                patch_sums::directions(gradient, normals, &binding.inverse_areas[slots], directions, volumes, lengths);
                evenness[0] = patch_sums::added_and_most(gradient, volumes, lengths);
            });
        });
        for (patch, [added, most]) in patches.list.iter().zip(&self.evenness) {
            let [all_added, all_most] = &mut self.components[patch.component as usize].evenness;
            (*all_added, *all_most) = (*all_added + added, *all_most + most);
        }
        for state in &mut self.components {
            let [added, most] = state.evenness;
            let evenness = if most > 0.0 { added / most } else { 0.0 };
            state.gradient_share = (1.0 - smoothstep((evenness - EVENNESS[0]) / (EVENNESS[1] - EVENNESS[0]))) as f32;
        }
    }
}

impl<'a> Problem<'a> {
    /// Normals of the slots of a patch; `None` where fields follow the gradient.
    pub(super) fn normals(&self, fields: &[ComponentField], patch: usize) -> Option<Normals<'a>> {
        let binding = self.bound.binding;
        let (patches, carried) = (&binding.patches, &self.skinned.carried);
        let gradient_share = fields[patches.list[patch].component as usize].gradient_share;
        (carried.is_used && gradient_share < 1.0).then(|| {
            let normals = Normals {
                directions: carried.rows.each_ref().map(|row| &**row),
                inverse_gradients: &binding.normals().inverse_gradients,
                gradient_share,
            };
            normals.of(&(patches.list[patch].start..patches.slot_offsets[patch + 1] as usize))
        })
    }
}
