//! Which place of the posed spine belongs to a place of the rest spine, and how much longer it is there.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

use crate::error::{Error, Result, check_numbers};
use crate::numeric::real::{LANES, Lanes};
use crate::spine::arc_length::ArcLength;
use crate::spine::curve::Spine;

/// Steps of Newton's method, or halvings, to invert a rising function.
const STEPS: usize = 100;

/// Which station of the posed spine is whose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Match {
    /// The same parameter where both spines have the same pieces, else station by station, smoothly by length between.
    #[default]
    Stations,
    /// The same part of the length.
    RelativeLength,
    /// The same length from the first station.
    Length,
}

/// A place of a spine: cell, and u in it.
pub(crate) type Place = (usize, f64);

/// The map of one frame, from places of the rest spine to places of the posed one.
pub(crate) struct Matching<'a> {
    rest: &'a Spine,
    posed: &'a Spine,
    /// None: the same place.
    by_length: Option<ByLength<'a>>,
}

/// Length of `source` → map → slide → length of the posed spine.
struct ByLength<'a> {
    source: &'a ArcLength,
    source_spine: &'a Spine,
    target: &'a ArcLength,
    map: LengthMap,
    slide: f64,
}

enum LengthMap {
    Scale(f64),
    Stations(Rising),
}

impl<'a> Matching<'a> {
    /// # Errors
    /// Stations that differ in number where they are to match, a slide that is not finite.
    pub fn new(rest: &'a Spine, posed: &'a Spine, rule: Match, slide: f64) -> Result<Self> {
        check_numbers("slide", &[slide])?;
        let is_same = rest.cells().breaks() == posed.cells().breaks();
        let (source_spine, map) = match rule {
            Match::Stations if is_same => {
                if slide == 0.0 {
                    return Ok(Self { rest, posed, by_length: None });
                }
                (posed, LengthMap::Scale(1.0))
            }
            Match::Stations => {
                if rest.station_count() != posed.station_count() {
                    return Err(Error::StationCount { found: posed.station_count(), bound: rest.station_count() });
                }
                let lengths = |spine: &Spine| spine.stations().iter().map(|&t| spine.arc_length_at(t)).collect();
                (rest, LengthMap::Stations(Rising::new(lengths(rest), lengths(posed))))
            }
            Match::RelativeLength => (rest, LengthMap::Scale(posed.length() / rest.length())),
            Match::Length => (rest, LengthMap::Scale(1.0)),
        };
        let by_length = ByLength { source: source_spine.arc_length(), source_spine, target: posed.arc_length(), map, slide };
        Ok(Self { rest, posed, by_length: Some(by_length) })
    }

    /// True when every place is its own.
    pub fn is_same(&self) -> bool {
        self.by_length.is_none()
    }

    /// Place of the posed spine, and the derivative of its parameter by that of the rest spine. `hint`: a cell nearby.
    pub fn posed_place(&self, (cell, u): Place, hint: usize) -> (Place, f64) {
        let Some(by) = &self.by_length else { return ((cell, u), 1.0) };
        let (length, slope) = by.source.at(cell, u);
        let (mapped, growth) = by.map.at(length);
        let place = by.target.place(mapped + by.slide, hint);
        let (_, posed_slope) = by.target.at(place.0, place.1);
        let rate = slope * by.source_spine.cells().rate(cell) * growth / (posed_slope * self.posed.cells().rate(place.0));
        (place, rate)
    }

    /// As `posed_place`, eight at a time.
    #[inline(always)]
    pub fn posed_places<S: Simd>(&self, simd: S, cells: [u32; LANES], u: Lanes, hint: &mut usize) -> ([u32; LANES], Lanes, Lanes) {
        let Some(by) = &self.by_length else { return (cells, u, [1.0; LANES]) };
        let lanes = |numbers| f64x8::simd_from(simd, numbers);
        let rates = |spine: &Spine, cells: [u32; LANES]| lanes(cells.map(|cell| spine.cells().rate(cell as usize)));
        let (lengths, slopes) = by.source.at_lanes(simd, cells, lanes(u));
        let (mapped, growth) = match &by.map {
            LengthMap::Scale(scale) => (lengths * *scale, lanes([*scale; LANES])),
            LengthMap::Stations(rising) => {
                let pairs = <[f64; LANES]>::from(lengths).map(|length| rising.at(length));
                (lanes(pairs.map(|pair| pair.0)), lanes(pairs.map(|pair| pair.1)))
            }
        };
        let (posed_cells, posed_u, posed_slopes) = by.target.place_lanes(simd, mapped + by.slide, hint);
        let rate = slopes * rates(by.source_spine, cells) * growth / (posed_slopes * rates(self.posed, posed_cells));
        (posed_cells, posed_u.into(), rate.into())
    }

