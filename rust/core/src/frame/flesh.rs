//! The law of flesh in a frame: what it adds to the skin, and whose the volume is that is missing then.

use std::sync::Arc;

use fearless_simd::{Level, dispatch};

use super::buffers::{ComponentTarget, Losses, Posed, Skinned, Targets};
use super::scratch::with_scratch;
use super::skin::skin_points;
use super::{Bound, Mask, Pose, widened};
use crate::binding::Binding;
use crate::fields::field::FieldFrame;
use crate::flesh::settings::Flesh;
use crate::flesh::shape::{Points, Shape};
use crate::numeric::block_rows::{Block, LANES, PATCH_POINTS};
use crate::numeric::lanes::{self, V4};
use crate::surface::patches::Patch;
use crate::volume_losses::staged::giant_volume;

/// What joints lose by turns that cannot be told from their losses is shared by how much they turn, as this part of what a
/// limb holds.
const EXTENT_PART: f64 = 0.01;

/// Finds what the law of flesh adds to each point, and what it leaves of the artist's mask.
pub(super) fn shape<'a>(flesh: &'a mut Shape, mask: &mut Option<Arc<Mask>>, bound: Bound, pose: &Pose, posed: &Posed) -> &'a Shape {
    if start(flesh, mask.as_deref(), bound, pose, posed) {
        keep_out_of_creases(flesh, mask, bound.binding);
    }
    flesh
}

/// True where the law adds anything.
fn start(flesh: &mut Shape, mask: Option<&Mask>, bound: Bound, pose: &Pose, posed: &Posed) -> bool {
    let Bound { binding, settings, .. } = bound;
    flesh.rest();
    if settings.iter().all(|joint| joint.flesh.amount == 0.0) {
        return false;
    }
    let anatomy = binding.anatomy();
    let bones = &posed.motions.tree.bones;
    let is_fleshed = |joint: usize| pose.is_fleshed.is_some_and(|fleshed| fleshed[bones[joint] as usize]);
    let of_joint = |joint: usize| if is_fleshed(joint) { Flesh::NONE } else { settings[joint].flesh };
    if !flesh.take(anatomy, &posed.motions, of_joint) {
        return false;
    }
    let palette = &posed.motions.palette;
    flesh.untwist(anatomy, &posed.motions, &posed.channels, (palette.armature_from_rest(), palette.origin), binding.size);
    let sites = &binding.sites;
    let has_factor = mask.is_some() || pose.is_fleshed.is_some() || !sites.influences.mask.is_empty();
    let normals = if bound.supports.is_even { &*binding.normals().directions } else { &[] };
    flesh.shape(anatomy, &posed.motions, &binding.patches, &Body { binding, posed, pose, mask, has_factor, normals });
    true
}

/// The body of a frame, as the law asks for it.
struct Body<'a> {
    binding: &'a Binding,
    posed: &'a Posed,
    pose: &'a Pose<'a>,
    mask: Option<&'a Mask>,
    has_factor: bool,
    normals: &'a [V4],
}

impl Points for Body<'_> {
    #[inline(always)]
    fn rest<'a>(&'a self, patch: usize, number: usize, room: &'a mut [Block<f64>; 3]) -> [&'a Block<f64>; 3] {
        let Binding { sites, patches, plan, .. } = self.binding;
        if self.posed.body.of_site.is_empty() {
            return plan.stages.rest(patch, number);
        }
        let rest = self.posed.body.rest(self.binding);
        let &Patch { start, owned, .. } = &patches.list[patch];
        for (lane, slot) in (start + number * LANES..start + owned).take(LANES).enumerate() {
            let place = sites.mean(slot, |site| rest[site]);
            room.iter_mut().zip(place).for_each(|(row, coordinate)| row[lane] = coordinate);
        }
        room.each_ref()
    }

    fn skin(&self, patch: usize, places: &mut [V4; PATCH_POINTS]) {
        with_scratch(|scratch| {
            dispatch!(Level::new(), simd => skin_points(simd, self.binding, self.posed, patch, &mut scratch.rows, places));
        });
    }

    fn factor(&self) -> Option<impl Fn(usize) -> f64> {
        let Self { binding, posed, pose, mask, .. } = *self;
        let (sites, bones) = (&binding.sites, &posed.motions.tree.bones);
        let is_fleshed = move |joint: u16| {
            let bone = bones.get(usize::from(joint));
            pose.is_fleshed.zip(bone).is_some_and(|(fleshed, &bone)| fleshed[bone as usize])
        };
        self.has_factor.then_some(move |slot: usize| {
            let of_site = |site: usize| {
                let (joints, weights) = sites.influences.of(site);
                let fleshed: f64 = joints.iter().zip(weights).filter(|(joint, _)| is_fleshed(**joint)).map(|(_, weight)| weight).sum();
                sites.share(site) * sites.influences.mask(site) * (1.0 - fleshed.min(1.0))
            };
            let free = mask.map_or(1.0, |mask| {
                let is_pinned = mask.is_pinned[binding.patches.component_of_slot(slot) as usize];
                if is_pinned { 0.0 } else { f64::from(mask.of_slot[slot]) }
            });
            free * sites.of_slot(slot).map(of_site).sum::<f64>()
        })
    }

    fn normals(&self) -> &[V4] {
        self.normals
    }
}

