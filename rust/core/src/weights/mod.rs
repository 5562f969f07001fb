//! Automatic weights that do not fail [RHC09 §4.1, MATH §6]: distances inside of the body, evened out over its skin.
//!
//! Everything is measured in voxels, so that the unit of the scene does not matter.

mod bone_paths;
mod crossings;
mod distances;
mod dividing;
mod geodesic;
mod initial;
mod inset;
mod lattice;
mod limits;
mod mirror;
mod overlap;
mod sampling;
mod sheets;
mod shell;
mod skin;
mod solid;
mod sources;
mod voxels;

use glam::DVec3;

pub use lattice::Plane;
pub use limits::WeightRows;
pub use skin::Surface;

use crate::error::{Error, Result, check_finite, check_indices, check_offsets};
use crate::surface::diffusion::Diffusion;
use crate::surface::laplacian::Laplacian;
use distances::Distances;
use lattice::Extent;
use limits::Limits;
use skin::{NO_SHELL, Skin};
use solid::Solid;

/// Voxels along the longest side of the body.
const RESOLUTIONS: std::ops::RangeInclusive<usize> = 8..=1024;

/// Bones as straight pieces, in the space of the surfaces.
#[derive(Debug, Clone, Copy)]
pub struct Bones<'a> {
    /// (B,)
    pub heads: &'a [DVec3],
    /// (B,)
    pub tails: &'a [DVec3],
    /// (B,) parent of each bone, -1 for none; None: bones are parent and child where they share an end.
    pub parents: Option<&'a [i32]>,
    /// (B,) above 0: a bone of stiffness 2 holds as if it were at half its distance; None: 1.
    pub stiffness: Option<&'a [f64]>,
    /// (B,) bones whose weights stay as they are; None: none.
    pub is_locked: Option<&'a [bool]>,
}

/// Both sides are to be alike.
#[derive(Debug, Clone, Copy)]
pub struct Symmetry<'a> {
    /// Between the sides.
    pub plane: Plane,
    /// (B,) partner of each bone, itself for one in the middle, -1 for none; None: by their ends.
    pub partners: Option<&'a [i32]>,
}

/// How weights are found.
#[derive(Debug, Clone, Copy)]
pub struct WeightSettings<'a> {
    /// Voxels along the longest side; None: as many as the body needs.
    pub resolution: Option<usize>,
    /// How fast a bone's hold falls with distance: its exponent.
    pub falloff: f64,
    /// Length over which weights pass from bone to bone, as a part of the distance to the nearest bone: half of the way there
    /// from the skin, by the place in the flesh where bones are compared.
    pub smoothing: f64,
    /// Influences that a vertex may have; None: any number.
    pub max_influences: Option<usize>,
    /// Both sides alike.
    pub symmetry: Option<Symmetry<'a>>,
}

impl Default for WeightSettings<'_> {
    fn default() -> Self {
        Self { resolution: None, falloff: 12.0, smoothing: 0.83, max_influences: Some(4), symmetry: None }
    }
}

/// Weights of all surfaces' vertices, one after the other, and how they were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// Rows of vertices.
    pub rows: WeightRows,
    /// (N,) vertices of shells that no bone reaches inside of the body, and loose ones: they took from the nearest place
    /// of the body that a bone reaches.
    pub is_fallback: Vec<bool>,
    /// Voxels along each axis; 0 where nothing was solid.
    pub dims: [usize; 3],
    /// Edge of a voxel.
    pub voxel_size: f64,
    /// Solid voxels.
    pub voxel_count: usize,
    /// What the largest arrays took.
    pub memory_bytes: usize,
}

