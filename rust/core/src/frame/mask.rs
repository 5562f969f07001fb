//! How much of each point's weight the artist leaves it.

use std::ops::Range;

use crate::binding::Binding;
use crate::error::{Error, Result};
use crate::surface::patches::NO_SLOT;

/// A factor on the weights of every field.
///
/// Weights of a field count against each other only: per component, factors are relative to the largest.
#[derive(Debug, Clone)]
pub(crate) struct Mask {
    pub of_slot: Vec<f32>,
    /// Per component: sound, and nothing in it may move.
    pub is_pinned: Vec<bool>,
}

impl Mask {
    /// `of_vertex` in 0..1; coincident vertices share the smallest of theirs. `None`: it changes nothing.
    pub fn new(binding: &Binding, of_vertex: &[f32]) -> Result<Option<Self>> {
        let bound = binding.slot_of_vertex.len();
        if of_vertex.len() != bound {
            return Err(Error::Length { what: "mask", found: of_vertex.len(), needed: bound });
        }
        if let Some(&found) = of_vertex.iter().find(|m| !(0.0..=1.0).contains(*m)) {
            return Err(Error::Value { what: "mask", found: found.into(), needed: "numbers from 0 to 1" });
        }
        let mut of_slot = vec![1.0f32; binding.patches.slot_count()];
        for (&slot, &m) in binding.slot_of_vertex.iter().zip(of_vertex).filter(|(slot, _)| **slot != NO_SLOT) {
            let least = &mut of_slot[slot as usize];
            *least = if m < *least { m } else { *least };
        }
        // Points without area, which shells share, move with none of them.
        let mut most = vec![None; binding.components.len()];
        let slots_of = |index: usize| binding.patches.list[index].start..binding.patches.slot_offsets[index + 1] as usize;
        for (index, patch) in binding.patches.list.iter().enumerate() {
            for slot in slots_of(index).take(patch.owned).filter(|&slot| binding.inverse_areas[slot] > 0.0) {
                let most = most[patch.component as usize].get_or_insert(0.0f32);
                *most = most.max(of_slot[slot]);
            }
        }
        for (index, patch) in binding.patches.list.iter().enumerate() {
            if let Some(most) = most[patch.component as usize].filter(|most| *most > 0.0) {
                of_slot[slots_of(index)].iter_mut().for_each(|m| *m /= most);
            }
        }
        let is_pinned = most.iter().map(|most| *most == Some(0.0)).collect();
        Ok(of_slot.iter().any(|m| *m != 1.0).then_some(Self { of_slot, is_pinned }))
    }

    /// Factors at some slots; `None` where they change nothing.
    pub fn of_slots(&self, slots: Range<usize>) -> Option<&[f32]> {
        let factors = &self.of_slot[slots];
        factors.iter().any(|m| *m != 1.0).then_some(factors)
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.of_slot)
    }
}
