//! Losses by sweeping: a body is skinned once per joint that deforms it, with only the joints so far turned.
//!
//! Serves what has no closed form: dual quaternions, and rest shapes that shape keys change from frame to frame. The last
//! stage is the skinned surface itself, so the changes sum to the whole by construction.

use glam::DVec3;

use crate::csr::Csr;
use crate::dual_quaternion;
use crate::lanes::{self, V4, add_scaled, scale, sub, transform};
use crate::motions::Motions;
use crate::sites::Sites;
use crate::skinning::{Columns, Mode};
use crate::sweeps;
use crate::volume_loss::{Anatomy, Bodies, Change, Job, Moment, find_job, joints_of, moved_volume};

/// What deforms each body: patches, then giants.
#[derive(Debug, Clone)]
pub(crate) struct Stages {
    /// Joint above each body.
    tops: Vec<u16>,
    /// Per body, joints that deform it, parents first.
    joints: Csr<u16>,
    /// The same as jobs.
    jobs: Csr<u32>,
    /// Per body and one past the last: where its weights start, one row of points per joint.
    weight_offsets: Vec<u32>,
    /// Weight of all that hangs on a joint.
    weights: Vec<f64>,
}

/// One body in one frame.
pub(crate) struct Staged<'a> {
    pub index: usize,
    pub slots: &'a [u32],
    /// Rest position per site.
    pub rest: &'a [V4],
    pub moment: Moment,
    /// Volume of the body as skinned: what the last stage leaves.
    pub skinned: f64,
}

/// Room for the points of one body.
pub(crate) struct StageBuffers<'a> {
    /// Rest, armature space.
    place: &'a mut [V4],
    /// Blended so far: positions, or rotations and their dual parts.
    blend: &'a mut [V4],
    dual: &'a mut [V4],
    position: &'a mut [V4],
}

impl<'a> StageBuffers<'a> {
    /// Four rows of equal length.
    pub fn new(room: &'a mut [V4]) -> Self {
        let quarter = room.len() / 4;
        let (place, room) = room.split_at_mut(quarter);
        let (blend, room) = room.split_at_mut(quarter);
        let (dual, position) = room.split_at_mut(quarter);
        Self { place, blend, dual, position }
    }
}

impl Stages {
    /// Fills `bodies` with patches and giants.
    pub fn new(anatomy: &Anatomy, jobs: &[Job], bodies: &mut Bodies) -> Self {
        let Anatomy { patches, sites, .. } = *anatomy;
        let mut result =
            Self { tops: Vec::new(), joints: Csr::default(), jobs: Csr::default(), weight_offsets: vec![0], weights: Vec::new() };
        let place = |slot: &u32| sites.mean(*slot as usize, |site| sites.rest[site]);
        let mut buffer = [lanes::ZERO; crate::patches::PATCH_POINTS];
        for patch in &patches.list {
            let slots = &patches.local[patch.local.clone()];
            for (p, slot) in buffer.iter_mut().zip(slots) {
                *p = place(slot);
            }
            let (volume, area) = sweeps::moment(patches, patch, &buffer);
            result.push(anatomy, slots, patch.component, jobs);
            bodies.push(patch.component, result.top(), (volume, lanes::to(area)));
        }
        for giant in &patches.giants {
            let places: Vec<V4> = giant.corners.iter().map(place).collect();
            result.push(anatomy, &giant.corners, giant.component, jobs);
            bodies.push(giant.component, result.top(), giant_moment(&places));
        }
        result.weights.shrink_to_fit();
        result
    }

    /// Joint above the body pushed last.
    fn top(&self) -> u32 {
        self.tops.last().map_or(0, |&top| u32::from(top))
    }

