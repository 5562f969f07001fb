//! The body as voxels: how fine, and what of the skin is in it.

use glam::DVec3;
use rayon::prelude::*;

use super::Bones;
use super::bone_paths::BonePaths;
use super::dividing::divide;
use super::lattice::{Extent, Lattice, Plane};
use super::shell::{MOST_CELLS, shell_cells};
use super::skin::Skin;
use super::voxels::Voxels;
use crate::error::{Error, Result};
use crate::surface::polygons::{Cut, cut};

/// Resolution at which the body is measured before its own is chosen.
const COARSE: f64 = 64.0;
/// Solid voxels that an automatic resolution aims at: a few hundredths of a second per bone.
const TARGET_COUNT: f64 = 100_000.0;
/// Automatic resolutions: voxels along the longest side.
const AUTOMATIC: std::ops::RangeInclusive<f64> = 32.0..=512.0;
/// Resolution below which nothing is told apart any more.
const COARSEST: f64 = 8.0;
/// Shells whose voxels are found before they are counted.
const SHELLS: usize = 256;
/// Cells of the lattice, solid or not, that an automatic resolution may take: 8 MB of bits.
const CELLS_MAX: f64 = 64e6;
/// Shells farther from the bones than this part of the bones' diagonal do not stretch the lattice: a stray triangle at the
/// end of the world would leave one voxel for the body.
const SURROUNDINGS: f64 = 0.5;

/// Voxels of the body.
pub struct Solid {
    pub lattice: Lattice,
    pub voxels: Voxels,
    /// Points of the skin, in voxels.
    pub points: Vec<DVec3>,
    /// Cells of each shell, empty for those that are not of the body.
    cells_of_shell: Vec<Vec<u32>>,
}

impl Solid {
    /// `resolution` in voxels along the longest side, or chosen; None when nothing of the skin is solid. `free` are those of
    /// the bones that give weights.
    ///
    /// # Errors
    /// More voxels than fit into memory.
    pub fn new(skin: &Skin, bones: &Bones, free: &[[DVec3; 2]], resolution: Option<usize>, plane: Option<&Plane>) -> Result<Option<Self>> {
        let faces_of_shell = skin.faces_of_shell();
        let extent_of = |shell: usize| {
            let corners = faces_of_shell.row(shell).iter().flat_map(|&face| skin.faces.row(face as usize));
            Extent::of(corners.map(|&point| skin.points[point as usize]))
        };
        let shells: Vec<(u32, Extent)> = (0..skin.is_solid.len())
            .filter(|&shell| skin.is_solid[shell])
            .filter_map(|shell| Some((shell as u32, extent_of(shell)?)))
            .collect();
        let around_bones = Extent::of(free.iter().flatten().copied()).map(|e| e.grown(SURROUNDINGS * e.diagonal()));
        let mut near: Vec<(u32, Extent)> =
            shells.iter().copied().filter(|(_, extent)| around_bones.as_ref().is_some_and(|b| b.meets(extent))).collect();
        if near.is_empty() {
            near = shells;
        }
        let Some(extent) = near.iter().map(|shell| shell.1).reduce(|a, b| a.joined(&b)) else { return Ok(None) };
        let extent = plane.map_or(extent, |plane| extent.mirrored_about(plane));
        let near: Vec<u32> = near.into_iter().map(|shell| shell.0).collect();
        let build = |resolution: f64| {
            let lattice = Lattice::new(&extent, resolution);
            let points: Vec<DVec3> = skin.points.iter().map(|&p| lattice.in_voxels(p)).collect();
            let cells_of = |&shell: &u32| shell_cells(lattice.dims, &triangles(skin, &points, faces_of_shell.row(shell as usize)));
            let mut lists = Vec::with_capacity(near.len());
            let mut count = 0;
            for some in near.chunks(SHELLS) {
                let found: Vec<Vec<u32>> = some.par_iter().map(cells_of).collect::<Option<_>>()?;
                count += found.iter().map(Vec::len).sum::<usize>();
                if count > MOST_CELLS {
                    return None;
                }
                lists.extend(found);
            }
            Some((lattice, points, lists))
        };
        let built = match resolution {
            Some(resolution) => build(resolution as f64),
            // A skin that is folded up beyond measure is divided less finely than it should be.
            None => halves(automatic(&extent, |resolution| Some(build(resolution)?.2))).find_map(build),
        };
        let Some((lattice, points, lists)) = built else {
            return Err(Error::TooManyVoxels { resolution: resolution.unwrap_or(COARSEST as usize) });
        };
        let mut voxels = Voxels::new(lattice.dims, &lists);
        let mut cells_of_shell = vec![Vec::new(); skin.is_solid.len()];
        for (&shell, cells) in near.iter().zip(lists) {
            cells_of_shell[shell as usize] = cells;
        }
        let ends = bones.heads.iter().zip(bones.tails).map(|(&head, &tail)| [head, tail].map(|p| lattice.in_voxels(p)));
        let paths = BonePaths::new(lattice.dims, &ends.collect::<Vec<_>>(), bones.parents);
        divide(&mut voxels, &cells_of_shell, &paths, bones.heads.len());
        Ok((!voxels.is_empty()).then_some(Self { lattice, voxels, points, cells_of_shell }))
    }

