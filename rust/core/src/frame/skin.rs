//! Skins all points, patch by patch; volume and gradient of the surface they make.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x4, f64x4};

use super::buffers::{Gradient, Posed, Skinned, SkinnedPatch, Staged};
use super::places::ragged;
use super::scratch::{Scratch, with_scratch};
use crate::binding::Binding;
use crate::flesh::shape::Shape;
use crate::numeric::block_rows::{LANES, PATCH_POINTS};
use crate::numeric::lanes::{self, Four, V4};
use crate::parallel::split::{Ragged, for_each_piece};
use crate::skinning::motions::Motions;
use crate::surface::patches::Patch;
use crate::surface::sweeps::{self, Buffer, GRADIENT_PARTS, mean_and_cross, polygon_gradient};
use crate::volume_losses::job::{Change, Moment};
use crate::volume_losses::staged::{Portion, Rows, giant_moment, giant_volume};

impl Staged {
    /// Moments at rest: those of the bound body, or those that skinning finds for another one.
    pub(super) fn start(&mut self, binding: &Binding, posed: &Posed) -> &mut Self {
        let is_bound = posed.body.of_site.is_empty();
        let portions = binding.plan.portions(posed.body.is_staged(binding));
        if is_bound != self.has_bound_moments || !is_bound {
            self.portion_moments.clone_from(&portions.rest_moments);
        }
        if is_bound && !self.has_bound_moments {
            portions.rigid_moments(&self.portion_moments, &mut self.job_moments);
        }
        self.has_bound_moments = is_bound;
        if posed.body.is_brought {
            self.changes.resize(binding.plan.stages.change_count(), Change::default());
        }
        self
    }
}

impl Skinned {
    /// Skins all points; volume and gradient of the skinned surface, and stages on the way to it.
    pub(super) fn skin<'a>(
        &'a mut self,
        binding: &Binding,
        posed: &Posed,
        flesh: &Shape,
        staged: &'a mut Staged,
        swept: &mut Gradient,
    ) -> (&'a Self, &'a Staged) {
        let level = Level::new();
        let patches = &binding.patches;
        let count = patches.list.len();
        let stages = if posed.body.is_staged(binding) { Some(&binding.plan.stages) } else { None };
        let (motions, added, rest_body) = (&posed.motions, &posed.added, &posed.body);
        let of_losses = flesh.of_losses(motions);
        self.offsets.resize(if added.is_empty() { 0 } else { patches.slot_count() }, [0.0; 3]);
        let offset_rows = if added.is_empty() { &patches.no_rows } else { &patches.slot_offsets };
        let rest = rest_body.rest(binding);
        let has_shapes = !rest_body.of_site.is_empty();
        let change_offsets = stages.map_or(&*patches.no_rows, |stages| &stages.change_offsets()[..=count]);
        let moment_offsets = if stages.is_some() { &patches.numbers } else { &patches.no_rows };
        let (changes, giant_changes) = staged.changes.split_at_mut(change_offsets[count] as usize);
        let (moments, giant_moments) = staged.portion_moments.split_at_mut(moment_offsets[count] as usize);
        let (sources, giant_sources) = swept.sources.split_at_mut(patches.patch_source_count());
        for_each_piece(
            count,
            (
                (ragged(&mut self.places.near, &patches.slot_offsets), ragged(&mut self.places.rest, &patches.slot_offsets)),
                ragged(&mut swept.rows, &patches.slot_offsets),
                (Ragged::new(sources, &patches.source_offsets), Ragged::new(&mut self.offsets, offset_rows)),
                &mut *self.patches,
                (Ragged::new(changes, change_offsets), Ragged::new(moments, moment_offsets)),
            ),
            &|index, ((near, rest_of_it), gradient, (sources, offsets), sums, (changes, moment))| {
                let from = Skinner { binding, posed, of_losses, flesh, index };
                let into = SkinnedInto {
                    near: near.map(|row| row.values),
                    rest: rest_of_it.map(|row| row.values),
                    gradient: gradient.map(|row| row.values),
                    sources: sources.values,
                    offsets: offsets.values,
                    sums: &mut sums[0],
                    changes: changes.values,
                    moment: moment.values.first_mut(),
                };
                with_scratch(|scratch| dispatch!(level, simd => skin_patch(simd, from, into, scratch)));
            },
        );
        sweep_giants(binding, giant_sources, |slot| self.places.at(slot), |giant, volume| self.giant_volumes[giant] = volume);
        let Some(stages) = stages else { return (self, staged) };
        let mut giant_changes = giant_changes;
        let shaped_rest = has_shapes.then_some(rest);
        for (index, (giant, moment)) in patches.giants.iter().zip(giant_moments).enumerate() {
            let corners = giant.corners.len();
            let padded = corners.next_multiple_of(LANES);
            let mut positions = &mut staged.giant_positions[..padded];
            if has_shapes {
                for (p, &slot) in positions.iter_mut().zip(&giant.corners) {
                    *p = binding.sites.mean(slot as usize, |site| rest[site]);
                }
                *moment = giant_moment(&positions[..corners]);
            }
            let (changes, rest_of_them) = giant_changes.split_at_mut(stages.joint_count(count + index));
            let portion = Portion {
                index: count + index,
                slots: &giant.corners,
                sites: &binding.sites,
                shaped_rest,
                motions: of_losses,
                moment: *moment,
            };
            let rows = Rows::new(&mut staged.giant_room, padded);
            let volume = |p: &&mut [V4]| giant_volume(&p[..corners]);
            let last = dispatch!(level, simd => stages.measure(simd, portion, rows, &mut positions, volume, changes));
            if let Some(last) = last {
                let ends_skinned = added.is_empty() && !flesh.is_active();
                changes[last].loss -= if ends_skinned { self.giant_volumes[index] } else { volume(&positions) };
            }
            giant_changes = rest_of_them;
        }
        if has_shapes {
            binding.plan.portions(true).rigid_moments(&staged.portion_moments, &mut staged.job_moments);
        }
        (self, staged)
    }
}

