//! Sums over the faces of one patch: volume, gradient, the exact cubic. Positions lie in a buffer that bytes index without
//! checks; triangles and strips of quads come four at a time, one to a lane.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x4};

use crate::numeric::block_rows::PATCH_POINTS;
use crate::numeric::lanes::{self, Four, V4, add, add_scaled, cross, mul, scale, sub};
use crate::surface::patches::{Patch, Patches};
use crate::surface::strips::Rung;
use crate::surface::volume::VolumeCubic;

/// One vector per local point of a patch.
pub(crate) type Buffer = [V4; PATCH_POINTS];

/// Gradients are summed in this many parts: that of a quad needs no division then.
pub(crate) const GRADIENT_PARTS: f64 = 24.0;

/// Volume of the cones over a patch's faces with the origin.
#[inline(always)]
pub(crate) fn volume<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer) -> f64 {
    let none = f64x4::splat(simd, 0.0);
    let (mut lanes24, mut lanes6) = (none, none);
    for_each_quad(
        simd,
        patches,
        patch,
        p,
        #[inline(always)]
        |[a, b, c, d]| lanes24 += (a + b + c + d).dot((c - a).cross(d - b)),
    );
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(simd, p, corners);
        lanes6 += a.dot((b - a).cross(c - a));
    }
    let mut polygon6 = lanes::ZERO;
    for f in polygons(patches, &patch.polygons) {
        let (mean, area) = mean_and_cross(f.iter().map(|&i| p[i as usize]));
        polygon6 = add(polygon6, mul(mean, area));
    }
    lanes::sum(lanes24.into()) / 24.0 + (lanes::sum(lanes6.into()) + lanes::sum(polygon6)) / 6.0
}

/// Volume and area vector of a patch's faces.
#[inline(always)]
pub(crate) fn moment<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer) -> (f64, V4) {
    let mut area2 = lanes::ZERO;
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(simd, p, corners);
        area2 = add(area2, (b - a).cross(c - a).sum());
    }
    for_each_quad(
        simd,
        patches,
        patch,
        p,
        #[inline(always)]
        |[a, b, c, d]| area2 = add(area2, (c - a).cross(d - b).sum()),
    );
    for f in polygons(patches, &patch.polygons) {
        area2 = add(area2, mean_and_cross(f.iter().map(|&i| p[i as usize])).1);
    }
    (volume(simd, patches, patch, p), scale(area2, 0.5))
}

/// Volume of a patch, and its derivative by each local point times `GRADIENT_PARTS` [MATH §1]; `gradient` starts at 0.
#[inline(always)]
pub(crate) fn volume_and_gradient<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer, gradient: &mut Buffer) -> f64 {
    let none = f64x4::splat(simd, 0.0);
    let (mut lanes24, mut lanes6) = (none, none);
    for strip in strips(patches, patch) {
        let nothing = Four::splat(simd, 0.0);
        let (mut a, mut d) = rung(simd, p, &strip[0]);
        let (mut by_a, mut by_d, mut behind) = (nothing, nothing, a + d);
        for ends in strip.windows(2) {
            let (b, c) = rung(simd, p, &ends[1]);
            let ahead = b + c;
            let (first, second, all) = (c - a, d - b, behind + ahead);
            let area = first.cross(second);
            lanes24 += all.dot(area);
            let (by_first, by_second) = (first.cross(all), second.cross(all));
            (by_a + (area - by_second)).scatter_add(simd, gradient, ends[0][0]);
            (by_d + (area - by_first)).scatter_add(simd, gradient, ends[0][1]);
            (by_a, by_d) = (area + by_first, area + by_second);
            (a, d, behind) = (b, c, ahead);
        }
        let [left, right] = strip[strip.len() - 1];
        by_a.scatter_add(simd, gradient, left);
        by_d.scatter_add(simd, gradient, right);
    }
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(simd, p, corners);
        // det(a, b, c) by each corner: exact also where the three do not sum to a third of the area vector.
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        lanes6 += a.dot(bc);
        bc.scale(GRADIENT_PARTS / 6.0).scatter_add(simd, gradient, corners[0]);
        ca.scale(GRADIENT_PARTS / 6.0).scatter_add(simd, gradient, corners[1]);
        ab.scale(GRADIENT_PARTS / 6.0).scatter_add(simd, gradient, corners[2]);
    }
    let mut polygon6 = lanes::ZERO;
    for f in polygons(patches, &patch.polygons) {
        let at = |i: u8| p[i as usize];
        let (mean, area) = mean_and_cross(f.iter().map(|&i| at(i)));
        polygon6 = add(polygon6, mul(mean, area));
        for (k, &i) in f.iter().enumerate() {
            let (next, previous) = (at(f[(k + 1) % f.len()]), at(f[(k + f.len() - 1) % f.len()]));
            gradient[i as usize] = add(gradient[i as usize], polygon_gradient(mean, area, previous, next, f.len()));
        }
    }
    lanes::sum(lanes24.into()) / 24.0 + (lanes::sum(lanes6.into()) + lanes::sum(polygon6)) / 6.0
}

/// Derivative of a polygon's volume by a corner between `previous` and `next`, times `GRADIENT_PARTS`.
#[inline(always)]
pub(crate) fn polygon_gradient(mean: V4, area: V4, previous: V4, next: V4, corners: usize) -> V4 {
    let turning = cross(sub(next, previous), mean);
    scale(add_scaled(turning, area, 1.0 / corners as f64), GRADIENT_PARTS / 6.0)
}

