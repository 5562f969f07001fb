//! Divides voxels in which solids pass through each other into sheets.

use std::collections::{BTreeMap, HashMap};

use super::bone_paths::BonePaths;
use super::overlap::{Passing, Scene};
use super::sheets::{EVERYTHING, Sheets};
use super::voxels::{NONE, Voxels};
use crate::numeric::csr::Csr;
use crate::numeric::union_find::UnionFind;

/// Pairs of shells that may be in voxels together: each takes some bytes.
const MOST_PAIRS: usize = 1 << 26;

/// Divides voxels in which solids pass through each other, and cuts the ways between those solids. `cells` are those of
/// each shell. Nothing changes where all is one solid.
pub fn divide(voxels: &mut Voxels, cells: &[Vec<u32>], paths: &BonePaths, bone_count: usize) {
    // Shells that do not share a cell may still touch, but one alone cannot.
    if cells.iter().filter(|cells| !cells.is_empty()).count() < 2 {
        return;
    }
    let voxel_of_sample: Vec<u32> = paths.places.iter().map(|&p| voxels.cell_at(p).map_or(NONE, |cell| voxels.of_cell(cell))).collect();
    let mut sampled: Vec<u32> = paths.places.iter().filter_map(|&p| voxels.cell_at(p)).collect();
    sampled.sort_unstable();
    sampled.dedup();
    let bearing: Vec<u32> = (0..cells.len() as u32).filter(|&shell| meet(&cells[shell as usize], &sampled)).collect();
    if bearing.len() < 2 {
        return;
    }
    let pairs: Vec<(u32, u32)> = bearing
        .iter()
        .enumerate()
        .flat_map(|(rank, &shell)| cells[shell as usize].iter().map(move |&cell| (cell, rank as u32)))
        .map(|(cell, rank)| (voxels.of_cell(cell), rank))
        .collect();
    let shells_of_voxel = Csr::from_pairs(voxels.len(), &pairs);
    let bones = Bearing::new(bearing.iter().map(|&shell| common(&cells[shell as usize], &sampled)));
    let is_mixed = |row: &&[u32]| row.iter().any(|&shell| bones.class_of[shell as usize] != bones.class_of[row[0] as usize]);
    // More shells in one place than can be told apart are one solid.
    if shells_of_voxel.rows().filter(is_mixed).map(|row| row.len() * row.len()).sum::<usize>() > MOST_PAIRS {
        return;
    }
    let scene = Scene { voxels, shells_of_voxel: &shells_of_voxel, paths, voxel_of_sample: &voxel_of_sample };
    let mut passings: Vec<Passing> =
        touching(voxels, &shells_of_voxel, &bones).into_iter().filter_map(|([a, b], both)| scene.passing([a, b], &both)).collect();
    if passings.is_empty() {
        return;
    }
    let contested = contested(&shells_of_voxel, &mut passings);
    let mut viewer_of_shell = vec![EVERYTHING; cells.len()];
    for (rank, &shell) in bearing.iter().enumerate() {
        viewer_of_shell[shell as usize] = rank as u32 + 1;
    }
    let (lists, sheet_of_node, next_nodes, first_cells) = nodes(&shells_of_voxel, &contested);
    let mut is_blocked = vec![false; bearing.len() * bearing.len()];
    let mut is_barred = vec![false; bearing.len() * bone_count];
    for passing in &passings {
        let [a, b] = passing.shells.map(|shell| shell as usize);
        is_blocked[a * bearing.len() + b] = true;
        is_blocked[b * bearing.len() + a] = true;
        for (side, strangers) in passing.strangers.iter().enumerate() {
            for &bone in strangers {
                is_barred[passing.shells[side] as usize * bone_count + bone as usize] = true;
            }
        }
    }
    let are_blocked = |a: u32, b: u32| is_blocked[a as usize * bearing.len() + b as usize];
    let sheet_count = lists.len();
    let mut is_seen = vec![true; (bearing.len() + 1) * sheet_count];
    let mut is_held = vec![true; bone_count * sheet_count];
    for (sheet, list) in lists.iter().enumerate() {
        for shell in 0..bearing.len() as u32 {
            is_seen[(shell as usize + 1) * sheet_count + sheet] =
                list.contains(&shell) || !list.iter().any(|&other| are_blocked(shell, other));
        }
        for bone in 0..bone_count {
            is_held[bone * sheet_count + sheet] =
                list.is_empty() || list.iter().any(|&shell| !is_barred[shell as usize * bone_count + bone]);
        }
    }
    let sheets = Sheets { sheet: sheet_of_node, next_nodes, viewer_of_shell, sheet_count, is_seen, is_held };
    // Ways lead on in shells that two nodes share, and from shell to shell where nothing is against it.
    let share = |a: u32, b: u32| lists[a as usize].iter().any(|shell| lists[b as usize].contains(shell));
    let is_free = |a: u32, b: u32| !lists[a as usize].iter().any(|&m| lists[b as usize].iter().any(|&n| are_blocked(m, n)));
    voxels.divide(sheets, &first_cells, |a, b, is_contested| share(a, b) || !is_contested && is_free(a, b));
}

/// Which voxels of shells have samples of bones. Only shells that each have some of their own can pass through each other.
struct Bearing {
    /// Per shell, the number of its list.
    class_of: Vec<u32>,
    lists: Vec<Vec<u32>>,
    /// Per pair of lists, whether each has something that the other has not.
    are_apart: Vec<bool>,
}

