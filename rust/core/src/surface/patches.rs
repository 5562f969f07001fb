//! A surface in patches: faces that lie together, each patch with its own short list of points. The unit of all sweeps.
//!
//! Every point is *owned* by the first patch that uses it and has a *slot*: owned points of a patch are neighbours in
//! memory, padded to whole lanes. A patch sees its owned points and a few *foreign* ones of other patches, all by one byte.
//! Sums are taken per patch and then in patch order, so that no bit of a result depends on the number of threads.

use std::ops::Range;

use glam::DVec3;

use crate::numeric::block_rows::{LANES, PATCH_POINTS};
use crate::numeric::csr::Csr;
use crate::surface::strips::{Rung, strips};
use crate::surface::topology::Topology;

/// A patch this full ends where the next faces hang on another joint.
const FULL_ENOUGH: usize = 160;
/// A vertex of no sound shell.
pub(crate) const NO_SLOT: u32 = u32::MAX;

/// Three coordinates of the points of one patch.
pub(crate) type Rows<'a> = [&'a [f32]; 3];

/// Faces of one component that share a list of points.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    pub component: u32,
    /// Points that the patch owns: the first of its padded slots.
    pub owned: usize,
    /// Owned points that other patches or giants use too: the first of these.
    pub shared: usize,
    /// First slot.
    pub start: usize,
    /// Slots of owned points, then of foreign ones: `local` of `Patches`.
    pub local: Range<usize>,
    pub triangles: Range<usize>,
    pub strips: Range<usize>,
    pub polygons: Range<usize>,
}

/// A face with more corners than a patch has room for: a huge cap.
#[derive(Debug, Clone)]
pub(crate) struct Giant {
    pub component: u32,
    /// Slots of its corners, in order.
    pub corners: Vec<u32>,
}

/// What a point gets from another patch: its place among the owner's points, and where the other patch left it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Import {
    pub owned: u8,
    /// Index into what patches leave for each other: shared and foreign points of each, then corners of giants.
    pub source: u32,
}

/// All faces of the sound components of a mesh.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patches {
    pub list: Vec<Patch>,
    /// Per patch and one past the last: first slot.
    pub slot_offsets: Vec<u32>,
    /// Per patch and one past the last: where it leaves values of shared points, then of foreign ones.
    pub source_offsets: Vec<u32>,
    /// Offsets of one row per patch, and of none.
    pub numbers: Vec<u32>,
    pub no_rows: Vec<u32>,
    /// Slot of each local point, patch after patch.
    pub local: Vec<u32>,
    /// Four at a time, corner by corner; the last of a patch are filled up with faces of one point.
    pub triangles: Vec<[[u8; 4]; 3]>,
    /// All quads.
    pub strips: Csr<Rung>,
    pub polygons: Csr<u8>,
    pub giants: Vec<Giant>,
    /// Per patch.
    pub imports: Csr<Import>,
    /// Slot of each point; `NO_SLOT` for one of no sound component.
    pub slot_of_point: Vec<u32>,
}

impl Patches {
    /// `places`: positions per point, for nearness. `keys`: per face, what it hangs on; equal keys go together. `point_keys`:
    /// per point, what moves it; the points of a patch lie in their order.
    pub fn new(topology: &Topology, keys: &[u32], point_keys: &[u32], places: &[DVec3]) -> Self {
        let code = morton_coder(places);
        let mut order: Vec<(u32, u32, u64, u32)> = topology
            .faces
            .rows()
            .enumerate()
            .map(|(index, corners)| {
                let mean = corners.iter().map(|&p| places[p as usize]).sum::<DVec3>() / corners.len() as f64;
                (topology.component_of_face[index], keys[index], code(mean), index as u32)
            })
            .collect();
        order.sort_unstable();
        let mut builder = Builder::new(places.len());
        let mut giants: Vec<(u32, u32)> = Vec::new();
        let mut open: Option<(u32, u32)> = None;
        for (component, key, _, index) in order {
            let corners = topology.faces.row(index as usize);
            if corners.len() > PATCH_POINTS {
                giants.push((component, index));
                continue;
            }
            if let Some((old_component, old_key)) = open {
                let ends = old_component != component || (old_key != key && builder.points.len() >= FULL_ENOUGH);
                if ends || !builder.has_room(corners) {
                    builder.close(old_component);
                }
            }
            builder.add(corners);
            open = Some((component, key));
        }
        if let Some((component, _)) = open {
            builder.close(component);
        }
        for &(component, index) in &giants {
            builder.own_points(component, topology.faces.row(index as usize));
        }
        let mut result = builder.result;
        result.slot_offsets.push(result.padded_end() as u32);
        result.put_shared_first(point_keys, &giants.iter().flat_map(|g| topology.faces.row(g.1 as usize)).copied().collect::<Vec<u32>>());
        for slot in &mut result.local {
            *slot = result.slot_of_point[*slot as usize];
        }
        for (component, index) in giants {
            let corners = topology.faces.row(index as usize).iter().map(|&p| result.slot_of_point[p as usize]).collect();
            result.giants.push(Giant { component, corners });
        }
        result.imports = result.find_imports();
        result.numbers = (0..=result.list.len() as u32).collect();
        result.no_rows = vec![0; result.list.len() + 1];
        result
    }