    /// Place of the rest spine whose place of the posed spine this is.
    pub fn rest_place(&self, (cell, u): Place) -> Place {
        let Some(by) = &self.by_length else { return (cell, u) };
        let length = by.map.inverse(by.target.at(cell, u).0 - by.slide);
        by.source.place(length, cell.min(self.rest.cells().count() - 1))
    }
}

impl LengthMap {
    fn at(&self, length: f64) -> (f64, f64) {
        match self {
            Self::Scale(scale) => (length * scale, *scale),
            Self::Stations(rising) => rising.at(length),
        }
    }

    fn inverse(&self, length: f64) -> f64 {
        match self {
            Self::Scale(scale) => length / scale,
            Self::Stations(rising) => rising.inverse(length),
        }
    }
}

/// A rising function through given pairs, twice differentiable, with constant slopes beyond them: quintics without second
/// derivative at the pairs. Slopes are harmonic means of the neighbouring steps: at most twice the smaller one, which is how
/// steep such a quintic may be and still rise.
struct Rising {
    from: Vec<f64>,
    to: Vec<f64>,
    slopes: Vec<f64>,
}

impl Rising {
    fn new(from: Vec<f64>, to: Vec<f64>) -> Self {
        let steps: Vec<f64> = from.windows(2).zip(to.windows(2)).map(|(a, b)| (b[1] - b[0]) / (a[1] - a[0])).collect();
        let mut slopes = vec![steps[0]];
        slopes.extend(steps.windows(2).map(|w| 2.0 * w[0] * w[1] / (w[0] + w[1])));
        slopes.push(steps[steps.len() - 1]);
        Self { from, to, slopes }
    }

    /// Value and slope.
    fn at(&self, x: f64) -> (f64, f64) {
        let last = self.from.len() - 1;
        if x <= self.from[0] {
            return (self.to[0] + self.slopes[0] * (x - self.from[0]), self.slopes[0]);
        }
        if x >= self.from[last] {
            return (self.to[last] + self.slopes[last] * (x - self.from[last]), self.slopes[last]);
        }
        let i = self.from.partition_point(|&f| f <= x).clamp(1, last) - 1;
        let h = self.from[i + 1] - self.from[i];
        let u = (x - self.from[i]) / h;
        let (delta, m0, m1) = (self.to[i + 1] - self.to[i], self.slopes[i] * h, self.slopes[i + 1] * h);
        let c = [10.0 * delta - 6.0 * m0 - 4.0 * m1, -15.0 * delta + 8.0 * m0 + 7.0 * m1, 6.0 * delta - 3.0 * (m0 + m1)];
        let value = self.to[i] + u * (m0 + u * u * (c[0] + u * (c[1] + u * c[2])));
        (value, (m0 + u * u * (3.0 * c[0] + u * (4.0 * c[1] + u * 5.0 * c[2]))) / h)
    }

    fn inverse(&self, y: f64) -> f64 {
        let last = self.to.len() - 1;
        if y <= self.to[0] {
            return self.from[0] + (y - self.to[0]) / self.slopes[0];
        }
        if y >= self.to[last] {
            return self.from[last] + (y - self.to[last]) / self.slopes[last];
        }
        let i = self.to.partition_point(|&t| t <= y).clamp(1, last) - 1;
        let (mut low, mut high) = (self.from[i], self.from[i + 1]);
        let mut x = 0.5 * (low + high);
        for _ in 0..STEPS {
            let (value, slope) = self.at(x);
            if value > y {
                high = x;
            } else {
                low = x;
            }
            let newton = x - (value - y) / slope;
            let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
            if (next - x).abs() <= f64::EPSILON * (1.0 + x.abs()) {
                return next;
            }
            x = next;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::Rising;

    #[test]
    fn rising_functions_rise_and_are_inverted() {
        let rising = Rising::new(vec![0.0, 1.0, 1.5, 4.0, 5.0], vec![0.0, 0.1, 3.0, 3.2, 9.0]);
        let mut before = f64::NEG_INFINITY;
        for i in -100..=700 {
            let x = f64::from(i) * 0.01;
            let (y, slope) = rising.at(x);
            assert!(y > before && slope > 0.0);
            assert!((rising.inverse(y) - x).abs() < 1e-12, "{x}");
            let h = 1e-6;
            assert!(((rising.at(x + h).0 - rising.at(x - h).0) / (2.0 * h) - slope).abs() < 1e-5);
            before = y;
        }
    }
}
