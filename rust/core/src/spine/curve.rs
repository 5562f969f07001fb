//! `Spine`: the curve that drives fleshing [MATH §5].

use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;

use crate::error::{Error, LARGEST, Result, SMALLEST, check_finite, check_numbers};
use crate::numeric::real::sine_cosine;
use crate::spine::arc_length::ArcLength;
use crate::spine::b_spline::{BSpline, KnotFlags};
use crate::spine::cells::{Cells, Station};
use crate::spine::closest::{Closest, Search};
use crate::spine::frames::{across, any_across, least_rotation};
use crate::spine::imported_curve::{ImportedCurve, RESOLUTION_MAX, Samples};
use crate::spine::interpolation::End;
use crate::spine::pieces::{Bare, b_spline, polynomial};

/// An end piece of a trimmed spine is at least this part of a whole one.
const TRIMMED_PIECE_MIN: f64 = 0.25;
/// Stations nearer to a trimmed end than this part of their mean distance are left out.
const TRIMMED_STATION_MIN: f64 = 0.05;

/// Points of one parallel task.
pub(crate) const TASK: usize = 256;

/// How a curve is made from points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Quintic, four times differentiable, through the points, straight at its ends.
    #[default]
    Spline,
    /// One polynomial through the points \[ZR13\].
    Polynomial,
    /// Quintic non-uniform B-spline over the points \[ZR13\].
    BSpline,
}

/// Parameters of the points that a curve is made from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Parameters<'a> {
    /// Steps are the distances of the points.
    #[default]
    Chord,
    /// Steps are the roots of the distances: calmer where they differ much.
    Centripetal,
    /// One per point, rising.
    Given(&'a [f64]),
}

/// A curve of Blender is followed to within a tolerance, or with so many samples per segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// The fewest samples that keep the deviation below this part of the length.
    Tolerance(f64),
    /// Samples per segment.
    Samples(usize),
}

/// The place of a spine that is closest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// Also beyond the ends, on their tangents.
    pub parameter: f64,
    /// On the spine.
    pub position: DVec3,
    /// Of the point from it.
    pub distance: f64,
    /// Before the first or after the last station.
    pub is_beyond_ends: bool,
    /// Another place is as near, or the point is a centre of curvature.
    pub is_ambiguous: bool,
}

/// An open curve with rotation-minimising frames, rigid beyond its ends.
#[derive(Debug)]
pub struct Spine {
    /// Method and parameters of the points; None: from another curve.
    made_by: Option<(Method, Vec<f64>)>,
    stations: Vec<f64>,
    /// Piece that begins at the first station; those before it are a run-out.
    first_piece: usize,
    cells: Cells,
    /// First axis of the frame at the first station.
    normal: DVec3,
    resolution: usize,
    /// Places of the imported curve.
    checks: Vec<DVec3>,
    deviation: OnceLock<f64>,
    arc_length: OnceLock<ArcLength>,
    search: OnceLock<Search>,
}

impl Spine {
    /// A curve made from points. `normal`: first axis of the frames at the first point, as far as it is across the tangent.
    ///
    /// # Errors
    /// Fewer than two points, coincident neighbours, values that are not finite, parameters that do not rise.
    pub fn new(points: &[DVec3], method: Method, parameters: Parameters, normal: Option<DVec3>) -> Result<Self> {
        check_points("points", points)?;
        let parameters = parameters_of(points, parameters)?;
        let (pieces, checks) = match method {
            Method::Spline => (Bare::new(&parameters, points, [End::Straight; 2]), Vec::new()),
            Method::Polynomial => polynomial(&parameters, points),
            Method::BSpline => (b_spline(&parameters, points), Vec::new()),
        };
        let stations = match method {
            Method::BSpline => BSpline::clamped(&parameters, points).centres(),
            _ => parameters.clone(),
        };
        Self::assemble(Some((method, parameters)), pieces, stations, 1, checks, normal)
    }

    /// Blender's Bézier spline.
    ///
    /// # Errors
    /// As `new`, and handles of other lengths.
    pub fn from_bezier(
        points: &[DVec3],
        left_handles: &[DVec3],
        right_handles: &[DVec3],
        resolution: Resolution,
        normal: Option<DVec3>,
    ) -> Result<Self> {
        check_points("points", points)?;
        for (what, handles) in [("left_handles", left_handles), ("right_handles", right_handles)] {
            check_length(what, handles.len(), points.len())?;
            check_finite(what, handles)?;
        }
        Self::from_imported(&ImportedCurve::bezier(points, left_handles, right_handles), resolution, normal)
    }

