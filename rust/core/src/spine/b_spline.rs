//! B-splines by de Boor's scheme: the quintic ones of \[ZR13\], and rational ones as Blender has them.

use glam::{DVec3, DVec4};

use crate::spine::quintic::Jet;

/// Highest degree that Blender offers is 5, and ours is 5.
const DEGREE_MAX: usize = 5;

/// A rational B-spline; control points are (w·x, w·y, w·z, w).
#[derive(Debug, Clone)]
pub(crate) struct BSpline {
    degree: usize,
    knots: Vec<f64>,
    controls: Vec<DVec4>,
}

/// How Blender spreads the knots of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KnotFlags {
    /// The curve begins and ends at its first and last control point (*Endpoint*).
    pub use_endpoint: bool,
    /// Segments are Bézier curves (*Bézier*).
    pub use_bezier: bool,
}

impl BSpline {
    /// The quintic spline of \[ZR13\] that begins and ends at its control points; of lower degree where there are fewer than
    /// six. Knots are means of the control points' `parameters`, so that speed follows their distances.
    pub fn clamped(parameters: &[f64], points: &[DVec3]) -> Self {
        let degree = DEGREE_MAX.min(points.len() - 1);
        let mut knots = vec![parameters[0]; degree + 1];
        for inner in parameters[1..].windows(degree).take(points.len() - degree - 1) {
            knots.push(inner.iter().sum::<f64>() / degree as f64);
        }
        knots.extend(vec![parameters[points.len() - 1]; degree + 1]);
        Self { degree, knots, controls: points.iter().map(|p| p.extend(1.0)).collect() }
    }

    /// A spline as Blender has it; None where the flags leave no span for so few points. `order` is 2 to 6 and at most the
    /// number of points.
    pub fn of_blender(points: &[DVec3], weights: &[f64], order: usize, flags: KnotFlags) -> Option<Self> {
        let controls = points.iter().zip(weights).map(|(&p, &w)| (p * w).extend(w)).collect();
        let spline = Self { degree: order - 1, knots: blender_knots(points.len(), order, flags), controls };
        (spline.spans().len() > 1).then_some(spline)
    }

    /// Distinct knots within the domain.
    pub fn spans(&self) -> Vec<f64> {
        let mut spans = self.knots[self.degree..=self.controls.len()].to_vec();
        spans.dedup();
        spans
    }

    /// Parameter at which each control point pulls most: the mean of its inner knots.
    pub fn centres(&self) -> Vec<f64> {
        let mean = |inner: &[f64]| inner.iter().sum::<f64>() / self.degree as f64;
        self.knots[1..self.knots.len() - 1].windows(self.degree).map(mean).collect()
    }

    /// Position and derivatives; at a knot those of the span that begins there if `after`, else of the one that ends there.
    pub fn jet(&self, t: f64, is_after: bool) -> Jet {
        let domain = self.degree..self.controls.len();
        let last = if is_after { self.knots.partition_point(|&k| k <= t) } else { self.knots.partition_point(|&k| k < t) };
        let span = last.clamp(domain.start + 1, domain.end) - 1;
        let controls = &self.controls[span - self.degree..=span];
        let knots = &self.knots[span + 1 - self.degree..=span + self.degree];
        let [a, a1, a2] = de_boor(controls, knots, t);
        let position = a.truncate() / a.w;
        let first = (a1.truncate() - a1.w * position) / a.w;
        let second = (a2.truncate() - 2.0 * a1.w * first - a2.w * position) / a.w;
        Jet { position, first, second }
    }
}

/// Value and derivatives of one span, of degree + 1 controls and twice as many knots less two.
fn de_boor(controls: &[DVec4], knots: &[f64], t: f64) -> [DVec4; 3] {
    let degree = controls.len() - 1;
    let mut jets = [[DVec4::ZERO; 3]; DEGREE_MAX + 1];
    for (jet, &control) in jets.iter_mut().zip(controls) {
        jet[0] = control;
    }
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            let (low, high) = (knots[i - 1], knots[i + degree - level]);
            let width = high - low;
            let u = (t - low) / width;
            let (a, b) = (jets[i - 1], jets[i]);
            jets[i] = [a[0].lerp(b[0], u), a[1].lerp(b[1], u) + (b[0] - a[0]) / width, a[2].lerp(b[2], u) + (b[1] - a[1]) * (2.0 / width)];
        }
    }
    jets[degree]
}

/// Knots as Blender counts them for open curves.
fn blender_knots(point_count: usize, order: usize, flags: KnotFlags) -> Vec<f64> {
    let repeat = if flags.use_bezier { order - 1 } else { 1 };
    let head = match (flags.use_endpoint, flags.use_bezier) {
        (true, _) => order,
        (false, true) => repeat.min(2),
        (false, false) => 1,
    };
    let tail = if flags.use_endpoint { order } else { 0 };
    let count = point_count + order;
    let (mut knots, mut current, mut left) = (Vec::with_capacity(count), 0.0, head);
    for _ in 0..count - tail {
        knots.push(current);
        left -= 1;
        if left == 0 {
            current += 1.0;
            left = repeat;
        }
    }
    knots.resize(count, current);
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [DVec3; 7] = [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 0.5, 0.0),
        DVec3::new(2.0, -0.5, 1.0),
        DVec3::new(3.0, 0.0, 1.5),
        DVec3::new(4.0, 1.0, 0.5),
        DVec3::new(5.0, 0.0, 0.0),
        DVec3::new(6.0, 0.2, -0.4),
    ];
    const FLAGS: KnotFlags = KnotFlags { use_endpoint: true, use_bezier: false };

    #[test]
    fn clamped_splines_begin_and_end_at_their_controls() {
        let parameters = [0.0, 1.0, 2.5, 3.0, 4.0, 6.0, 7.0];
        for count in 2..=7 {
            let spline = BSpline::clamped(&parameters[..count], &POINTS[..count]);
            let end = parameters[count - 1];
            assert!(spline.jet(0.0, true).position.distance(POINTS[0]) < 1e-14);
            assert!(spline.jet(end, false).position.distance(POINTS[count - 1]) < 1e-14);
            assert_eq!(spline.centres().len(), count);
            assert_eq!((spline.centres()[0], spline.centres()[count - 1]), (0.0, end));
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let weights = [1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 1.0];
        for order in 3..=6 {
            let spline = BSpline::of_blender(&POINTS, &weights, order, FLAGS).expect("enough points");
            let (t, h) = (1.3, 1e-5);
            let [before, here, after] = [t - h, t, t + h].map(|t| spline.jet(t, true));
            assert!(here.first.distance((after.position - before.position) / (2.0 * h)) < 1e-8);
            assert!(here.second.distance((after.first - before.first) / (2.0 * h)) < 1e-7);
        }
    }

    #[test]
    fn knots_are_those_of_blender() {
        let knots = |endpoint, bezier| blender_knots(5, 4, KnotFlags { use_endpoint: endpoint, use_bezier: bezier });
        assert_eq!(knots(false, false), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!(knots(true, false), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
        assert_eq!(knots(false, true), [0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0]);
    }
}
