//! How flesh gives way in the normal plane: radial, normal, binormal, and blends of them [ZR13, MATH §5].
//!
//! p is an offset in the normal plane, k the curvature vector in the same frame. About a bent spine a chunk of flesh is
//! 1 − k·p of what it is about a straight one. `unbend` takes p about a bent spine to q about a straight one with the
//! determinant 1 − k·p, `bend` takes it back. Nothing here needs a Frenet frame: k may vanish or turn over.

use crate::error::{Error, LARGEST, Result};
use crate::numeric::real::{Real, sine_cosine};

/// 1/√3: the smallest w of the radial bend, and its largest k·q.
const ROOT: f64 = 0.577_350_269_189_625_8;
/// Largest κx of the binormal bend: where it is 1 flesh is infinitely wide, here it is twenty times as wide.
pub(crate) const BINORMAL_MAX: f64 = 0.95;
/// Relative change of w that ends its iteration; then it is exact to rounding.
const CONVERGED: f64 = 1e-6;
const STEPS: usize = 40;
/// Flesh grows thicker at most by this factor where the spine is compressed: at a cusp it would be infinite.
const SWELL_MAX: f64 = 4.0;

/// Which way flesh gives way in the normal plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// To and from the spine: round tubes stay round.
    Radial,
    /// Along the curvature.
    Normal,
    /// Across the curvature.
    Binormal,
}

/// One kind or a blend: between kinds stands the density 1 − t k·p of a spine that is bent the t-th part, so that each
/// kind bends its part and no volume is lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    stages: [Stage; 3],
    count: usize,
}

/// `kind` bends from the `from`-th part of the curvature to the `to`-th.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stage {
    kind: Kind,
    from: f64,
    to: f64,
}

impl From<Kind> for Blend {
    fn from(kind: Kind) -> Self {
        Self { stages: [Stage { kind, from: 0.0, to: 1.0 }; 3], count: 1 }
    }
}

impl Blend {
    /// Weights of radial, normal and binormal.
    ///
    /// # Errors
    /// Weights that are negative, not finite, or all 0.
    pub fn new(weights: [f64; 3]) -> Result<Self> {
        let needed = "weights of 0 or more of radial, normal and binormal, not all 0";
        if let Some(&found) = weights.iter().find(|w| !(**w >= 0.0 && **w <= LARGEST)) {
            return Err(Error::Value { what: "kind", found, needed });
        }
        let sum: f64 = weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(Error::Value { what: "kind", found: sum, needed });
        }
        let mut blend = Self { count: 0, ..Self::from(Kind::Radial) };
        let mut done = 0.0;
        for (kind, weight) in [Kind::Radial, Kind::Normal, Kind::Binormal].into_iter().zip(weights) {
            if weight > 0.0 {
                blend.stages[blend.count] = Stage { kind, from: done / sum, to: (done + weight) / sum };
                done += weight;
                blend.count += 1;
            }
        }
        blend.stages[blend.count - 1].to = 1.0;
        Ok(blend)
    }

    fn stages(&self) -> &[Stage] {
        &self.stages[..self.count]
    }

    /// q about a straight spine, for p about one of curvature k; k·p ≤ 1.
    #[inline(always)]
    pub(crate) fn unbend<R: Real>(&self, p: [R; 2], k: [R; 2]) -> [R; 2] {
        let mut p = p;
        let mut clamped = p[0].constant(0.0);
        for stage in self.stages().iter().rev() {
            p = stage.kind.unbend(p, scaled(k, stage.to));
            if stage.from > 0.0 {
                p = stage.kind.bend(p, scaled(k, stage.from), &mut clamped);
            }
        }
        p
    }

    /// p about a spine of curvature k, for q about a straight one; q out of the valid space is taken at its border, and
    /// `clamped` becomes 1.
    #[inline(always)]
    pub(crate) fn bend<R: Real>(&self, q: [R; 2], k: [R; 2], clamped: &mut R) -> [R; 2] {
        let mut q = q;
        for stage in self.stages() {
            if stage.from > 0.0 {
                q = stage.kind.unbend(q, scaled(k, stage.from));
            }
            q = stage.kind.bend(q, scaled(k, stage.to), clamped);
        }
        q
    }
}

