//! The intrinsic Delaunay triangulation of a surface: the surface stays as it is, edges are turned within it until the
//! angles across each sum to at most half a turn. Then no edge between two triangles has a negative cotangent weight,
//! however thin the triangles were.
//!
//! Only lengths count. Turned edges may be loops, and two may join the same points.

use glam::DVec3;

/// No triangle across.
const NONE: u32 = u32::MAX;
/// By how much two sides are at least longer than the third, as a part of the mean length: all sides are made longer by
/// what is missing, so that collapsed triangles have an area.
const LEAST_SLACK: f64 = 1e-6;
/// Sum of cotangents below which an edge is turned: corners on one circle are left alone.
const TIE: f64 = -1e-9;
/// Turns per side of a triangle before it is good enough.
const TURNS: usize = 32;

/// Triangles glued along their sides; side i runs from corner i to the next. Sides are numbered 3 triangle + i.
pub struct Triangulation {
    pub corners: Vec<[u32; 3]>,
    pub lengths: Vec<[f64; 3]>,
    /// Per side the one across; none at borders, where more than two meet, or where two run the same way.
    across: Vec<u32>,
}

impl Triangulation {
    /// Delaunay, from triangles of points. Those with a corner twice are left out.
    pub fn new(points: &[DVec3], triangles: impl IntoIterator<Item = [u32; 3]>) -> Self {
        let corners: Vec<[u32; 3]> = triangles.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let length = |a: u32, b: u32| points[a as usize].distance(points[b as usize]);
        let mut lengths: Vec<[f64; 3]> = corners.iter().map(|&[a, b, c]| [length(a, b), length(b, c), length(c, a)]).collect();
        let mean = lengths.as_flattened().iter().sum::<f64>() / (3 * lengths.len()).max(1) as f64;
        let missing = |[a, b, c]: &[f64; 3]| LEAST_SLACK * mean + 2.0 * a.max(*b).max(*c) - (a + b + c);
        let longer = lengths.iter().map(missing).fold(0.0, f64::max);
        for side in lengths.as_flattened_mut() {
            *side += longer;
        }
        let across = glued(&corners);
        let mut all = Self { corners, lengths, across };
        all.turn_edges();
        all
    }

    fn turn_edges(&mut self) {
        let mut open: Vec<u32> = (0..self.across.len() as u32).filter(|&side| side < self.across[side as usize]).collect();
        for _ in 0..TURNS * self.across.len() {
            let Some(side) = open.pop() else { return };
            let other = self.across[side as usize];
            if other != NONE && side / 3 != other / 3 && self.cotangent(side) + self.cotangent(other) < TIE {
                self.turn(side);
                // Its four neighbours may be wrong now.
                open.extend([side / 3, other / 3].into_iter().flat_map(|t| [3 * t + 1, 3 * t + 2]));
            }
        }
    }

    /// Of the angle across from a side.
    fn cotangent(&self, side: u32) -> f64 {
        let [a, b, c] = self.sides_from(side);
        (b * b + c * c - a * a) / (2.0 * double_area([a, b, c]))
    }

    /// Lengths of a triangle, this side first.
    fn sides_from(&self, side: u32) -> [f64; 3] {
        let (triangle, i) = (side as usize / 3, side as usize % 3);
        [0, 1, 2].map(|k| self.lengths[triangle][(i + k) % 3])
    }

    /// Replaces the side a b of the triangles a b c and b a d by c d.
    fn turn(&mut self, side: u32) {
        let other = self.across[side as usize];
        let (t, u) = (side / 3, other / 3);
        let [ab, bc, ca] = self.sides_from(side);
        let [_, ad, db] = self.sides_from(other);
        let corner = |side: u32, k: u32| self.corners[side as usize / 3][((side + k) % 3) as usize];
        let after = |side: u32, k: u32| side / 3 * 3 + (side + k) % 3;
        // 3 t is a multiple of 3, so the number of a side turns about as its place does.
        let [a, b, c, d] = [corner(side, 0), corner(side, 1), corner(side, 2), corner(other, 2)];
        let old = [after(side, 1), after(side, 2), after(other, 1), after(other, 2)];
        let new = [3 * t + 2, 3 * u + 1, 3 * u + 2, 3 * t + 1];
        let outer = old.map(|side| self.across[side as usize]);
        let cosines = [(ab * ab + ca * ca - bc * bc) / (2.0 * ab * ca), (ab * ab + ad * ad - db * db) / (2.0 * ab * ad)];
        let sines = [double_area([ab, bc, ca]) / (ab * ca), double_area([ab, ad, db]) / (ab * ad)];
        let cosine = cosines[0] * cosines[1] - sines[0] * sines[1];
        let cd = (ca * ca + ad * ad - 2.0 * ca * ad * cosine).max(0.0).sqrt();

        (self.corners[t as usize], self.lengths[t as usize]) = ([c, d, b], [cd, db, bc]);
        (self.corners[u as usize], self.lengths[u as usize]) = ([d, c, a], [cd, ca, ad]);
        self.across[3 * t as usize] = 3 * u;
        self.across[3 * u as usize] = 3 * t;
        for (side, across) in new.into_iter().zip(outer) {
            // The two triangles may be glued to each other along other sides as well.
            let across = old.iter().position(|&o| o == across).map_or(across, |i| new[i]);
            self.across[side as usize] = across;
            if across != NONE {
                self.across[across as usize] = side;
            }
        }
    }
}

