//! Solid voxels: one bit per cell of the lattice, everything else per solid voxel only.

use glam::DVec3;
use rayon::prelude::*;

use super::sheets::{EVERYTHING, Sheets};
use crate::numeric::union_find::UnionFind;

/// No voxel there.
pub const NONE: u32 = u32::MAX;

/// Part of a voxel that surfaces lie from their outermost centres.
pub const SKIN: f64 = 0.5;

/// The 26 neighbours: six across faces, opposite ones together, twelve across edges, eight across corners.
pub const STEPS: [[i8; 3]; 26] = steps();
/// Across faces.
pub const FACE_STEPS: usize = 6;

const fn steps() -> [[i8; 3]; 26] {
    let mut steps = [[0; 3]; 26];
    let mut count = 0;
    let mut axes = 1;
    while axes <= 3 {
        let mut code = 0;
        while code < 27 {
            // Digits 0, 1, 2 stand for 0, -1, 1, the first axis last.
            let step = [digit(code), digit(code / 3), digit(code / 9)];
            if (step[0] != 0) as i8 + (step[1] != 0) as i8 + (step[2] != 0) as i8 == axes {
                steps[count] = step;
                count += 1;
            }
            code += 1;
        }
        axes += 1;
    }
    steps
}

const fn digit(code: i8) -> i8 {
    match code % 3 {
        0 => 0,
        1 => -1,
        _ => 1,
    }
}

/// Which of `STEPS` leads to a neighbour.
#[inline]
pub fn step_to(step: [i64; 3]) -> usize {
    STEP_AT[((step[2] + 1) * 9 + (step[1] + 1) * 3 + step[0] + 1) as usize]
}

const STEP_AT: [usize; 27] = step_at();

const fn step_at() -> [usize; 27] {
    let mut found = [0; 27];
    let mut index = 0;
    while index < 26 {
        let [x, y, z] = STEPS[index];
        found[((z + 1) * 9 + (y + 1) * 3 + x + 1) as usize] = index;
        index += 1;
    }
    found
}

/// Solid voxels, numbered by z, y, x; after them those that are there again, where solids pass through each other.
pub struct Voxels {
    dims: [usize; 3],
    solid: Vec<u64>,
    /// Voxels before each word of `solid`.
    ranks: Vec<u32>,
    /// Cell of each voxel.
    pub cells: Vec<[u16; 3]>,
    /// Per voxel its neighbours in the order of `STEPS`.
    pub neighbours: Vec<[u32; 26]>,
    /// Connected part of each voxel.
    pub part: Vec<u32>,
    pub part_count: usize,
    /// Where solids pass through each other.
    pub sheets: Option<Sheets>,
}

impl Voxels {
    /// From lists of cells, which may overlap; a cell's index is (z dims[1] + y) dims[0] + x.
    pub fn new(dims: [usize; 3], lists: &[Vec<u32>]) -> Self {
        let mut solid = vec![0u64; dims.iter().product::<usize>().div_ceil(64)];
        for &cell in lists.iter().flatten() {
            solid[cell as usize / 64] |= 1 << (cell % 64);
        }
        let mut ranks = Vec::with_capacity(solid.len());
        let mut cells = Vec::new();
        for (word, &bits) in solid.iter().enumerate() {
            ranks.push(cells.len() as u32);
            let mut left = bits;
            while left != 0 {
                let cell = word * 64 + left.trailing_zeros() as usize;
                cells.push([cell % dims[0], cell / dims[0] % dims[1], cell / dims[0] / dims[1]].map(|i| i as u16));
                left &= left - 1;
            }
        }
        let mut voxels = Self { dims, solid, ranks, cells, neighbours: Vec::new(), part: Vec::new(), part_count: 0, sheets: None };
        let around = |cell: &[u16; 3]| STEPS.map(|step| voxels.at([0, 1, 2].map(|i| i64::from(cell[i]) + i64::from(step[i]))));
        voxels.neighbours = voxels.cells.par_iter().map(around).collect();
        voxels.find_parts();
        voxels
    }