/// V(P + tU) of a patch.
#[inline(always)]
pub(crate) fn volume_cubic<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer, u: &Buffer) -> VolumeCubic {
    let none = [f64x4::splat(simd, 0.0); 4];
    let mut quads = none;
    for strip in strips(patches, patch) {
        let ((mut a, mut d), (mut ua, mut ud)) = (rung(simd, p, &strip[0]), rung(simd, u, &strip[0]));
        let (mut behind, mut u_behind) = (a + d, ua + ud);
        for next in &strip[1..] {
            let ((b, c), (ub, uc)) = (rung(simd, p, next), rung(simd, u, next));
            let (ahead, u_ahead) = (b + c, ub + uc);
            add_cone(&mut quads, [behind + ahead, u_behind + u_ahead], [c - a, uc - ua], [d - b, ud - ub]);
            (a, d, ua, ud) = (b, c, ub, uc);
            (behind, u_behind) = (ahead, u_ahead);
        }
    }
    let mut triangles = none;
    for corners in &patches.triangles[patch.triangles.clone()] {
        let ([a, b, c], [ua, ub, uc]) = (triangle(simd, p, corners), triangle(simd, u, corners));
        add_cone(&mut triangles, [a, ua], [b - a, ub - ua], [c - a, uc - ua]);
    }
    let coefficient = |i: usize| lanes::sum(quads[i].into()) / 24.0 + lanes::sum(triangles[i].into()) / 6.0;
    let mut cubic = VolumeCubic([coefficient(0), coefficient(1), coefficient(2), coefficient(3)]);
    for f in polygons(patches, &patch.polygons) {
        cubic.join(&polygon_cubic(f.iter().map(|&i| (p[i as usize], u[i as usize]))));
    }
    cubic
}

/// Adds mean · (first × second), each linear in t.
#[inline(always)]
fn add_cone<S: Simd>(sums: &mut [f64x4<S>; 4], mean: [Four<S>; 2], first: [Four<S>; 2], second: [Four<S>; 2]) {
    let area = first[0].cross(second[0]);
    sums[0] += mean[0].dot(area);
    let by_t = first[1].cross(second[0]) + first[0].cross(second[1]);
    sums[1] += mean[1].dot(area) + mean[0].dot(by_t);
    let by_t2 = first[1].cross(second[1]);
    sums[2] += mean[1].dot(by_t) + mean[0].dot(by_t2);
    sums[3] += mean[1].dot(by_t2);
}

#[inline(always)]
pub(crate) fn triangle<S: Simd>(simd: S, p: &Buffer, [a, b, c]: &[[u8; 4]; 3]) -> [Four<S>; 3] {
    [Four::gather(simd, p, *a), Four::gather(simd, p, *b), Four::gather(simd, p, *c)]
}

/// Corners in order, of four quads at a time.
#[inline(always)]
fn for_each_quad<S: Simd>(simd: S, patches: &Patches, patch: &Patch, p: &Buffer, mut visit: impl FnMut([Four<S>; 4])) {
    for strip in strips(patches, patch) {
        let (mut a, mut d) = rung(simd, p, &strip[0]);
        for next in &strip[1..] {
            let (b, c) = rung(simd, p, next);
            visit([a, b, c, d]);
            (a, d) = (b, c);
        }
    }
}

#[inline(always)]
pub(crate) fn strips<'a>(patches: &'a Patches, patch: &Patch) -> impl Iterator<Item = &'a [Rung]> {
    patch.strips.clone().map(|strip| patches.strips.row(strip))
}

#[inline(always)]
pub(crate) fn rung<S: Simd>(simd: S, p: &Buffer, [left, right]: &Rung) -> (Four<S>, Four<S>) {
    (Four::gather(simd, p, *left), Four::gather(simd, p, *right))
}

/// V(P + tU) of one polygon.
#[inline(always)]
pub(crate) fn polygon_cubic(corners: impl ExactSizeIterator<Item = (V4, V4)> + Clone) -> VolumeCubic {
    let count = corners.len() as f64;
    let (p, u) = corners.clone().fold((lanes::ZERO, lanes::ZERO), |(p, u), (q, v)| (add(p, q), add(u, v)));
    let mean = [scale(p, 1.0 / count), scale(u, 1.0 / count)];
    let mut area = [lanes::ZERO; 3];
    let Some((last, u_last)) = corners.clone().last() else { return VolumeCubic::default() };
    let (mut a, mut ua) = (sub(last, mean[0]), sub(u_last, mean[1]));
    for (q, v) in corners {
        let (b, ub) = (sub(q, mean[0]), sub(v, mean[1]));
        area[0] = add(area[0], cross(a, b));
        area[1] = add(area[1], add(cross(ua, b), cross(a, ub)));
        area[2] = add(area[2], cross(ua, ub));
        (a, ua) = (b, ub);
    }
    let of_t = [
        mul(mean[0], area[0]),
        add(mul(mean[1], area[0]), mul(mean[0], area[1])),
        add(mul(mean[1], area[1]), mul(mean[0], area[2])),
        mul(mean[1], area[2]),
    ];
    VolumeCubic(of_t.map(|lane| lanes::sum(lane) / 6.0))
}

/// Corner mean and twice the area vector of a polygon.
#[inline(always)]
pub(crate) fn mean_and_cross(corners: impl ExactSizeIterator<Item = V4> + Clone) -> (V4, V4) {
    let mean = scale(corners.clone().fold(lanes::ZERO, add), 1.0 / corners.len() as f64);
    let mut area = lanes::ZERO;
    let mut previous = sub(corners.clone().last().unwrap_or(mean), mean);
    for corner in corners {
        let current = sub(corner, mean);
        area = add(area, cross(previous, current));
        previous = current;
    }
    (mean, area)
}

#[inline(always)]
pub(crate) fn polygons<'a>(patches: &'a Patches, range: &Range<usize>) -> impl Iterator<Item = &'a [u8]> {
    range.clone().map(|f| patches.polygons.row(f))
}
