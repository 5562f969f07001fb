//! How high a joint's field is at the points of one patch, eight at a time: its bell, or the artist's profiles [MATH §4].

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8, u32x8};

use crate::fields::field::FieldFrame;
use crate::fields::joint::Profiles;
use crate::fields::profile::{BELL_END, BELL_WIDTH, Profile};
use crate::fields::supports::Support;
use crate::numeric::block_rows::{Block, LANES, PATCH_POINTS};
use crate::surface::patches::Rows;

/// Heights at all points that a joint may move of a patch.
pub(crate) type Heights = [Block<f32>; PATCH_POINTS / LANES];

pub(crate) const NO_HEIGHTS: Heights = [[0.0; LANES]; PATCH_POINTS / LANES];

/// Places of the points of a patch, about a joint.
struct Around<'a, S: Simd> {
    places: [&'a [Block<f32>]; 3],
    origin: [f32x8<S>; 3],
}

impl<'a, S: Simd> Around<'a, S> {
    #[inline(always)]
    fn new(simd: S, [x, y, z]: Rows<'a>, frame: &FieldFrame) -> Self {
        let [a, b, c] = frame.origin.as_vec3().to_array();
        Self {
            places: [x.as_chunks().0, y.as_chunks().0, z.as_chunks().0],
            origin: [f32x8::splat(simd, a), f32x8::splat(simd, b), f32x8::splat(simd, c)],
        }
    }

    #[inline(always)]
    fn at(&self, simd: S, number: usize) -> [f32x8<S>; 3] {
        let u = f32x8::simd_from(simd, self.places[0][number]) - self.origin[0];
        let v = f32x8::simd_from(simd, self.places[1][number]) - self.origin[1];
        [u, v, f32x8::simd_from(simd, self.places[2][number]) - self.origin[2]]
    }
}

/// A joint's bell.
pub(crate) struct Bell<'a, S: Simd> {
    around: Around<'a, S>,
    narrowness: f32,
}

impl<'a, S: Simd> Bell<'a, S> {
    #[inline(always)]
    pub fn new(simd: S, places: Rows<'a>, frame: &FieldFrame) -> Self {
        let narrowness = (frame.inverse_length * frame.inverse_length / (BELL_WIDTH * BELL_WIDTH * BELL_END)) as f32;
        Self { around: Around::new(simd, places, frame), narrowness }
    }

    /// Weights times the heights at the points of a block.
    #[inline(always)]
    pub fn times(&self, simd: S, weights: &Block<f32>, number: usize) -> f32x8<S> {
        let [u, v, w] = self.around.at(simd, number);
        let (none, all) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let base = all - (u * u + v * v + w * w) * self.narrowness;
        let base = base.simd_gt(none).select(base, none);
        let square = base * base;
        let fourth = square * square;
        f32x8::simd_from(simd, *weights) * (fourth * fourth)
    }
}

/// Weights times the artist's profiles, for each block of weights.
pub(crate) fn drawn(support: Support, places: Rows, frame: &FieldFrame, profiles: &Profiles, heights: &mut [Block<f32>]) {
    dispatch!(Level::new(), simd => drawn_by_lanes(simd, support, places, frame, profiles, heights));
}

#[inline(always)]
fn drawn_by_lanes<S: Simd>(simd: S, support: Support, places: Rows, frame: &FieldFrame, profiles: &Profiles, heights: &mut [Block<f32>]) {
    let around = Around::new(simd, places, frame);
    let axes = frame.axes.map(|axis| (axis * frame.inverse_length).as_vec3().to_array());
    let folded = frame.folded() as f32;
    for ((number, weights), heights) in support.present.numbered(support.weights).zip(heights) {
        let [u, v, w] = around.at(simd, number);
        let mut height = f32x8::simd_from(simd, *weights);
        for axis in 0..3 {
            let [a, b, c] = axes[axis];
            let x = u * a + v * b + w * c;
            let mut curve = curve_at(simd, &profiles.axes[axis], x);
            if let Some((curves, _)) = &profiles.folded {
                curve += (curve_at(simd, &curves[axis], x) - curve) * folded;
            }
            height *= curve;
        }
        *heights = height.into();
    }
}

/// `Profile::at` of eight places.
#[inline(always)]
fn curve_at<S: Simd>(simd: S, profile: &Profile, x: f32x8<S>) -> f32x8<S> {
    let lines = profile.lines();
    let steps = lines.len() as f32;
    let none = f32x8::splat(simd, 0.0);
    let place = (x + 1.0) * (0.5 * steps);
    let is_inside = place.simd_gt(none) & place.simd_lt(f32x8::splat(simd, steps));
    let place = is_inside.select(place, none);
    let indices: [u32; LANES] = u32x8::truncate_from(place).into();
    let (mut starts, mut rises) = ([0.0; LANES], [0.0; LANES]);
    for ((start, rise), index) in starts.iter_mut().zip(&mut rises).zip(indices) {
        [*start, *rise] = lines[index as usize];
    }
    let height = f32x8::simd_from(simd, starts) + f32x8::simd_from(simd, rises) * place.fract();
    is_inside.select(height, none)
}

/// Place, and weight times bell and times profiles, if any, of the points of a patch that a joint may move.
pub(crate) fn of_points(
    support: Support,
    places: Rows,
    frame: &FieldFrame,
    profiles: Option<&Profiles>,
) -> impl Iterator<Item = (usize, f32, f32)> {
    let (mut round, mut shaped) = (NO_HEIGHTS, NO_HEIGHTS);
    dispatch!(Level::new(), simd => bells_by_lanes(simd, support, places, frame, &mut round));
    if let Some(profiles) = profiles {
        drawn(support, places, frame, profiles, &mut shaped);
    }
    let blocks = support.present.numbered(support.weights).enumerate();
    blocks.flat_map(move |(row, (number, weights))| {
        let points = (0..LANES).filter(|&lane| weights[lane] > 0.0);
        points.map(move |lane| (number * LANES + lane, round[row][lane], shaped[row][lane]))
    })
}

#[inline(always)]
fn bells_by_lanes<S: Simd>(simd: S, support: Support, places: Rows, frame: &FieldFrame, heights: &mut Heights) {
    let bell = Bell::new(simd, places, frame);
    for ((number, weights), heights) in support.present.numbered(support.weights).zip(heights) {
        *heights = bell.times(simd, weights, number).into();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn eight_places_are_as_high_as_one(samples in prop::collection::vec(0.0..1.0f64, 2..200), places in prop::array::uniform8(-1.5..1.5f32)) {
            let profile = Profile::new(&samples).unwrap();
            let found: [f32; LANES] = dispatch!(Level::new(), simd => curve_at(simd, &profile, f32x8::simd_from(simd, places)).into());
            let rounding = 1e-6 * samples.len() as f64;
            for (height, x) in found.into_iter().zip(places) {
                prop_assert!((f64::from(height) - profile.at(f64::from(x))).abs() <= rounding);
            }
        }
    }

    #[test]
    fn ends_and_places_that_are_none_have_no_height() {
        let profile = Profile::new(&[1.0, 1.0, 1.0]).unwrap();
        let places = [-1.0, 1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.1, 1.1, 0.0];
        let found: [f32; LANES] = dispatch!(Level::new(), simd => curve_at(simd, &profile, f32x8::simd_from(simd, places)).into());
        assert_eq!(found, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }
}
