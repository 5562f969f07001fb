//! Faces in small fixed groups, each with its own short list of points: the unit of parallel sweeps over a surface.
//!
//! A sweep copies a patch's points into a buffer on the stack and works on small indices. Sums are taken per patch and
//! then in patch order, so that no bit of a result depends on the number of threads.

use std::ops::Range;

use glam::DVec3;

use crate::csr::Csr;
use crate::volume::{VolumeCubic, polygon_mean_and_cross, quad_volume24, triangle_volume6};

/// Most points of one patch: its buffer lives on the stack.
pub(crate) const PATCH_POINTS: usize = 1024;

/// Faces of one group that share a buffer.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Caller's label: every face of a patch has the same.
    pub group: u32,
    /// Where its points lie among those of all patches: its slots.
    pub points: Range<usize>,
    triangles: Range<usize>,
    quads: Range<usize>,
    polygons: Range<usize>,
}

/// All faces of a sweep.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patches {
    list: Vec<Patch>,
    points: Vec<u32>,
    triangles: Vec<[u16; 3]>,
    quads: Vec<[u16; 4]>,
    polygons: Csr<u16>,
    /// Faces with more corners than a patch has room for: huge caps.
    giants: Vec<(u32, Vec<u32>)>,
}

/// Positions of a patch's points, on the stack.
pub(crate) type PatchBuffer = [DVec3; PATCH_POINTS];

impl Patches {
    /// Groups `faces` of equal `group_of_face`, near ones together (by Morton code of `positions`).
    pub fn new(faces: &[(u32, &[u32])], positions: &[DVec3]) -> Self {
        let code = morton_coder(positions);
        let mut order: Vec<(u32, u64, u32)> = faces
            .iter()
            .enumerate()
            .map(|(index, (group, corners))| {
                let mean = corners.iter().map(|&p| positions[p as usize]).sum::<DVec3>() / corners.len() as f64;
                (*group, code(mean), index as u32)
            })
            .collect();
        order.sort_unstable();
        let mut result = Self::default();
        let mut open = OpenPatch::new(positions.len());
        for (group, _, index) in order {
            let corners = faces[index as usize].1;
            if corners.len() > PATCH_POINTS {
                result.giants.push((group, corners.to_vec()));
                continue;
            }
            if open.group != Some(group) || !open.has_room(corners) {
                result.close(&mut open);
                open.group = Some(group);
            }
            open.add(corners);
        }
        result.close(&mut open);
        result
    }

    fn close(&mut self, open: &mut OpenPatch) {
        let Some(group) = open.group.take() else { return };
        let (points, triangles, quads, polygons) = (self.points.len(), self.triangles.len(), self.quads.len(), self.polygons.len());
        self.points.append(&mut open.points);
        self.triangles.append(&mut open.triangles);
        self.quads.append(&mut open.quads);
        for polygon in open.polygons.drain(..) {
            self.polygons.push_row(polygon);
        }
        self.list.push(Patch {
            group,
            points: points..self.points.len(),
            triangles: triangles..self.triangles.len(),
            quads: quads..self.quads.len(),
            polygons: polygons..self.polygons.len(),
        });
        open.generation += 1;
    }

    pub fn len(&self) -> usize {
        self.list.len()
    }

    pub fn patch(&self, index: usize) -> &Patch {
        &self.list[index]
    }

    pub fn patches(&self) -> &[Patch] {
        &self.list
    }

    pub fn giants(&self) -> &[(u32, Vec<u32>)] {
        &self.giants
    }

    /// Points of all patches, one after the other: `slots` of a patch lie here.
    pub fn slot_points(&self) -> &[u32] {
        &self.points
    }

