//! `Fleshing`: points bound to a rest spine once, and bent along a posed one each frame [MATH §5].

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::error::{Error, Result, check_finite};
use crate::numeric::real::{LANES, Lanes};
use crate::spine::bound_points::BoundPoints;
use crate::spine::closest::Closest;
use crate::spine::curve::{ClosestPoint, Spine, TASK};
use crate::spine::flow::{Block, Flow};
use crate::spine::matching::{Match, Matching};
use crate::spine::planar::{Blend, thin, turn};
use crate::spine::twist::{Twist, TwistCurve};

/// How one frame is posed.
#[derive(Debug, Clone, Copy)]
pub struct Flesh<'a> {
    /// The posed spine.
    pub spine: &'a Spine,
    /// Twist along the rest spine.
    pub twist: Twist<'a>,
    /// Length by which the body glides along the posed spine.
    pub slide: f64,
    /// Flesh grows thinner where the spine grows longer.
    pub stretch: bool,
}

impl<'a> Flesh<'a> {
    /// Along a spine, no twist, no slide, stretching.
    pub fn along(spine: &'a Spine) -> Self {
        Self { spine, twist: Twist::default(), slide: 0.0, stretch: true }
    }
}

/// Figures of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FleshingReport {
    /// Points held at the border of the valid space of the posed curvature.
    pub clamped_count: usize,
    /// Largest |fleshed − rest|.
    pub max_offset: f64,
}

/// Buffers of a frame, to be used again.
#[derive(Debug, Default)]
pub struct FleshFrame {
    pub(crate) blocks: Vec<Block>,
}

/// Points bound to a rest spine. Immutable; frames are computed in a `FleshFrame`.
#[derive(Debug, Clone)]
pub struct Fleshing {
    rest_spine: Arc<Spine>,
    rest: Arc<Vec<DVec3>>,
    influence: Option<Arc<Vec<f64>>>,
    /// One per point.
    closest: Arc<Vec<Closest>>,
    /// Place of each point among the bound ones.
    ranks: Arc<Vec<u32>>,
    bound: BoundPoints,
    blend: Blend,
    rule: Match,
}

impl Fleshing {
    /// Binds points. `influence` per point, in [0, 1]: part of the way that it goes.
    ///
    /// # Errors
    /// Points that are not finite, influences of another number or out of range.
    pub fn bind(rest_spine: Arc<Spine>, points: Vec<DVec3>, blend: Blend, rule: Match, influence: Option<Vec<f64>>) -> Result<Self> {
        check_finite("points", &points)?;
        if let Some(influence) = &influence {
            if influence.len() != points.len() {
                return Err(Error::Length { what: "influence", found: influence.len(), needed: points.len() });
            }
            if let Some(&found) = influence.iter().find(|w| !(0.0..=1.0).contains(*w)) {
                return Err(Error::Value { what: "influence", found, needed: "numbers from 0 to 1" });
            }
        }
        let (search, cells) = (rest_spine.search(), rest_spine.cells());
        let closest: Vec<Closest> = points.par_iter().with_min_len(TASK).map(|&p| search.closest(cells, p)).collect();
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let key = |i: u32| (closest[i as usize].cell, closest[i as usize].u);
        order.par_sort_unstable_by(|&a, &b| {
            let ((cell_a, u_a), (cell_b, u_b)) = (key(a), key(b));
            cell_a.cmp(&cell_b).then(u_a.total_cmp(&u_b)).then(a.cmp(&b))
        });
        let mut ranks = vec![0; points.len()];
        for (rank, &point) in order.iter().enumerate() {
            ranks[point as usize] = rank as u32;
        }
        let bound = BoundPoints::new(&rest_spine, &points, &closest, &order, &blend);
        Ok(Self {
            rest_spine,
            rest: Arc::new(points),
            influence: influence.map(Arc::new),
            closest: Arc::new(closest),
            ranks: Arc::new(ranks),
            bound,
            blend,
            rule,
        })
    }

    /// The same binding with another kind.
    #[must_use]
    pub fn with_blend(&self, blend: Blend) -> Self {
        let mut order = vec![0; self.ranks.len()];
        for (point, &rank) in self.ranks.iter().enumerate() {
            order[rank as usize] = point as u32;
        }
        let bound = BoundPoints::new(&self.rest_spine, &self.rest, &self.closest, &order, &blend);
        Self { bound, blend, ..self.clone() }
    }

    /// The spine at bind.
    pub fn rest_spine(&self) -> &Arc<Spine> {
        &self.rest_spine
    }

    /// Points at bind.
    pub fn rest(&self) -> &[DVec3] {
        &self.rest
    }

    /// Where each point stands on the rest spine.
    pub fn stations(&self) -> Vec<ClosestPoint> {
        self.closest.par_iter().with_min_len(TASK).map(|closest| self.rest_spine.closest_point(closest)).collect()
    }

    /// Fleshed positions.
    ///
    /// # Errors
    /// Spines that do not match, twist or slide that is not finite.
    pub fn positions(&self, flesh: &Flesh, frame: &mut FleshFrame) -> Result<Vec<DVec3>> {
        self.flow(flesh, frame)?;
        let mut positions = vec![DVec3::ZERO; self.rest.len()];
        self.write(frame, &mut positions, |_, fleshed| fleshed);
        Ok(positions)
    }

