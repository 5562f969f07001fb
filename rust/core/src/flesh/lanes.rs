//! Numbers of eight points side by side, in plain loops that compile for the instruction set of who calls them.

use glam::{DMat3, DVec3};

use crate::numeric::block_rows::{Block, LANES};

/// Three coordinates of eight points.
pub(super) type Points8 = [Block<f32>; 3];

/// A number for each of eight points.
#[inline(always)]
pub(super) fn each(of: impl Fn(usize) -> f32) -> Block<f32> {
    let mut result = [0.0; LANES];
    for (lane, number) in result.iter_mut().enumerate() {
        *number = of(lane);
    }
    result
}

#[inline(always)]
pub(super) fn each3(of: impl Fn(usize) -> [f32; 3]) -> Points8 {
    let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        [x[lane], y[lane], z[lane]] = of(lane);
    }
    [x, y, z]
}

#[inline(always)]
pub(super) fn at(points: &Points8, lane: usize) -> [f32; 3] {
    [points[0][lane], points[1][lane], points[2][lane]]
}

#[inline(always)]
pub(super) fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

/// Columns.
#[inline(always)]
pub(super) fn single3(m: &DMat3) -> [[f32; 3]; 3] {
    [single(m.x_axis), single(m.y_axis), single(m.z_axis)]
}

#[inline(always)]
pub(super) fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn scale(a: [f32; 3], s: f32) -> [f32; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Image of a vector under columns.
#[inline(always)]
pub(super) fn image(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    add(add(scale(m[0], v[0]), scale(m[1], v[1])), scale(m[2], v[2]))
}

/// 3x² − 2x³, held at its ends.
#[inline(always)]
pub(super) fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// sin x and 1 − cos x of an angle in −180°..180°, by series of its half: to their last digits.
#[inline(always)]
pub(super) fn sine_and_versine(angle: f32) -> (f32, f32) {
    let half = 0.5 * angle;
    let square = half * half;
    let sine = half
        * (1.0
            + square
                * (-1.0 / 6.0
                    + square * (1.0 / 120.0 + square * (-1.0 / 5040.0 + square * (1.0 / 362_880.0 - square * (1.0 / 39_916_800.0))))));
    let cosine = 1.0
        + square
            * (-0.5
                + square
                    * (1.0 / 24.0
                        + square
                            * (-1.0 / 720.0 + square * (1.0 / 40_320.0 + square * (-1.0 / 3_628_800.0 + square * (1.0 / 479_001_600.0))))));
    (2.0 * sine * cosine, 2.0 * sine * sine)
}

/// A vector turned about a unit axis, less itself.
#[inline(always)]
pub(super) fn turned(axis: [f32; 3], v: [f32; 3], angle: f32) -> [f32; 3] {
    let (sine, versine) = sine_and_versine(angle);
    let across = cross(axis, v);
    add(scale(across, sine), scale(cross(axis, across), versine))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn series_are_sines(angle in -std::f32::consts::PI..std::f32::consts::PI) {
            let (sine, versine) = sine_and_versine(angle);
            let angle = f64::from(angle);
            prop_assert!((f64::from(sine) - angle.sin()).abs() < 3e-7);
            // Up to 2, where a last digit is 2.4e-7.
            prop_assert!((f64::from(versine) - (1.0 - angle.cos())).abs() < 1e-6);
        }
    }
}
