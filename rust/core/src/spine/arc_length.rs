//! Length along a spine, and the parameter at a length.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

use crate::numeric::real::{LANES, Real};
use crate::spine::cells::Cells;
use crate::spine::quintic::Quintic;

/// Gauss's rule of eight places on [0, 1]: exact for polynomials up to degree 15. Half of it; it is symmetrical.
const PLACES: [f64; 4] = [0.019_855_071_751_231_884, 0.101_666_761_293_186_63, 0.237_233_795_041_835_5, 0.408_282_678_752_175_1];
const SHARES: [f64; 4] = [0.050_614_268_145_188_13, 0.111_190_517_226_687_24, 0.156_853_322_938_943_65, 0.181_341_891_689_180_98];
/// Steps of Newton's method on a function that is almost a line; three are enough where the speed is even.
const STEPS: usize = 40;
/// Step after which the place is exact to rounding.
const CONVERGED: f64 = 1e-9;

/// ∫ f over [0, 1].
pub(crate) fn integral(f: impl Fn(f64) -> f64) -> f64 {
    PLACES.iter().zip(SHARES).map(|(&x, share)| share * (f(x) + f(1.0 - x))).sum()
}

/// Length from the first station, per cell a polynomial of its place. It is twice differentiable, and what a frame needs
/// of it is its own derivative: no map loses volume by the little that it differs from the true length.
#[derive(Debug)]
pub(crate) struct ArcLength {
    /// Per cell, rays included, Σ cᵢ uⁱ.
    polynomials: Vec<[f64; 6]>,
    /// Length at the start of each cell after the first ray, and at the end of the last.
    starts: Vec<f64>,
}

impl ArcLength {
    /// `origin`: cell at whose start the length is 0.
    pub fn new(pieces: &[Quintic], origin: usize) -> Self {
        let count = pieces.len();
        let mut starts = vec![0.0; count + 1];
        for (i, piece) in pieces.iter().enumerate() {
            starts[i + 1] = starts[i] + integral(|u| piece.derivatives(u)[1].length());
        }
        let zero = starts[origin];
        for start in &mut starts {
            *start -= zero;
        }
        let speed = |i: usize, u: f64| {
            let [_, first, second, _] = pieces[i].derivatives(u);
            let speed = first.length().max(f64::MIN_POSITIVE);
            (speed, second.dot(first) / speed)
        };
        let mut polynomials = vec![[starts[0], speed(0, 0.0).0, 0.0, 0.0, 0.0, 0.0]];
        for i in 0..count {
            let (delta, (m0, a0), (m1, a1)) = (starts[i + 1] - starts[i], speed(i, 0.0), speed(i, 1.0));
            polynomials.push([
                starts[i],
                m0,
                0.5 * a0,
                10.0 * delta - 6.0 * m0 - 4.0 * m1 - 1.5 * a0 + 0.5 * a1,
                -15.0 * delta + 8.0 * m0 + 7.0 * m1 + 1.5 * a0 - a1,
                6.0 * delta - 3.0 * (m0 + m1) - 0.5 * (a0 - a1),
            ]);
        }
        polynomials.push([starts[count], speed(count - 1, 1.0).0, 0.0, 0.0, 0.0, 0.0]);
        Self { polynomials, starts }
    }

    /// Length at a place of a cell, and its derivative by that place.
    #[inline]
    pub fn at(&self, cell: usize, u: f64) -> (f64, f64) {
        evaluate(&self.polynomials[cell], u)
    }