/// Weights of surfaces on bones.
///
/// `locked` are influences per vertex, of which those of locked bones are kept; the others share what is left.
/// `progress` is told the part that is done and returns false to cancel.
///
/// # Errors
/// Arrays of wrong length or with values that are not finite or out of range; no bone that is not locked; more voxels than fit
/// into memory; cancelled.
pub fn automatic_weights(
    surfaces: &[Surface],
    bones: &Bones,
    locked: Option<&WeightRows>,
    settings: &WeightSettings,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Weights> {
    check_bones(bones)?;
    check_settings(settings, bones.heads.len())?;
    let mut step = |from: f64, to: f64, part: f64| if progress(from + (to - from) * part) { Ok(()) } else { Err(Error::Cancelled) };
    let skin = Skin::new(surfaces)?;
    let locked = locked.map(|rows| locked_rows(rows, bones, skin.point_of_vertex.len())).transpose()?;
    let free: Vec<u32> = (0..bones.heads.len() as u32).filter(|&b| !bones.is_locked.is_some_and(|l| l[b as usize])).collect();
    if free.is_empty() {
        return Err(Error::NoFreeBone);
    }
    step(0.0, 0.0, 0.0)?;
    let segments: Vec<[DVec3; 2]> = free.iter().map(|&b| [bones.heads[b as usize], bones.tails[b as usize]]).collect();
    let count = skin.points.len();
    let solid = Solid::new(&skin, bones, &segments, settings.resolution, settings.symmetry.as_ref().map(|s| &s.plane))?;
    step(0.0, 0.1, 1.0)?;

    let Distances { mut columns, depths, is_reached, memory_bytes } = if let Some(solid) = &solid {
        let stiffness = |pick: fn(f64, f64) -> f64, start| bones.stiffness.map_or(1.0, |s| s.iter().copied().fold(start, pick));
        // The nearest bone may be the least stiff one, and another the most stiff.
        let spread = stiffness(f64::max, 0.0) / stiffness(f64::min, f64::INFINITY);
        let numbered: Vec<(u32, [DVec3; 2])> = free.iter().copied().zip(segments).collect();
        Distances::inside(solid, &skin, &numbered, initial::range(settings.falloff) * spread, |part| step(0.1, 0.7, part))?
    } else {
        let unit = Extent::of(segments.iter().flatten().copied()).map_or(1.0, |e| e.diagonal() / 128.0);
        Distances::straight(&skin.points, &segments, skin.is_solid.len(), if unit > 0.0 { unit } else { 1.0 })?
    };
    let stiffness: Vec<f64> = free.iter().map(|&b| bones.stiffness.map_or(1.0, |s| s[b as usize])).collect();
    let nearest = initial::weights_from_distances(&mut columns, count, &stiffness, settings.falloff);
    if let Some(solid) = solid.as_ref().filter(|_| settings.smoothing > 0.0) {
        let own = initial::own_length(settings.falloff);
        let lengths: Vec<f64> =
            nearest.iter().zip(&depths).map(|(&d, &depth)| initial::length_left(settings.smoothing, own, d, depth)).collect();
        if let Some(diffusion) = Diffusion::new(Laplacian::new(&solid.points, &skin.faces), &lengths) {
            step(0.7, 0.8, 1.0)?;
            diffusion.run(&mut columns, |part| step(0.8, 0.95, part))?;
        }
    }
    if let Some(symmetry) = &settings.symmetry {
        let partners = free_partners(symmetry, bones, &free);
        mirror::symmetrise(&mut columns, &mirror::partners(&skin.points, &symmetry.plane), &partners);
    }
    let limits = Limits { max_influences: settings.max_influences.unwrap_or(usize::MAX), bones: &free, locked: locked.as_ref() };
    let rows = limits.rows(&columns, count, &skin.point_of_vertex);
    let is_lost = |shell: u32| shell == NO_SHELL || skin.is_solid[shell as usize] && !is_reached[shell as usize];
    let is_fallback = skin.point_of_vertex.iter().map(|&point| is_lost(skin.shell_of_point[point as usize])).collect();
    step(1.0, 1.0, 1.0)?;
    Ok(Weights {
        rows,
        is_fallback,
        dims: solid.as_ref().map_or([0; 3], |s| s.lattice.dims),
        voxel_size: solid.as_ref().map_or(0.0, |s| s.lattice.size),
        voxel_count: solid.as_ref().map_or(0, |s| s.voxels.len()),
        memory_bytes: memory_bytes + solid.as_ref().map_or(0, Solid::memory_bytes),
    })
}

/// Partners of the free bones among themselves.
fn free_partners(symmetry: &Symmetry, bones: &Bones, free: &[u32]) -> Vec<Option<u32>> {
    let by_ends = || {
        let segments: Vec<[DVec3; 2]> = bones.heads.iter().zip(bones.tails).map(|(&h, &t)| [h, t]).collect();
        mirror::bone_partners(&segments, &symmetry.plane)
    };
    let all: Vec<Option<u32>> = symmetry.partners.map_or_else(by_ends, |p| p.iter().map(|&p| u32::try_from(p).ok()).collect());
    let position = |bone: u32| free.binary_search(&bone).ok().map(|i| i as u32);
    free.iter().map(|&bone| all[bone as usize].and_then(position)).collect()
}

/// The rows of locked bones.
fn locked_rows(rows: &WeightRows, bones: &Bones, vertex_count: usize) -> Result<WeightRows> {
    check_offsets("weight_offsets", &rows.offsets, rows.weights.len())?;
    if rows.offsets.len() != vertex_count + 1 {
        return Err(Error::Length { what: "weight_offsets", found: rows.offsets.len(), needed: vertex_count + 1 });
    }
    if rows.bones.len() != rows.weights.len() {
        return Err(Error::Length { what: "weight_bones", found: rows.bones.len(), needed: rows.weights.len() });
    }
    check_indices("weight_bones", &rows.bones, bones.heads.len())?;
    crate::skinning::blend::check_weights("weights", &rows.weights)?;
    let mut kept = WeightRows { offsets: vec![0], ..WeightRows::default() };
    for vertex in 0..vertex_count {
        for (bone, weight) in rows.row(vertex).filter(|w| bones.is_locked.is_some_and(|l| l[w.0 as usize])) {
            kept.bones.push(bone);
            kept.weights.push(weight);
        }
        kept.offsets.push(kept.bones.len() as i32);
    }
    Ok(kept)
}

fn check_bones(bones: &Bones) -> Result<()> {
    let count = bones.heads.len();
    let lengths = [
        ("bone_tails", bones.tails.len()),
        ("stiffness", bones.stiffness.map_or(count, <[f64]>::len)),
        ("locked_bones", bones.is_locked.map_or(count, <[bool]>::len)),
        ("bone_parents", bones.parents.map_or(count, <[i32]>::len)),
    ];
    if let Some(&(what, found)) = lengths.iter().find(|(_, found)| *found != count) {
        return Err(Error::Length { what, found, needed: count });
    }
    check_finite("bone_heads", bones.heads)?;
    check_finite("bone_tails", bones.tails)?;
    if let Some(parents) = bones.parents
        && let Some(row) = parents.iter().position(|&p| p < -1 || p >= count as i32)
    {
        return Err(Error::Index { what: "bone_parents", row, found: i64::from(parents[row]), limit: count });
    }
    match bones.stiffness.into_iter().flatten().find(|s| !(**s >= 1e-3 && **s <= 1e3)) {
        Some(&found) => Err(Error::Value { what: "stiffness", found, needed: "numbers in 0.001..1000" }),
        None => Ok(()),
    }
}

fn check_settings(settings: &WeightSettings, bone_count: usize) -> Result<()> {
    let refuse = |what, found, needed| Err(Error::Value { what, found, needed });
    if let Some(found) = settings.resolution.filter(|r| !RESOLUTIONS.contains(r)) {
        return refuse("resolution", found as f64, "8..1024 voxels");
    }
    if !(0.5..=32.0).contains(&settings.falloff) {
        return refuse("falloff", settings.falloff, "a number in 0.5..32");
    }
    if !(0.0..=10.0).contains(&settings.smoothing) {
        return refuse("smoothing", settings.smoothing, "a number in 0..10");
    }
    if settings.max_influences == Some(0) {
        return refuse("max_influences", 0.0, "1 or more");
    }
    let Some(symmetry) = &settings.symmetry else { return Ok(()) };
    check_finite("symmetry_plane", &[symmetry.plane.point, symmetry.plane.normal])?;
    if symmetry.plane.normal.length_squared() == 0.0 {
        return refuse("symmetry_plane", 0.0, "a normal of some length");
    }
    match symmetry.partners {
        Some(p) if p.len() != bone_count => Err(Error::Length { what: "mirrored_bones", found: p.len(), needed: bone_count }),
        Some(p) => match p.iter().position(|&p| p < -1 || p >= bone_count as i32) {
            Some(row) => Err(Error::Index { what: "mirrored_bones", row, found: i64::from(p[row]), limit: bone_count }),
            None => Ok(()),
        },
        None => Ok(()),
    }
}
