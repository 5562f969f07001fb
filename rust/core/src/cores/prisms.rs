//! Prisms between the faces of a patch and those of its core, each shared by the corners of its face.
//!
//! Walls between neighbours cancel: over a closed surface prisms sum to its volume less that of its core.

use fearless_simd::{Simd, f64x4};

use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::lanes::{self, Four, V4, add, add_scaled, cross, mul, scale, sub};
use crate::surface::patches::{Patch, Patches};
use crate::surface::sweeps::{Buffer, mean_and_cross, polygons, rung, strips, triangle};

/// Adds what each local point has of the prisms between skin `p` and core `m`.
#[inline(always)]
pub(crate) fn prisms<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer, m: &Buffer, by_point: &mut [f64; PATCH_POINTS]) {
    let mut share = |part: f64x4<S>, corners: [[u8; 4]; 4], count: usize| {
        let part: [f64; 4] = part.into();
        for corner in &corners[..count] {
            for lane in 0..4 {
                by_point[usize::from(corner[lane])] += part[lane];
            }
        }
    };
    for strip in strips(patches, patch) {
        let ((mut a, mut d), (mut ma, mut md)) = (rung(simd, p, &strip[0]), rung(simd, m, &strip[0]));
        for ends in strip.windows(2) {
            let ((b, c), (mb, mc)) = (rung(simd, p, &ends[1]), rung(simd, m, &ends[1]));
            // About the face's mean its own cone is 0.
            let o = ((a + d) + (b + c)).scale(0.25);
            let (pa, pb, pc, pd) = (a - o, b - o, c - o, d - o);
            let (qa, qb, qc, qd) = (ma - o, mb - o, mc - o, md - o);
            let walls = wall(pa, pb, qa, qb) + wall(pb, pc, qb, qc) + (wall(pc, pd, qc, qd) + wall(pd, pa, qd, qa));
            let core = ((qa + qb) + (qc + qd)).dot((qc - qa).cross(qd - qb));
            share((walls - core) * (1.0 / 96.0), [ends[0][0], ends[0][1], ends[1][0], ends[1][1]], 4);
            (a, d, ma, md) = (b, c, mb, mc);
        }
    }
    for corners in &patches.triangles[patch.triangles.clone()] {
        let ([a, b, c], [ma, mb, mc]) = (triangle(simd, p, corners), triangle(simd, m, corners));
        let o = (a + b + c).scale(1.0 / 3.0);
        let (pa, pb, pc, qa, qb, qc) = (a - o, b - o, c - o, ma - o, mb - o, mc - o);
        let walls = wall(pa, pb, qa, qb) + wall(pb, pc, qb, qc) + wall(pc, pa, qc, qa);
        let core = qa.dot((qb - qa).cross(qc - qa)) * 4.0;
        share((walls - core) * (1.0 / 72.0), [corners[0], corners[1], corners[2], [0; 4]], 3);
    }
    for f in polygons(patches, &patch.polygons) {
        let part = polygon_prism(f.len(), |i| (p[usize::from(f[i])], m[usize::from(f[i])])) / f.len() as f64;
        for &i in f {
            by_point[usize::from(i)] += part;
        }
    }
}

/// 24 times the cone over the wall of an edge from a to b, whose core runs from m to n.
#[inline(always)]
fn wall<S: Simd>(a: Four<S>, b: Four<S>, m: Four<S>, n: Four<S>) -> f64x4<S> {
    ((a + b) + (m + n)).dot((m - b).cross(n - a))
}

/// The prism of one polygon; `corner` tells its skin and its core.
pub(crate) fn polygon_prism(count: usize, corner: impl Fn(usize) -> (V4, V4)) -> f64 {
    let skin = (0..count).fold(lanes::ZERO, |sum, i| add(sum, corner(i).0));
    let o = scale(skin, 1.0 / count as f64);
    let about = |i: usize| {
        let (p, m) = corner(i % count);
        (sub(p, o), sub(m, o))
    };
    let walls = (0..count).fold(lanes::ZERO, |sum, i| {
        let ((a, m), (b, n)) = (about(i), about(i + 1));
        add(sum, mul(add(add(a, b), add(m, n)), cross(sub(m, b), sub(n, a))))
    });
    let (mean, area) = mean_and_cross((0..count).map(|i| about(i).1));
    lanes::sum(add_scaled(scale(walls, 1.0 / 24.0), mul(mean, area), -1.0 / 6.0))
}