    pub fn points_of(&self, patch: &Patch) -> &[u32] {
        &self.points[patch.points.clone()]
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.list)
            + size_of_val(&*self.points)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.quads)
            + self.polygons.memory_bytes()
            + self.giants.iter().map(|(_, corners)| size_of_val(&**corners)).sum::<usize>()
    }

    /// Copies a patch's points; returns how many.
    #[inline]
    pub fn load(&self, patch: &Patch, positions: &[DVec3], buffer: &mut PatchBuffer) -> usize {
        let points = self.points_of(patch);
        for (slot, &point) in buffer.iter_mut().zip(points) {
            *slot = positions[point as usize];
        }
        points.len()
    }

    /// Volume of the cones over a patch's faces.
    #[inline]
    pub fn volume(&self, patch: &Patch, p: &PatchBuffer) -> f64 {
        let at = |i: u16| p[i as usize & (PATCH_POINTS - 1)];
        let triangles: f64 = self.triangles[patch.triangles.clone()].iter().map(|f| triangle_volume6(f.map(at))).sum();
        let quads: f64 = self.quads[patch.quads.clone()].iter().map(|f| quad_volume24(f.map(at))).sum();
        let polygons: f64 = patch
            .polygons
            .clone()
            .map(|f| {
                let (mean, cross) = polygon_mean_and_cross(self.polygons.row(f).iter().map(|&i| at(i)));
                mean.dot(cross)
            })
            .sum();
        (triangles + polygons + quads / 4.0) / 6.0
    }

    /// Sum of the area vectors of a patch's faces.
    pub fn area_vector(&self, patch: &Patch, p: &PatchBuffer) -> DVec3 {
        let at = |i: u16| p[i as usize];
        let mut sum = DVec3::ZERO;
        for f in &self.triangles[patch.triangles.clone()] {
            sum += crate::volume::triangle_cross(f.map(at));
        }
        for f in &self.quads[patch.quads.clone()] {
            let [a, b, c, d] = f.map(at);
            sum += (c - a).cross(d - b);
        }
        for f in patch.polygons.clone() {
            sum += polygon_mean_and_cross(self.polygons.row(f).iter().map(|&i| at(i))).1;
        }
        sum * 0.5
    }

    /// Volume of a patch; `gradient` (one per slot of the patch) receives its derivative by each point [MATH §1].
    #[inline]
    pub fn volume_and_gradient(&self, patch: &Patch, p: &PatchBuffer, gradient: &mut [DVec3]) -> f64 {
        gradient.fill(DVec3::ZERO);
        let at = |i: u16| p[i as usize & (PATCH_POINTS - 1)];
        let mut triangles = 0.0;
        for &f in &self.triangles[patch.triangles.clone()] {
            let corners = f.map(at);
            let [a, b, c] = corners;
            // det(a, b, c) by each corner: exact also where the three do not sum to a third of the area vector.
            let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
            triangles += a.dot(bc);
            gradient[f[0] as usize] += bc / 6.0;
            gradient[f[1] as usize] += ca / 6.0;
            gradient[f[2] as usize] += ab / 6.0;
        }
        let mut quads = 0.0;
        for &f in &self.quads[patch.quads.clone()] {
            let [a, b, c, d] = f.map(at);
            let (first, second, sum) = (c - a, d - b, a + b + c + d);
            let cross = first.cross(second);
            quads += sum.dot(cross);
            let (by_first, by_second) = (first.cross(sum), second.cross(sum));
            gradient[f[0] as usize] += (cross - by_second) / 24.0;
            gradient[f[1] as usize] += (cross + by_first) / 24.0;
            gradient[f[2] as usize] += (cross + by_second) / 24.0;
            gradient[f[3] as usize] += (cross - by_first) / 24.0;
        }
        let mut polygons = 0.0;
        for f in patch.polygons.clone() {
            let corners = self.polygons.row(f);
            let (mean, cross) = polygon_mean_and_cross(corners.iter().map(|&i| at(i)));
            polygons += mean.dot(cross);
            for (i, &corner) in corners.iter().enumerate() {
                let next = at(corners[(i + 1) % corners.len()]);
                let previous = at(corners[(i + corners.len() - 1) % corners.len()]);
                gradient[corner as usize] += (cross / corners.len() as f64 + (next - previous).cross(mean)) / 6.0;
            }
        }
        (triangles + polygons + quads / 4.0) / 6.0
    }

    /// V(P + tU) of a patch.
    #[inline]
    pub fn volume_cubic(&self, patch: &Patch, p: &PatchBuffer, u: &PatchBuffer) -> VolumeCubic {
        let mut cubic = VolumeCubic::default();
        let at = |i: u16| p[i as usize & (PATCH_POINTS - 1)];
        let by = |i: u16| u[i as usize & (PATCH_POINTS - 1)];
        for f in &self.triangles[patch.triangles.clone()] {
            let ([a, b, c], [ua, ub, uc]) = (f.map(at), f.map(by));
            let (first, second, u_first, u_second) = (b - a, c - a, ub - ua, uc - ua);
            let cross = [first.cross(second), u_first.cross(second) + first.cross(u_second), u_first.cross(u_second)];
            cubic.add([a, ua], cross, 1.0 / 6.0);
        }
        for f in &self.quads[patch.quads.clone()] {
            let ([a, b, c, d], [ua, ub, uc, ud]) = (f.map(at), f.map(by));
            let (first, second, u_first, u_second) = (c - a, d - b, uc - ua, ud - ub);
            let cross = [first.cross(second), u_first.cross(second) + first.cross(u_second), u_first.cross(u_second)];
            cubic.add([a + b + c + d, ua + ub + uc + ud], cross, 1.0 / 24.0);
        }
        for f in patch.polygons.clone() {
            let corners = self.polygons.row(f);
            polygon_cubic(corners.iter().map(|&i| (at(i), by(i))), &mut cubic);
        }
        cubic
    }
}