    /// Adds the nodes of sheets: `added` are the voxels that they repeat. `is_way` of two sheets, and whether one of the voxels
    /// has several, says whether ways lead from one to the other.
    pub fn divide(&mut self, sheets: Sheets, added: &[u32], is_way: impl Fn(u32, u32, bool) -> bool) {
        let count = self.len();
        let nodes_in =
            |voxel: u32| std::iter::successors(Some(voxel), |&node| Some(sheets.next_nodes[node as usize]).filter(|&next| next != NONE));
        let is_contested = |voxel: u32| sheets.next_nodes[voxel as usize] != NONE;
        let mut neighbours = Vec::with_capacity(count + added.len());
        for (node, voxel) in (0..count as u32).chain(added.iter().copied()).enumerate() {
            neighbours.push(self.neighbours[voxel as usize].map(|other| {
                if other == NONE {
                    return NONE;
                }
                let is_several = is_contested(voxel) || is_contested(other);
                let leads = |&to: &u32| is_way(sheets.sheet[node], sheets.sheet[to as usize], is_several);
                nodes_in(other).find(leads).unwrap_or(NONE)
            }));
        }
        self.cells.extend(added.iter().map(|&voxel| self.cells[voxel as usize]).collect::<Vec<_>>());
        self.neighbours = neighbours;
        self.sheets = Some(sheets);
        self.find_parts();
    }

    /// All nodes of a voxel, which is the first of them.
    #[inline]
    pub fn nodes_in(&self, voxel: u32) -> impl Iterator<Item = u32> {
        let next = |&node: &u32| self.sheets.as_ref().map(|s| s.next_nodes[node as usize]).filter(|&next| next != NONE);
        std::iter::successors((voxel != NONE).then_some(voxel), next)
    }

    /// Whether points of a shell see a node.
    #[inline]
    pub fn is_seen(&self, node: u32, viewer: u32) -> bool {
        self.sheets.as_ref().is_none_or(|sheets| sheets.is_seen(node, viewer))
    }

    /// Whether a bone may hold a node.
    #[inline]
    pub fn is_held(&self, node: u32, bone: u32) -> bool {
        self.sheets.as_ref().is_none_or(|sheets| sheets.is_held(node, bone))
    }

    /// How points of a shell look at nodes.
    #[inline]
    pub fn viewer(&self, shell: u32) -> u32 {
        self.sheets.as_ref().map_or(EVERYTHING, |sheets| sheets.viewer(shell))
    }

    fn find_parts(&mut self) {
        let mut sets = UnionFind::new(self.len());
        for (voxel, neighbours) in self.neighbours.iter().enumerate() {
            for &other in neighbours.iter().filter(|&&other| other < voxel as u32) {
                sets.join(voxel as u32, other);
            }
        }
        let mut part = vec![NONE; self.len()];
        self.part_count = 0;
        for voxel in 0..self.len() {
            let root = sets.find(voxel as u32) as usize;
            if part[root] == NONE {
                part[root] = self.part_count as u32;
                self.part_count += 1;
            }
            part[voxel] = part[root];
        }
        self.part = part;
    }

    /// Voxel at a cell of the lattice or beyond it.
    #[inline]
    pub fn at(&self, cell: [i64; 3]) -> u32 {
        self.index(cell).map_or(NONE, |cell| self.of_cell(cell))
    }

    /// Whether there is a voxel at a cell of the lattice or beyond it.
    #[inline]
    pub fn is_solid(&self, cell: [i64; 3]) -> bool {
        self.index(cell).is_some_and(|cell| self.solid[cell as usize / 64] >> (cell % 64) & 1 == 1)
    }

    /// Whether a place is in a voxel.
    #[inline]
    pub fn is_solid_at(&self, p: DVec3) -> bool {
        self.cell_at(p).is_some_and(|cell| self.of_cell(cell) != NONE)
    }

    /// Whether a place is in a voxel that points of a shell see.
    #[inline]
    pub fn is_flesh(&self, p: DVec3, viewer: u32) -> bool {
        self.cell_at(p).is_some_and(|cell| self.nodes_in(self.of_cell(cell)).any(|node| self.is_seen(node, viewer)))
    }

