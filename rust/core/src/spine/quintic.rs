//! One piece of a spine: a polynomial of degree five over u in [0, 1].

use glam::DVec3;

/// Position and first two derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Jet {
    pub position: DVec3,
    pub first: DVec3,
    pub second: DVec3,
}

/// Σ cᵢ uⁱ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quintic(pub [DVec3; 6]);

impl Quintic {
    /// The piece between two jets whose derivatives are by u.
    pub fn hermite(start: Jet, end: Jet) -> Self {
        let delta = end.position - start.position;
        let (m0, m1, a0, a1) = (start.first, end.first, start.second, end.second);
        Self([
            start.position,
            m0,
            0.5 * a0,
            10.0 * delta - 6.0 * m0 - 4.0 * m1 - 1.5 * a0 + 0.5 * a1,
            -15.0 * delta + 8.0 * m0 + 7.0 * m1 + 1.5 * a0 - a1,
            6.0 * delta - 3.0 * m0 - 3.0 * m1 - 0.5 * a0 + 0.5 * a1,
        ])
    }

    /// The part from `from` to `to` as a piece of its own; backwards if `to` < `from`.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let mut c = self.0;
        for first in 0..5 {
            for i in (first..5).rev() {
                c[i] += from * c[i + 1];
            }
        }
        let width = to - from;
        let mut power = 1.0;
        for c in &mut c {
            *c *= power;
            power *= width;
        }
        Self(c)
    }

    /// Position and derivatives by u, to the third.
    pub fn derivatives(&self, u: f64) -> [DVec3; 4] {
        let [mut p, mut d1, mut d2, mut d3] = [DVec3::ZERO; 4];
        for &c in self.0.iter().rev() {
            d3 = d3 * u + d2;
            d2 = d2 * u + d1;
            d1 = d1 * u + p;
            p = p * u + c;
        }
        [p, d1, 2.0 * d2, 6.0 * d3]
    }

    /// Position.
    pub fn at(&self, u: f64) -> DVec3 {
        self.0.iter().rev().fold(DVec3::ZERO, |p, &c| p * u + c)
    }

    /// Control points of the same curve in Bernstein form: it lies within their hull.
    pub fn control_points(&self) -> [DVec3; 6] {
        let mut b = [DVec3::ZERO; 6];
        for (j, b) in b.iter_mut().enumerate() {
            *b = (0..=j).map(|i| self.0[i] * (binomial(j, i) / binomial(5, i))).sum();
        }
        b
    }

    /// Continues the end of a curve with these derivatives by u so that it is straight at u = 1: the second and third
    /// derivatives fall to 0 along a cubic, the first three are continuous.
    pub fn run_out(position: DVec3, first: DVec3, second: DVec3, third: DVec3) -> Self {
        Self([position, first, 0.5 * second, third / 6.0, -0.25 * second - third / 6.0, 0.1 * second + 0.05 * third])
    }
}

/// n over k, small.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    (1..=k).map(|i| (n - k + i) as f64 / i as f64).product::<f64>().round()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece() -> Quintic {
        Quintic(std::array::from_fn(|i| DVec3::new((i as f64).cos(), (2.0 * i as f64).sin(), 0.3 * i as f64 - 0.7)))
    }

    #[test]
    fn parts_lie_on_the_whole() {
        let whole = piece();
        for (from, to) in [(0.0, 1.0), (0.25, 0.5), (1.0, 0.0), (0.7, 0.1)] {
            let part = whole.part(from, to);
            for i in 0..=10 {
                let u = f64::from(i) / 10.0;
                assert!(part.at(u).distance(whole.at(from + (to - from) * u)) < 1e-14);
            }
        }
    }

    #[test]
    fn hermite_takes_its_jets() {
        let whole = piece();
        let jet = |u| {
            let [position, first, second, _] = whole.derivatives(u);
            Jet { position, first, second }
        };
        let again = Quintic::hermite(jet(0.0), jet(1.0));
        assert!((0..6).all(|i| again.0[i].distance(whole.0[i]) < 1e-12));
    }

    #[test]
    fn control_points_begin_and_end_the_curve() {
        let b = piece().control_points();
        assert!(b[0].distance(piece().at(0.0)) < 1e-14 && b[5].distance(piece().at(1.0)) < 1e-14);
        let midpoint: DVec3 = (0..6).map(|i| b[i] * binomial(5, i) / 32.0).sum();
        assert!(midpoint.distance(piece().at(0.5)) < 1e-14);
    }

    #[test]
    fn run_outs_end_straight() {
        let [p, d1, d2, d3] = piece().derivatives(0.4);
        let out = Quintic::run_out(p, d1, d2, d3);
        let start = out.derivatives(0.0);
        assert!([p, d1, d2, d3].iter().zip(start).all(|(a, b)| a.distance(b) < 1e-12));
        let end = out.derivatives(1.0);
        assert!(end[2].length() < 1e-12 && end[3].length() < 1e-12);
    }
}
