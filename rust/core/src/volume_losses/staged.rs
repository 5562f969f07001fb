//! Skinning by stages: all points of a portion follow the joint above it, then one joint after the other turns.
//!
//! Every joint does the same to all points of a portion, by their weight: loops over points that compile to SIMD. Where there
//! is no closed form of losses, for dual quaternions and rest shapes that change, the volume is taken at every stage.
//! The last stage is the skinned surface itself, so the changes sum to the whole by construction.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use glam::DVec3;

use crate::numeric::block_rows::{Block, BlockRows, LANES, PATCH_POINTS};
use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, Four, V4, add_scaled, scale, sub};
use crate::skinning::blend::Mode;
use crate::skinning::motions::Motions;
use crate::skinning::sites::Sites;
use crate::surface::sweeps;
use crate::volume_losses::job::{Anatomy, Change, Job, Moment, Portions, find_job, joints_of, moved_volume};

/// What deforms each portion: patches, then giants.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stages {
    /// Joint above each portion, and the portion's component.
    tops: Vec<u16>,
    components: Vec<u32>,
    /// Per portion, joints that deform it, parents first.
    joints: Csr<u16>,
    /// The same as jobs.
    jobs: Csr<u32>,
    /// Per portion: the first of its rows of weights.
    first_rows: Vec<u32>,
    /// Weight of all that hangs on a joint: per portion and joint a row for each `PATCH_POINTS` of its points.
    weights: BlockRows<f64>,
    /// Per portion and one past the last: where its rest positions start, three rows of whole blocks.
    rest_offsets: Vec<u32>,
    rest: Vec<f64>,
    /// Per portion, whether each of its points is one site, and joints are few.
    is_single: Vec<bool>,
}

/// One portion in one frame.
#[derive(Clone, Copy)]
pub(crate) struct Portion<'a> {
    pub index: usize,
    pub slots: &'a [u32],
    pub sites: &'a Sites,
    /// Rest position per site, where it is not the bound one.
    pub shaped_rest: Option<&'a [V4]>,
    pub motions: &'a Motions,
    /// At rest, where losses are measured.
    pub moment: Moment,
}

