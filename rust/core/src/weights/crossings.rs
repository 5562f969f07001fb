//! Where the lines through voxel centres along one axis cross a surface.
//!
//! A line that meets an edge belongs to exactly one of the edge's two faces, because both compare the same numbers: lines
//! cross closed surfaces inwards as often as outwards, whatever the shape of faces.

use glam::DVec3;

/// One crossing: how deep along the axis, and +1 where the line leaves the surface, -1 where it enters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    pub depth: f64,
    pub sign: i8,
}

/// Crossings of all lines along `axis`, a line per cell of the other two axes, in order of depth.
pub struct Crossings {
    starts: Vec<u32>,
    /// Line after line.
    sorted: Vec<Crossing>,
    /// Lines along the first of the other axes.
    width: usize,
}

/// The cells that are looked at: voxels from `low`, `dims` along each axis.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub low: [usize; 3],
    pub dims: [usize; 3],
}

/// The two axes across `axis`, in right-handed order.
pub const fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

impl Crossings {
    /// Scans triangles, counter-clockwise seen from outside, in voxels.
    pub fn new(axis: usize, window: &Window, triangles: &[[DVec3; 3]]) -> Self {
        let [u, v] = across(axis);
        let (width, height) = (window.dims[u], window.dims[v]);
        let low = [window.low[u] as f64, window.low[v] as f64];
        let mut found: Vec<(u32, Crossing)> = Vec::new();
        for corners in triangles {
            let flat = corners.map(|p| [p[u] - low[0], p[v] - low[1], p[axis]]);
            scan(&flat, width, height, |line, crossing| found.push((line, crossing)));
        }
        let mut starts = vec![0u32; width * height + 1];
        for (line, _) in &found {
            starts[*line as usize + 1] += 1;
        }
        for line in 0..width * height {
            starts[line + 1] += starts[line];
        }
        let mut next = starts.clone();
        let mut sorted = vec![Crossing { depth: 0.0, sign: 0 }; found.len()];
        for (line, crossing) in found {
            sorted[next[line as usize] as usize] = crossing;
            next[line as usize] += 1;
        }
        for line in starts.windows(2) {
            sorted[line[0] as usize..line[1] as usize].sort_unstable_by(|a, b| a.depth.total_cmp(&b.depth).then(a.sign.cmp(&b.sign)));
        }
        Self { starts, sorted, width }
    }

    /// Crossings of the line at cell (u, v) of the window.
    #[inline]
    pub fn line(&self, u: usize, v: usize) -> &[Crossing] {
        let line = v * self.width + u;
        &self.sorted[self.starts[line] as usize..self.starts[line + 1] as usize]
    }

    /// All crossings, as cells (u, v) and depths.
    pub fn cells(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        let lines = self.starts.windows(2).enumerate();
        lines.flat_map(|(line, range)| {
            let cell = [line % self.width, line / self.width];
            self.sorted[range[0] as usize..range[1] as usize].iter().map(move |crossing| (cell, crossing.depth))
        })
    }
}

/// Lines at half numbers that cross one triangle; corners are (u, v, depth).
fn scan(corners: &[[f64; 3]; 3], width: usize, height: usize, mut found: impl FnMut(u32, Crossing)) {
    let bounds = |i: usize| {
        let [a, b, c] = corners.map(|p| p[i]);
        (a.min(b).min(c), a.max(b).max(c))
    };
    let (first_v, last_v) = bounds(1);
    let rows = (first_v - 0.5).ceil().max(0.0)..(last_v - 0.5).ceil().min(height as f64);
    if rows.start >= rows.end {
        return;
    }
    let (shallow, deep) = bounds(2);
    let [a, b, c] = *corners;
    let (ab, ac) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    let normal = [ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]];
    for row in rows.start as usize..rows.end as usize {
        let v = row as f64 + 0.5;
        // The two edges that the row crosses: where, and whether upwards.
        let mut cuts = [(0.0, false); 2];
        let mut count = 0;
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            if (p[1] > v) != (q[1] > v) && count < 2 {
                // From the lower end, so that both faces of an edge find the same number.
                let (low, high) = if q[1] > v { (p, q) } else { (q, p) };
                cuts[count] = (low[0] + (high[0] - low[0]) * ((v - low[1]) / (high[1] - low[1])), q[1] > v);
                count += 1;
            }
        }
        if count < 2 {
            continue;
        }
        let [left, right] = if cuts[0].0 <= cuts[1].0 { cuts } else { [cuts[1], cuts[0]] };
        // Counter-clockwise triangles run down on their left.
        let sign = if left.1 { -1 } else { 1 };
        let columns = (left.0 + 0.5).floor().max(0.0)..(right.0 + 0.5).floor().min(width as f64);
        if columns.start >= columns.end {
            continue;
        }
        for column in columns.start as usize..columns.end as usize {
            let u = column as f64 + 0.5;
            let slope = -(normal[0] * (u - a[0]) + normal[1] * (v - a[1])) / normal[2];
            let depth = if slope.is_finite() { (a[2] + slope).clamp(shallow, deep) } else { 0.5 * (shallow + deep) };
            found((row * width + column) as u32, Crossing { depth, sign });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_through_edges_and_corners_cross_a_closed_surface_evenly() {
        // An octahedron whose corners and edges lie on lines through voxel centres.
        let centre = DVec3::splat(4.5);
        let corner = |i: usize| centre + 3.0 * [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z][i];
        let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let window = Window { low: [0; 3], dims: [9; 3] };
        for axis in 0..3 {
            let crossings = Crossings::new(axis, &window, &faces.map(|f| f.map(corner)));
            let mut crossed = 0;
            for u in 0..9 {
                for v in 0..9 {
                    let line = crossings.line(u, v);
                    assert_eq!(line.iter().map(|c| i32::from(c.sign)).sum::<i32>(), 0);
                    assert!(line.first().is_none_or(|first| first.sign == -1));
                    crossed += usize::from(!line.is_empty());
                }
            }
            assert!(crossed > 10);
        }
    }
}
