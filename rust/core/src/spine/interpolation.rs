//! The smoothest spline for fleshing: piecewise quintic, four times differentiable, through given points [MATH §5].

use glam::{DMat2, DVec2, DVec3};

use crate::spine::quintic::{Jet, Quintic};

/// What the spline is at one of its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// Second and third derivatives 0: it can be continued by its tangent.
    Straight,
    /// First and second derivatives by the parameter.
    Fixed(DVec3, DVec3),
}

/// First and second derivatives of one knot.
type Derivatives = [DVec3; 2];

/// Pieces through `points` at rising `parameters`, at least two.
pub(crate) fn interpolate(parameters: &[f64], points: &[DVec3], ends: [End; 2]) -> Vec<Quintic> {
    let last = points.len() - 1;
    // Block tridiagonal in the pairs of derivatives; `upper` and `right` are what elimination leaves of each row.
    let mut upper = Vec::with_capacity(points.len());
    let mut right: Vec<Derivatives> = Vec::with_capacity(points.len());
    for i in 0..=last {
        let before = (i > 0).then(|| Side::new(parameters[i] - parameters[i - 1], points[i] - points[i - 1]));
        let after = (i < last).then(|| Side::new(parameters[i + 1] - parameters[i], points[i + 1] - points[i]));
        let mut row = match (before, after) {
            (None, Some(after)) => Row::end(&after, ends[0], 1.0),
            (Some(before), None) => Row::end(&before, ends[1], -1.0),
            (Some(before), Some(after)) => Row::knot(&before, &after),
            (None, None) => unreachable!("at least two points"),
        };
        if i > 0 {
            row.diagonal -= row.lower * upper[i - 1];
            row.right = subtract(row.right, product(row.lower, right[i - 1]));
        }
        let inverse = row.diagonal.inverse();
        upper.push(inverse * row.upper);
        right.push(product(inverse, row.right));
    }
    for i in (0..last).rev() {
        right[i] = subtract(right[i], product(upper[i], right[i + 1]));
    }
    let piece = |i: usize| {
        let width = parameters[i + 1] - parameters[i];
        let jet = |k: usize| Jet { position: points[k], first: right[k][0] * width, second: right[k][1] * (width * width) };
        Quintic::hermite(jet(i), jet(i + 1))
    };
    (0..last).map(piece).collect()
}

/// The piece on one side of a knot: its width and the step of the points.
struct Side {
    h: f64,
    step: DVec3,
}

impl Side {
    fn new(h: f64, step: DVec3) -> Self {
        Self { h, step }
    }
}

/// lower · before + diagonal · own + upper · after = right, in pairs of derivatives.
struct Row {
    lower: DMat2,
    diagonal: DMat2,
    upper: DMat2,
    right: Derivatives,
}

impl Row {
    /// The third and fourth derivatives are the same on both sides; rows are scaled by the wider piece.
    fn knot(a: &Side, b: &Side) -> Self {
        let h = a.h.max(b.h);
        let (p, q) = (h / a.h, h / b.h);
        Self {
            lower: rows([24.0 * p * p, 3.0 * p * h], [168.0 * p.powi(3), 24.0 * p * p * h]),
            diagonal: rows([36.0 * (p * p - q * q), -9.0 * (p + q) * h], [192.0 * (p.powi(3) + q.powi(3)), 36.0 * (q * q - p * p) * h]),
            upper: rows([-24.0 * q * q, 3.0 * q * h], [168.0 * q.powi(3), -24.0 * q * q * h]),
            right: [60.0 / h * (a.step * p.powi(3) - b.step * q.powi(3)), 360.0 / h * (a.step * p.powi(4) + b.step * q.powi(4))],
        }
    }

    /// `side` is the only piece; `direction` −1 at the last knot, where the curve is seen backwards.
    fn end(side: &Side, end: End, direction: f64) -> Self {
        let other = match end {
            End::Fixed(..) => DMat2::ZERO,
            End::Straight => rows([24.0, -3.0 * direction * side.h], [0.0, 0.0]),
        };
        let (diagonal, right) = match end {
            End::Fixed(first, second) => (DMat2::IDENTITY, [first, second]),
            End::Straight => (rows([36.0, 9.0 * direction * side.h], [0.0, side.h]), [60.0 / side.h * side.step, DVec3::ZERO]),
        };
        let (lower, upper) = if direction > 0.0 { (DMat2::ZERO, other) } else { (other, DMat2::ZERO) };
        Self { lower, diagonal, upper, right }
    }
}

fn rows(first: [f64; 2], second: [f64; 2]) -> DMat2 {
    DMat2::from_cols(DVec2::new(first[0], second[0]), DVec2::new(first[1], second[1]))
}

fn product(m: DMat2, v: Derivatives) -> Derivatives {
    [m.x_axis.x * v[0] + m.y_axis.x * v[1], m.x_axis.y * v[0] + m.y_axis.y * v[1]]
}

fn subtract(a: Derivatives, b: Derivatives) -> Derivatives {
    [a[0] - b[0], a[1] - b[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARAMETERS: [f64; 5] = [0.0, 0.7, 1.9, 2.4, 4.0];

    fn points() -> Vec<DVec3> {
        PARAMETERS.iter().map(|t| DVec3::new(*t, (1.3 * t).sin(), (0.6 * t).cos() * t)).collect()
    }

    /// Derivatives by the parameter, to the fourth.
    fn derivatives(piece: &Quintic, width: f64, u: f64) -> [DVec3; 5] {
        let [p, d1, d2, d3] = piece.derivatives(u);
        let d4 = 24.0 * piece.0[4] + 120.0 * u * piece.0[5];
        [p, d1 / width, d2 / width.powi(2), d3 / width.powi(3), d4 / width.powi(4)]
    }

    #[test]
    fn four_derivatives_are_continuous_and_ends_are_straight() {
        let pieces = interpolate(&PARAMETERS, &points(), [End::Straight; 2]);
        let at = |i: usize, u: f64| derivatives(&pieces[i], PARAMETERS[i + 1] - PARAMETERS[i], u);
        for i in 1..pieces.len() {
            let (before, after) = (at(i - 1, 1.0), at(i, 0.0));
            assert!(before.iter().zip(after).all(|(a, b)| a.distance(b) < 1e-10), "{before:?} {after:?}");
        }
        for end in [at(0, 0.0), at(3, 1.0)] {
            assert!(end[2].length() < 1e-11 && end[3].length() < 1e-11);
        }
    }

    #[test]
    fn two_points_make_a_line() {
        let pieces = interpolate(&[0.0, 2.0], &[DVec3::X, DVec3::Y], [End::Straight; 2]);
        assert!(pieces[0].at(0.25).distance(DVec3::new(0.75, 0.25, 0.0)) < 1e-15);
    }

    #[test]
    fn quintic_curves_are_reproduced() {
        let whole = Quintic(std::array::from_fn(|i| DVec3::new(1.0, -0.4, 0.2 * i as f64) * (0.8f64).powi(i as i32)));
        let points: Vec<DVec3> = PARAMETERS.iter().map(|&t| whole.at(t)).collect();
        let end = |t: f64| End::Fixed(whole.derivatives(t)[1], whole.derivatives(t)[2]);
        let pieces = interpolate(&PARAMETERS, &points, [end(0.0), end(4.0)]);
        for (i, piece) in pieces.iter().enumerate() {
            let t = 0.5 * (PARAMETERS[i] + PARAMETERS[i + 1]);
            assert!(piece.at(0.5).distance(whole.at(t)) < 1e-10 * whole.at(t).length());
        }
    }
}
