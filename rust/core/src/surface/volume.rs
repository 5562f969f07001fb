//! Enclosed volume of polygon meshes, one formula for triangles, quads and n-gons, and its exact cubic [RHC09 eq. 1–2, MATH §1–2].

use glam::DVec3;

/// Corner mean and twice the area vector of a polygon, from its corners in order.
#[inline]
pub(crate) fn polygon_mean_and_cross(corners: impl ExactSizeIterator<Item = DVec3> + Clone) -> (DVec3, DVec3) {
    let count = corners.len() as f64;
    let mean = corners.clone().sum::<DVec3>() / count;
    let mut cross = DVec3::ZERO;
    let mut previous = corners.clone().last().unwrap_or(mean) - mean;
    for corner in corners {
        let current = corner - mean;
        cross += previous.cross(current);
        previous = current;
    }
    (mean, cross)
}

/// Area vector of one face.
pub(crate) fn face_area_vector(points: &[DVec3], face: &[u32]) -> DVec3 {
    if face.is_empty() {
        return DVec3::ZERO;
    }
    polygon_mean_and_cross(face.iter().map(|&p| points[p as usize])).1 * 0.5
}

/// Volume of one face's cone with its apex at `origin`.
pub(crate) fn face_volume(points: &[DVec3], face: &[u32], origin: DVec3) -> f64 {
    if face.is_empty() {
        return 0.0;
    }
    let (mean, cross) = polygon_mean_and_cross(face.iter().map(|&p| points[p as usize] - origin));
    mean.dot(cross) / 6.0
}

/// Coefficients of V(P + tU), a cubic in t.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VolumeCubic(pub [f64; 4]);

impl VolumeCubic {
    /// Adds another part of the same surface.
    #[inline]
    pub(crate) fn join(&mut self, other: &Self) {
        for (sum, term) in self.0.iter_mut().zip(other.0) {
            *sum += term;
        }
    }

    /// Volume at t.
    pub fn at(&self, t: f64) -> f64 {
        let [c0, c1, c2, c3] = self.0;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    /// The t nearest 0 with V(P + tU) = target, by safeguarded Newton; `None` when the field cannot reach it.
    pub fn root_nearest_zero(&self, target: f64) -> Option<f64> {
        let [c0, c1, c2, c3] = self.0;
        let gap = target - c0;
        if gap == 0.0 {
            return Some(0.0);
        }
        if c1 == 0.0 || !gap.is_finite() {
            return None;
        }
        // Newton from the linear guess; a field that must be scaled beyond its own size has lost its meaning.
        let mut t = gap / c1;
        for _ in 0..50 {
            let slope = c1 + t * (2.0 * c2 + t * 3.0 * c3);
            if slope == 0.0 {
                return None;
            }
            let step = (t * (c1 + t * (c2 + t * c3)) - gap) / slope;
            t -= step;
            if step.abs() <= 1e-16 * t.abs().max(f64::MIN_POSITIVE) {
                break;
            }
        }
        let residual = (self.at(t) - target).abs();
        (t.is_finite() && residual <= 1e-9 * gap.abs() + 1e-14 * target.abs()).then_some(t)
    }
}