    /// Slots with their padding.
    pub fn slot_count(&self) -> usize {
        self.slot_offsets.last().map_or(0, |&end| end as usize)
    }

    /// Component of the point in a slot.
    pub fn component_of_slot(&self, slot: usize) -> u32 {
        self.list[self.slot_offsets.partition_point(|&start| start as usize <= slot) - 1].component
    }

    /// Values that patches leave for each other.
    pub fn patch_source_count(&self) -> usize {
        self.source_offsets.last().map_or(0, |&end| end as usize)
    }

    /// The same and corners of giants.
    pub fn source_count(&self) -> usize {
        self.patch_source_count() + self.giants.iter().map(|g| g.corners.len()).sum::<usize>()
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.list)
            + size_of_val(&*self.local)
            + size_of_val(&*self.triangles)
            + self.strips.memory_bytes()
            + self.polygons.memory_bytes()
            + self.giants.iter().map(|g| size_of_val(&*g.corners)).sum::<usize>()
            + self.imports.memory_bytes()
            + size_of_val(&*self.slot_of_point)
    }

    fn padded_end(&self) -> usize {
        self.list.last().map_or(0, |p| p.start + p.owned.next_multiple_of(LANES))
    }

    /// Renumbers the points that each patch owns. `local` still holds points, those of giants are `elsewhere` too.
    fn put_shared_first(&mut self, keys: &[u32], elsewhere: &[u32]) {
        let mut is_shared = vec![false; self.slot_of_point.len()];
        for patch in &self.list {
            for &point in &self.local[patch.local.start + patch.owned..patch.local.end] {
                is_shared[point as usize] = true;
            }
        }
        for &point in elsewhere {
            is_shared[point as usize] = true;
        }
        self.source_offsets.push(0);
        for patch in &mut self.list {
            let owned = &mut self.local[patch.local.start..patch.local.start + patch.owned];
            let mut order: Vec<u32> = (0..patch.owned as u32).collect();
            // By number where keys are equal: vertices that follow one another read neighbours in memory.
            order.sort_by_key(|&place| {
                let point = owned[place as usize];
                (!is_shared[point as usize], keys[point as usize], point)
            });
            patch.shared = owned.iter().filter(|&&point| is_shared[point as usize]).count();
            let mut renumbered: [u8; PATCH_POINTS] = std::array::from_fn(|place| place as u8);
            for (new, &old) in order.iter().enumerate() {
                renumbered[old as usize] = new as u8;
            }
            let points: Vec<u32> = order.iter().map(|&old| owned[old as usize]).collect();
            owned.copy_from_slice(&points);
            for (new, &point) in points.iter().enumerate() {
                self.slot_of_point[point as usize] = (patch.start + new) as u32;
            }
            let renumber = |corner: &mut u8| *corner = renumbered[usize::from(*corner)];
            self.triangles[patch.triangles.clone()].as_flattened_mut().as_flattened_mut().iter_mut().for_each(renumber);
            self.strips.rows_mut(patch.strips.clone()).as_flattened_mut().as_flattened_mut().iter_mut().for_each(renumber);
            self.polygons.rows_mut(patch.polygons.clone()).iter_mut().for_each(renumber);
            let end = self.source_offsets[self.source_offsets.len() - 1] as usize + patch.shared + patch.local.len() - patch.owned;
            self.source_offsets.push(end as u32);
        }
    }

    fn find_imports(&self) -> Csr<Import> {
        let mut pairs = Vec::new();
        let mut import = |slot: u32, source: usize| {
            let patch = self.slot_offsets.partition_point(|&start| start <= slot) - 1;
            let owned = (slot - self.slot_offsets[patch]) as u8;
            pairs.push((patch as u32, Import { owned, source: source as u32 }));
        };
        for (patch, &first) in self.list.iter().zip(&self.source_offsets) {
            for (place, &slot) in self.local[patch.local.start + patch.owned..patch.local.end].iter().enumerate() {
                import(slot, first as usize + patch.shared + place);
            }
        }
        let mut source = self.patch_source_count();
        for giant in &self.giants {
            for &corner in &giant.corners {
                import(corner, source);
                source += 1;
            }
        }
        Csr::from_pairs(self.list.len(), &pairs)
    }
}

