//! Skins all points, patch by patch; volume and gradient of the surface they make.

use fearless_simd::{Level, Simd, dispatch};

use super::added::Added;
use super::scratch::{Scratch, with_scratch};
use super::{PatchSums, Workspace, ragged};
use crate::binding::Binding;
use crate::lanes::{self, V4};
use crate::motions::Motions;
use crate::patches::{PATCH_POINTS, Patch};
use crate::split::{Ragged, for_each_piece};
use crate::stages::{Body, Rows, giant_moment, giant_volume};
use crate::sweeps::{self, Buffer, GRADIENT_PARTS, mean_and_cross, polygon_gradient};
use crate::volume_loss::{Change, Moment};

impl Workspace {
    /// Skins all points; volume and gradient of the skinned surface, and stages on the way to it.
    pub(crate) fn skin(&mut self, binding: &Binding) {
        let level = Level::new();
        let patches = &binding.patches;
        let count = patches.list.len();
        let has_shapes = !self.rest.is_empty();
        let rest = if has_shapes { &self.rest } else { &binding.sites.rest };
        let stages = if binding.plan.forms.is_none() { Some(&binding.plan.stages) } else { None };
        let (motions, added) = (&self.motions, &self.added);
        let change_offsets = stages.map_or(&*patches.no_rows, |stages| &stages.change_offsets()[..=count]);
        let moment_offsets = if stages.is_some() { &patches.numbers } else { &patches.no_rows };
        let (changes, giant_changes) = self.stage_changes.split_at_mut(change_offsets[count] as usize);
        let (moments, giant_moments) = self.body_moments.split_at_mut(moment_offsets[count] as usize);
        let (sources, giant_sources) = self.sources.split_at_mut(patches.patch_source_count());
        for_each_piece(
            count,
            (
                (ragged(&mut self.skinned.near, &patches.slot_offsets), ragged(&mut self.skinned.rest, &patches.slot_offsets)),
                ragged(&mut self.gradient, &patches.slot_offsets),
                Ragged::new(sources, &patches.source_offsets),
                &mut *self.patches,
                (Ragged::new(changes, change_offsets), Ragged::new(moments, moment_offsets)),
            ),
            &|index, ((near, rest_of_it), gradient, sources, sums, (changes, moment))| {
                let from = Skinner { binding, motions, rest, has_shapes, added, index };
                let into = Skinned {
                    near: near.map(|row| row.values),
                    rest: rest_of_it.map(|row| row.values),
                    gradient: gradient.map(|row| row.values),
                    sources: sources.values,
                    sums: &mut sums[0],
                    changes: changes.values,
                    moment: moment.values.first_mut(),
                };
                with_scratch(|scratch| dispatch!(level, simd => skin_patch(simd, from, into, scratch)));
            },
        );
        sweep_giants(binding, &mut self.giant_volumes, giant_sources, |slot| self.skinned.at(slot));
        let Some(stages) = stages else { return };
        let mut giant_changes = giant_changes;
        for (index, (giant, moment)) in patches.giants.iter().zip(giant_moments).enumerate() {
            let body = Body { index: count + index, slots: &giant.corners, owned: 0, sites: &binding.sites, rest, motions };
            let corners = giant.corners.len();
            let mut positions = &mut self.giant_positions[..corners];
            if has_shapes {
                for (p, &slot) in positions.iter_mut().zip(&giant.corners) {
                    *p = binding.sites.mean(slot as usize, |site| rest[site]);
                }
                *moment = giant_moment(positions);
            }
            let (changes, rest_of_them) = giant_changes.split_at_mut(stages.joint_count(count + index));
            let rows = Rows::new(&mut self.giant_room, corners);
            if let Some(last) = stages.measure(body, *moment, rows, &mut positions, |p| giant_volume(p), changes) {
                changes[last].loss -= if added.is_empty() { self.giant_volumes[index] } else { giant_volume(positions) };
            }
            giant_changes = rest_of_them;
        }
        if has_shapes {
            binding.plan.bodies.rigid_moments(&self.body_moments, &mut self.job_moments);
        }
    }
}

/// What a patch is skinned from.
#[derive(Clone, Copy)]
struct Skinner<'a> {
    binding: &'a Binding,
    motions: &'a Motions,
    rest: &'a [V4],
    has_shapes: bool,
    added: &'a Added,
    index: usize,
}