    /// Writes fleshed − rest, one per point.
    ///
    /// # Errors
    /// As `positions`, and another number of offsets than of points.
    pub fn deform(&self, flesh: &Flesh, frame: &mut FleshFrame, offsets: &mut [[f32; 3]]) -> Result<FleshingReport> {
        if offsets.len() != self.rest.len() {
            return Err(Error::Length { what: "offsets", found: offsets.len(), needed: self.rest.len() });
        }
        self.flow(flesh, frame)?;
        let max_square = self.write(frame, offsets, |rest, fleshed| (fleshed - rest).as_vec3().to_array());
        Ok(FleshingReport { clamped_count: self.clamped_count(frame), max_offset: max_square.sqrt() })
    }

    /// Where points about the posed spine come from. Influence is not looked at.
    ///
    /// # Errors
    /// As `positions`; points that are not finite.
    pub fn inverse(&self, flesh: &Flesh, points: &[DVec3]) -> Result<Vec<DVec3>> {
        check_finite("points", points)?;
        let matching = self.matching(flesh)?;
        let twist = self.twist(flesh)?;
        let (rest, posed, search) = (self.rest_spine.cells(), flesh.spine.cells(), flesh.spine.search());
        let origin = |&point: &DVec3| {
            let Closest { cell, u, .. } = search.closest(posed, point);
            let station = posed.station(cell, u);
            let offset = point - DVec3::from(station.position);
            let p = [offset.dot(station.normal.into()), offset.dot(station.binormal.into())];
            let place = matching.rest_place((cell, u));
            let at_rest = rest.station(place.0, place.1);
            let angle = twist.as_ref().map_or(0.0, |twist| twist.at(rest.parameter(place.0, place.1)));
            let mut q = turn(self.blend.unbend(p, station.curvature), -(station.angle + angle));
            if flesh.stretch {
                let (_, rate) = matching.posed_place(place, cell);
                q = thin(q, at_rest.speed / (station.speed * rate), &mut 0.0);
            }
            let p = self.blend.bend(turn(q, at_rest.angle), at_rest.curvature, &mut 0.0);
            let image = DVec3::from(at_rest.position + at_rest.normal * p[0] + at_rest.binormal * p[1]);
            if image.is_finite() { image } else { point }
        };
        Ok(points.par_iter().with_min_len(TASK).map(origin).collect())
    }

    /// Bound data.
    pub fn memory_bytes(&self) -> usize {
        let block = size_of::<[u32; LANES]>() + 5 * size_of::<Lanes>();
        let point = size_of::<DVec3>() + size_of::<Closest>() + size_of::<u32>();
        let influence = self.influence.as_ref().map_or(0, |influence| size_of_val(&***influence));
        self.bound.cells.len() * (block + size_of::<Block>()) + self.rest.len() * point + influence + self.rest_spine.memory_bytes()
    }

    pub(crate) fn blend(&self) -> &Blend {
        &self.blend
    }

    pub(crate) fn closest(&self) -> &[Closest] {
        &self.closest
    }

    pub(crate) fn matching<'a>(&'a self, flesh: &Flesh<'a>) -> Result<Matching<'a>> {
        Matching::new(&self.rest_spine, flesh.spine, self.rule, flesh.slide)
    }

    fn twist(&self, flesh: &Flesh) -> Result<Option<TwistCurve>> {
        TwistCurve::new(self.rest_spine.stations(), flesh.twist)
    }

    /// Images of all bound points, in their order.
    pub(crate) fn flow(&self, flesh: &Flesh, frame: &mut FleshFrame) -> Result<()> {
        let (matching, twist) = (self.matching(flesh)?, self.twist(flesh)?);
        frame.blocks.resize(self.bound.cells.len(), Block::default());
        let flow = Flow {
            bound: &self.bound,
            blend: &self.blend,
            cells: flesh.spine.cells().all(),
            matching: &matching,
            twist: twist.as_ref(),
            stretch: flesh.stretch,
        };
        flow.run(&mut frame.blocks);
        Ok(())
    }

    /// The block and lane of a point.
    pub(crate) fn lane(&self, point: usize) -> (usize, usize) {
        let rank = self.ranks[point] as usize;
        (rank / LANES, rank % LANES)
    }

    /// Image of a point, mixed by its influence; a point so far off that its image is no number stays.
    pub(crate) fn image(&self, frame: &FleshFrame, point: usize) -> DVec3 {
        let (block, lane) = self.lane(point);
        let fleshed = DVec3::from_array(frame.blocks[block].positions[lane]);
        let rest = self.rest[point];
        if !fleshed.is_finite() {
            return rest;
        }
        match &self.influence {
            Some(influence) if influence[point] < 1.0 => rest.lerp(fleshed, influence[point]),
            _ => fleshed,
        }
    }

    /// Hands the image of each point to `value`; the square of the largest offset.
    fn write<T: Send>(&self, frame: &FleshFrame, out: &mut [T], value: impl Fn(DVec3, DVec3) -> T + Sync) -> f64 {
        let tasks = out.par_chunks_mut(TASK * LANES).enumerate().map(|(task, chunk)| {
            let mut max_square = 0.0_f64;
            for (i, out) in chunk.iter_mut().enumerate() {
                let point = task * TASK * LANES + i;
                let (rest, fleshed) = (self.rest[point], self.image(frame, point));
                max_square = max_square.max(rest.distance_squared(fleshed));
                *out = value(rest, fleshed);
            }
            max_square
        });
        tasks.reduce(|| 0.0, f64::max)
    }

    fn clamped_count(&self, frame: &FleshFrame) -> usize {
        let counted = |(i, block): (usize, &Block)| {
            let filled = (self.rest.len() - i * LANES).min(LANES);
            block.is_clamped[..filled].iter().filter(|&&is_clamped| is_clamped).count()
        };
        frame.blocks.iter().enumerate().map(counted).sum()
    }
}
