//! Sums over the faces of one patch: volume, gradient, the exact cubic. Positions lie in a buffer that bytes index without
//! checks; triangles and quads come four at a time, one to a lane.

use std::ops::Range;

use crate::lanes::{self, Four, V4, add, add_scaled, cross, mul, scale, sub};
use crate::patches::{PATCH_POINTS, Patch, Patches};
use crate::volume::VolumeCubic;

/// One vector per local point of a patch.
pub(crate) type Buffer = [V4; PATCH_POINTS];

/// Gradients are summed in this many parts: that of a quad needs no division then.
pub(crate) const GRADIENT_PARTS: f64 = 24.0;

/// Volume of the cones over a patch's faces with the origin.
#[inline(always)]
pub(crate) fn volume(patches: &Patches, patch: &Patch, p: &Buffer) -> f64 {
    let mut lanes24 = lanes::ZERO;
    for corners in &patches.quads[patch.quads.clone()] {
        let [a, b, c, d] = quad(p, corners);
        lanes24 = add(lanes24, a.add(b).add(c.add(d)).dot(c.sub(a).cross(d.sub(b))));
    }
    let mut lanes6 = lanes::ZERO;
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(p, corners);
        lanes6 = add(lanes6, a.dot(b.sub(a).cross(c.sub(a))));
    }
    for f in polygons(patches, &patch.polygons) {
        let (mean, area) = mean_and_cross(f.iter().map(|&i| p[i as usize]));
        lanes6 = add(lanes6, mul(mean, area));
    }
    lanes::sum(lanes24) / 24.0 + lanes::sum(lanes6) / 6.0
}

/// Volume and area vector of a patch's faces.
pub(crate) fn moment(patches: &Patches, patch: &Patch, p: &Buffer) -> (f64, V4) {
    let mut area2 = lanes::ZERO;
    let mut sum = |area: Four| area.to_rows().iter().for_each(|&row| area2 = add(area2, row));
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(p, corners);
        sum(b.sub(a).cross(c.sub(a)));
    }
    for corners in &patches.quads[patch.quads.clone()] {
        let [a, b, c, d] = quad(p, corners);
        sum(c.sub(a).cross(d.sub(b)));
    }
    for f in polygons(patches, &patch.polygons) {
        area2 = add(area2, mean_and_cross(f.iter().map(|&i| p[i as usize])).1);
    }
    (volume(patches, patch, p), scale(area2, 0.5))
}

/// Volume of a patch, and its derivative by each local point times `GRADIENT_PARTS` [MATH §1]; `gradient` starts at 0.
#[inline(always)]
pub(crate) fn volume_and_gradient(patches: &Patches, patch: &Patch, p: &Buffer, gradient: &mut Buffer) -> f64 {
    let mut lanes24 = lanes::ZERO;
    for corners in &patches.quads[patch.quads.clone()] {
        let [a, b, c, d] = quad(p, corners);
        let (first, second, all) = (c.sub(a), d.sub(b), a.add(b).add(c.add(d)));
        let area = first.cross(second);
        lanes24 = add(lanes24, all.dot(area));
        let (by_first, by_second) = (first.cross(all), second.cross(all));
        give(gradient, corners[0], area.sub(by_second));
        give(gradient, corners[1], area.add(by_first));
        give(gradient, corners[2], area.add(by_second));
        give(gradient, corners[3], area.sub(by_first));
    }
    let mut lanes6 = lanes::ZERO;
    for corners in &patches.triangles[patch.triangles.clone()] {
        let [a, b, c] = triangle(p, corners);
        // det(a, b, c) by each corner: exact also where the three do not sum to a third of the area vector.
        let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
        lanes6 = add(lanes6, a.dot(bc));
        give(gradient, corners[0], bc.scale(GRADIENT_PARTS / 6.0));
        give(gradient, corners[1], ca.scale(GRADIENT_PARTS / 6.0));
        give(gradient, corners[2], ab.scale(GRADIENT_PARTS / 6.0));
    }
    for f in polygons(patches, &patch.polygons) {
        let at = |i: u8| p[i as usize];
        let (mean, area) = mean_and_cross(f.iter().map(|&i| at(i)));
        lanes6 = add(lanes6, mul(mean, area));
        for (k, &i) in f.iter().enumerate() {
            let (next, previous) = (at(f[(k + 1) % f.len()]), at(f[(k + f.len() - 1) % f.len()]));
            gradient[i as usize] = add(gradient[i as usize], polygon_gradient(mean, area, previous, next, f.len()));
        }
    }
    lanes::sum(lanes24) / 24.0 + lanes::sum(lanes6) / 6.0
}

