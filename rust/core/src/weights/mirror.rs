//! Both sides alike: which points and bones are each other's mirror image.

use glam::DVec3;
use rayon::prelude::*;

use super::lattice::{Extent, Plane};
use crate::numeric::nearness::PointTree;

/// How far an image may be from its partner, as a part of the diagonal.
const TOLERANCE: f64 = 1e-4;

/// Per point its partner; None where no other lies at its image. Partners are mutual, a point of the plane is its own.
pub fn partners(points: &[DVec3], plane: &Plane) -> Vec<Option<u32>> {
    let tolerance = Extent::of(points.iter().copied()).map_or(0.0, |extent| extent.diagonal()) * TOLERANCE;
    let tree = PointTree::new(points, (0..points.len() as u32).collect());
    let closest = |p: &DVec3| tree.nearest(plane.mirrored(*p), tolerance);
    mutual(&points.par_iter().map(closest).collect::<Vec<_>>())
}

/// Bones by their ends, where the caller does not say.
pub fn bone_partners(bones: &[[DVec3; 2]], plane: &Plane) -> Vec<Option<u32>> {
    let size = Extent::of(bones.iter().flatten().copied()).map_or(0.0, |extent| extent.diagonal());
    let apart = |a: &[DVec3; 2], b: &[DVec3; 2]| a[0].distance(b[0]).max(a[1].distance(b[1]));
    let closest = |bone: &[DVec3; 2]| {
        let image = bone.map(|p| plane.mirrored(p));
        let all = bones.iter().enumerate().map(|(i, other)| (apart(&image, other), i as u32));
        all.filter(|(distance, _)| *distance <= size * TOLERANCE).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, i)| i)
    };
    mutual(&bones.iter().map(closest).collect::<Vec<_>>())
}

fn mutual(closest: &[Option<u32>]) -> Vec<Option<u32>> {
    let back = |i: usize| closest[i].filter(|&other| closest[other as usize] == Some(i as u32));
    (0..closest.len()).map(back).collect()
}

/// Gives partners the mean of both sides' weights: columns of `points.len()` values, one per bone.
pub fn symmetrise(columns: &mut [f32], points: &[Option<u32>], bones: &[Option<u32>]) {
    let count = points.len();
    for (bone, partner) in bones.iter().enumerate() {
        let Some(other) = partner.map(|other| other as usize).filter(|&other| other >= bone) else { continue };
        for (point, partner) in points.iter().enumerate() {
            let Some(image) = partner.map(|image| image as usize) else { continue };
            // A bone that is its own partner meets each pair of points twice.
            if other == bone && image < point {
                continue;
            }
            let (a, b) = (bone * count + point, other * count + image);
            let mean = 0.5 * (columns[a] + columns[b]);
            columns[a] = mean;
            columns[b] = mean;
        }
    }
}
