//! Where a frame of fleshing is exact.

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::spine::closest::Closest;
use crate::spine::curve::TASK;
use crate::spine::fleshing::{Flesh, FleshFrame, Fleshing};
use crate::spine::matching::Matching;
use crate::spine::planar::thin;

/// Part of its distance by which an image must be nearer to another station to count as overlapping.
const NEARER: f64 = 1e-6;
/// Directions about the spine in which the valid radius is looked for.
const DIRECTIONS: usize = 24;
/// Halvings of the valid radius.
const HALVINGS: usize = 40;

/// Where a frame is exact; one per point.
#[derive(Debug, Clone, Default)]
pub struct Validity {
    /// Held at the border of the valid space of the posed curvature.
    pub is_clamped: Vec<bool>,
    /// The image lies nearer to another station of the posed spine.
    pub is_overlapping: Vec<bool>,
    /// No unique station of the rest spine.
    pub is_ambiguous: Vec<bool>,
    /// Carried rigidly beyond the stations of the rest spine.
    pub is_beyond_ends: Vec<bool>,
    /// Part of the way from the posed spine to the border of the valid space.
    pub usage: Vec<f64>,
}

impl Validity {
    /// Points that are neither clamped nor overlapping nor ambiguous.
    pub fn valid_count(&self) -> usize {
        let flags = self.is_clamped.iter().zip(&self.is_overlapping).zip(&self.is_ambiguous);
        flags.filter(|((clamped, overlapping), ambiguous)| !(**clamped || **overlapping || **ambiguous)).count()
    }
}

impl Fleshing {
    /// Where a frame is exact. Projects every image on the posed spine; influence is not looked at.
    ///
    /// # Errors
    /// As `positions`.
    pub fn validity(&self, flesh: &Flesh, frame: &mut FleshFrame) -> Result<Validity> {
        self.flow(flesh, frame)?;
        let matching = self.matching(flesh)?;
        let (posed, search) = (flesh.spine.cells(), flesh.spine.search());
        let [first, last] = self.rest_spine().parameter_range();
        let rows = self.closest().par_iter().enumerate().with_min_len(TASK).map(|(point, closest)| {
            let (block, lane) = self.lane(point);
            let block = &frame.blocks[block];
            let image = DVec3::from_array(block.positions[lane]);
            let is_clamped = block.is_clamped[lane] || !image.is_finite();
            let ((cell, u), _) = matching.posed_place((closest.cell, closest.u), closest.cell);
            let station = posed.station(cell, u);
            let offset = image - DVec3::from(station.position);
            let own = offset.length();
            let is_overlapping = !is_clamped && {
                let Closest { distance, .. } = search.closest(posed, image);
                distance < own * (1.0 - NEARER)
            };
            let parameter = self.rest_spine().cells().parameter(closest.cell, closest.u);
            let curvature: DVec3 = (station.normal * station.curvature[0] + station.binormal * station.curvature[1]).into();
            let usage = if is_clamped { 1.0 } else { curvature.dot(offset).clamp(0.0, 1.0) };
            (is_clamped, is_overlapping, closest.is_ambiguous, !(first..=last).contains(&parameter), usage)
        });
        let rows: Vec<(bool, bool, bool, bool, f64)> = rows.collect();
        Ok(Validity {
            is_clamped: rows.iter().map(|row| row.0).collect(),
            is_overlapping: rows.iter().map(|row| row.1).collect(),
            is_ambiguous: rows.iter().map(|row| row.2).collect(),
            is_beyond_ends: rows.iter().map(|row| row.3).collect(),
            usage: rows.iter().map(|row| row.4).collect(),
        })
    }

    /// Radius about the rest spine, at parameters of it, within which no point is held at a border; infinite where both
    /// spines are straight.
    ///
    /// # Errors
    /// As `positions`.
    pub fn valid_radii(&self, flesh: &Flesh, parameters: &[f64]) -> Result<Vec<f64>> {
        let matching = self.matching(flesh)?;
        Ok(parameters.par_iter().map(|&parameter| self.valid_radius(flesh, &matching, parameter)).collect())
    }

    fn valid_radius(&self, flesh: &Flesh, matching: &Matching, parameter: f64) -> f64 {
        let (rest, posed) = (self.rest_spine().cells(), flesh.spine.cells());
        let place = rest.place(parameter);
        let at_rest = rest.station(place.0, place.1);
        let ((cell, u), rate) = matching.posed_place(place, place.0);
        let station = posed.station(cell, u);
        let growth = station.speed * rate / at_rest.speed;
        let bend = at_rest.curvature[0].hypot(at_rest.curvature[1]);
        let posed_bend = station.curvature[0].hypot(station.curvature[1]);
        let is_free = |radius: f64| {
            (0..DIRECTIONS).all(|i| {
                let (sine, cosine) = (std::f64::consts::TAU * i as f64 / DIRECTIONS as f64).sin_cos();
                // From the directions of both curvatures, which are the tightest.
                let about = |k: [f64; 2], length: f64| if length > 0.0 { [k[0] / length, k[1] / length] } else { [1.0, 0.0] };
                let (k, c) = (about(at_rest.curvature, bend), about(station.curvature, posed_bend));
                let mut clamped = 0.0;
                let p = [radius * (k[0] * cosine - k[1] * sine), radius * (k[1] * cosine + k[0] * sine)];
                let mut q = self.blend().unbend(p, at_rest.curvature);
                if flesh.stretch {
                    q = thin(q, growth, &mut clamped);
                }
                // Twist may turn any direction to the posed curvature.
                let length = q[0].hypot(q[1]);
                [1.0, std::f64::consts::FRAC_1_SQRT_2].iter().all(|along| {
                    let across = (1.0 - along * along).sqrt();
                    let q = [length * (along * c[0] - across * c[1]), length * (along * c[1] + across * c[0])];
                    self.blend().bend(q, station.curvature, &mut clamped);
                    clamped == 0.0
                })
            })
        };
        let start = 1.0 / bend.max(posed_bend);
        if !start.is_finite() {
            return if is_free(0.0) { f64::INFINITY } else { 0.0 };
        }
        let (mut low, mut high) = (0.0, if bend > 0.0 { 1.0 / bend } else { 4.0 * start * growth.sqrt().max(1.0) });
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_free(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }
}
