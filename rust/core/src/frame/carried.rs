//! Normals at rest, evened out, as the pose carries them along: what even fields push along.

use fearless_simd::{Level, Simd, dispatch};

use super::buffers::{ComponentField, Fields, Posed, Skinned};
use super::places::ragged;
use super::{Bound, Problem};
use crate::binding::Binding;
use crate::fields::patch_sums::{self, Normals};
use crate::flesh::shape::Shape;
use crate::flesh::smoothstep;
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
        let (patches, level) = (&binding.patches, Level::new());
        for_each_piece(patches.list.len(), ragged(&mut carried.rows, &patches.slot_offsets), &|index, carried| {
            let patch = &patches.list[index];
            let mut rows = carried.map(|row| &mut row.values[..patch.owned]);
            dispatch!(level, simd => carry(simd, binding, posed, patch.start, rows.each_mut().map(|row| &mut **row)));
            let [x, y, z] = &mut rows;
            for (place, [a, b, c, _]) in flesh.turned().iter().skip(patch.start).take(patch.owned).enumerate() {
                (x[place], y[place], z[place]) = (x[place] + a, y[place] + b, z[place] + c);
            }
            patch_sums::normalize(rows);
        });
    }
}

/// Carries the normals of slots, from a first one on.
#[inline(always)]
fn carry<S: Simd>(_: S, binding: &Binding, posed: &Posed, first: usize, [x, y, z]: [&mut [f32]; 3]) {
    let (sites, palette, normals) = (&binding.sites, &posed.motions.palette, &binding.normals().directions);
    for (place, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
        let slot = first + place;
        let [a, b, c, _] = sites.mean(slot, |site| palette.carry(&sites.influences, site, normals[slot]));
        (*x, *y, *z) = (a as f32, b as f32, c as f32);
    }
}

impl Fields {
    /// All even fields follow their normals, until `weigh_gradient` knows better.
    pub(super) fn follow_normals(&mut self) {
        for state in &mut self.components {
            state.gradient_share = 0.0;
        }
    }

    /// How far each shell's even fields have to follow its gradient, from sums that did not: skinning may turn a shell over, and its
    /// normals not along. Whether any has to.
    pub(super) fn weigh_gradient(&mut self, problem: Problem) -> bool {
        if !problem.skinned.carried.is_used {
            return false;
        }
        for state in &mut self.components {
            state.evenness = [0.0; 2];
        }
        for (patch, [added, most]) in problem.bound.binding.patches.list.iter().zip(&self.evenness) {
            let [all_added, all_most] = &mut self.components[patch.component as usize].evenness;
            (*all_added, *all_most) = (*all_added + added, *all_most + most);
        }
        for state in &mut self.components {
            let [added, most] = state.evenness;
            let evenness = if most > 0.0 { added / most } else { 0.0 };
            state.gradient_share = (1.0 - smoothstep((evenness - EVENNESS[0]) / (EVENNESS[1] - EVENNESS[0]))) as f32;
        }
        self.components.iter().any(|state| state.gradient_share > 0.0)
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