/// Derivative of a polygon's volume by a corner between `previous` and `next`, times `GRADIENT_PARTS`.
#[inline(always)]
pub(crate) fn polygon_gradient(mean: V4, area: V4, previous: V4, next: V4, corners: usize) -> V4 {
    let turning = cross(sub(next, previous), mean);
    scale(add_scaled(turning, area, 1.0 / corners as f64), GRADIENT_PARTS / 6.0)
}

/// V(P + tU) of a patch.
#[inline(always)]
pub(crate) fn volume_cubic(patches: &Patches, patch: &Patch, p: &Buffer, u: &Buffer) -> VolumeCubic {
    let mut quads = [lanes::ZERO; 4];
    for corners in &patches.quads[patch.quads.clone()] {
        let ([a, b, c, d], [ua, ub, uc, ud]) = (quad(p, corners), quad(u, corners));
        let mean = [a.add(b).add(c.add(d)), ua.add(ub).add(uc.add(ud))];
        add_cone(&mut quads, mean, [c.sub(a), uc.sub(ua)], [d.sub(b), ud.sub(ub)]);
    }
    let mut triangles = [lanes::ZERO; 4];
    for corners in &patches.triangles[patch.triangles.clone()] {
        let ([a, b, c], [ua, ub, uc]) = (triangle(p, corners), triangle(u, corners));
        add_cone(&mut triangles, [a, ua], [b.sub(a), ub.sub(ua)], [c.sub(a), uc.sub(ua)]);
    }
    let mut cubic = VolumeCubic(std::array::from_fn(|i| lanes::sum(quads[i]) / 24.0 + lanes::sum(triangles[i]) / 6.0));
    for f in polygons(patches, &patch.polygons) {
        cubic.join(&polygon_cubic(f.iter().map(|&i| (p[i as usize], u[i as usize]))));
    }
    cubic
}

/// Adds mean · (first × second), each linear in t.
#[inline(always)]
fn add_cone(sums: &mut [V4; 4], mean: [Four; 2], first: [Four; 2], second: [Four; 2]) {
    let area = first[0].cross(second[0]);
    let by_t = first[1].cross(second[0]).add(first[0].cross(second[1]));
    let by_t2 = first[1].cross(second[1]);
    sums[0] = add(sums[0], mean[0].dot(area));
    sums[1] = add(sums[1], add(mean[1].dot(area), mean[0].dot(by_t)));
    sums[2] = add(sums[2], add(mean[1].dot(by_t), mean[0].dot(by_t2)));
    sums[3] = add(sums[3], mean[1].dot(by_t2));
}

#[inline(always)]
fn four(p: &Buffer, [a, b, c, d]: [u8; 4]) -> Four {
    Four::from_rows([p[usize::from(a)], p[usize::from(b)], p[usize::from(c)], p[usize::from(d)]])
}

#[inline(always)]
fn triangle(p: &Buffer, [a, b, c]: &[[u8; 4]; 3]) -> [Four; 3] {
    [four(p, *a), four(p, *b), four(p, *c)]
}

#[inline(always)]
fn quad(p: &Buffer, [a, b, c, d]: &[[u8; 4]; 4]) -> [Four; 4] {
    [four(p, *a), four(p, *b), four(p, *c), four(p, *d)]
}

/// Adds to the gradient at one corner of four faces.
#[inline(always)]
fn give(gradient: &mut Buffer, [a, b, c, d]: [u8; 4], parts: Four) {
    let [at_a, at_b, at_c, at_d] = parts.to_rows();
    gradient[usize::from(a)] = add(gradient[usize::from(a)], at_a);
    gradient[usize::from(b)] = add(gradient[usize::from(b)], at_b);
    gradient[usize::from(c)] = add(gradient[usize::from(c)], at_c);
    gradient[usize::from(d)] = add(gradient[usize::from(d)], at_d);
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
fn polygons<'a>(patches: &'a Patches, range: &Range<usize>) -> impl Iterator<Item = &'a [u8]> {
    range.clone().map(|f| patches.polygons.row(f))
}