    /// Blender's NURBS spline; its stations are the ends of its spans.
    ///
    /// # Errors
    /// As `new`; weights of another length or not above 0; an order out of range, or above what the points can bear.
    pub fn from_nurbs(
        points: &[DVec3],
        weights: &[f64],
        order: usize,
        flags: KnotFlags,
        resolution: Resolution,
        normal: Option<DVec3>,
    ) -> Result<Self> {
        check_count("points", points.len())?;
        check_finite("points", points)?;
        check_size("points", points)?;
        check_length("weights", weights.len(), points.len())?;
        if let Some(&found) = weights.iter().find(|w| !(SMALLEST..=LARGEST).contains(*w)) {
            return Err(Error::Value { what: "weights", found, needed: "numbers above 0, from 1e-30 to 1e15" });
        }
        if !(2..=6).contains(&order) || order > points.len() {
            return Err(Error::Value { what: "order", found: order as f64, needed: "2 to 6, and not more than there are points" });
        }
        let spline = BSpline::of_blender(points, weights, order, flags).ok_or(Error::NoSpan { found: points.len(), order })?;
        Self::from_imported(&ImportedCurve::nurbs(spline), resolution, normal)
    }

    /// Blender's poly spline, its corners rounded.
    ///
    /// # Errors
    /// As `new`.
    pub fn from_poly(points: &[DVec3], resolution: Resolution, normal: Option<DVec3>) -> Result<Self> {
        check_points("points", points)?;
        Self::from_imported(&ImportedCurve::Poly(points.to_vec()), resolution, normal)
    }

    fn from_imported(curve: &ImportedCurve, resolution: Resolution, normal: Option<DVec3>) -> Result<Self> {
        match resolution {
            Resolution::Samples(count) if (1..=RESOLUTION_MAX).contains(&count) => Self::from_samples(curve.samples(count)?, normal),
            Resolution::Samples(count) => {
                Err(Error::Value { what: "resolution", found: count as f64, needed: "1 to 64 samples per segment" })
            }
            Resolution::Tolerance(part) if part > 0.0 && part.is_finite() => {
                let mut count = 1;
                loop {
                    let spine = Self::from_samples(curve.samples(count)?, normal)?;
                    if count == RESOLUTION_MAX || spine.deviation() <= part * spine.length() {
                        return Ok(spine);
                    }
                    count *= 2;
                }
            }
            Resolution::Tolerance(found) => Err(Error::Value { what: "tolerance", found, needed: "a number above 0" }),
        }
    }

    fn from_samples(samples: Samples, normal: Option<DVec3>) -> Result<Self> {
        let Samples { parameters, points, ends, resolution, checks } = samples;
        let stations = parameters.iter().copied().step_by(resolution).collect();
        Self::assemble(None, Bare::new(&parameters, &points, ends), stations, resolution, checks, normal)
    }

    fn assemble(
        made_by: Option<(Method, Vec<f64>)>,
        bare: Bare,
        stations: Vec<f64>,
        resolution: usize,
        checks: Vec<DVec3>,
        normal: Option<DVec3>,
    ) -> Result<Self> {
        let Bare { breaks, pieces, first_piece } = bare;
        let tangent = pieces[first_piece].0[1].normalize_or(DVec3::X);
        let normal = match normal {
            Some(normal) => {
                check_finite("normal", &[normal])?;
                across(normal, tangent)
            }
            None => any_across(tangent),
        };
        if let Some(row) = pieces.iter().position(|piece| piece.0.iter().any(|c| !c.is_finite())) {
            return Err(Error::NotFinite { what: "curve between its points", row });
        }
        let cells = Cells::new(&breaks, &pieces, first_piece, normal);
        Ok(Self {
            made_by,
            stations,
            first_piece,
            cells,
            normal,
            resolution,
            checks,
            deviation: OnceLock::new(),
            arc_length: OnceLock::new(),
            search: OnceLock::new(),
        })
    }