/// Skin that lies in a closed crease has no room to grow.
fn keep_out_of_creases(flesh: &Shape, mask: &mut Option<Arc<Mask>>, binding: &Binding) {
    let Some(free) = flesh.free() else { return };
    let artists = mask.as_deref();
    let of_artist = |slot: usize| artists.map_or(1.0, |mask| mask.of_slot[slot]);
    let of_slot = free.iter().enumerate().map(|(slot, free)| of_artist(slot) * free).collect();
    let is_pinned = artists.map_or_else(|| vec![false; binding.components.len()], |mask| mask.is_pinned.clone());
    *mask = Some(Arc::new(Mask { of_slot, is_pinned }));
}

/// Puts a joint's field where flesh gives: amid the section, along the limb that is turned by half of the bend.
pub(super) fn halve(flesh: &Shape, binding: &Binding, posed: &Posed, joint: usize, frame: &mut FieldFrame) {
    if !flesh.is_active() {
        return;
    }
    if let Some((middle, along, part)) = flesh.halved(binding.anatomy(), &posed.motions, joint) {
        frame.turn_to(middle - posed.motions.palette.origin, along, part);
    }
}

impl Targets {
    /// Volumes of giant faces as skinned, for those with the law.
    pub(super) fn take_flesh_from_giants(&mut self, binding: &Binding, flesh: &Shape, skinned: &Skinned) {
        let flesh = Some(flesh).filter(|flesh| flesh.is_active());
        let (Some(flesh), giants) = (flesh, &binding.patches.giants) else { return };
        for (giant, volume) in giants.iter().zip(&skinned.giant_volumes) {
            let bare = |&slot: &u32| lanes::sub(skinned.places.at(slot as usize), widened(flesh.offset(slot as usize)));
            let corners: Vec<V4> = giant.corners.iter().map(bare).collect();
            self.components[giant.component as usize].bare += giant_volume(&corners) - volume;
        }
    }
}

impl Losses {
    /// What is missing once the law has been followed, by what each joint's turn takes: they sum to it.
    pub(super) fn share_flesh(&mut self, binding: &Binding, flesh: &Shape, components: &[ComponentTarget]) -> &Self {
        if !flesh.is_active() {
            return self;
        }
        let anatomy = binding.anatomy();
        let count = components.len();
        let (mut unexplained, mut sums) = (vec![0.0; count], vec![0.0; count]);
        for (state, unexplained) in components.iter().zip(&mut unexplained) {
            *unexplained = state.rest - state.skinned;
        }
        let part = |loss: f64, joint: u32| loss.abs() + EXTENT_PART * flesh.extent(anatomy, joint as usize);
        for (job, change) in binding.plan.jobs.iter().zip(&self.changes) {
            let component = job.component as usize;
            unexplained[component] += change.intent - change.loss;
            sums[component] += part(change.loss, job.joint);
        }
        for (job, change) in binding.plan.jobs.iter().zip(&mut self.changes) {
            let component = job.component as usize;
            if sums[component] > 0.0 {
                change.loss += unexplained[component] * (part(change.loss, job.joint) / sums[component]);
            }
        }
        self
    }
}
