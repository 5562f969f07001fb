//! Curves that come from elsewhere, and the smooth spline through samples of them.
//!
//! Bézier and poly curves have corners of curvature or even of direction, at which a body would crease or tear [MATH §5].
//! The spline passes through samples of each segment, at parameters that are lengths along the imported curve.

use glam::DVec3;

use crate::error::{Error, Result};
use crate::spine::b_spline::BSpline;
use crate::spine::interpolation::End;
use crate::spine::quintic::{Jet, Quintic};

/// Samples per segment are at most so many: finer ones only make corners sharper.
pub(crate) const RESOLUTION_MAX: usize = 64;
/// The deviation is measured at so many places between two samples.
const CHECKS: usize = 4;
/// Derivatives shorter than this part of the segment's chord have no direction.
const STILL: f64 = 1e-9;

/// A curve in segments, each over u in [0, 1].
pub(crate) enum ImportedCurve {
    /// One cubic per segment.
    Bezier(Vec<Quintic>),
    /// Spans of a rational B-spline.
    Nurbs(BSpline, Vec<f64>),
    /// Straight segments.
    Poly(Vec<DVec3>),
}

/// What a spline is interpolated from.
pub(crate) struct Samples {
    pub parameters: Vec<f64>,
    pub points: Vec<DVec3>,
    pub ends: [End; 2],
    /// Samples from one station to the next.
    pub resolution: usize,
    /// Places of the imported curve between the samples.
    pub checks: Vec<DVec3>,
}

impl ImportedCurve {
    pub fn bezier(points: &[DVec3], left_handles: &[DVec3], right_handles: &[DVec3]) -> Self {
        let cubic = |i: usize| {
            let (a, b, c, d) = (points[i], right_handles[i], left_handles[i + 1], points[i + 1]);
            Quintic([a, 3.0 * (b - a), 3.0 * (a - 2.0 * b + c), d - a + 3.0 * (b - c), DVec3::ZERO, DVec3::ZERO])
        };
        Self::Bezier((0..points.len() - 1).map(cubic).collect())
    }

    pub fn nurbs(spline: BSpline) -> Self {
        let spans = spline.spans();
        Self::Nurbs(spline, spans)
    }

    pub fn segment_count(&self) -> usize {
        match self {
            Self::Bezier(segments) => segments.len(),
            Self::Nurbs(_, spans) => spans.len() - 1,
            Self::Poly(points) => points.len() - 1,
        }
    }

    /// Position and derivatives by u.
    fn jet(&self, segment: usize, u: f64) -> Jet {
        match self {
            Self::Bezier(segments) => {
                let [position, first, second, _] = segments[segment].derivatives(u);
                Jet { position, first, second }
            }
            Self::Nurbs(spline, spans) => {
                let width = spans[segment + 1] - spans[segment];
                let t = if u == 1.0 { spans[segment + 1] } else { spans[segment] + u * width };
                let jet = spline.jet(t, u < 1.0);
                Jet { position: jet.position, first: jet.first * width, second: jet.second * (width * width) }
            }
            Self::Poly(points) => {
                let step = points[segment + 1] - points[segment];
                Jet { position: points[segment] + u * step, first: step, second: DVec3::ZERO }
            }
        }
    }

    /// Samples with `resolution` of them to a segment.
    ///
    /// # Errors
    /// A segment without length.
    pub fn samples(&self, resolution: usize) -> Result<Samples> {
        let count = self.segment_count();
        let (mut parameters, mut points, mut checks) = (vec![0.0], vec![self.jet(0, 0.0).position], Vec::new());
        let mut total = 0.0;
        for segment in 0..count {
            for sample in 0..resolution {
                let at = |part: f64| (sample as f64 + part) / resolution as f64;
                let length = super::arc_length::integral(|part| self.jet(segment, at(part)).first.length()) / resolution as f64;
                total += length;
                checks.extend((0..CHECKS).map(|check| self.jet(segment, at((check as f64 + 0.5) / CHECKS as f64)).position));
                parameters.push(total);
                points.push(self.jet(segment, at(1.0)).position);
            }
        }
        // Lengths are summed: a step that the sum cannot hold is no step.
        let is_still = |w: &[f64]| w[1] - w[0] <= total * f64::EPSILON;
        if let Some(row) = parameters.windows(2).position(is_still) {
            return Err(Error::Coincident { row: row / resolution + 1 });
        }
        let ends = match self {
            Self::Poly(_) => [End::Straight; 2],
            _ => [self.end(0, 0.0), self.end(count - 1, 1.0)],
        };
        Ok(Samples { parameters, points, ends, resolution, checks })
    }

    /// Direction and curvature at an end: derivatives by length.
    fn end(&self, segment: usize, u: f64) -> End {
        let jet = self.jet(segment, u);
        let chord = self.jet(segment, 0.0).position.distance(self.jet(segment, 1.0).position);
        let speed = jet.first.length();
        if speed <= STILL * chord {
            // A handle that lies in its point: the curve starts towards where it bends to, its curvature is not defined.
            let ahead = if u < 0.5 { jet.second } else { -jet.second };
            let tangent = if ahead.length() > STILL * chord { ahead.normalize() } else { DVec3::X };
            return End::Fixed(tangent, DVec3::ZERO);
        }
        let tangent = jet.first / speed;
        End::Fixed(tangent, (jet.second - jet.second.dot(tangent) * tangent) / (speed * speed))
    }
}
