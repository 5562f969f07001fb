//! Values of voxels at any place, continuous in it.
//!
//! A place sees the voxels that are at most one voxel farther than its nearest one, with weights that fall smoothly to 0
//! there: it is defined everywhere, also outside of the solid, where it follows the nearest surface.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use rayon::prelude::*;

use super::sheets::EVERYTHING;
use super::voxels::{NONE, Voxels};
use crate::numeric::csr::Csr;

/// How much farther than the nearest one a voxel may be, in voxels.
const REACH: f64 = 1.0;
/// Half of the window of cells about a place, which is searched first.
const NEAR: i64 = 2;
/// Cells of a window, along an axis and in all.
const WIDTH: usize = 2 * NEAR as usize + 1;
const CELLS: usize = WIDTH.pow(3);
/// No voxel outside of that window is nearer.
const CERTAIN: f64 = NEAR as f64 + 0.5;
/// Edge of a block of cells, by which voxels far away are searched.
const BLOCK: u16 = 8;
/// Places per parallel piece.
const CHUNK: usize = 1024;

/// Finds what places see of the voxels of some parts.
pub struct Sampler<'a> {
    voxels: &'a Voxels,
    is_source: &'a [bool],
    /// Per voxel the distance to the nearest bone.
    nearest: &'a [f32],
    /// Voxels by block, with the low corner of each block.
    blocks: Vec<(DVec3, Vec<u32>)>,
}

impl<'a> Sampler<'a> {
    /// `is_source` says which parts of the voxels are seen. Of solids in one place a point sees its own, and otherwise the
    /// one that is `nearest` to a bone.
    pub fn new(voxels: &'a Voxels, is_source: &'a [bool], nearest: &'a [f32]) -> Self {
        let mut keyed: Vec<([u16; 3], u32)> = (0..voxels.len() as u32)
            .filter(|&voxel| is_source[voxels.part[voxel as usize] as usize])
            .map(|voxel| (voxels.cells[voxel as usize].map(|c| c / BLOCK), voxel))
            .collect();
        keyed.sort_unstable();
        let blocks = keyed
            .chunk_by(|a, b| a.0 == b.0)
            .map(|run| (DVec3::from_array(run[0].0.map(|c| f64::from(c * BLOCK))), run.iter().map(|v| v.1).collect()))
            .collect();
        Self { voxels, is_source, nearest, blocks }
    }

    /// Voxels and weights that sum to 1, per place and who looks from there. There must be a voxel to be seen.
    pub fn rows(&self, places: &[DVec3], viewers: &[u32]) -> Csr<(u32, f32)> {
        let row = |(&p, &viewer): (&DVec3, &u32)| self.row(p, viewer);
        let pieces: Vec<Vec<Vec<(u32, f32)>>> = places
            .par_chunks(CHUNK)
            .zip(viewers.par_chunks(CHUNK))
            .map(|(places, viewers)| places.iter().zip(viewers).map(row).collect())
            .collect();
        let mut rows = Csr::default();
        for row in pieces.into_iter().flatten() {
            rows.push_row(row);
        }
        rows
    }

