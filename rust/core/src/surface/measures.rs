//! Sums over all sound faces of a mesh by themselves: volume per component, gradient per point, the exact cubic.

use glam::DVec3;

use crate::numeric::lanes::{self, V4};
use crate::surface::sweeps::{GRADIENT_PARTS, mean_and_cross, polygon_cubic, polygon_gradient};
use crate::surface::topology::Topology;
use crate::surface::volume::{VolumeCubic, face_volume};

/// Faces whose volumes are summed before they join the total: long sums lose digits.
const BLOCK: usize = 256;

/// Volume of each component's cones with the origin.
pub(crate) fn volumes(topology: &Topology, points: &[DVec3]) -> Vec<f64> {
    let mut volumes = vec![0.0; topology.components.len()];
    let faces: Vec<(u32, &[u32])> = topology.component_of_face.iter().copied().zip(topology.faces.rows()).collect();
    for run in faces.chunk_by(|a, b| a.0 == b.0) {
        for block in run.chunks(BLOCK) {
            volumes[block[0].0 as usize] += block.iter().map(|(_, face)| face_volume(points, face, DVec3::ZERO)).sum::<f64>();
        }
    }
    volumes
}

/// Derivative of the volume by each point [MATH §1].
pub(crate) fn gradient(topology: &Topology, points: &[DVec3]) -> Vec<DVec3> {
    let mut gradient = vec![lanes::ZERO; points.len()];
    let mut corners: Vec<V4> = Vec::new();
    for face in topology.faces.rows() {
        corners.clear();
        corners.extend(face.iter().map(|&p| lanes::from(points[p as usize])));
        let (mean, area) = mean_and_cross(corners.iter().copied());
        for (i, &point) in face.iter().enumerate() {
            let (next, previous) = (corners[(i + 1) % face.len()], corners[(i + face.len() - 1) % face.len()]);
            let by_corner = polygon_gradient(mean, area, previous, next, face.len());
            gradient[point as usize] = lanes::add(gradient[point as usize], by_corner);
        }
    }
    gradient.into_iter().map(|g| lanes::to(g) / GRADIENT_PARTS).collect()
}

/// V(P + tU) of each component.
pub(crate) fn cubics(topology: &Topology, points: &[DVec3], field: &[DVec3]) -> Vec<VolumeCubic> {
    let mut cubics = vec![VolumeCubic::default(); topology.components.len()];
    for (face, &component) in topology.faces.rows().zip(&topology.component_of_face) {
        let corners = face.iter().map(|&p| (lanes::from(points[p as usize]), lanes::from(field[p as usize])));
        cubics[component as usize].join(&polygon_cubic(corners));
    }
    cubics
}
