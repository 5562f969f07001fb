//! Sweeps over all sound faces of a mesh: volume per group, gradient per point, the exact cubic.

use glam::DVec3;
use rayon::prelude::*;

use crate::csr::Csr;
use crate::patches::{PATCH_POINTS, Patches, polygon_cubic};
use crate::volume::{VolumeCubic, polygon_mean_and_cross};

/// Faces in patches, by group.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    patches: Patches,
    group_count: usize,
    slot_count: usize,
    /// Slots of the patches that hold each point.
    slots_of_point: Csr<u32>,
}

/// Buffers of a surface's sweeps.
#[derive(Debug, Clone, Default)]
pub(crate) struct SurfaceBuffers {
    slots: Vec<DVec3>,
    volumes: Vec<f64>,
    cubics: Vec<VolumeCubic>,
}

impl SurfaceBuffers {
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.slots) + size_of_val(&*self.volumes) + size_of_val(&*self.cubics)
    }
}

impl Surface {
    /// `faces`: (group, corners), all points of `positions`.
    pub fn new(faces: &[(u32, &[u32])], group_count: usize, positions: &[DVec3]) -> Self {
        let patches = Patches::new(faces, positions);
        let giants = patches.giants().iter().flat_map(|(_, corners)| corners);
        let slots: Vec<(u32, u32)> = patches.slot_points().iter().chain(giants).zip(0..).map(|(&point, slot)| (point, slot)).collect();
        Self { slots_of_point: Csr::from_pairs(positions.len(), &slots), patches, group_count, slot_count: slots.len() }
    }

    pub fn group_count(&self) -> usize {
        self.group_count
    }

    pub fn memory_bytes(&self) -> usize {
        self.patches.memory_bytes() + self.slots_of_point.memory_bytes()
    }

    pub fn buffers(&self) -> SurfaceBuffers {
        SurfaceBuffers {
            slots: vec![DVec3::ZERO; self.slot_count],
            volumes: vec![0.0; self.patches.len()],
            cubics: vec![VolumeCubic::default(); self.patches.len()],
        }
    }

    /// Volume of each group's cones with the origin.
    pub fn volumes(&self, positions: &[DVec3], buffers: &mut SurfaceBuffers, of_group: &mut [f64]) {
        let patches = &self.patches;
        buffers.volumes.par_iter_mut().zip(patches.patches()).for_each(|(volume, patch)| {
            let mut p = [DVec3::ZERO; PATCH_POINTS];
            patches.load(patch, positions, &mut p);
            *volume = patches.volume(patch, &p);
        });
        self.sum_volumes(positions, buffers, of_group);
    }

    fn sum_volumes(&self, positions: &[DVec3], buffers: &SurfaceBuffers, of_group: &mut [f64]) {
        of_group.fill(0.0);
        for (volume, patch) in buffers.volumes.iter().zip(self.patches.patches()) {
            of_group[patch.group as usize] += volume;
        }
        for (group, corners) in self.patches.giants() {
            let (mean, cross) = polygon_mean_and_cross(corners.iter().map(|&p| positions[p as usize]));
            of_group[*group as usize] += mean.dot(cross) / 6.0;
        }
    }

    /// Volume and area vector of each group at rest.
    pub fn moments(&self, positions: &[DVec3], of_group: &mut [(f64, DVec3)]) {
        of_group.fill((0.0, DVec3::ZERO));
        let mut p = [DVec3::ZERO; PATCH_POINTS];
        for patch in self.patches.patches() {
            self.patches.load(patch, positions, &mut p);
            let moment = &mut of_group[patch.group as usize];
            moment.0 += self.patches.volume(patch, &p);
            moment.1 += self.patches.area_vector(patch, &p);
        }
        for (group, corners) in self.patches.giants() {
            let (mean, cross) = polygon_mean_and_cross(corners.iter().map(|&p| positions[p as usize]));
            let moment = &mut of_group[*group as usize];
            moment.0 += mean.dot(cross) / 6.0;
            moment.1 += cross * 0.5;
        }
    }

    /// Volume per group; the gradient stays in the buffers, to be read by `gradient_at`.
    pub fn volumes_and_gradient(&self, positions: &[DVec3], buffers: &mut SurfaceBuffers, of_group: &mut [f64]) {
        let (slots, giant_slots) = buffers.slots.split_at_mut(self.patches.slot_points().len());
        self.gradient_sweep(0, positions, slots, &mut buffers.volumes);
        let mut giant_slots = giant_slots.iter_mut();
        for (_, corners) in self.patches.giants() {
            let at = |i: usize| positions[corners[i % corners.len()] as usize];
            let (mean, cross) = polygon_mean_and_cross(corners.iter().map(|&p| positions[p as usize]));
            for (i, slot) in (0..corners.len()).zip(&mut giant_slots) {
                *slot = (cross / corners.len() as f64 + (at(i + 1) - at(i + corners.len() - 1)).cross(mean)) / 6.0;
            }
        }
        self.sum_volumes(positions, buffers, of_group);
    }

    /// Patches from `first` on, as many as there are `volumes`; halves go to other threads.
    fn gradient_sweep(&self, first: usize, positions: &[DVec3], slots: &mut [DVec3], volumes: &mut [f64]) {
        match volumes {
            [] => {}
            [volume] => {
                let patch = self.patches.patch(first);
                let mut p = [DVec3::ZERO; PATCH_POINTS];
                self.patches.load(patch, positions, &mut p);
                *volume = self.patches.volume_and_gradient(patch, &p, slots);
            }
            _ => {
                let half = volumes.len() / 2;
                let slot_count = self.patches.patch(first + half).points.start - self.patches.patch(first).points.start;
                let (volumes, later_volumes) = volumes.split_at_mut(half);
                let (slots, later_slots) = slots.split_at_mut(slot_count);
                rayon::join(
                    || self.gradient_sweep(first, positions, slots, volumes),
                    || self.gradient_sweep(first + half, positions, later_slots, later_volumes),
                );
            }
        }
    }

    /// Gradient by one point, after `volumes_and_gradient`.
    #[inline]
    pub fn gradient_at(&self, point: usize, buffers: &SurfaceBuffers) -> DVec3 {
        self.slots_of_point.row(point).iter().map(|&slot| buffers.slots[slot as usize]).sum()
    }

    /// V(P + tU) of each group.
    pub fn cubics(&self, positions: &[DVec3], field: &[DVec3], buffers: &mut SurfaceBuffers, of_group: &mut [VolumeCubic]) {
        let patches = &self.patches;
        buffers.cubics.par_iter_mut().zip(patches.patches()).for_each(|(cubic, patch)| {
            let (mut p, mut u) = ([DVec3::ZERO; PATCH_POINTS], [DVec3::ZERO; PATCH_POINTS]);
            patches.load(patch, positions, &mut p);
            patches.load(patch, field, &mut u);
            *cubic = patches.volume_cubic(patch, &p, &u);
        });
        of_group.fill(VolumeCubic::default());
        for (cubic, patch) in buffers.cubics.iter().zip(patches.patches()) {
            of_group[patch.group as usize].join(cubic);
        }
        for (group, corners) in patches.giants() {
            polygon_cubic(corners.iter().map(|&p| (positions[p as usize], field[p as usize])), &mut of_group[*group as usize]);
        }
    }
}