impl Kind {
    #[inline(always)]
    fn unbend<R: Real>(self, p: [R; 2], k: [R; 2]) -> [R; 2] {
        let c = |value| p[0].constant(value);
        match self {
            Kind::Radial => {
                let w = (c(1.0) - c(2.0 / 3.0) * dot(k, p)).max(c(0.0)).sqrt();
                [p[0] * w, p[1] * w]
            }
            Kind::Normal => {
                let (unit, along) = direction(k, p);
                moved(p, unit, -(c(0.5) * along * dot(unit, p)))
            }
            Kind::Binormal => {
                let (unit, along) = direction(k, p);
                let side = [-unit[1], unit[0]];
                moved(p, side, -(along * dot(side, p)))
            }
        }
    }

    #[inline(always)]
    fn bend<R: Real>(self, q: [R; 2], k: [R; 2], clamped: &mut R) -> [R; 2] {
        let c = |value| q[0].constant(value);
        match self {
            Kind::Radial => {
                let along = dot(k, q);
                *clamped = c(ROOT).if_below(along, c(1.0), *clamped);
                let clamped = c(ROOT).if_below(along, c(ROOT) / along.max(c(ROOT)), c(1.0));
                let w = largest_root(c(ROOT) - along.min(c(ROOT)));
                let factor = clamped / w;
                [q[0] * factor, q[1] * factor]
            }
            Kind::Normal => {
                let (unit, along) = direction(k, q);
                *clamped = c(0.5).if_below(along, c(1.0), *clamped);
                let x = dot(unit, q);
                let clamped = c(0.5).if_below(along, x * (c(0.5) / along.max(c(0.5))), x);
                let root = (c(1.0) - c(2.0) * along.min(c(0.5))).max(c(0.0)).sqrt();
                moved(q, unit, c(2.0) * clamped / (c(1.0) + root) - x)
            }
            Kind::Binormal => {
                let (unit, along) = direction(k, q);
                *clamped = c(BINORMAL_MAX).if_below(along, c(1.0), *clamped);
                let x = dot(unit, q);
                let clamped = c(BINORMAL_MAX).if_below(along, x * (c(BINORMAL_MAX) / along.max(c(BINORMAL_MAX))), x);
                let side = [-unit[1], unit[0]];
                let factor = c(1.0) / (c(1.0) - along.min(c(BINORMAL_MAX)));
                let y = dot(side, q);
                moved(moved(q, unit, clamped - x), side, y * (factor - c(1.0)))
            }
        }
    }
}

/// Direction of k, and k·p. Any direction where k is 0: there all maps are the identity.
#[inline(always)]
fn direction<R: Real>(k: [R; 2], p: [R; 2]) -> ([R; 2], R) {
    // The larger coordinate is taken out first, so that no square of a small number is lost.
    let size = k[0].max(-k[0]).max(k[1].max(-k[1])).max(k[0].constant(f64::MIN_POSITIVE));
    let [x, y] = [k[0] / size, k[1] / size];
    let length = (x * x + y * y).max(x.constant(f64::MIN_POSITIVE)).sqrt();
    ([x / length, y / length], dot(k, p))
}

#[inline(always)]
fn dot<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn moved<R: Real>(p: [R; 2], direction: [R; 2], by: R) -> [R; 2] {
    [p[0] + direction[0] * by, p[1] + direction[1] * by]
}

#[inline(always)]
fn scaled<R: Real>(k: [R; 2], part: f64) -> [R; 2] {
    if part == 1.0 { k } else { [k[0] * k[0].constant(part), k[1] * k[0].constant(part)] }
}

/// The largest root of w³ − w + ⅔ x, for `room` = 1/√3 − x ≥ 0.
///
/// At the border two roots meet; with w = 1/√3 + v the equation is v²(v + √3) = ⅔ room, where no digit is lost. Halley's
/// method, from a fraction that is right to the third order in small √room.
#[inline(always)]
fn largest_root<R: Real>(room: R) -> R {
    let c = |value| room.constant(value);
    let root3 = 3.0 * ROOT;
    let right = c(2.0 / 3.0) * room;
    // v (1 + v/√3)^½ = g.
    let g = (right * c(ROOT)).sqrt();
    let mut v = g * (c(1.0) + c(0.75 * ROOT) * g) / (c(1.0) + c(1.25 * ROOT) * g);
    // Lanes stop one by one: what one number becomes does not depend on its neighbours.
    let mut part = c(1.0);
    for _ in 0..STEPS {
        let f = v * v * (v + c(root3)) - right;
        let f1 = v * (c(3.0) * v + c(2.0 * root3));
        let f2 = c(6.0) * v + c(2.0 * root3);
        let step = part * (c(2.0) * f * f1) / (c(2.0) * f1 * f1 - f * f2).max(c(f64::MIN_POSITIVE));
        v = v - step;
        part = step.max(-step).if_below(c(CONVERGED) * v + c(1e-100), c(0.0), part);
        if part.is_below(c(0.5)) {
            break;
        }
    }
    v + c(ROOT)
}