/// Adds V(P + tU) of one polygon.
pub(crate) fn polygon_cubic(corners: impl ExactSizeIterator<Item = (DVec3, DVec3)> + Clone, cubic: &mut VolumeCubic) {
    let count = corners.len() as f64;
    let (p, u) = corners.clone().fold((DVec3::ZERO, DVec3::ZERO), |(p, u), (q, v)| (p + q, u + v));
    let mean = [p / count, u / count];
    let mut cross = [DVec3::ZERO; 3];
    let Some((mut a, mut ua)) = corners.clone().last().map(|(q, v)| (q - mean[0], v - mean[1])) else { return };
    for (q, v) in corners {
        let (b, ub) = (q - mean[0], v - mean[1]);
        cross[0] += a.cross(b);
        cross[1] += ua.cross(b) + a.cross(ub);
        cross[2] += ua.cross(ub);
        (a, ua) = (b, ub);
    }
    cubic.add(mean, cross, 1.0 / 6.0);
}

/// A patch being filled.
struct OpenPatch {
    group: Option<u32>,
    generation: u32,
    /// Per point of the mesh: the generation that last used it, and its slot then.
    slot_of_point: Vec<(u32, u16)>,
    points: Vec<u32>,
    triangles: Vec<[u16; 3]>,
    quads: Vec<[u16; 4]>,
    polygons: Vec<Vec<u16>>,
}

impl OpenPatch {
    fn new(point_count: usize) -> Self {
        Self {
            group: None,
            generation: 1,
            slot_of_point: vec![(0, 0); point_count],
            points: Vec::new(),
            triangles: Vec::new(),
            quads: Vec::new(),
            polygons: Vec::new(),
        }
    }

    fn has_room(&self, corners: &[u32]) -> bool {
        self.points.len() + corners.len() <= PATCH_POINTS
    }

    fn slot(&mut self, point: u32) -> u16 {
        let known = &mut self.slot_of_point[point as usize];
        if known.0 != self.generation {
            *known = (self.generation, self.points.len() as u16);
            self.points.push(point);
        }
        known.1
    }

    fn add(&mut self, corners: &[u32]) {
        match *corners {
            [a, b, c] => {
                let face = [a, b, c].map(|p| self.slot(p));
                self.triangles.push(face);
            }
            [a, b, c, d] => {
                let face = [a, b, c, d].map(|p| self.slot(p));
                self.quads.push(face);
            }
            _ => {
                let face = corners.iter().map(|&p| self.slot(p)).collect();
                self.polygons.push(face);
            }
        }
    }
}

/// Interleaved bits of a position in the box of all: near codes are near places.
fn morton_coder(positions: &[DVec3]) -> impl Fn(DVec3) -> u64 {
    let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let scale = 1_048_575.0 / (high - low).max_element().max(f64::MIN_POSITIVE);
    move |p| {
        let q = (p - low) * scale;
        let spread = |value: f64| {
            let mut bits = value as u64;
            bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
            bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
            bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
            bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
            (bits | bits << 2) & 0x1249_2492_4924_9249
        };
        spread(q.x) | spread(q.y) << 1 | spread(q.z) << 2
    }
}
