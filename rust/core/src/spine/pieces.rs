//! From points to the pieces of a curve, run-outs included.

use glam::DVec3;

use crate::spine::b_spline::BSpline;
use crate::spine::interpolation::{End, interpolate};
use crate::spine::polynomial::neville;
use crate::spine::quintic::{Jet, Quintic};

/// A run-out is as long as this part of the curve: there the curvature of its end falls to 0.
const RUN_OUT: f64 = 0.125;
/// Its pieces: cells are as many in every piece.
const RUN_OUT_PIECES: usize = 4;
/// Samples between two points of a polynomial of more than six: what the quintics leave of it is reported.
const POLYNOMIAL_SAMPLES: usize = 8;
/// A curve before frames are put to it.
pub(crate) struct Bare {
    pub breaks: Vec<f64>,
    pub pieces: Vec<Quintic>,
    pub first_piece: usize,
}

impl Bare {
    /// A spline through samples, with run-outs at ends that are not straight.
    pub fn new(parameters: &[f64], points: &[DVec3], ends: [End; 2]) -> Self {
        let mut pieces = interpolate(parameters, points, ends);
        let mut breaks = parameters.to_vec();
        let (start, end) = (breaks[0], breaks[breaks.len() - 1]);
        let width = RUN_OUT * (end - start);
        let run_out = |piece: &Quintic, u: f64, piece_width: f64| {
            let [position, d1, d2, d3] = piece.derivatives(u);
            let s = width / piece_width * if u < 0.5 { -1.0 } else { 1.0 };
            Quintic::run_out(position, d1 * s, d2 * (s * s), d3 * (s * s * s))
        };
        let part_of = |i: usize| i as f64 / RUN_OUT_PIECES as f64;
        if matches!(ends[1], End::Fixed(..)) {
            let last = pieces.len() - 1;
            let whole = run_out(&pieces[last], 1.0, end - breaks[last]);
            pieces.extend((0..RUN_OUT_PIECES).map(|i| whole.part(part_of(i), part_of(i + 1))));
            breaks.extend((1..=RUN_OUT_PIECES).map(|i| end + part_of(i) * width));
        }
        let mut first_piece = 0;
        if matches!(ends[0], End::Fixed(..)) {
            let whole = run_out(&pieces[0], 0.0, breaks[1] - start);
            pieces.splice(0..0, (0..RUN_OUT_PIECES).rev().map(|i| whole.part(part_of(i + 1), part_of(i))));
            breaks.splice(0..0, (1..=RUN_OUT_PIECES).rev().map(|i| start - part_of(i) * width));
            first_piece = RUN_OUT_PIECES;
        }
        Self { breaks, pieces, first_piece }
    }
}

/// The polynomial sampled: quintics reproduce it up to six points.
pub(crate) fn polynomial(parameters: &[f64], points: &[DVec3]) -> (Bare, Vec<DVec3>) {
    let samples = if points.len() > 6 { POLYNOMIAL_SAMPLES } else { 1 };
    let at = |interval: usize, part: f64| parameters[interval] + part * (parameters[interval + 1] - parameters[interval]);
    let mut times = vec![parameters[0]];
    let mut checks = Vec::new();
    for interval in 0..points.len() - 1 {
        for sample in 1..=samples {
            times.push(if sample == samples { parameters[interval + 1] } else { at(interval, sample as f64 / samples as f64) });
            checks.push(neville(parameters, points, at(interval, (sample as f64 - 0.5) / samples as f64)).position);
        }
    }
    let sampled: Vec<DVec3> = times.iter().map(|&t| neville(parameters, points, t).position).collect();
    let end = |t: f64| fixed(neville(parameters, points, t));
    let pieces = Bare::new(&times, &sampled, [end(times[0]), end(times[times.len() - 1])]);
    (pieces, checks)
}

/// The B-spline itself: quintics through its knots that are as smooth are the same.
pub(crate) fn b_spline(parameters: &[f64], points: &[DVec3]) -> Bare {
    let spline = BSpline::clamped(parameters, points);
    let knots = spline.spans();
    let at_knots: Vec<DVec3> = knots.iter().map(|&t| spline.jet(t, true).position).collect();
    Bare::new(&knots, &at_knots, [fixed(spline.jet(knots[0], true)), fixed(spline.jet(knots[knots.len() - 1], false))])
}

fn fixed(jet: Jet) -> End {
    End::Fixed(jet.first, jet.second)
}