    /// A pose: this spine's method and parameters with other points. Without `normal`, this spine's is turned by the least
    /// rotation that turns its first tangent.
    ///
    /// # Errors
    /// Another number of points, points that are not finite or coincide; spines of curves of Blender, or trimmed ones.
    pub fn posed(&self, points: &[DVec3], normal: Option<DVec3>) -> Result<Self> {
        let Some((method, parameters)) = &self.made_by else { return Err(Error::NotPoseable) };
        check_length("points", points.len(), self.stations.len())?;
        let make = |normal| Self::new(points, *method, Parameters::Given(parameters), normal);
        let posed = make(normal)?;
        if normal.is_some() {
            return Ok(posed);
        }
        make(Some(least_rotation(self.start_tangent(), posed.start_tangent(), self.normal)))
    }

    /// The part between two parameters, straight at its ends and rigid beyond.
    ///
    /// # Errors
    /// Ends that are not in order within the stations.
    pub fn trimmed(&self, start: f64, end: f64) -> Result<Self> {
        let [first, last] = self.parameter_range();
        if !(first <= start && start < end && end <= last) {
            return Err(Error::Trim { start, end, first, last });
        }
        // Two pieces for one, so that the straight ends reach less far.
        let halves = self.cells.breaks().windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).chain([last]);
        let mut parameters: Vec<f64> = std::iter::once(start).chain(halves.filter(|t| (start..end).contains(t) && *t != start)).collect();
        parameters.push(end);
        for is_end in [false, true] {
            let count = parameters.len();
            if count > 2 {
                let (outer, inner) = if is_end { (count - 2, count - 3) } else { (1, 2) };
                let edge = if is_end { end } else { start };
                if (parameters[outer] - edge).abs() < TRIMMED_PIECE_MIN * (parameters[inner] - parameters[outer]).abs() {
                    parameters.remove(outer);
                }
            }
        }
        let points: Vec<DVec3> = parameters.iter().map(|&t| self.position(t)).collect();
        let between = parameters.windows(2).flat_map(|w| [0.25, 0.5, 0.75].map(|u| w[0] + u * (w[1] - w[0])));
        let checks = between.map(|t| self.position(t)).collect();
        // No station hair's breadth from an end: what is given at both would have any rate between them.
        let near = TRIMMED_STATION_MIN * (last - first) / (self.stations.len() - 1) as f64;
        let inner = self.stations.iter().copied().filter(|&t| start + near < t && t < end - near);
        let stations = std::iter::once(start).chain(inner).chain([end]).collect();
        let pieces = Bare::new(&parameters, &points, [End::Straight; 2]);
        let normal = self.frame(start)[1];
        Self::assemble(None, pieces, stations, self.resolution, checks, Some(normal))
    }

    /// Number of stations.
    pub fn station_count(&self) -> usize {
        self.stations.len()
    }

    /// Parameter of each station.
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Parameters of the first and the last station.
    pub fn parameter_range(&self) -> [f64; 2] {
        [self.stations[0], self.stations[self.stations.len() - 1]]
    }

    /// Samples per segment.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    /// Largest distance of the imported curve, at samples between those that the spline passes through, from this one.
    pub fn deviation(&self) -> f64 {
        *self.deviation.get_or_init(|| {
            let distances = self.checks.iter().map(|&p| self.search().closest(&self.cells, p).distance);
            distances.fold(0.0, f64::max)
        })
    }

    /// Places where the tangent turns by more than a right angle within a cell.
    pub fn fold_count(&self) -> usize {
        self.cells.fold_count()
    }

    /// Length from the first to the last station.
    pub fn length(&self) -> f64 {
        self.arc_length_at(self.parameter_range()[1])
    }

    /// Length along the curve from the first station.
    pub fn arc_length_at(&self, parameter: f64) -> f64 {
        self.arc_length().at_parameter(&self.cells, parameter)
    }

    /// Parameter at a length along the curve from the first station.
    pub fn parameter_at(&self, arc_length: f64) -> f64 {
        self.arc_length().parameter(&self.cells, arc_length)
    }

    /// Position at a parameter.
    pub fn position(&self, parameter: f64) -> DVec3 {
        let (cell, u) = self.cells.place(parameter);
        self.cells.station(cell, u).position.into()
    }

    /// Tangent, normal and binormal at a parameter.
    pub fn frame(&self, parameter: f64) -> [DVec3; 3] {
        let (cell, u) = self.cells.place(parameter);
        let station = self.cells.station(cell, u);
        let (sine, cosine) = sine_cosine(station.angle);
        let normal = station.normal * cosine + station.binormal * sine;
        let binormal = station.binormal * cosine - station.normal * sine;
        [station.tangent.into(), normal.into(), binormal.into()]
    }

    /// Curvature vector at a parameter: to the centre of curvature, 1 / radius long.
    pub fn curvature(&self, parameter: f64) -> DVec3 {
        let (cell, u) = self.cells.place(parameter);
        let Station { normal, binormal, curvature, .. } = self.cells.station(cell, u);
        (normal * curvature[0] + binormal * curvature[1]).into()
    }

    /// Length per parameter.
    pub fn speed(&self, parameter: f64) -> f64 {
        let (cell, u) = self.cells.place(parameter);
        self.cells.station(cell, u).speed
    }

    /// The closest place of the curve to each point; beyond an end, on its tangent.
    ///
    /// # Errors
    /// Points that are not finite.
    pub fn closest(&self, points: &[DVec3]) -> Result<Vec<ClosestPoint>> {
        check_finite("points", points)?;
        let search = self.search();
        Ok(points.par_iter().with_min_len(TASK).map(|&p| self.closest_point(&search.closest(&self.cells, p))).collect())
    }

    pub(crate) fn closest_point(&self, closest: &Closest) -> ClosestPoint {
        let parameter = self.cells.parameter(closest.cell, closest.u);
        let [first, last] = self.parameter_range();
        ClosestPoint {
            parameter,
            position: self.cells.station(closest.cell, closest.u).position.into(),
            distance: closest.distance,
            is_beyond_ends: !(first..=last).contains(&parameter),
            is_ambiguous: closest.is_ambiguous,
        }
    }

    fn start_tangent(&self) -> DVec3 {
        self.frame(self.stations[0])[0]
    }

    pub(crate) fn cells(&self) -> &Cells {
        &self.cells
    }

    pub(crate) fn arc_length(&self) -> &ArcLength {
        let origin = self.cells.first_of_piece(self.first_piece);
        self.arc_length.get_or_init(|| ArcLength::new(self.cells.parts(), origin))
    }

    pub(crate) fn search(&self) -> &Search {
        self.search.get_or_init(|| Search::new(self.cells.parts()))
    }

    /// Heap memory of what is built so far.
    pub fn memory_bytes(&self) -> usize {
        self.cells.memory_bytes() + self.search.get().map_or(0, Search::memory_bytes)
    }
}

