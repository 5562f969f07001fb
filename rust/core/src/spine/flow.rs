//! One frame of fleshing: every bound point in closed form, eight at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use rayon::prelude::*;

use crate::numeric::real::{LANES, Lanes};
use crate::spine::bound_points::BoundPoints;
use crate::spine::cells::{Cell, CellAt};
use crate::spine::matching::Matching;
use crate::spine::planar::{Blend, thin, turn};
use crate::spine::twist::TwistCurve;

/// Blocks of one parallel task.
const TASK: usize = 64;
/// Eight images.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Block {
    pub positions: [[f64; 3]; LANES],
    /// Held at the border of the valid space.
    pub is_clamped: [bool; LANES],
}

/// What a frame is made from.
pub(crate) struct Flow<'a> {
    pub bound: &'a BoundPoints,
    pub blend: &'a Blend,
    pub cells: &'a [Cell],
    pub matching: &'a Matching<'a>,
    pub twist: Option<&'a TwistCurve>,
    pub stretch: bool,
}

/// Where eight points go on the posed spine.
struct Target {
    cells: [u32; LANES],
    u: Lanes,
    /// Derivative of the posed parameter by the rest one, per rest length.
    rate: Lanes,
    twist: Lanes,
}

impl Flow<'_> {
    /// All blocks of the bound points.
    pub fn run(&self, blocks: &mut [Block]) {
        let level = Level::new();
        blocks.par_chunks_mut(TASK).enumerate().for_each(|(task, blocks)| {
            dispatch!(level, simd => self.run_task(simd, task * TASK, blocks));
        });
    }

    #[inline(always)]
    fn run_task<S: Simd>(&self, simd: S, first: usize, blocks: &mut [Block]) {
        // Any cell that the posed spine has; bound ones are those of the rest spine.
        let mut loaded = (0, CellAt::splat(simd, &self.cells[0]));
        let mut hint = self.cells.len() / 2;
        for (i, block) in blocks.iter_mut().enumerate() {
            let target = self.target(simd, first + i, &mut hint);
            let cell = target.cells[0];
            if target.cells.iter().all(|&c| c == cell) {
                if loaded.0 != cell {
                    loaded = (cell, CellAt::splat(simd, &self.cells[cell as usize]));
                }
                *block = self.images(simd, first + i, &target, &loaded.1);
            } else {
                *block = self.images(simd, first + i, &target, &CellAt::gather(simd, self.cells, target.cells));
            }
        }
    }

    #[inline(always)]
    fn target<S: Simd>(&self, simd: S, block: usize, hint: &mut usize) -> Target {
        let (cells, u, per_speed) = (&self.bound.cells[block], &self.bound.u[block], &self.bound.per_speed[block]);
        let mut target = Target { cells: *cells, u: *u, rate: *per_speed, twist: [0.0; LANES] };
        if !self.matching.is_same() {
            let (cells, u, rate) = self.matching.posed_places(simd, *cells, *u, hint);
            (target.cells, target.u) = (cells, u);
            target.rate = std::array::from_fn(|lane| rate[lane] * per_speed[lane]);
        }
        if let Some(twist) = self.twist {
            target.twist = std::array::from_fn(|lane| twist.at(self.bound.parameter[block][lane]));
        }
        target
    }

    #[inline(always)]
    fn images<S: Simd>(&self, simd: S, block: usize, target: &Target, cell: &CellAt<f64x8<S>>) -> Block {
        let lanes = |numbers: &Lanes| f64x8::simd_from(simd, *numbers);
        let station = cell.at(lanes(&target.u));
        let mut clamped = f64x8::splat(simd, 0.0);
        let q = self.bound.q[block].each_ref().map(lanes);
        let thinned = if self.stretch { thin(q, station.speed * lanes(&target.rate), &mut clamped) } else { q };
        let turned = turn(thinned, station.angle + lanes(&target.twist));
        let p = self.blend.bend(turned, station.curvature, &mut clamped);
        let image = station.position + station.normal * p[0] + station.binormal * p[1];
        let [x, y, z]: [Lanes; 3] = [image.x.into(), image.y.into(), image.z.into()];
        let clamped: Lanes = clamped.into();
        Block { positions: std::array::from_fn(|lane| [x[lane], y[lane], z[lane]]), is_clamped: clamped.map(|clamped| clamped != 0.0) }
    }
}