    /// Index of the cell of the lattice that a place is in.
    #[inline]
    pub fn cell_at(&self, p: DVec3) -> Option<u32> {
        self.index(p.floor().to_array().map(|x| x as i64))
    }

    /// From a place to the nearest centre of some voxels, which are given with their weights.
    pub fn least_distance(&self, row: &[(u32, f32)], p: DVec3) -> f64 {
        row.iter().map(|(voxel, _)| self.centre(*voxel).distance(p)).fold(f64::INFINITY, f64::min)
    }

    #[inline]
    fn index(&self, cell: [i64; 3]) -> Option<u32> {
        let is_within = (0..3).all(|i| cell[i] >= 0 && cell[i] < self.dims[i] as i64);
        is_within.then(|| ((cell[2] as usize * self.dims[1] + cell[1] as usize) * self.dims[0] + cell[0] as usize) as u32)
    }

    /// Voxel at the index of a cell.
    #[inline]
    pub fn of_cell(&self, cell: u32) -> u32 {
        let (word, bit) = (cell as usize / 64, cell % 64);
        let bits = self.solid[word];
        if bits >> bit & 1 == 0 { NONE } else { self.ranks[word] + (bits & ((1 << bit) - 1)).count_ones() }
    }

    /// Nodes with their centre in a box.
    pub fn in_box(&self, low: DVec3, high: DVec3) -> Vec<u32> {
        let last = DVec3::from_array(self.dims.map(|d| d as f64 - 1.0));
        let [first, end] = [(low - 0.5).ceil().max(DVec3::ZERO), (high - 0.5).floor().min(last)];
        let sides = (end - first + 1.0).max(DVec3::ZERO);
        if sides.element_product() > self.len() as f64 {
            let is_within = |&voxel: &u32| self.centre(voxel).cmpge(low).all() && self.centre(voxel).cmple(high).all();
            return (0..self.len() as u32).filter(is_within).collect();
        }
        let [xs, ys, zs] = [0, 1, 2].map(|i| first[i] as i64..(first[i] + sides[i]) as i64);
        let mut found = Vec::new();
        for z in zs {
            for y in ys.clone() {
                found.extend(xs.clone().flat_map(|x| self.nodes_in(self.at([x, y, z]))));
            }
        }
        found
    }

    #[inline]
    pub fn centre(&self, voxel: u32) -> DVec3 {
        DVec3::from_array(self.cells[voxel as usize].map(f64::from)) + 0.5
    }

    /// Of the lattice, in voxels.
    #[inline]
    pub fn diagonal(&self) -> f64 {
        DVec3::from_array(self.dims.map(|d| d as f64)).length()
    }

    /// Number of solid voxels.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.solid)
            + size_of_val(&*self.ranks)
            + size_of_val(&*self.cells)
            + size_of_val(&*self.neighbours)
            + size_of_val(&*self.part)
            + self.sheets.as_ref().map_or(0, Sheets::memory_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_mutual_and_numbers_follow_cells() {
        let cells: Vec<u32> = (0..7 * 5 * 6).filter(|i| i % 3 != 0 || i % 7 == 2).collect();
        let voxels = Voxels::new([7, 5, 6], &[cells.clone(), cells.clone()]);
        assert_eq!(voxels.len(), cells.len());
        for (voxel, &cell) in cells.iter().enumerate() {
            assert_eq!(voxels.of_cell(cell), voxel as u32);
            assert_eq!(voxels.at(voxels.centre(voxel as u32).floor().to_array().map(|x| x as i64)), voxel as u32);
            for (step, &other) in STEPS.iter().zip(&voxels.neighbours[voxel]) {
                let back = STEPS.iter().position(|s| (0..3).all(|i| s[i] == -step[i])).expect("steps come in pairs");
                assert!(other == NONE || voxels.neighbours[other as usize][back] == voxel as u32);
            }
        }
    }

    #[test]
    fn opposite_faces_stand_together() {
        for axis in 0..3 {
            assert_eq!(STEPS[2 * axis].map(|x| -x), STEPS[2 * axis + 1]);
            assert_eq!(STEPS[2 * axis][axis], -1);
        }
    }
}