/// What a patch is skinned from.
#[derive(Clone, Copy)]
struct Skinner<'a> {
    binding: &'a Binding,
    posed: &'a Posed,
    /// Motions without turns that cost no volume.
    of_losses: &'a Motions,
    flesh: &'a Shape,
    index: usize,
}

/// What skinning a patch leaves.
struct SkinnedInto<'a> {
    near: [&'a mut [f32]; 3],
    rest: [&'a mut [f32]; 3],
    gradient: [&'a mut [f32]; 3],
    sources: &'a mut [V4],
    /// What is added to the skin; empty where nothing is.
    offsets: &'a mut [[f32; 3]],
    sums: &'a mut SkinnedPatch,
    changes: &'a mut [Change],
    moment: Option<&'a mut Moment>,
}

/// Skins the points a patch sees; keeps those it owns, the gradient of all, and what its joints lose.
#[inline(always)]
fn skin_patch<S: Simd>(simd: S, from: Skinner, into: SkinnedInto, scratch: &mut Scratch) {
    let Skinner { binding, posed, of_losses, flesh, index } = from;
    let Posed { motions, added, body: rest_body, .. } = posed;
    let (rest, has_shapes) = (rest_body.rest(binding), !rest_body.of_site.is_empty());
    let (patches, sites, palette, stages) = (&binding.patches, &binding.sites, &motions.palette, &binding.plan.stages);
    let patch = &patches.list[index];
    let slots = &patches.local[patch.local.clone()];
    let Scratch { first: p, second: by_point, rows, .. } = scratch;
    let mut portion = Portion { index, slots, sites, shaped_rest: has_shapes.then_some(rest), motions, moment: Moment::default() };
    let (mut last, mut bare, mut is_skinned) = (None, None, false);
    if let Some(moment) = into.moment {
        if has_shapes {
            for (p, &slot) in p.iter_mut().zip(slots) {
                *p = sites.mean(slot as usize, |site| rest[site]);
            }
            let (volume, area) = sweeps::moment(simd, patches, patch, p);
            *moment = (volume, lanes::to(area));
        }
        portion.moment = *moment;
        portion.motions = of_losses;
        is_skinned = std::ptr::eq(of_losses, motions) && stages.ends_skinned(portion);
        let rows = Rows::new(rows, PATCH_POINTS);
        last = stages.measure(
            simd,
            portion,
            rows,
            p,
            #[inline(always)]
            |p| sweeps::volume(simd, patches, patch, p),
            into.changes,
        );
        if !std::ptr::eq(of_losses, motions)
            && let Some(last) = last.take()
        {
            into.changes[last].loss -= sweeps::volume(simd, patches, patch, p);
        }
    }
    if !is_skinned {
        skin_points(simd, binding, posed, index, rows, p);
    }
    if !added.is_empty() || flesh.is_active() {
        if let Some(last) = last.take() {
            into.changes[last].loss -= sweeps::volume(simd, patches, patch, p);
        }
        if !added.is_empty() {
            for (local, (p, &slot)) in p.iter_mut().zip(slots).enumerate() {
                let mut offset = added.of_slot(binding, slot as usize);
                let skinned = *p;
                if added.is_posed() {
                    *p = offset;
                    offset = lanes::sub(offset, skinned);
                } else {
                    *p = lanes::add(skinned, offset);
                }
                if local < patch.owned {
                    into.offsets[local] = [offset[0], offset[1], offset[2]].map(|x| x as f32);
                }
            }
        }
        if flesh.moves(index, &slots[patch.owned..]) {
            bare = Some(sweeps::volume(simd, patches, patch, p));
            for (p, &slot) in p.iter_mut().zip(slots) {
                let by = f32x4::simd_from(simd, flesh.offsets()[slot as usize]);
                *p = (f64x4::simd_from(simd, *p) + by.combine(by).widen().0).into();
            }
        }
    }
    by_point[..slots.len()].fill(lanes::ZERO);
    let volume = sweeps::volume_and_gradient(simd, patches, patch, p, by_point);
    if let Some(last) = last {
        into.changes[last].loss -= volume;
    }
    *into.sums = SkinnedPatch { volume, bare: bare.unwrap_or(volume), gap_squared: 0.0 };
    keep_gradient(simd, binding, patch, by_point, into.gradient, into.sources);
    keep_places(simd, patch, p, into.near, into.rest);
    let has_coincident = binding.has_shared_sites() || sites.is_split();
    if has_coincident && (added.is_posed() || sites.is_split() || rest_body.is_split()) {
        for &slot in &slots[..patch.owned] {
            let gap_squared = if added.is_posed() {
                gap_squared(binding.vertices_of_slot().row(slot as usize).iter().filter_map(|&v| added.place_of_vertex(v as usize)))
            } else if rest_body.is_split() {
                let coincident = binding.vertices_of_slot().row(slot as usize).iter().map(|&vertex| vertex as usize);
                let site = |vertex: usize| sites.site_of_vertex[vertex] as usize;
                gap_squared(coincident.map(|v| palette.skin(&sites.influences, site(v), rest_body.rest_of_vertex(binding, v))))
            } else {
                gap_squared(sites.of_slot(slot as usize).map(|site| palette.skin(&sites.influences, site, rest[site])))
            };
            into.sums.gap_squared = into.sums.gap_squared.max(gap_squared);
        }
    }
}

/// The points that a patch sees, as skinning alone leaves them.
#[inline(always)]
pub(super) fn skin_points<S: Simd>(simd: S, binding: &Binding, posed: &Posed, index: usize, rows: &mut [f64], p: &mut Buffer) {
    let (sites, motions, rest) = (&binding.sites, &posed.motions, posed.body.rest(binding));
    let slots = &binding.patches.local[binding.patches.list[index].local.clone()];
    let shaped_rest = (!posed.body.of_site.is_empty()).then_some(rest);
    let portion = Portion { index, slots, sites, shaped_rest, motions, moment: Moment::default() };
    if binding.plan.stages.ends_skinned(portion) {
        binding.plan.stages.skin(simd, portion, Rows::new(rows, PATCH_POINTS), p);
        return;
    }
    for (p, &slot) in p.iter_mut().zip(slots) {
        *p = sites.mean(slot as usize, |site| motions.palette.skin(&sites.influences, site, rest[site]));
    }
}

/// Of the largest distance of coincident vertices from the first of them.
#[inline(always)]
fn gap_squared(mut coincident: impl Iterator<Item = V4>) -> f64 {
    let Some(first) = coincident.next() else { return 0.0 };
    coincident.map(|other| lanes::to(other).distance_squared(lanes::to(first))).fold(0.0, f64::max)
}

/// Keeps a patch's part of the gradient: whole for the points it alone uses, for others to be summed.
#[inline(always)]
pub(super) fn keep_gradient<S: Simd>(
    simd: S,
    binding: &Binding,
    patch: &Patch,
    by_point: &Buffer,
    gradient: [&mut [f32]; 3],
    sources: &mut [V4],
) {
    let (shared, foreign) = sources.split_at_mut(patch.shared);
    shared.copy_from_slice(&by_point[..patch.shared]);
    foreign.copy_from_slice(&by_point[patch.owned..patch.local.len()]);
    let per_area = 1.0 / (GRADIENT_PARTS * binding.area_unit);
    let gradient = gradient.map(|row| row.as_chunks_mut::<LANES>().0);
    for (number, eight) in by_point.as_chunks::<LANES>().0.iter().take(gradient[0].len()).enumerate() {
        let (early, late) = halves(simd, eight);
        let (early, late) = (early.scale(per_area).coordinates(), late.scale(per_area).coordinates());
        for axis in 0..3 {
            gradient[axis][number] = early[axis].narrow(late[axis]).into();
        }
    }
    clear_padding(patch, gradient.map(<[[f32; LANES]]>::as_flattened_mut));
}

/// Keeps the positions of the points that a patch owns.
#[inline(always)]
fn keep_places<S: Simd>(simd: S, patch: &Patch, p: &Buffer, near: [&mut [f32]; 3], rest: [&mut [f32]; 3]) {
    let [near, rest] = [near, rest].map(|rows| rows.map(|row| row.as_chunks_mut::<LANES>().0));
    for (number, eight) in p.as_chunks::<LANES>().0.iter().take(near[0].len()).enumerate() {
        let (early, late) = halves(simd, eight);
        let (early, late) = (early.coordinates(), late.coordinates());
        for axis in 0..3 {
            let rounded = early[axis].narrow(late[axis]);
            let (early_rounded, late_rounded) = rounded.widen();
            near[axis][number] = rounded.into();
            rest[axis][number] = (early[axis] - early_rounded).narrow(late[axis] - late_rounded).into();
        }
    }
    clear_padding(patch, near.map(<[[f32; LANES]]>::as_flattened_mut));
    clear_padding(patch, rest.map(<[[f32; LANES]]>::as_flattened_mut));
}

#[inline(always)]
fn halves<S: Simd>(simd: S, [a, b, c, d, e, f, g, h]: &[V4; LANES]) -> (Four<S>, Four<S>) {
    (Four::of_rows(simd, [a, b, c, d]), Four::of_rows(simd, [e, f, g, h]))
}

fn clear_padding(patch: &Patch, rows: [&mut [f32]; 3]) {
    for row in rows {
        row[patch.owned..].fill(0.0);
    }
}

/// Gradient of faces too large for any patch; `keep` is told the volume of each.
pub(super) fn sweep_giants(binding: &Binding, sources: &mut [V4], place: impl Fn(usize) -> V4, mut keep: impl FnMut(usize, f64)) {
    let mut sources = sources.iter_mut();
    for (index, giant) in binding.patches.giants.iter().enumerate() {
        let count = giant.corners.len();
        let at = |i: usize| place(giant.corners[i % count] as usize);
        let (mean, area) = mean_and_cross((0..count).map(at));
        keep(index, lanes::sum(lanes::mul(mean, area)) / 6.0);
        for (i, source) in (0..count).zip(&mut sources) {
            *source = polygon_gradient(mean, area, at(i + count - 1), at(i + 1), count);
        }
    }
}