    /// As `at`, eight at a time.
    #[inline(always)]
    pub fn at_lanes<S: Simd>(&self, simd: S, cells: [u32; LANES], u: f64x8<S>) -> (f64x8<S>, f64x8<S>) {
        evaluate(&self.gather(simd, cells), u)
    }

    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, cells: [u32; LANES]) -> [f64x8<S>; 6] {
        let polynomials = cells.map(|cell| &self.polynomials[cell as usize]);
        std::array::from_fn(|i| f64x8::simd_from(simd, polynomials.map(|c| c[i])))
    }

    /// The cell of a length. `hint`: a cell nearby, where the search begins.
    #[inline]
    fn cell(&self, length: f64, hint: usize) -> usize {
        let last = self.polynomials.len() - 1;
        let mut cell = hint.min(last);
        while cell > 0 && length < self.starts[cell - 1] {
            cell -= 1;
        }
        while cell < last && length >= self.starts[cell] {
            cell += 1;
        }
        cell
    }

    /// A first guess of the place in a cell, and between which numbers it is.
    #[inline]
    fn bracket(&self, cell: usize, length: f64) -> [f64; 3] {
        let c = &self.polynomials[cell];
        if cell == 0 {
            [(length - c[0]) / c[1], f64::NEG_INFINITY, 0.0]
        } else if cell == self.polynomials.len() - 1 {
            [(length - c[0]) / c[1], 0.0, f64::INFINITY]
        } else {
            [(length - self.starts[cell - 1]) / (self.starts[cell] - self.starts[cell - 1]), 0.0, 1.0]
        }
    }

    /// Cell and place at a length. `hint`: a cell nearby.
    pub fn place(&self, length: f64, hint: usize) -> (usize, f64) {
        let cell = self.cell(length, hint);
        (cell, solve(&self.polynomials[cell], length, self.bracket(cell, length)))
    }

    /// As `place`, eight at a time; and the derivative of each length by its place.
    #[inline(always)]
    pub fn place_lanes<S: Simd>(&self, simd: S, lengths: f64x8<S>, hint: &mut usize) -> ([u32; LANES], f64x8<S>, f64x8<S>) {
        let each: [f64; LANES] = lengths.into();
        let cells = each.map(|length| {
            *hint = self.cell(length, *hint);
            *hint as u32
        });
        let brackets: [[f64; 3]; LANES] = std::array::from_fn(|lane| self.bracket(cells[lane] as usize, each[lane]));
        let polynomials = self.gather(simd, cells);
        let bracket = std::array::from_fn(|i| f64x8::simd_from(simd, brackets.map(|bracket| bracket[i])));
        let u = solve(&polynomials, lengths, bracket);
        (cells, u, evaluate(&polynomials, u).1)
    }

    /// Lengths at parameters.
    pub fn at_parameter(&self, cells: &Cells, parameter: f64) -> f64 {
        let (cell, u) = cells.place(parameter);
        self.at(cell, u).0
    }

    /// Parameter at a length.
    pub fn parameter(&self, cells: &Cells, length: f64) -> f64 {
        let (cell, u) = self.place(length, cells.count() / 2);
        cells.parameter(cell, u)
    }
}

/// Σ cᵢ uⁱ and its derivative.
#[inline(always)]
fn evaluate<R: Real>(c: &[R; 6], u: R) -> (R, R) {
    let (mut value, mut slope) = (c[5], u.constant(0.0));
    for &c in c[..5].iter().rev() {
        slope = slope * u + value;
        value = value * u + c;
    }
    (value, slope)
}

/// The place at which a rising polynomial has a value, between two numbers.
#[inline(always)]
fn solve<R: Real>(c: &[R; 6], value: R, [guess, low, high]: [R; 3]) -> R {
    let mut u = guess.max(low).min(high);
    // Lanes stop one by one: what one number becomes does not depend on its neighbours.
    let mut part = u.constant(1.0);
    for _ in 0..STEPS {
        let (found, slope) = evaluate(c, u);
        let next = (u - part * (found - value) / slope.max(u.constant(f64::MIN_POSITIVE))).max(low).min(high);
        let step = next - u;
        u = next;
        // The next step would be below rounding: the method squares its error.
        part = step.max(-step).if_below(u.constant(CONVERGED), u.constant(0.0), part);
        if part.is_below(u.constant(0.5)) {
            break;
        }
    }
    u
}

#[cfg(test)]
mod tests {
    use super::integral;

    #[test]
    fn integrals_of_polynomials_are_exact() {
        for degree in 0..=15 {
            assert!((integral(|x| x.powi(degree)) - 1.0 / f64::from(degree + 1)).abs() < 2e-16);
        }
    }
}