impl Bearing {
    fn new(lists: impl Iterator<Item = Vec<u32>>) -> Self {
        let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut result = Self { class_of: Vec::new(), lists: Vec::new(), are_apart: Vec::new() };
        for list in lists {
            let class = *numbers.entry(list).or_insert_with_key(|list| {
                result.lists.push(list.clone());
                result.lists.len() as u32 - 1
            });
            result.class_of.push(class);
        }
        let has_own = |a: &Vec<u32>, b: &Vec<u32>| a.iter().any(|voxel| b.binary_search(voxel).is_err());
        let pairs = result.lists.iter().flat_map(|a| result.lists.iter().map(move |b| (a, b)));
        result.are_apart = pairs.map(|(a, b)| has_own(a, b) && has_own(b, a)).collect();
        result
    }

    fn are_apart(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|shell| self.class_of[shell as usize] as usize);
        self.are_apart[a * self.lists.len() + b]
    }
}

/// What two sorted lists share.
fn common(list: &[u32], values: &[u32]) -> Vec<u32> {
    values.iter().copied().filter(|value| list.binary_search(value).is_ok()).collect()
}

/// Whether two sorted lists share a value.
fn meet(list: &[u32], values: &[u32]) -> bool {
    if values.len() < list.len() {
        values.iter().any(|value| list.binary_search(value).is_ok())
    } else {
        list.iter().any(|value| values.binary_search(value).is_ok())
    }
}

/// Pairs of shells that share voxels or have neighbouring ones, and may be two solids, with the voxels that they share, sorted.
fn touching(voxels: &Voxels, shells_of_voxel: &Csr<u32>, bones: &Bearing) -> BTreeMap<[u32; 2], Vec<u32>> {
    let mut pairs: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (voxel, row) in shells_of_voxel.rows().enumerate() {
        for (i, &a) in row.iter().enumerate() {
            for &b in row[i + 1..].iter().filter(|&&b| bones.are_apart(a, b)) {
                pairs.entry([a, b]).or_default().push(voxel as u32);
            }
        }
        for &other in voxels.neighbours[voxel].iter().filter(|&&other| other < voxel as u32) {
            let beside = shells_of_voxel.row(other as usize);
            if beside != row {
                for (&a, &b) in row.iter().flat_map(|a| beside.iter().map(move |b| (a, b))).filter(|&(&a, &b)| bones.are_apart(a, b)) {
                    pairs.entry([a.min(b), a.max(b)]).or_default();
                }
            }
        }
    }
    pairs
}

/// Sheets of the voxels that have several, as lists of shells. Two solids that are one by way of a third are one in that
/// whole part of their overlap.
fn contested(shells_of_voxel: &Csr<u32>, passings: &mut [Passing]) -> BTreeMap<u32, Vec<Vec<u32>>> {
    loop {
        let mut apart: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
        for passing in &*passings {
            for &voxel in passing.apart.iter().flatten() {
                apart.entry(voxel).or_default().push(passing.shells);
            }
        }
        let mut is_settled = true;
        let mut found = BTreeMap::new();
        for (voxel, apart) in apart {
            let row = shells_of_voxel.row(voxel as usize);
            let mut sets = UnionFind::new(row.len());
            for (i, &a) in row.iter().enumerate() {
                for (j, &b) in row.iter().enumerate().skip(i + 1) {
                    if !apart.contains(&[a, b]) {
                        sets.join(i as u32, j as u32);
                    }
                }
            }
            let mut lists: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
            for (i, &shell) in row.iter().enumerate() {
                lists.entry(sets.find(i as u32)).or_default().push(shell);
            }
            for passing in &mut *passings {
                if apart.contains(&passing.shells) && lists.values().any(|list| passing.shells.iter().all(|shell| list.contains(shell))) {
                    passing.apart.retain(|part| part.binary_search(&voxel).is_err());
                    is_settled = false;
                }
            }
            found.insert(voxel, lists.into_values().collect());
        }
        if is_settled {
            return found;
        }
    }
}

/// Lists of shells per sheet; per node its sheet and the next node of its voxel; voxels of the nodes that are added to the first ones.
fn nodes(shells_of_voxel: &Csr<u32>, contested: &BTreeMap<u32, Vec<Vec<u32>>>) -> (Vec<Vec<u32>>, Vec<u32>, Vec<u32>, Vec<u32>) {
    let mut lists: Vec<Vec<u32>> = Vec::new();
    let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
    let mut number = |list: &[u32]| {
        *numbers.entry(list.to_vec()).or_insert_with(|| {
            lists.push(list.to_vec());
            lists.len() as u32 - 1
        })
    };
    let mut sheets: Vec<u32> = Vec::with_capacity(shells_of_voxel.len());
    let mut last: Option<(&[u32], u32)> = None;
    for (voxel, row) in shells_of_voxel.rows().enumerate() {
        if let Some(first) = contested.get(&(voxel as u32)).map(|lists| &lists[0]) {
            sheets.push(number(first));
            continue;
        }
        // Mostly the same as before it.
        let known = last.filter(|(list, _)| *list == row).map(|(_, sheet)| sheet);
        let sheet = known.unwrap_or_else(|| number(row));
        last = Some((row, sheet));
        sheets.push(sheet);
    }
    let mut next_nodes = vec![NONE; sheets.len()];
    let mut voxels = Vec::new();
    for (&voxel, lists) in contested {
        let mut previous = voxel as usize;
        for list in &lists[1..] {
            next_nodes[previous] = sheets.len() as u32;
            previous = sheets.len();
            sheets.push(number(list));
            next_nodes.push(NONE);
            voxels.push(voxel);
        }
    }
    (lists, sheets, next_nodes, voxels)
}
