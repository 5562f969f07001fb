//! Directions that fine detail rides along: normals of the skin at rest, evened out over a part of the flesh below.
//!
//! By its own gradient every wall of a navel would be pushed its own way, and torn from the others.

use glam::{DMat3, DVec3};

use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, V4};
use crate::skinning::sites::Sites;
use crate::surface::diffusion::Diffusion;
use crate::surface::laplacian::Laplacian;
use crate::surface::volume::face_area_vector;

/// Over which length, in lengths of the joints a point follows.
const LENGTH: f64 = 0.08;
/// Part of a point's own normal that is always left: the two sides of a thin edge would leave nothing.
const OWN: f64 = 0.02;

/// Per slot, a unit vector in armature space, taken to that of rest positions; 0 for points of no face. Empty where no joint has
/// a length, or numbers are beyond computing with.
///
/// `faces` as slots, `places` per slot and `lengths` per joint in armature space.
pub(crate) fn even_normals(faces: &Csr<u32>, places: &[DVec3], sites: &Sites, lengths: &[f64], rest_from_armature: &DMat3) -> Vec<V4> {
    let has_length = |joint: &&f64| **joint > 0.0;
    let count = lengths.iter().filter(has_length).count();
    if count == 0 {
        return Vec::new();
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
        let area = face_area_vector(places, face);
        face.iter().for_each(|&slot| own[slot as usize] += area);
    }
    own.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
    let Some(diffusion) = Diffusion::new(Laplacian::new(places, faces), &over) else { return Vec::new() };
    let even = diffusion.vectors(&own);
    let direction = |(even, own): (DVec3, &DVec3)| {
        let normal = if *own == DVec3::ZERO { DVec3::ZERO } else { (even + *own * OWN).normalize_or(*own) };
        lanes::from(*rest_from_armature * normal)
    };
    even.into_iter().zip(&own).map(direction).collect()
}