    fn row(&self, p: DVec3, viewer: u32) -> Vec<(u32, f32)> {
        let mut seen = self.window(p, viewer).unwrap_or_else(|| self.search(p, viewer));
        if seen.is_empty() {
            // No bone reaches what the point is of.
            seen = self.search(p, EVERYTHING);
        }
        let least = seen.iter().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min);
        let weight = |distance: f64| (1.0 - (distance - least) / REACH).powi(2);
        let sum: f64 = seen.iter().map(|(_, distance)| weight(*distance)).sum();
        seen.into_iter().map(|(voxel, distance)| (voxel, (weight(distance) / sum) as f32)).collect()
    }

    fn is_seen(&self, node: u32, viewer: u32) -> bool {
        self.is_source[self.voxels.part[node as usize] as usize] && self.voxels.is_seen(node, viewer)
    }

    /// What of a voxel is seen.
    #[inline]
    fn node(&self, voxel: u32, viewer: u32) -> u32 {
        if self.voxels.sheets.is_none() {
            return if voxel != NONE && self.is_seen(voxel, viewer) { voxel } else { NONE };
        }
        let distance = |&node: &u32| self.nearest[node as usize];
        let seen = self.voxels.nodes_in(voxel).filter(|&node| self.is_seen(node, viewer));
        seen.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(NONE)
    }

    /// What a place sees, if the cells about it are enough to tell.
    fn window(&self, p: DVec3, viewer: u32) -> Option<Vec<(u32, f64)>> {
        let middle = p.floor().to_array().map(|x| x as i64);
        let mut cells = [(NONE, f64::INFINITY); CELLS];
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (index, cell) in cells.iter_mut().enumerate() {
            let at = [index % WIDTH, index / WIDTH % WIDTH, index / WIDTH / WIDTH];
            let voxel = self.node(self.voxels.at([0, 1, 2].map(|i| middle[i] + at[i] as i64 - NEAR)), viewer);
            if voxel != NONE {
                *cell = (voxel, self.voxels.centre(voxel).distance(p));
                if cell.1 < least {
                    (nearest, least) = (index, cell.1);
                }
            }
        }
        (least + REACH <= CERTAIN).then(|| {
            let in_reach = (0..CELLS).filter(|&i| cells[i].1 < least + REACH).fold(0, |bits, i| bits | 1 << i);
            if self.voxels.sheets.is_some() {
                let mut seen = (0..CELLS).filter(|&i| in_reach >> i & 1 == 1).map(|i| cells[i]).collect();
                self.keep_this_side(&mut seen);
                return seen;
            }
            let here = connected(1 << nearest, in_reach);
            (0..CELLS).filter(|&i| here >> i & 1 == 1).map(|i| cells[i]).collect()
        })
    }

    /// Voxels that may be at most `REACH` farther than the nearest one, wherever that is.
    fn search(&self, p: DVec3, viewer: u32) -> Vec<(u32, f64)> {
        let to_block = |low: DVec3| p.distance(p.clamp(low + 0.5, low + (f64::from(BLOCK) - 0.5)));
        // Few are looked at: no need to sort the rest. Numbers of 0 and more are in the order of their bits.
        let mut ahead: BinaryHeap<Reverse<(u64, usize)>> =
            self.blocks.iter().enumerate().map(|(i, block)| Reverse((to_block(block.0).to_bits(), i))).collect();
        let (mut least, mut seen) = (f64::INFINITY, Vec::new());
        while let Some(Reverse((_, block))) = ahead.pop().filter(|next| f64::from_bits(next.0.0) <= least + REACH) {
            for &voxel in self.blocks[block].1.iter().filter(|&&voxel| self.voxels.is_seen(voxel, viewer)) {
                let distance = self.voxels.centre(voxel).distance(p);
                if distance < least + REACH {
                    least = least.min(distance);
                    seen.push((voxel, distance));
                }
            }
        }
        seen.retain(|(_, distance)| *distance < least + REACH);
        self.keep_this_side(&mut seen);
        seen
    }

    /// Drops voxels that hang together with the nearest one only by others that are not seen: those across a gap.
    fn keep_this_side(&self, seen: &mut Vec<(u32, f64)>) {
        seen.sort_unstable_by_key(|(voxel, _)| *voxel);
        let Some(&(nearest, _)) = seen.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        let position = |voxel: u32, seen: &[(u32, f64)]| seen.binary_search_by_key(&voxel, |(v, _)| *v).ok();
        let mut is_here = vec![false; seen.len()];
        let mut open: Vec<u32> = vec![nearest];
        while let Some(voxel) = open.pop() {
            let Some(index) = position(voxel, seen) else { continue };
            if !std::mem::replace(&mut is_here[index], true) {
                let neighbours = &self.voxels.neighbours[voxel as usize];
                open.extend(neighbours.iter().filter(|&&n| n != NONE));
            }
        }
        let mut here = is_here.into_iter();
        seen.retain(|_| here.next().unwrap_or(false));
    }
}

