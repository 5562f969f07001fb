//! Whether two shells that overlap are one solid, or two that pass through each other.
//!
//! They are two where each has bones of its own and no bones lead there from one into the other: a hand in a thigh is not
//! part of it, an arm that is stuck into a trunk is where its bones come out of the trunk. Less than a quarter of a bone
//! does not count: it does not matter where exactly bones end, or how far they stick out of their skin.

use super::bone_paths::{BonePaths, NO_BONE};
use super::voxels::{NONE, Voxels};
use crate::numeric::csr::Csr;
use crate::numeric::union_find::UnionFind;

/// A shell has a bone of its own where this part of it, or more, is only in that shell.
const OWN: f64 = 0.25;
/// Samples of a gap that bones lead across all the same: two voxels.
const GAP: usize = 4;

/// Samples that are only in the first shell, only in the second, in both or on the way, elsewhere.
const FIRST: u8 = 0;
const SECOND: u8 = 1;
const BETWEEN: u8 = 2;
const ELSEWHERE: u8 = 3;

/// Two shells that are not one solid, at least not everywhere.
pub struct Passing {
    pub shells: [u32; 2],
    /// Connected voxels of the overlap in which they pass through each other.
    pub apart: Vec<Vec<u32>>,
    /// Per shell the bones of the other, which do not hold it.
    pub strangers: [Vec<u32>; 2],
}

/// What shells and samples share: shells per voxel, voxel per sample.
pub struct Scene<'a> {
    pub voxels: &'a Voxels,
    pub shells_of_voxel: &'a Csr<u32>,
    pub paths: &'a BonePaths,
    pub voxel_of_sample: &'a [u32],
}