    fn push(&mut self, anatomy: &Anatomy, slots: &[u32], component: u32, jobs: &[Job]) {
        let Anatomy { sites, tree, .. } = *anatomy;
        let all_sites = || slots.iter().flat_map(|&slot| sites.of_slot(slot as usize));
        let bones = || {
            all_sites().flat_map(|site| {
                let world = (sites.influences.mask(site) < 1.0).then_some(tree.world());
                sites.influences.of(site).0.iter().map(|&b| usize::from(b)).chain(world)
            })
        };
        let (top, joints) = joints_of(bones, tree);
        self.tops.push(top as u16);
        for &joint in &joints {
            let under = usize::from(joint)..usize::from(tree.ends[usize::from(joint)]);
            self.weights.extend(slots.iter().map(|&slot| {
                let of_site = |site: usize| {
                    let (bones, weights) = sites.influences.of(site);
                    bones.iter().zip(weights).filter(|(b, _)| under.contains(&usize::from(**b))).map(|(_, w)| w).sum::<f64>()
                };
                sites.of_slot(slot as usize).map(|site| sites.share(site) * of_site(site)).sum::<f64>()
            }));
        }
        self.weight_offsets.push(self.weights.len() as u32);
        // A patch without faces has joints that no face knows: they change nothing.
        self.jobs.push_row(joints.iter().map(|&j| find_job(jobs, usize::from(j), component).unwrap_or(u32::MAX)));
        self.joints.push_row(joints);
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.tops) + self.joints.memory_bytes() + self.jobs.memory_bytes() + size_of_val(&*self.weights)
    }

    /// Changes of all bodies.
    pub fn change_count(&self) -> usize {
        self.joints.values().len()
    }

    /// Per body and one past the last: where its changes start, one per joint.
    pub fn change_offsets(&self) -> &[u32] {
        self.joints.offsets()
    }

    /// Adds the changes of all bodies to those of jobs.
    pub fn gather(&self, changes: &[Change], of_job: &mut [Change]) {
        for (change, &job) in changes.iter().zip(self.jobs.values()) {
            if let Some(sum) = of_job.get_mut(job as usize) {
                sum.join(change);
            }
        }
    }

    /// What each joint's turn does to one body.
    #[inline(always)]
    pub fn measure(
        &self,
        body: &Staged,
        motions: &Motions,
        sites: &Sites,
        buffers: StageBuffers,
        volume: impl Fn(&[V4]) -> f64,
        changes: &mut [Change],
    ) {
        changes.fill(Change::default());
        let joints = self.joints.row(body.index);
        let Some(last) = joints.iter().rposition(|&j| !motions.is_still[usize::from(j)]) else { return };
        let top = usize::from(self.tops[body.index]);
        let count = body.slots.len();
        let weights = &self.weights[self.weight_offsets[body.index] as usize..];
        let palette = &motions.palette;
        let mean_rest = |slot: u32| sites.mean(slot as usize, |site| body.rest[site]);
        let StageBuffers { place, blend, dual, position } = buffers;
        let (place, blend, dual, position) = (&mut place[..count], &mut blend[..count], &mut dual[..count], position);
        let linear = palette.mode == Mode::Linear;
        for ((&slot, place), (blend, dual)) in body.slots.iter().zip(place.iter_mut()).zip(blend.iter_mut().zip(dual.iter_mut())) {
            let p = mean_rest(slot);
            if linear {
                (*place, *blend) = (p, transform(palette.alone(top), p));
            } else {
                let x = palette.in_armature(p);
                let motion = palette.dual(top);
                (*place, *blend, *dual) = (x, motion.rotation, motion.dual_at(x));
            }
        }
        let mut before = moved_volume(palette.alone(top), body.moment);
        for (stage, (&joint, change)) in joints.iter().zip(changes).enumerate().take(last + 1) {
            let joint = usize::from(joint);
            if motions.is_still[joint] {
                continue;
            }
            let parts = &weights[stage * count..][..count];
            let parent = usize::from(motions.tree.parents[joint]);
            let mut volume_with = |motion: usize, keeps: bool| {
                if linear {
                    let added = difference(palette.alone(motion), palette.alone(parent));
                    for (i, q) in position[..count].iter_mut().enumerate() {
                        *q = add_scaled(blend[i], transform(&added, place[i]), parts[i]);
                        if keeps {
                            blend[i] = *q;
                        }
                    }
                } else {
                    let (to, from) = (palette.dual(motion), palette.dual(parent));
                    let turned = sub(to.rotation, from.rotation);
                    let origin = lanes::from(palette.origin);
                    for i in 0..count {
                        let rotation = add_scaled(blend[i], turned, parts[i]);
                        let moved = add_scaled(dual[i], sub(to.dual_at(place[i]), from.dual_at(place[i])), parts[i]);
                        if keeps {
                            (blend[i], dual[i]) = (rotation, moved);
                        }
                        position[i] = sub(dual_quaternion::transform(rotation, moved, place[i]), origin);
                    }
                    if !sites.influences.mask.is_empty() {
                        for (q, (&slot, &x)) in position.iter_mut().zip(body.slots.iter().zip(place.iter())) {
                            let still = sub(x, origin);
                            let mask = sites.of_slot(slot as usize).map(|site| sites.share(site) * sites.influences.mask(site)).sum();
                            *q = add_scaled(still, sub(*q, still), mask);
                        }
                    }
                }
                volume(position)
            };
            let stretched = if motions.has_intent[joint] { volume_with(motions.stretched(joint), false) } else { before };
            let after = if stage == last { body.skinned } else { volume_with(joint, true) };
            *change = Change { intent: stretched - before, loss: stretched - after };
            before = after;
        }
    }
}

fn difference(a: &Columns, b: &Columns) -> Columns {
    std::array::from_fn(|i| sub(a[i], b[i]))
}

/// Volume and area vector of a polygon.
pub(crate) fn giant_moment(corners: &[V4]) -> (f64, DVec3) {
    let (_, twice_area) = sweeps::mean_and_cross(corners.iter().copied());
    (giant_volume(corners), lanes::to(scale(twice_area, 0.5)))
}

/// Volume of a polygon's cone.
pub(crate) fn giant_volume(corners: &[V4]) -> f64 {
    let (mean, twice_area) = sweeps::mean_and_cross(corners.iter().copied());
    lanes::sum(lanes::mul(mean, twice_area)) / 6.0
}