/// What skinning a patch leaves.
struct Skinned<'a> {
    near: [&'a mut [f32]; 3],
    rest: [&'a mut [f32]; 3],
    gradient: [&'a mut [f32]; 3],
    sources: &'a mut [V4],
    sums: &'a mut PatchSums,
    changes: &'a mut [Change],
    moment: Option<&'a mut Moment>,
}

/// Skins the points a patch sees; keeps those it owns, the gradient of all, and what its joints lose.
#[inline(always)]
fn skin_patch<S: Simd>(simd: S, from: Skinner, into: Skinned, scratch: &mut Scratch) {
    let Skinner { binding, motions, rest, has_shapes, added, index } = from;
    let (patches, sites, palette, stages) = (&binding.patches, &binding.sites, &motions.palette, &binding.plan.stages);
    let patch = &patches.list[index];
    let slots = &patches.local[patch.local.clone()];
    let Scratch { first: p, second: by_point, rows, .. } = scratch;
    let body = Body { index, slots, owned: patch.owned, sites, rest, motions };
    let is_skinned = stages.ends_skinned(body);
    let mut last = None;
    if let Some(moment) = into.moment {
        if has_shapes {
            for (p, &slot) in p.iter_mut().zip(slots) {
                *p = sites.mean(slot as usize, |site| rest[site]);
            }
            let (volume, area) = sweeps::moment(simd, patches, patch, p);
            *moment = (volume, lanes::to(area));
        }
        let rows = Rows::new(rows, PATCH_POINTS);
        last = stages.measure(
            body,
            *moment,
            rows,
            p,
            #[inline(always)]
            |p| sweeps::volume(simd, patches, patch, p),
            into.changes,
        );
    } else if is_skinned {
        stages.skin(body, Rows::new(rows, PATCH_POINTS), p);
    }
    if !is_skinned {
        for (p, &slot) in p.iter_mut().zip(slots) {
            *p = sites.mean(slot as usize, |site| palette.skin(&sites.influences, site, rest[site]));
        }
    }
    if !added.is_empty() {
        if let Some(last) = last.take() {
            into.changes[last].loss -= sweeps::volume(simd, patches, patch, p);
        }
        for (p, &slot) in p.iter_mut().zip(slots) {
            *p = lanes::add(*p, added.of_slot(slot as usize));
        }
    }
    by_point[..slots.len()].fill(lanes::ZERO);
    let volume = sweeps::volume_and_gradient(simd, patches, patch, p, by_point);
    if let Some(last) = last {
        into.changes[last].loss -= volume;
    }
    *into.sums = PatchSums { volume, ..PatchSums::default() };
    keep_gradient(binding, patch, by_point, into.gradient, into.sources);
    for (axis, (near, rest)) in into.near.into_iter().zip(into.rest).enumerate() {
        for ((near, rest), p) in near.iter_mut().zip(rest).zip(&p[..patch.owned]) {
            *near = p[axis] as f32;
            *rest = (p[axis] - f64::from(*near)) as f32;
        }
    }
    if sites.is_split() {
        for &slot in &slots[..patch.owned] {
            let mut twins = sites.of_slot(slot as usize).map(|site| palette.skin(&sites.influences, site, rest[site]));
            if let Some(first) = twins.next() {
                let gaps = twins.map(|twin| lanes::to(twin).distance_squared(lanes::to(first)));
                into.sums.gap_squared = gaps.fold(into.sums.gap_squared, f64::max);
            }
        }
    }
}

/// Keeps a patch's part of the gradient: whole for the points it alone uses, for others to be summed.
#[inline(always)]
pub(super) fn keep_gradient(binding: &Binding, patch: &Patch, by_point: &Buffer, gradient: [&mut [f32]; 3], sources: &mut [V4]) {
    let (shared, foreign) = sources.split_at_mut(patch.shared);
    shared.copy_from_slice(&by_point[..patch.shared]);
    foreign.copy_from_slice(&by_point[patch.owned..patch.local.len()]);
    let per_area = 1.0 / (GRADIENT_PARTS * binding.area_unit);
    for (axis, row) in gradient.into_iter().enumerate() {
        for (g, by_point) in row.iter_mut().zip(&by_point[..patch.owned]) {
            *g = (by_point[axis] * per_area) as f32;
        }
    }
}

/// Volume and gradient of faces too large for any patch.
pub(super) fn sweep_giants(binding: &Binding, volumes: &mut [f64], sources: &mut [V4], place: impl Fn(usize) -> V4) {
    let mut sources = sources.iter_mut();
    for (giant, volume) in binding.patches.giants.iter().zip(volumes) {
        let count = giant.corners.len();
        let at = |i: usize| place(giant.corners[i % count] as usize);
        let (mean, area) = mean_and_cross((0..count).map(at));
        *volume = lanes::sum(lanes::mul(mean, area)) / 6.0;
        for (i, source) in (0..count).zip(&mut sources) {
            *source = polygon_gradient(mean, area, at(i + count - 1), at(i + 1), count);
        }
    }
}
