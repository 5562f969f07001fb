//! The body of a frame: the bound one, with shape keys mixed in, or one that the frame brings along.

use glam::DVec3;

use super::Pose;
use crate::binding::Binding;
use crate::error::{Error, Result, check_numbers, check_rows};
use crate::numeric::lanes::{self, V4};

/// Rest positions of one frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    /// Whether the frame has brought them.
    pub is_brought: bool,
    /// Per site, about the centre; empty where they are the bound ones.
    pub of_site: Vec<V4>,
    /// Brought along per vertex, where vertices share sites.
    of_vertex: Vec<V4>,
}

impl Body {
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.of_site) + size_of_val(&*self.of_vertex)
    }

    /// Whether vertices of one site rest at places of their own.
    pub fn is_split(&self) -> bool {
        !self.of_vertex.is_empty()
    }

    /// Rest position of each site.
    pub fn rest<'a>(&'a self, binding: &'a Binding) -> &'a [V4] {
        if self.of_site.is_empty() { &binding.sites.rest } else { &self.of_site }
    }

    pub fn rest_of_vertex(&self, binding: &Binding, vertex: usize) -> V4 {
        if self.is_split() { self.of_vertex[vertex] } else { self.rest(binding)[binding.sites.site_of_vertex[vertex] as usize] }
    }

    /// Sets the body of a frame. Returns its centre in object space, and how far it reaches from there.
    pub fn set(&mut self, binding: &Binding, pose: &Pose) -> Result<(DVec3, f64)> {
        if pose.shape_values.len() > binding.shape_deltas.len() {
            return Err(Error::Length { what: "shape_values", found: pose.shape_values.len(), needed: binding.shape_deltas.len() });
        }
        check_numbers("shape_values", pose.shape_values)?;
        self.of_vertex.clear();
        self.is_brought = pose.rest_positions.is_some();
        if let Some(positions) = pose.rest_positions {
            self.bring(binding, positions)
        } else {
            self.of_site.clear();
            if !binding.shape_deltas.is_empty() {
                self.of_site.resize(binding.sites.len(), lanes::ZERO);
                binding.mix_shapes(pose.shape_values, &mut self.of_site);
            }
            Ok((binding.rest_centre, binding.radius_with(pose.shape_values)))
        }
    }

    fn bring(&mut self, binding: &Binding, positions: &[[f32; 3]]) -> Result<(DVec3, f64)> {
        let needed = binding.slot_of_vertex.len();
        if positions.len() != needed {
            return Err(Error::Length { what: "rest_positions", found: positions.len(), needed });
        }
        check_rows("rest_positions", positions)?;
        let at = |position: &[f32; 3]| DVec3::from_array(position.map(f64::from));
        let centre = positions.iter().map(at).sum::<DVec3>() / needed.max(1) as f64;
        let sites = &binding.sites;
        let Self { of_site, of_vertex, .. } = self;
        of_site.clear();
        of_site.resize(sites.len(), lanes::ZERO);
        let mut radius_squared = 0.0f64;
        for (position, &site) in positions.iter().zip(&sites.site_of_vertex) {
            let place = at(position) - centre;
            radius_squared = radius_squared.max(place.length_squared());
            let sum = &mut of_site[site as usize];
            *sum = lanes::add(*sum, lanes::from(place));
        }
        if binding.has_shared_sites() {
            let mut counts = vec![0u32; sites.len()];
            for &site in &sites.site_of_vertex {
                counts[site as usize] += 1;
            }
            for (sum, count) in of_site.iter_mut().zip(counts) {
                *sum = lanes::scale(*sum, 1.0 / f64::from(count));
            }
            of_vertex.extend(positions.iter().map(|position| lanes::from(at(position) - centre)));
        }
        Ok((centre, radius_squared.sqrt()))
    }

    /// Whether losses are measured by stages, not in closed form.
    pub fn is_staged(&self, binding: &Binding) -> bool {
        self.is_brought || binding.plan.forms.is_none()
    }
}