/// Patches while they are being filled. Points stand for slots until all have one.
struct Builder {
    result: Patches,
    generation: u32,
    /// Per point: the generation that last used it, and its place then.
    place_of_point: Vec<(u32, u16)>,
    points: Vec<u32>,
    faces: Vec<Vec<u16>>,
}

impl Builder {
    fn new(point_count: usize) -> Self {
        Self {
            result: Patches { slot_of_point: vec![NO_SLOT; point_count], ..Patches::default() },
            generation: 1,
            place_of_point: vec![(0, 0); point_count],
            points: Vec::new(),
            faces: Vec::new(),
        }
    }

    fn has_room(&self, corners: &[u32]) -> bool {
        let new = corners.iter().filter(|&&p| self.place_of_point[p as usize].0 != self.generation).count();
        self.points.len() + new <= PATCH_POINTS
    }

    fn add(&mut self, corners: &[u32]) {
        let face = corners
            .iter()
            .map(|&point| {
                let known = &mut self.place_of_point[point as usize];
                if known.0 != self.generation {
                    *known = (self.generation, self.points.len() as u16);
                    self.points.push(point);
                }
                known.1
            })
            .collect();
        self.faces.push(face);
    }

    /// Ends a patch: owned points first, then foreign ones.
    fn close(&mut self, component: u32) {
        let result = &mut self.result;
        let start = result.padded_end();
        let is_owned: Vec<bool> = self.points.iter().map(|&p| result.slot_of_point[p as usize] == NO_SLOT).collect();
        let owned = is_owned.iter().filter(|o| **o).count();
        let (mut next_owned, mut next_foreign) = (0, owned);
        let first_local = result.local.len();
        result.local.resize(first_local + self.points.len(), 0);
        let mut renumbered = vec![0u8; self.points.len()];
        for (place, &point) in self.points.iter().enumerate() {
            let next = if is_owned[place] { &mut next_owned } else { &mut next_foreign };
            if is_owned[place] {
                result.slot_of_point[point as usize] = (start + *next) as u32;
            }
            renumbered[place] = *next as u8;
            result.local[first_local + *next] = point;
            *next += 1;
        }
        let (triangles, first_strip, polygons) = (result.triangles.len(), result.strips.len(), result.polygons.len());
        let (mut three, mut four) = (Vec::new(), Vec::new());
        for face in self.faces.drain(..) {
            match *face {
                [a, b, c] => three.push([a, b, c].map(|p| renumbered[p as usize])),
                [a, b, c, d] => four.push([a, b, c, d].map(|p| renumbered[p as usize])),
                _ => result.polygons.push_row(face.iter().map(|&p| renumbered[p as usize])),
            }
        }
        result.triangles.extend(by_fours(&three));
        for strip in strips(&four) {
            result.strips.push_row(strip);
        }
        result.slot_offsets.push(start as u32);
        result.list.push(Patch {
            component,
            owned,
            shared: 0,
            start,
            local: first_local..result.local.len(),
            triangles: triangles..result.triangles.len(),
            strips: first_strip..result.strips.len(),
            polygons: polygons..result.polygons.len(),
        });
        self.points.clear();
        self.generation += 1;
    }

    /// Patches without faces for points that only giants use.
    fn own_points(&mut self, component: u32, points: &[u32]) {
        let mut free: Vec<u32> = points.iter().copied().filter(|&p| self.result.slot_of_point[p as usize] == NO_SLOT).collect();
        free.sort_unstable();
        free.dedup();
        for run in free.chunks(PATCH_POINTS) {
            self.points.extend_from_slice(run);
            self.close(component);
        }
    }
}

/// Faces four at a time, corner by corner.
fn by_fours<const N: usize>(faces: &[[u8; N]]) -> impl Iterator<Item = [[u8; 4]; N]> {
    faces.chunks(4).map(|four| std::array::from_fn(|corner| std::array::from_fn(|lane| four.get(lane).map_or(0, |face| face[corner]))))
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