/// Coordinates of the points of one portion, row after row: rest in three, blended motion in eight.
pub(crate) struct Rows<'a> {
    place: [&'a mut [f64]; 3],
    /// Position where skinning is linear, else the rotation.
    blend: [&'a mut [f64]; 4],
    dual: [&'a mut [f64]; 4],
}

/// Rows of a portion.
pub(crate) const ROWS: usize = 11;

impl<'a> Rows<'a> {
    /// `ROWS` rows of `count` numbers in `room`, whole blocks.
    #[inline(always)]
    pub fn new(room: &'a mut [f64], count: usize) -> Self {
        let mut rows = room.chunks_exact_mut(count.max(1));
        let mut next = || rows.next().unwrap_or_default();
        let [place, blend, dual] = [[next(), next(), next()], [next(), next(), next()], [next(), next(), next()]];
        let [px, py, pz] = place;
        let [bx, by, bz] = blend;
        let [dx, dy, dz] = dual;
        Self { place: [px, py, pz], blend: [bx, by, bz, next()], dual: [dx, dy, dz, next()] }
    }
}

/// Portions that more joints deform are skinned vertex by vertex.
const JOINTS_MAX: usize = 32;

impl Stages {
    /// Portions are patches, then giants.
    pub fn new(anatomy: &Anatomy, jobs: &[Job]) -> Self {
        let mut result = Self::default();
        result.rest_offsets.push(0);
        for patch in &anatomy.patches.list {
            result.push(anatomy, &anatomy.patches.local[patch.local.clone()], patch.component, jobs);
        }
        for giant in &anatomy.patches.giants {
            result.push(anatomy, &giant.corners, giant.component, jobs);
        }
        result.weights.shrink_to_fit();
        result.rest.shrink_to_fit();
        result
    }

    /// Portions with their moments at rest.
    pub fn portions(&self, anatomy: &Anatomy) -> Portions {
        let Anatomy { patches, sites, .. } = *anatomy;
        let place = |slot: &u32| sites.mean(*slot as usize, |site| sites.rest[site]);
        let mut portions = Portions::default();
        let mut tops = self.tops.iter().map(|&top| u32::from(top));
        let mut buffer = [lanes::ZERO; PATCH_POINTS];
        for (patch, top) in patches.list.iter().zip(&mut tops) {
            for (p, slot) in buffer.iter_mut().zip(&patches.local[patch.local.clone()]) {
                *p = place(slot);
            }
            let (volume, area) = dispatch!(Level::new(), simd => sweeps::moment(simd, patches, patch, &buffer));
            portions.push(patch.component, top, (volume, lanes::to(area)));
        }
        for (giant, top) in patches.giants.iter().zip(&mut tops) {
            let places: Vec<V4> = giant.corners.iter().map(place).collect();
            portions.push(giant.component, top, giant_moment(&places));
        }
        portions
    }

    fn push(&mut self, anatomy: &Anatomy, slots: &[u32], component: u32, jobs: &[Job]) {
        let Anatomy { sites, tree, .. } = *anatomy;
        let padding = slots.len()..slots.len().next_multiple_of(LANES);
        let all_sites = || slots.iter().flat_map(|&slot| sites.of_slot(slot as usize));
        let bones = || {
            all_sites().flat_map(|site| {
                let world = (sites.influences.mask(site) < 1.0).then_some(tree.world());
                sites.influences.of(site).0.iter().map(|&b| usize::from(b)).chain(world)
            })
        };
        let (top, joints) = joints_of(bones, tree);
        let is_sparse = joints.len() <= JOINTS_MAX;
        self.tops.push(top as u16);
        self.components.push(component);
        self.is_single.push(is_sparse && slots.iter().all(|&slot| sites.of_slot(slot as usize).len() == 1));
        self.first_rows.push(self.weights.len() as u32);
        for &joint in &joints {
            let under = usize::from(joint)..usize::from(tree.ends[usize::from(joint)]);
            let of_site = |site: usize| {
                let (bones, weights) = sites.influences.of(site);
                bones.iter().zip(weights).filter(|(b, _)| under.contains(&usize::from(**b))).map(|(_, w)| w).sum::<f64>()
            };
            let of_slot = |slot: &u32| sites.of_slot(*slot as usize).map(|site| sites.share(site) * of_site(site)).sum::<f64>();
            for slots in slots.chunks(PATCH_POINTS) {
                self.weights.push_row(&slots.iter().map(of_slot).collect::<Vec<f64>>());
            }
        }
        for axis in 0..3 {
            self.rest.extend(slots.iter().map(|&slot| sites.mean(slot as usize, |site| sites.rest[site])[axis]));
            self.rest.extend(padding.clone().map(|_| 0.0));
        }
        self.rest_offsets.push(self.rest.len() as u32);
        // A patch without faces has joints that no face knows: they change nothing.
        self.jobs.push_row(joints.iter().map(|&j| find_job(jobs, usize::from(j), component).unwrap_or(u32::MAX)));
        self.joints.push_row(joints);
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.tops)
            + self.joints.memory_bytes()
            + self.jobs.memory_bytes()
            + self.weights.memory_bytes()
            + size_of_val(&*self.rest)
    }

    /// Joints that deform a portion.
    pub fn joint_count(&self, portion: usize) -> usize {
        self.joints.row(portion).len()
    }

    /// Changes of all portions.
    pub fn change_count(&self) -> usize {
        self.joints.values().len()
    }

    /// Per portion and one past the last: where its changes start, one per joint.
    pub fn change_offsets(&self) -> &[u32] {
        self.joints.offsets()
    }

    /// Adds the changes of all portions to those of jobs.
    pub fn gather(&self, changes: &[Change], of_job: &mut [Change]) {
        for (change, &job) in changes.iter().zip(self.jobs.values()) {
            if let Some(sum) = of_job.get_mut(job as usize) {
                sum.join(change);
            }
        }
    }

    /// True when the last stage is the skinned portion: its points are not split, and no bone's rotation lies so far from
    /// another's that Blender would turn its sign.
    #[inline(always)]
    pub fn ends_skinned(&self, portion: Portion) -> bool {
        let palette = &portion.motions.palette;
        if !self.is_single[portion.index] {
            return false;
        }
        let joints = self.joints.row(portion.index);
        let all = || joints.iter().map(|&j| usize::from(j)).chain([self.above(portion)]).map(|motion| palette.rotation(motion));
        palette.mode == Mode::Linear || all().enumerate().all(|(i, a)| all().skip(i + 1).all(|b| lanes::sum(lanes::mul(a, b)) >= 0.0))
    }

    /// Positions as all joints leave them: those of the skin where `ends_skinned`.
    #[inline(always)]
    pub fn skin<S: Simd>(&self, simd: S, portion: Portion, mut rows: Rows, positions: &mut [V4]) {
        self.start(simd, portion, &mut rows);
        for (stage, &joint) in self.joints.row(portion.index).iter().enumerate() {
            self.add(simd, portion, stage, usize::from(joint), &mut rows);
        }
        place_all(simd, portion, &rows, positions);
    }

    /// What each joint's turn does to one portion; `positions` end as all joints leave them.
    ///
    /// Returns the last joint that moves. Its loss is the volume before it: the caller takes from that the volume after it.
    #[inline(always)]
    pub fn measure<S: Simd, P: AsMut<[V4]>>(
        &self,
        simd: S,
        portion: Portion,
        mut rows: Rows,
        positions: &mut P,
        volume: impl Fn(&P) -> f64,
        changes: &mut [Change],
    ) -> Option<usize> {
        changes.fill(Change::default());
        let motions = portion.motions;
        let joints = self.joints.row(portion.index);
        let component = self.components[portion.index];
        let last = joints.iter().rposition(|&j| !motions.is_still_in(component, usize::from(j)));
        self.start(simd, portion, &mut rows);
        let mut before = moved_volume(motions.palette.alone(self.above(portion)), portion.moment);
        for (stage, change) in changes.iter_mut().enumerate().take(last.map_or(0, |last| last + 1)) {
            let joint = usize::from(joints[stage]);
            if motions.is_still_in(component, joint) {
                continue;
            }
            let mut stretched = before;
            if let Some(motion) = motions.intent(component, joint) {
                self.add(simd, portion, stage, motion, &mut rows);
                place_all(simd, portion, &rows, positions.as_mut());
                stretched = volume(positions);
                self.start(simd, portion, &mut rows);
                for (earlier, &joint) in joints[..stage].iter().enumerate() {
                    self.add(simd, portion, earlier, usize::from(joint), &mut rows);
                }
            }
            self.add(simd, portion, stage, joint, &mut rows);
            *change = Change { intent: stretched - before, loss: stretched };
            if Some(stage) != last {
                place_all(simd, portion, &rows, positions.as_mut());
                before = volume(positions);
                change.loss -= before;
            }
        }
        place_all(simd, portion, &rows, positions.as_mut());
        last
    }

    /// Index of the motion of a portion before any of its joints turns.
    #[inline(always)]
    fn above(&self, portion: Portion) -> usize {
        portion.motions.whole(self.components[portion.index], usize::from(self.tops[portion.index]))
    }

    /// All points as what is above leaves them.
    #[inline(always)]
    fn start<S: Simd>(&self, simd: S, portion: Portion, rows: &mut Rows) {
        let palette = &portion.motions.palette;
        let top = self.above(portion);
        let count = portion.slots.len();
        if palette.mode == Mode::Linear {
            if portion.shaped_rest.is_some() {
                self.put_at_rest(portion, rows);
            }
            let m = palette.alone(top);
            let moved = Eightfold::new(simd, |column, axis| m[column][axis]);
            let places = self.places(portion, &rows.place);
            let [qx, qy, qz] = blocks_of(&mut rows.blend);
            for number in 0..count.div_ceil(LANES) {
                let [x, y, z] = moved.of(simd, places, number);
                (qx[number], qy[number], qz[number]) = (x.into(), y.into(), z.into());
            }
            return;
        }
        self.put_at_rest(portion, rows);
        let [x, y, z] = rows.place.each_mut().map(|row| &mut row[..count]);
        let m = palette.armature_columns();
        for i in 0..count {
            let p = [x[i], y[i], z[i]];
            // As `lanes::transform`, for many points side by side.
            [x[i], y[i], z[i]] = std::array::from_fn(|axis| m[3][axis] + m[0][axis] * p[0] + m[1][axis] * p[1] + m[2][axis] * p[2]);
        }
        let motion = palette.dual(top);
        for (row, value) in rows.blend.iter_mut().zip(motion.rotation) {
            row[..count].fill(value);
        }
        rows.dual.iter_mut().for_each(|row| row[..count].fill(0.0));
        add_dual(simd, rows, &|| (0..count.div_ceil(LANES)).map(|number| (number, &[1.0; LANES])), motion.dual, motion.has_scale);
    }

    /// What joints turn about: for linear skinning the points at rest, as they are kept where no shape key changes them.
    #[inline(always)]
    fn places<'a>(&'a self, portion: Portion, place: &'a [&mut [f64]; 3]) -> [&'a [Block<f64>]; 3] {
        let is_kept = portion.motions.palette.mode == Mode::Linear && portion.shaped_rest.is_none();
        let rows = if is_kept { self.rest_of(portion.index) } else { place.each_ref().map(|row| &**row) };
        rows.map(|row| row.as_chunks().0)
    }

    /// Eight points of a portion where they rest, if no shape key moves them.
    #[inline(always)]
    pub fn rest(&self, portion: usize, number: usize) -> [&Block<f64>; 3] {
        self.rest_of(portion).map(|row| &row.as_chunks().0[number])
    }

    #[inline(always)]
    fn rest_of(&self, portion: usize) -> [&[f64]; 3] {
        let rest = &self.rest[self.rest_offsets[portion] as usize..self.rest_offsets[portion + 1] as usize];
        let (x, yz) = rest.split_at(rest.len() / 3);
        let (y, z) = yz.split_at(yz.len() / 2);
        [x, y, z]
    }

    #[inline(always)]
    fn put_at_rest(&self, portion: Portion, rows: &mut Rows) {
        let count = portion.slots.len();
        if let Some(rest) = portion.shaped_rest {
            for (i, &slot) in portion.slots.iter().enumerate() {
                let p = portion.sites.mean(slot as usize, |site| rest[site]);
                rows.place.iter_mut().zip(p).for_each(|(row, p)| row[i] = p);
            }
            return;
        }
        for (row, rest) in rows.place.iter_mut().zip(self.rest_of(portion.index)) {
            row[..count].copy_from_slice(&rest[..count]);
        }
    }

    /// Lets a joint follow `motion` where it followed its parent.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, portion: Portion, stage: usize, motion: usize, rows: &mut Rows) {
        let palette = &portion.motions.palette;
        let parent = portion.motions.above(self.components[portion.index], usize::from(self.joints.row(portion.index)[stage]));
        let stretches = portion.slots.len().div_ceil(PATCH_POINTS);
        let first_row = self.first_rows[portion.index] as usize + stage * stretches;
        for stretch in 0..stretches {
            let (present, parts) = self.weights.row(first_row + stretch);
            let first = stretch * (PATCH_POINTS / LANES);
            let blocks = || present.numbered(parts).map(|(number, part)| (first + number, part));
            if palette.mode == Mode::Linear {
                let (to, from) = (palette.alone(motion), palette.alone(parent));
                let turned = Eightfold::new(simd, |column, axis| to[column][axis] - from[column][axis]);
                let places = self.places(portion, &rows.place);
                let [qx, qy, qz] = blocks_of(&mut rows.blend);
                for (number, part) in blocks() {
                    let [x, y, z] = turned.of(simd, places, number);
                    add_parts(simd, &mut qx[number], part, x);
                    add_parts(simd, &mut qy[number], part, y);
                    add_parts(simd, &mut qz[number], part, z);
                }
                continue;
            }
            let (to, from) = (palette.dual(motion), palette.dual(parent));
            let turned = sub(to.rotation, from.rotation);
            for (row, turned) in rows.blend.iter_mut().zip(turned) {
                let (row, _) = row.as_chunks_mut();
                for (number, part) in blocks() {
                    add_parts(simd, &mut row[number], part, f64x8::splat(simd, turned));
                }
            }
            let dual = std::array::from_fn(|i| sub(to.dual[i], from.dual[i]));
            add_dual(simd, rows, &blocks, dual, to.has_scale || from.has_scale);
        }
    }
}