    /// Whether a place is in a voxel of a shell; where that is not of the body, in one of the body.
    pub fn has(&self, shell: u32, p: DVec3) -> bool {
        let cells = &self.cells_of_shell[shell as usize];
        if cells.is_empty() {
            self.voxels.is_solid_at(p)
        } else {
            self.voxels.cell_at(p).is_some_and(|cell| cells.binary_search(&cell).is_ok())
        }
    }

    /// Per shell, whether it has a voxel in one of some parts.
    pub fn shells_in(&self, is_in: &[bool]) -> Vec<bool> {
        let voxels = &self.voxels;
        let is_reached = |(shell, cells): (usize, &Vec<u32>)| {
            let viewer = voxels.viewer(shell as u32);
            let is_node_in = |node: u32| voxels.is_seen(node, viewer) && is_in[voxels.part[node as usize] as usize];
            cells.iter().any(|&cell| voxels.nodes_in(voxels.of_cell(cell)).any(is_node_in))
        };
        self.cells_of_shell.iter().enumerate().map(is_reached).collect()
    }

    pub fn memory_bytes(&self) -> usize {
        self.voxels.memory_bytes() + size_of_val(&*self.points) + self.cells_of_shell.iter().map(|c| size_of_val(&**c)).sum::<usize>()
    }
}

/// The resolution with about `TARGET_COUNT` solid voxels: long thin bodies get more along their length.
fn automatic(extent: &Extent, cells: impl Fn(f64) -> Option<Vec<Vec<u32>>>) -> f64 {
    let Some((coarse, lists)) = halves(COARSE).find_map(|resolution| Some((resolution, cells(resolution)?))) else { return COARSEST };
    let mut solid: Vec<u32> = lists.concat();
    solid.sort_unstable();
    solid.dedup();
    let wanted = coarse * (TARGET_COUNT / solid.len().max(1) as f64).cbrt();
    let wanted = wanted.clamp(*AUTOMATIC.start(), *AUTOMATIC.end());
    let cell_count = Lattice::new(extent, wanted).cell_count() as f64;
    (wanted * (CELLS_MAX / cell_count).cbrt().min(1.0)).round()
}

/// A resolution, half of it and so on, down to the coarsest.
fn halves(resolution: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(resolution), |&r| (r > COARSEST).then(|| (0.5 * r).max(COARSEST)))
}

/// Faces as triangles; quads as fans about their mean, like round polygons.
fn triangles(skin: &Skin, points: &[DVec3], faces: &[u32]) -> Vec<[DVec3; 3]> {
    let mut triangles = Vec::with_capacity(4 * faces.len());
    let mut corners = Vec::new();
    for &face in faces {
        corners.clear();
        corners.extend(skin.faces.row(face as usize).iter().map(|&point| points[point as usize]));
        let cut = match *corners {
            [a, b, c] => {
                triangles.push([a, b, c]);
                continue;
            }
            [a, b, c, d] => Cut::Fan(0.25 * (a + b + c + d)),
            _ => cut(&corners),
        };
        match cut {
            Cut::Fan(mean) => triangles.extend((0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()], mean])),
            Cut::Ears(ears) => triangles.extend(ears.iter().map(|ear| ear.map(|i| corners[i]))),
        }
    }
    triangles
}
