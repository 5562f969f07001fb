//! What is skinned: one site per distinct pair of rest position and influences. Coincident vertices that move alike share one.
//!
//! Sites lie in the order of slots, so that a patch skins neighbours in memory.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec3;

use crate::numeric::csr::Csr;
use crate::numeric::lanes::{self, V4, add_scaled, scale};
use crate::skinning::blend::Influences;
use crate::surface::patches::{NO_SLOT, Patches};
use crate::surface::topology::Topology;

/// Sites of a mesh.
#[derive(Debug, Clone)]
pub(crate) struct Sites {
    /// Influences per site, on joints.
    pub influences: Influences,
    /// Rest position per site, about the mesh's centre.
    pub rest: Vec<V4>,
    pub site_of_vertex: Vec<u32>,
    /// Per slot and one past the last: first site. Padding has none.
    offsets: Vec<u32>,
    /// Part of its point that each site has: how many of its vertices it is. Empty where every point has one site.
    shares: Vec<f64>,
}

impl Sites {
    /// `rest` per vertex; vertices that differ in any of `shape_deltas` do not share a site.
    pub fn new(topology: &Topology, patches: &Patches, rest: &[DVec3], of_vertex: &Influences, shape_deltas: &[Vec<DVec3>]) -> Self {
        let slots: Vec<(u32, u32)> =
            topology.point_of_vertex.iter().zip(0..).map(|(&point, vertex)| (patches.slot_of_point[point as usize], vertex)).collect();
        let in_slots: Vec<(u32, u32)> = slots.iter().copied().filter(|(slot, _)| *slot != NO_SLOT).collect();
        let vertices_of_slot = Csr::from_pairs(patches.slot_count(), &in_slots);
        // All that tells coincident vertices apart; -0 is 0.
        let key_of = |vertex: u32| {
            let vertex = vertex as usize;
            let (bones, weights) = of_vertex.of(vertex);
            let places = std::iter::once(rest[vertex]).chain(shape_deltas.iter().map(|deltas| deltas[vertex]));
            let numbers = places.flat_map(|p| p.to_array()).chain([of_vertex.mask(vertex)]).chain(weights.iter().copied());
            numbers.map(|x| (x + 0.0).to_bits()).chain(bones.iter().map(|&bone| u64::from(bone))).collect::<Vec<u64>>()
        };
        let mut result = Self {
            influences: Influences { offsets: vec![0], bones: Vec::new(), weights: Vec::new(), mask: Vec::new() },
            rest: Vec::new(),
            site_of_vertex: vec![0; rest.len()],
            offsets: vec![0],
            shares: Vec::new(),
        };
        let mut shares = Vec::new();
        for coincident in vertices_of_slot.rows() {
            let first = result.rest.len();
            let mut leaders: Vec<(u32, f64)> = Vec::new();
            let mut place_of_key: HashMap<Vec<u64>, usize> = HashMap::new();
            for &vertex in coincident {
                let mut place = leaders.len();
                if coincident.len() > 1 {
                    place = *place_of_key.entry(key_of(vertex)).or_insert(place);
                }
                if place == leaders.len() {
                    leaders.push((vertex, 0.0));
                }
                leaders[place].1 += 1.0;
                result.site_of_vertex[vertex as usize] = (first + place) as u32;
            }
            for (leader, count) in leaders {
                result.push(of_vertex, leader as usize, rest);
                shares.push(count / coincident.len() as f64);
            }
            result.offsets.push(result.rest.len() as u32);
        }
        for &(_, vertex) in slots.iter().filter(|(slot, _)| *slot == NO_SLOT) {
            result.site_of_vertex[vertex as usize] = result.rest.len() as u32;
            result.push(of_vertex, vertex as usize, rest);
        }
        if shares.iter().any(|share| *share != 1.0) {
            shares.shrink_to_fit();
            result.shares = shares;
        }
        result.influences.shrink();
        result.rest.shrink_to_fit();
        result
    }

    fn push(&mut self, of_vertex: &Influences, vertex: usize, rest: &[DVec3]) {
        let (bones, weights) = of_vertex.of(vertex);
        self.influences.bones.extend_from_slice(bones);
        self.influences.weights.extend_from_slice(weights);
        self.influences.offsets.push(self.influences.bones.len() as u32);
        if !of_vertex.mask.is_empty() {
            self.influences.mask.push(of_vertex.mask[vertex]);
        }
        self.rest.push(lanes::from(rest[vertex]));
    }

    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Sites of the point in a slot.
    #[inline(always)]
    pub fn of_slot(&self, slot: usize) -> Range<usize> {
        self.offsets[slot] as usize..self.offsets[slot + 1] as usize
    }

    /// Part of its point.
    #[inline(always)]
    pub fn share(&self, site: usize) -> f64 {
        self.shares.get(site).copied().unwrap_or(1.0)
    }

    /// True where some point has several sites.
    pub fn is_split(&self) -> bool {
        !self.shares.is_empty()
    }

    /// Mean over the sites of a slot of any quantity per site.
    #[inline(always)]
    pub fn mean(&self, slot: usize, of_site: impl Fn(usize) -> V4) -> V4 {
        let mut sites = self.of_slot(slot);
        if sites.len() == 1 {
            return of_site(sites.start);
        }
        let first = sites.next().map_or(lanes::ZERO, |site| scale(of_site(site), self.share(site)));
        sites.fold(first, |sum, site| add_scaled(sum, of_site(site), self.share(site)))
    }

    pub fn memory_bytes(&self) -> usize {
        self.influences.memory_bytes()
            + size_of_val(&*self.rest)
            + size_of_val(&*self.site_of_vertex)
            + size_of_val(&*self.offsets)
            + size_of_val(&*self.shares)
    }
}