fn parameters_of(points: &[DVec3], parameters: Parameters) -> Result<Vec<f64>> {
    let steps = |step: fn(f64) -> f64| {
        let mut sum = 0.0;
        let rest = points.windows(2).map(move |w| {
            sum += step(w[0].distance(w[1]));
            sum
        });
        std::iter::once(0.0).chain(rest).collect::<Vec<f64>>()
    };
    let made = match parameters {
        Parameters::Chord => steps(|length| length),
        Parameters::Centripetal => steps(f64::sqrt),
        Parameters::Given(given) => {
            check_length("parameters", given.len(), points.len())?;
            check_numbers("parameters", given)?;
            given.to_vec()
        }
    };
    // Lengths of steps are as uneven as the points; given ones may be no steeper than numbers are large.
    let least = if matches!(parameters, Parameters::Given(_)) { SMALLEST } else { 0.0 };
    match made.windows(2).position(|w| !(w[1] > w[0] && w[1] - w[0] >= least)) {
        Some(row) => Err(Error::Parameters { row: row + 1 }),
        None => Ok(made),
    }
}

fn check_points(what: &'static str, points: &[DVec3]) -> Result<()> {
    check_count(what, points.len())?;
    check_finite(what, points)?;
    let size = check_size(what, points)?;
    match points.windows(2).position(|w| w[0].distance(w[1]) <= size * f64::EPSILON) {
        Some(row) => Err(Error::Coincident { row: row + 1 }),
        None => Ok(()),
    }
}

/// The size of points that a curve can be made from.
fn check_size(what: &'static str, points: &[DVec3]) -> Result<f64> {
    let size = points.iter().fold(0.0, |size: f64, p| size.max(p.distance(points[0])));
    match size {
        0.0 => Err(Error::Coincident { row: 1 }),
        SMALLEST.. => Ok(size),
        _ => Err(Error::TooSmall { what, found: size }),
    }
}

fn check_count(what: &'static str, found: usize) -> Result<()> {
    if found >= 2 { Ok(()) } else { Err(Error::SpinePoints { what, found }) }
}

fn check_length(what: &'static str, found: usize, needed: usize) -> Result<()> {
    if found == needed { Ok(()) } else { Err(Error::Length { what, found, needed }) }
}