impl Scene<'_> {
    /// Two shells that touch, with the voxels of both, sorted; None where they are one as they stand.
    pub fn passing(&self, shells: [u32; 2], both: &[u32]) -> Option<Passing> {
        let classes = self.classes(shells)?;
        let BonePaths { places, bones, ties, .. } = self.paths;
        let mut runs = UnionFind::new(places.len());
        for &[i, j] in ties {
            if classes[i as usize] == BETWEEN && classes[j as usize] == BETWEEN {
                runs.join(i, j);
            }
        }
        // Per run between the shells, by its root: bits of the shells that it leads to.
        let mut leads_to = vec![0u8; places.len()];
        let mut bridges: Vec<u32> = Vec::new();
        for &[i, j] in ties {
            match (classes[i as usize], classes[j as usize]) {
                (BETWEEN, class @ (FIRST | SECOND)) => leads_to[runs.find(i) as usize] |= 1 << class,
                (class @ (FIRST | SECOND), BETWEEN) => leads_to[runs.find(j) as usize] |= 1 << class,
                (FIRST, SECOND) | (SECOND, FIRST) => bridges.extend([i, j]),
                _ => {}
            }
        }
        let mut held = vec![0u8; bones.iter().filter(|&&b| b != NO_BONE).max().map_or(0, |&b| b as usize + 1)];
        let mut crossing: Vec<(u32, u32)> = Vec::new();
        for (sample, &class) in classes.iter().enumerate() {
            let run = runs.find(sample as u32);
            let bits = match class {
                FIRST | SECOND => 1 << class,
                BETWEEN => leads_to[run as usize],
                _ => 0,
            };
            if class == BETWEEN && bits == 3 {
                crossing.push((run, sample as u32));
            }
            if bones[sample] != NO_BONE {
                held[bones[sample] as usize] |= bits;
            }
        }
        crossing.sort_unstable();
        let parts = self.parts(both);
        let mut is_one = vec![false; parts.len()];
        let ways = crossing.chunk_by(|a, b| a.0 == b.0).map(|way| way.iter().map(|s| s.1).collect::<Vec<u32>>());
        for way in ways.chain(bridges.chunks(2).map(<[u32]>::to_vec)) {
            if parts.is_empty() {
                return None;
            }
            self.join_along(&way, &parts, &mut is_one);
        }
        let strangers = [2, 1].map(|own| (0..held.len() as u32).filter(|&bone| held[bone as usize] == own).collect());
        let apart = parts.into_iter().zip(is_one).filter(|(_, is_one)| !is_one).map(|(part, _)| part).collect();
        Some(Passing { shells, apart, strangers })
    }

    /// Per sample where it is; None if not both shells have bones of their own.
    fn classes(&self, shells: [u32; 2]) -> Option<Vec<u8>> {
        let BonePaths { bones, ties, counts, .. } = self.paths;
        let has = |voxel: u32, shell: u32| voxel != NONE && self.shells_of_voxel.row(voxel as usize).contains(&shell);
        let class = |&voxel: &u32| match shells.map(|shell| has(voxel, shell)) {
            [true, false] => FIRST,
            [false, true] => SECOND,
            [true, true] => BETWEEN,
            _ => ELSEWHERE,
        };
        let mut classes: Vec<u8> = self.voxel_of_sample.iter().map(class).collect();
        if !classes.contains(&FIRST) || !classes.contains(&SECOND) {
            return None;
        }
        let mut runs = UnionFind::new(classes.len());
        for &[i, j] in ties {
            if classes[i as usize] == classes[j as usize] {
                runs.join(i, j);
            }
        }
        let mut sizes = vec![0usize; classes.len()];
        let mut pieces: Vec<(u32, u32)> = Vec::new();
        for (sample, &bone) in bones.iter().enumerate() {
            let run = runs.find(sample as u32);
            sizes[run as usize] += 1;
            if bone != NO_BONE {
                pieces.push((run, bone));
            }
        }
        pieces.sort_unstable();
        let mut is_own = vec![false; classes.len()];
        for piece in pieces.chunk_by(|a, b| a == b) {
            let (run, bone) = piece[0];
            is_own[run as usize] |= piece.len() as f64 >= OWN * counts[bone as usize];
        }
        for (sample, class) in classes.iter_mut().enumerate() {
            let run = runs.find(sample as u32) as usize;
            let is_way = if *class == ELSEWHERE { sizes[run] <= GAP } else { !is_own[run] };
            if is_way {
                *class = BETWEEN;
            }
        }
        (classes.contains(&FIRST) && classes.contains(&SECOND)).then_some(classes)
    }

    /// Connected parts of an overlap.
    fn parts(&self, both: &[u32]) -> Vec<Vec<u32>> {
        let mut sets = UnionFind::new(both.len());
        for (index, &voxel) in both.iter().enumerate() {
            for &other in self.voxels.neighbours[voxel as usize].iter().filter(|&&other| other < voxel) {
                if let Ok(other) = both.binary_search(&other) {
                    sets.join(index as u32, other as u32);
                }
            }
        }
        let rooted: Vec<(u32, u32)> = both.iter().enumerate().map(|(i, &voxel)| (sets.find(i as u32), voxel)).collect();
        let parts = Csr::from_pairs(both.len(), &rooted);
        parts.rows().filter(|part| !part.is_empty()).map(<[u32]>::to_vec).collect()
    }

    /// Marks the parts of an overlap through which a way along bones leads, or the nearest one where it leads past them.
    fn join_along(&self, way: &[u32], parts: &[Vec<u32>], is_one: &mut [bool]) {
        let passed = |part: &Vec<u32>| way.iter().any(|&s| part.binary_search(&self.voxel_of_sample[s as usize]).is_ok());
        let mut is_passed = false;
        for (part, is_one) in parts.iter().zip(&mut *is_one) {
            if passed(part) {
                (*is_one, is_passed) = (true, true);
            }
        }
        if is_passed {
            return;
        }
        let distance = |part: &[u32]| {
            let each = |&voxel: &u32| {
                let centre = self.voxels.centre(voxel);
                way.iter().map(|&s| self.paths.places[s as usize].distance(centre)).fold(f64::INFINITY, f64::min)
            };
            part.iter().map(each).fold(f64::INFINITY, f64::min)
        };
        let nearest = (0..parts.len()).min_by(|&i, &j| distance(&parts[i]).total_cmp(&distance(&parts[j])));
        if let Some(nearest) = nearest {
            is_one[nearest] = true;
        }
    }
}