/// Bits of a window of cells that hang together with `start` by bits of `allowed`, across faces, edges and corners.
fn connected(start: u128, allowed: u128) -> u128 {
    let mut found = start;
    loop {
        let mut grown = found;
        for (stride, [first, last]) in BORDERS {
            grown |= (grown << stride & !first) | (grown >> stride & !last);
        }
        grown &= allowed;
        if grown == found {
            return found;
        }
        found = grown;
    }
}

/// Per axis the distance of neighbouring cells in a window, and the cells of its first and last layer.
const BORDERS: [(usize, [u128; 2]); 3] = borders();

const fn borders() -> [(usize, [u128; 2]); 3] {
    let mut borders = [(1, [0; 2]), (WIDTH, [0; 2]), (WIDTH * WIDTH, [0; 2])];
    let mut axis = 0;
    while axis < 3 {
        let mut cell = 0;
        while cell < CELLS {
            let layer = cell / borders[axis].0 % WIDTH;
            if layer == 0 {
                borders[axis].1[0] |= 1 << cell;
            }
            if layer == WIDTH - 1 {
                borders[axis].1[1] |= 1 << cell;
            }
            cell += 1;
        }
        axis += 1;
    }
    borders
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two slabs, one voxel thick, with `gap` empty layers between them.
    fn slabs(gap: usize) -> Voxels {
        let dims = [9, 9, gap + 6];
        let cells = (0..81 * dims[2]).filter(|i| [2, 3 + gap].contains(&(i / 81))).map(|i| i as u32);
        Voxels::new(dims, &[cells.collect()])
    }

    fn rows(voxels: &Voxels, is_source: &[bool], places: &[DVec3]) -> Csr<(u32, f32)> {
        Sampler::new(voxels, is_source, &vec![0.0; voxels.len()]).rows(places, &vec![EVERYTHING; places.len()])
    }

    fn values(rows: &Csr<(u32, f32)>, voxels: &Voxels, of: impl Fn(DVec3) -> f64) -> Vec<f64> {
        rows.rows().map(|row| row.iter().map(|&(voxel, weight)| f64::from(weight) * of(voxels.centre(voxel))).sum()).collect()
    }

    #[test]
    fn values_are_continuous_from_inside_to_far_away() {
        let voxels = slabs(20);
        let places: Vec<DVec3> = (0..4000).map(|i| DVec3::new(3.0 + 2e-3 * f64::from(i), 4.3, 2.4 - 1e-3 * f64::from(i))).collect();
        let rows = rows(&voxels, &[true, true], &places);
        let found = values(&rows, &voxels, |p| p.x);
        assert!(found.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02));
        assert!(rows.rows().all(|row| (row.iter().map(|w| w.1).sum::<f32>() - 1.0).abs() < 1e-5));
    }

    #[test]
    fn a_place_at_a_narrow_gap_sees_its_own_side_only() {
        let voxels = slabs(1);
        let places = [DVec3::new(4.4, 4.6, 3.3), DVec3::new(4.4, 4.6, 3.7)];
        let found = values(&rows(&voxels, &[true, true], &places), &voxels, |p| p.z);
        assert_eq!(found.iter().map(|z| z.round()).collect::<Vec<_>>(), [3.0, 5.0]);
    }

    #[test]
    fn parts_that_are_no_source_are_not_seen() {
        let voxels = slabs(1);
        let found = values(&rows(&voxels, &[false, true], &[DVec3::new(4.4, 4.6, 2.1)]), &voxels, |p| p.z);
        assert!((found[0] - 4.5).abs() < 1e-6);
    }
}
