//! Points as a frame needs them: where they stand on the rest spine, and where in its straightened plane.

use glam::DVec3;
use rayon::prelude::*;

use crate::numeric::real::{LANES, Lanes};
use crate::spine::closest::Closest;
use crate::spine::curve::{Spine, TASK};
use crate::spine::planar::{Blend, turn};

/// Bound points in the order of the spine, eight to a block; the last block is filled up with its last point.
#[derive(Debug, Clone)]
pub(crate) struct BoundPoints {
    pub cells: Vec<[u32; LANES]>,
    pub u: Vec<Lanes>,
    pub parameter: Vec<Lanes>,
    /// Offset in the plane of a straight spine, along normal and binormal.
    pub q: Vec<[Lanes; 2]>,
    /// 1 / length of the rest spine per parameter.
    pub per_speed: Vec<Lanes>,
}

impl BoundPoints {
    pub fn new(spine: &Spine, points: &[DVec3], closest: &[Closest], order: &[u32], blend: &Blend) -> Self {
        let count = order.len().div_ceil(LANES);
        let blocks = (0..count).into_par_iter().with_min_len(TASK / LANES).map(|block| {
            let lane = |lane: usize| {
                let point = order[(block * LANES + lane).min(order.len() - 1)] as usize;
                let Closest { cell, u, .. } = closest[point];
                let station = spine.cells().station(cell, u);
                let offset = points[point] - DVec3::from(station.position);
                let p = [offset.dot(station.normal.into()), offset.dot(station.binormal.into())];
                let q = turn(blend.unbend(p, station.curvature), -station.angle);
                (cell as u32, [u, spine.cells().parameter(cell, u), q[0], q[1], 1.0 / station.speed])
            };
            let lanes: [_; LANES] = std::array::from_fn(lane);
            (lanes.map(|lane| lane.0), std::array::from_fn::<Lanes, 5, _>(|i| lanes.map(|lane| lane.1[i])))
        });
        let blocks: Vec<([u32; LANES], [Lanes; 5])> = blocks.collect();
        Self {
            cells: blocks.iter().map(|block| block.0).collect(),
            u: blocks.iter().map(|block| block.1[0]).collect(),
            parameter: blocks.iter().map(|block| block.1[1]).collect(),
            q: blocks.iter().map(|block| [block.1[2], block.1[3]]).collect(),
            per_speed: blocks.iter().map(|block| block.1[4]).collect(),
        }
    }
}