/// An affine map of eight points side by side.
struct Eightfold<S: Simd> {
    x: [f64x8<S>; 4],
    y: [f64x8<S>; 4],
    z: [f64x8<S>; 4],
}

impl<S: Simd> Eightfold<S> {
    /// `at`: number in a column, of an axis.
    #[inline(always)]
    fn new(simd: S, at: impl Fn(usize, usize) -> f64) -> Self {
        let of = |axis: usize| [0, 1, 2, 3].map(|column| at(column, axis));
        let ([xa, xb, xc, xd], [ya, yb, yc, yd], [za, zb, zc, zd]) = (of(0), of(1), of(2));
        let all = |value: f64| f64x8::splat(simd, value);
        Self { x: [all(xa), all(xb), all(xc), all(xd)], y: [all(ya), all(yb), all(yc), all(yd)], z: [all(za), all(zb), all(zc), all(zd)] }
    }

    /// Images of the points of a block, one coordinate in each.
    #[inline(always)]
    fn of(&self, simd: S, [x, y, z]: [&[Block<f64>]; 3], number: usize) -> [f64x8<S>; 3] {
        let (x, y) = (f64x8::simd_from(simd, x[number]), f64x8::simd_from(simd, y[number]));
        let z = f64x8::simd_from(simd, z[number]);
        [
            self.x[0] * x + self.x[1] * y + self.x[2] * z + self.x[3],
            self.y[0] * x + self.y[1] * y + self.y[2] * z + self.y[3],
            self.z[0] * x + self.z[1] * y + self.z[2] * z + self.z[3],
        ]
    }
}