/// q / √ρ, ρ being how much longer the spine has become.
#[inline(always)]
pub(crate) fn thin<R: Real>(q: [R; 2], growth: R, clamped: &mut R) -> [R; 2] {
    let c = |value| growth.constant(value);
    let least = c(1.0 / (SWELL_MAX * SWELL_MAX));
    *clamped = growth.if_below(least, c(1.0), *clamped);
    let factor = c(1.0) / growth.max(least).sqrt();
    [q[0] * factor, q[1] * factor]
}

/// q turned from the first axis to the second.
#[inline(always)]
pub(crate) fn turn<R: Real>(q: [R; 2], angle: R) -> [R; 2] {
    let (sine, cosine) = sine_cosine(angle);
    [q[0] * cosine - q[1] * sine, q[0] * sine + q[1] * cosine]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blends() -> Vec<Blend> {
        let mut blends: Vec<Blend> = [Kind::Radial, Kind::Normal, Kind::Binormal].map(Blend::from).to_vec();
        blends.extend([[1.0, 1.0, 0.0], [0.2, 0.5, 0.3], [1.0, 0.0, 2.0]].map(|weights| Blend::new(weights).expect("sound")));
        blends
    }

    const PLACES: [[f64; 2]; 5] = [[0.1, 0.0], [-0.3, 0.25], [0.0, -0.4], [0.3, 0.1], [-0.7, 0.3]];
    const CURVATURES: [[f64; 2]; 6] = [[0.0, 0.0], [1e-200, -1e-200], [1e-16, 0.0], [0.4, -0.6], [-0.9, 0.3], [0.0, 1.1]];

    #[test]
    fn determinants_are_those_of_the_density() {
        let h = 1e-5;
        for blend in blends() {
            for (p, k) in PLACES.iter().flat_map(|p| CURVATURES.map(|k| (*p, k))) {
                let at = |x: f64, y: f64| blend.unbend([p[0] + x, p[1] + y], k);
                let column = |a: [f64; 2], b: [f64; 2]| [(a[0] - b[0]) / (2.0 * h), (a[1] - b[1]) / (2.0 * h)];
                let (a, b) = (column(at(h, 0.0), at(-h, 0.0)), column(at(0.0, h), at(0.0, -h)));
                assert!((a[0] * b[1] - a[1] * b[0] - (1.0 - dot(k, p))).abs() < 1e-8, "{blend:?} {p:?} {k:?}");
            }
        }
    }

    #[test]
    fn bending_undoes_unbending() {
        for blend in blends() {
            for (p, k) in PLACES.iter().flat_map(|p| CURVATURES.map(|k| (*p, k))) {
                let mut clamped = 0.0;
                let again = blend.bend(blend.unbend(p, k), k, &mut clamped);
                assert!((again[0] - p[0]).hypot(again[1] - p[1]) < 4e-15, "{blend:?} {p:?} {k:?} {again:?}");
                assert_eq!(clamped, 0.0);
            }
        }
    }

    #[test]
    fn the_root_is_exact_from_border_to_far_outside() {
        for i in 0..400 {
            let room = 10f64.powf(f64::from(i) * 0.06 - 16.0);
            let v = largest_root(room) - ROOT;
            let relative = v * v * (v + 3.0 * ROOT) / (2.0 / 3.0 * room) - 1.0;
            assert!(relative.abs() < 1e-15 + 4e-16 / v, "{room} {relative}");
        }
        assert_eq!(largest_root(0.0), ROOT);
    }

    #[test]
    fn out_of_the_valid_space_is_the_border() {
        for blend in blends() {
            let mut clamped = 0.0;
            let p = blend.bend([5.0, 1.0], [1.0, 0.0], &mut clamped);
            assert_eq!(clamped, 1.0);
            assert!(p[0].is_finite() && p[1].is_finite() && p[0] <= 1.0 + 1e-12, "{blend:?} {p:?}");
        }
    }
}
