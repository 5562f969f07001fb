//! Directions that fine detail rides along: normals of the skin at rest, evened out over a part of the flesh below.
//!
//! By its own gradient every wall of a navel would be pushed its own way, and torn from the others.

use glam::{DMat3, DVec3};

use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, V4};
use crate::skinning::sites::Sites;
use crate::surface::diffusion::Diffusion;
use crate::surface::laplacian::Laplacian;
use crate::surface::sweeps::{GRADIENT_PARTS, mean_and_cross, polygon_gradient};

/// Over which length, in lengths of the joints a point follows.
const LENGTH: f64 = 0.05;
/// Part of a point's own normal that is always left: the two sides of a thin edge would leave nothing.
const OWN: f64 = 0.02;

/// A point whose gradient at rest is less than this part of its area counts as if it had as much: what looks at itself.
const GRADIENT_MIN: f64 = 0.3;

/// Per slot; empty where no joint has a length, or numbers are beyond computing with.
#[derive(Debug, Clone, Default)]
pub(crate) struct EvenNormals {
    /// Unit vectors in armature space, taken to that of rest positions; 0 for points of no face.
    pub directions: Vec<V4>,
    /// Mean area over the length of the gradient at rest.
    pub inverse_gradients: Vec<f32>,
}

impl EvenNormals {
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.directions) + size_of_val(&*self.inverse_gradients)
    }
}

/// `faces` as slots; `places` and areas per slot, and `lengths` per joint, in armature space.
pub(crate) fn even_normals(
    faces: &Csr<u32>,
    places: &[DVec3],
    (area_unit, inverse_areas): (f64, &[f32]),
    sites: &Sites,
    lengths: &[f64],
    rest_from_armature: &DMat3,
) -> EvenNormals {
    let has_length = |joint: &&f64| **joint > 0.0;
    let count = lengths.iter().filter(has_length).count();
    if count == 0 {
        return EvenNormals::default();
    }
    let mean = lengths.iter().filter(has_length).sum::<f64>() / count as f64;
    let of_slot = |slot: usize| {
        let (mut sum, mut whole) = (0.0, 0.0);
        for site in sites.of_slot(slot) {
            let (joints, weights) = sites.influences.of(site);
            for (&joint, &weight) in joints.iter().zip(weights) {
                let length = lengths.get(usize::from(joint)).copied().filter(|length| *length > 0.0).unwrap_or(mean);
                sum += weight * sites.share(site) * length;
                whole += weight * sites.share(site);
            }
        }
        LENGTH * if whole > 0.0 { sum / whole } else { mean }
    };
    let over: Vec<f64> = (0..places.len()).map(of_slot).collect();
    let mut own = vec![DVec3::ZERO; places.len()];
    for face in faces.rows() {
        let (count, at) = (face.len(), |corner: usize| lanes::from(places[face[corner % face.len()] as usize]));
        let (mean, area) = mean_and_cross((0..count).map(at));
        for (corner, &slot) in face.iter().enumerate() {
            own[slot as usize] += lanes::to(polygon_gradient(mean, area, at(corner + count - 1), at(corner + 1), count));
        }
    }
    let inverse = |(gradient, &inverse_area): (&DVec3, &f32)| {
        let least = if inverse_area > 0.0 { GRADIENT_MIN / f64::from(inverse_area) } else { 0.0 };
        let length = (gradient.length() / (GRADIENT_PARTS * area_unit)).max(least);
        if length > 0.0 { length.recip() as f32 } else { 0.0 }
    };
    let inverse_gradients = own.iter().zip(inverse_areas).map(inverse).collect();
    for normal in &mut own {
        *normal = normal.normalize_or_zero();
    }
    let Some(diffusion) = Diffusion::new(Laplacian::new(places, faces), &over) else { return EvenNormals::default() };
    let even = diffusion.vectors(&own);
    let direction = |(even, own): (DVec3, &DVec3)| {
        let normal = if *own == DVec3::ZERO { DVec3::ZERO } else { (even + *own * OWN).normalize_or(*own) };
        lanes::from(*rest_from_armature * normal)
    };
    EvenNormals { directions: even.into_iter().zip(&own).map(direction).collect(), inverse_gradients }
}