/// Twice the area, by a formula that is accurate for thin triangles (Kahan).
pub fn double_area(mut lengths: [f64; 3]) -> f64 {
    lengths.sort_unstable_by(|a, b| b.total_cmp(a));
    let [a, b, c] = lengths;
    0.5 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).max(f64::MIN_POSITIVE).sqrt()
}

fn glued(corners: &[[u32; 3]]) -> Vec<u32> {
    let mut sides: Vec<(u32, u32, u32)> = (0..3 * corners.len() as u32)
        .map(|side| {
            let [a, b] = [side, side + 1].map(|s| corners[side as usize / 3][(s % 3) as usize]);
            (a.min(b), a.max(b), side)
        })
        .collect();
    sides.sort_unstable();
    let mut across = vec![NONE; sides.len()];
    let first = |side: u32| corners[side as usize / 3][(side % 3) as usize];
    for run in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if let [(_, _, one), (_, _, other)] = *run
            && first(one) != first(other)
        {
            across[one as usize] = other;
            across[other as usize] = one;
        }
    }
    across
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of a plane whose points are far from their neighbours along it: all triangles are thin.
    fn slanted() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (columns, rows) = (12, 9);
        let point = |i: u32| {
            let (x, y) = (f64::from(i % columns), f64::from(i / columns));
            DVec3::new(x + 3.4 * y + 0.1 * (7.0 * y + x).sin(), y + 0.1 * (5.0 * x).cos(), 0.0)
        };
        let corner = |x: u32, y: u32| y * columns + x;
        let cells = (0..rows - 1).flat_map(|y| (0..columns - 1).map(move |x| (x, y)));
        let triangles = cells.flat_map(|(x, y)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b, c], [a, c, d]]
        });
        ((0..columns * rows).map(point).collect(), triangles.collect())
    }

    fn area(lengths: &[[f64; 3]]) -> f64 {
        lengths.iter().map(|&l| 0.5 * double_area(l)).sum()
    }

    #[test]
    fn no_edge_between_two_triangles_is_negative_and_the_area_stays() {
        let (points, triangles) = slanted();
        let before: Vec<[f64; 3]> = triangles
            .iter()
            .map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(|[p, q]| points[p as usize].distance(points[q as usize])))
            .collect();
        let found = Triangulation::new(&points, triangles.iter().copied());
        assert!(found.corners != triangles);
        assert!((area(&found.lengths) - area(&before)).abs() < 1e-9 * area(&before));
        for side in 0..found.across.len() as u32 {
            let other = found.across[side as usize];
            if other != NONE {
                assert_eq!(found.across[other as usize], side);
                assert!(found.cotangent(side) + found.cotangent(other) >= 2.0 * TIE);
            }
        }
        // In a plane a side is as long as its points are apart.
        for (&[a, b, _], lengths) in found.corners.iter().zip(&found.lengths) {
            assert!((points[a as usize].distance(points[b as usize]) - lengths[0]).abs() < 1e-9);
        }
    }

    #[test]
    fn collapsed_and_folded_triangles_end() {
        let points: Vec<DVec3> = (0..9).map(|i| DVec3::new(f64::from(i % 3), f64::from(i % 2) * 1e-12, 0.0)).collect();
        let triangles = (0..9).flat_map(|i| (0..9).map(move |k| [i, (i + k) % 9, (i + 2 * k) % 9]));
        let found = Triangulation::new(&points, triangles);
        assert!(found.lengths.as_flattened().iter().all(|l| l.is_finite()));
    }
}
