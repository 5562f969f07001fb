//! The polynomial through all points \[ZR13\], by Neville's scheme.

use glam::DVec3;

use crate::spine::quintic::Jet;

/// Position and derivatives at `t` of the polynomial of least degree through `points` at `parameters`.
///
/// Wild between the points when there are many: equal steps and more than ten points should use a spline.
pub(crate) fn neville(parameters: &[f64], points: &[DVec3], t: f64) -> Jet {
    let mut jets: Vec<Jet> = points.iter().map(|&position| Jet { position, ..Jet::default() }).collect();
    for degree in 1..points.len() {
        for i in 0..points.len() - degree {
            let (a, b) = (jets[i], jets[i + 1]);
            let width = parameters[i + degree] - parameters[i];
            let u = (t - parameters[i]) / width;
            jets[i] = Jet {
                position: a.position.lerp(b.position, u),
                first: a.first.lerp(b.first, u) + (b.position - a.position) / width,
                second: a.second.lerp(b.second, u) + (b.first - a.first) * (2.0 / width),
            };
        }
    }
    jets[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_and_their_derivatives_are_reproduced() {
        let cubic = |t: f64| DVec3::new(t * t * t, 2.0 - t, t * t);
        let parameters = [0.0, 0.4, 1.1, 2.0, 2.5];
        let points = parameters.map(cubic);
        let jet = neville(&parameters, &points, 1.7);
        assert!(jet.position.distance(cubic(1.7)) < 1e-13);
        assert!(jet.first.distance(DVec3::new(3.0 * 1.7 * 1.7, -1.0, 3.4)) < 1e-12);
        assert!(jet.second.distance(DVec3::new(6.0 * 1.7, 0.0, 2.0)) < 1e-11);
    }
}
