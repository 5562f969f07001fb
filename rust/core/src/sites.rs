//! What is skinned: one site per distinct pair of rest position and influences. Twins that move alike share a site.

use std::collections::HashMap;

use glam::DVec3;

use crate::csr::Csr;
use crate::skinning::Influences;
use crate::topology::Topology;

/// Sites of a mesh. Vertices, sites and points are the same where nothing is split.
#[derive(Debug, Clone)]
pub(crate) struct Sites {
    /// Influences per site, on joints.
    pub influences: Influences,
    /// Rest position per site.
    pub rest: Vec<DVec3>,
    split: Option<Split>,
}

#[derive(Debug, Clone)]
struct Split {
    site_of_vertex: Vec<u32>,
    /// Sites of each point, as often as it has vertices there.
    sites_of_point: Csr<u32>,
}

impl Sites {
    /// `rest` per vertex; vertices that differ in any of `shape_deltas` do not share a site.
    pub fn new(topology: &Topology, rest: &[DVec3], influences: Influences, shape_deltas: &[Vec<DVec3>]) -> Self {
        if topology.is_identity() {
            return Self { influences, rest: rest.to_vec(), split: None };
        }
        let bits = |p: DVec3| p.to_array().map(f64::to_bits);
        let mut known: HashMap<(u32, Vec<u64>), u32> = HashMap::new();
        let mut first_vertex = Vec::new();
        let mut site_of_vertex = Vec::with_capacity(rest.len());
        for (vertex, &p) in rest.iter().enumerate() {
            let (bones, weights) = influences.of(vertex);
            let mut key: Vec<u64> = bits(p).to_vec();
            key.extend(shape_deltas.iter().flat_map(|deltas| bits(deltas[vertex])));
            key.extend(bones.iter().map(|&b| u64::from(b)));
            key.extend(weights.iter().map(|w| w.to_bits()));
            key.push(influences.mask(vertex).to_bits());
            let site = *known.entry((topology.point_of_vertex[vertex], key)).or_insert_with(|| {
                first_vertex.push(vertex);
                first_vertex.len() as u32 - 1
            });
            site_of_vertex.push(site);
        }
        let mut of_site = Influences { offsets: vec![0], bones: Vec::new(), weights: Vec::new(), mask: Vec::new() };
        for &vertex in &first_vertex {
            let (bones, weights) = influences.of(vertex);
            of_site.bones.extend_from_slice(bones);
            of_site.weights.extend_from_slice(weights);
            of_site.offsets.push(of_site.bones.len() as u32);
            if !influences.mask.is_empty() {
                of_site.mask.push(influences.mask[vertex]);
            }
        }
        let pairs: Vec<(u32, u32)> = topology.point_of_vertex.iter().copied().zip(site_of_vertex.iter().copied()).collect();
        let mut sites_of_point = Csr::default();
        for row in Csr::from_pairs(topology.point_count, &pairs).rows() {
            // One site is enough where all twins move alike.
            let alike = row.iter().all(|site| *site == row[0]);
            sites_of_point.push_row(row[..if alike { 1 } else { row.len() }].iter().copied());
        }
        Self {
            influences: of_site,
            rest: first_vertex.iter().map(|&vertex| rest[vertex]).collect(),
            split: Some(Split { site_of_vertex, sites_of_point }),
        }
    }

    pub fn len(&self) -> usize {
        self.rest.len()
    }

    #[inline]
    pub fn site_of_vertex(&self, vertex: usize) -> usize {
        self.split.as_ref().map_or(vertex, |split| split.site_of_vertex[vertex] as usize)
    }

    /// True when sites and points are the same.
    pub fn is_identity(&self) -> bool {
        self.split.is_none()
    }

    /// Mean over the sites of a point of any quantity per site.
    #[inline]
    pub fn mean(&self, point: usize, of_site: impl Fn(usize) -> DVec3) -> DVec3 {
        match &self.split {
            None => of_site(point),
            Some(split) => match split.sites_of_point.row(point) {
                [site] => of_site(*site as usize),
                sites => sites.iter().map(|&site| of_site(site as usize)).sum::<DVec3>() / sites.len() as f64,
            },
        }
    }

    /// Calls `visit(site, share)` for the sites of a point; shares sum to 1.
    pub fn visit(&self, point: usize, mut visit: impl FnMut(usize, f64)) {
        match &self.split {
            None => visit(point, 1.0),
            Some(split) => {
                let sites = split.sites_of_point.row(point);
                for &site in sites {
                    visit(site as usize, 1.0 / sites.len() as f64);
                }
            }
        }
    }

    /// Largest distance between the sites of one point.
    pub fn largest_gap(&self, positions: &[DVec3]) -> f64 {
        let Some(split) = &self.split else { return 0.0 };
        let mut gap = 0.0f64;
        for sites in split.sites_of_point.rows().filter(|sites| sites.len() > 1) {
            for &site in &sites[1..] {
                gap = gap.max(positions[site as usize].distance_squared(positions[sites[0] as usize]));
            }
        }
        gap.sqrt()
    }

    pub fn memory_bytes(&self) -> usize {
        let split = self.split.as_ref().map_or(0, |s| size_of_val(&*s.site_of_vertex) + s.sites_of_point.memory_bytes());
        self.influences.memory_bytes() + size_of_val(&*self.rest) + split
    }
}