/// Adds parts of a dual quaternion's dual part at each point.
#[inline(always)]
fn add_dual<'a, S: Simd, I: Iterator<Item = (usize, &'a Block<f64>)>>(
    simd: S,
    rows: &mut Rows,
    blocks: &impl Fn() -> I,
    dual: [V4; 4],
    has_scale: bool,
) {
    let [x, y, z] = rows.place.each_ref().map(|row| row.as_chunks::<LANES>().0);
    for (lane, row) in rows.dual.iter_mut().enumerate() {
        let at = |column: usize| f64x8::splat(simd, dual[column][lane]);
        let (d, a, b, c) = (at(0), at(1), at(2), at(3));
        let (row, _) = row.as_chunks_mut();
        if has_scale {
            for (number, part) in blocks() {
                let (x, y) = (f64x8::simd_from(simd, x[number]), f64x8::simd_from(simd, y[number]));
                add_parts(simd, &mut row[number], part, a * x + b * y + c * f64x8::simd_from(simd, z[number]) + d);
            }
        } else {
            for (number, part) in blocks() {
                add_parts(simd, &mut row[number], part, d);
            }
        }
    }
}

#[inline(always)]
fn add_parts<S: Simd>(simd: S, sums: &mut Block<f64>, parts: &Block<f64>, of: f64x8<S>) {
    *sums = (f64x8::simd_from(simd, *sums) + f64x8::simd_from(simd, *parts) * of).into();
}

/// Positions of all points, armature space − origin; of whole blocks, those beyond the last point mean nothing.
#[inline(always)]
fn place_all<S: Simd>(simd: S, portion: Portion, rows: &Rows, positions: &mut [V4]) {
    let palette = &portion.motions.palette;
    let is_linear = palette.mode == Mode::Linear;
    let origin = lanes::from(palette.origin);
    for (number, eight) in positions.as_chunks_mut::<LANES>().0.iter_mut().take(portion.slots.len().div_ceil(LANES)).enumerate() {
        let [bx, by, bz, bw] = rows.blend.each_ref().map(|row| block(row, number));
        if is_linear {
            put_rows(simd, [bx, by, bz], eight);
            continue;
        }
        let [x, y, z] = rows.place.each_ref().map(|row| block(row, number));
        let [dx, dy, dz, dw] = rows.dual.each_ref().map(|row| block(row, number));
        let mut q = [[0.0; LANES]; 3];
        for i in 0..LANES {
            // As `dual_quaternion::transform`, written out for many points side by side.
            let vector_squared = bx[i] * bx[i] + by[i] * by[i] + bz[i] * bz[i];
            let length_squared = vector_squared + bw[i] * bw[i];
            let inverse = if length_squared == 0.0 { 0.0 } else { 1.0 / length_squared };
            let kept = if length_squared == 0.0 { 1.0 } else { (bw[i] * bw[i] - vector_squared) * inverse };
            let twice = 2.0 * inverse;
            let along = bx[i] * x[i] + by[i] * y[i] + bz[i] * z[i] - dw[i];
            let turned = |v: f64, t: f64, v_cross_p: f64, v_cross_t: f64| v * along + bw[i] * (v_cross_p + t) + v_cross_t;
            q[0][i] = x[i] * kept + twice * turned(bx[i], dx[i], by[i] * z[i] - bz[i] * y[i], by[i] * dz[i] - bz[i] * dy[i]) - origin[0];
            q[1][i] = y[i] * kept + twice * turned(by[i], dy[i], bz[i] * x[i] - bx[i] * z[i], bz[i] * dx[i] - bx[i] * dz[i]) - origin[1];
            q[2][i] = z[i] * kept + twice * turned(bz[i], dz[i], bx[i] * y[i] - by[i] * x[i], bx[i] * dy[i] - by[i] * dx[i]) - origin[2];
        }
        put_rows(simd, [&q[0], &q[1], &q[2]], eight);
    }
    if is_linear {
        return;
    }
    let influences = &portion.sites.influences;
    if !influences.mask.is_empty() {
        for (i, (q, &slot)) in positions.iter_mut().zip(portion.slots).enumerate() {
            let still = sub([rows.place[0][i], rows.place[1][i], rows.place[2][i], 0.0], origin);
            let mask = portion.sites.of_slot(slot as usize).map(|site| portion.sites.share(site) * influences.mask(site)).sum();
            *q = add_scaled(still, sub(*q, still), mask);
        }
    }
}

#[inline(always)]
fn block<'a>(row: &'a &mut [f64], number: usize) -> &'a Block<f64> {
    &row.as_chunks().0[number]
}

/// Blocks of the first three rows.
#[inline(always)]
fn blocks_of<'a>([x, y, z, _]: &'a mut [&mut [f64]; 4]) -> [&'a mut [Block<f64>]; 3] {
    [x, y, z].map(|row| row.as_chunks_mut().0)
}

#[inline(always)]
fn put_rows<S: Simd>(simd: S, [x, y, z]: [&Block<f64>; 3], rows: &mut [V4; LANES]) {
    for (half, [a, b, c, d]) in rows.as_chunks_mut().0.iter_mut().enumerate() {
        let four = |row: &Block<f64>| row.as_chunks().0[half];
        let [to_a, to_b, to_c, to_d] = Four::of_coordinates(simd, [&four(x), &four(y), &four(z)]).rows(simd);
        (*a, *b, *c, *d) = (to_a.into(), to_b.into(), to_c.into(), to_d.into());
    }
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
