//! Distance from sources to all voxels, by ways that stay inside of the solid.
//!
//! |∇d| = 1 by upwind differences across the faces of voxels: the metric has no preferred directions, its error falls
//! with the size of voxels. Steps to all 26 neighbours are a second, never too short estimate, which also passes where
//! the solid is thin and hangs together at edges or corners only. The smaller one counts.

use super::voxels::{FACE_STEPS, NONE, STEPS, Voxels};

/// Distances within one bucket are settled together, and again if one of them changes.
const BUCKET: f32 = 0.5;
/// Buckets that are open at a time: more than any step passes over, however far distances are rounded.
const OPEN: u64 = 16;

/// Bucket of all that is farther: steps are lost in rounding there.
const LAST: u64 = 1 << 60;

/// Length of each of `STEPS`.
const LENGTHS: [f32; 26] = lengths();

const fn lengths() -> [f32; 26] {
    let mut lengths = [1.0; 26];
    let mut i = 0;
    while i < 26 {
        let [x, y, z] = STEPS[i];
        lengths[i] = match x * x + y * y + z * z {
            1 => 1.0,
            2 => std::f32::consts::SQRT_2,
            _ => 1.732_050_8,
        };
        i += 1;
    }
    lengths
}

/// Buffers of one run after the other.
#[derive(Default)]
pub struct Front {
    /// Per voxel, in voxels; infinite where no way leads.
    pub distances: Vec<f32>,
    /// Distance with which a voxel was passed on to its neighbours.
    passed: Vec<f32>,
    /// Least distance of a source: the first bucket begins there.
    start: f32,
    /// The bucket that is being settled, the next ones, and how many voxels they hold.
    bucket: u64,
    open: [Vec<u32>; OPEN as usize],
    open_count: usize,
}

impl Front {
    /// Distances from voxels that start with some distance. A voxel farther than its `bound` passes nothing on.
    ///
    /// Buckets in which nothing happens cost nothing, however far apart sources begin.
    pub fn spread(&mut self, voxels: &Voxels, sources: &[(u32, f32)], bounds: Option<&[f32]>) {
        self.distances.clear();
        self.distances.resize(voxels.len(), f32::INFINITY);
        self.passed.clear();
        self.passed.resize(voxels.len(), f32::INFINITY);
        self.start = sources.iter().map(|s| s.1).fold(f32::INFINITY, f32::min);
        for &(voxel, distance) in sources {
            let least = &mut self.distances[voxel as usize];
            *least = least.min(distance);
        }
        // Sources whose neighbours are as near as can be have nothing to pass on.
        let passes_on = |&&(voxel, distance): &&(u32, f32)| {
            let is_farther = |(&other, length): (&u32, &f32)| other != NONE && self.distances[other as usize] > distance + length;
            self.distances[voxel as usize] == distance && voxels.neighbours[voxel as usize].iter().zip(&LENGTHS).any(is_farther)
        };
        let mut waiting: Vec<(u64, u32)> =
            sources.iter().filter(passes_on).map(|&(voxel, distance)| (index(distance, self.start), voxel)).collect();
        waiting.sort_by_key(|&(bucket, _)| bucket);
        let mut waiting = waiting.into_iter().peekable();
        let mut batch = Vec::new();
        while let Some(next) = self.next_bucket(waiting.peek().map(|&(bucket, _)| bucket)) {
            self.bucket = next;
            while let Some((_, voxel)) = waiting.next_if(|&(bucket, _)| bucket == next) {
                batch.push(voxel);
            }
            let open = &mut self.open[(next % OPEN) as usize];
            self.open_count -= open.len();
            batch.append(open);
            for voxel in batch.drain(..) {
                let distance = self.distances[voxel as usize];
                let is_stale = index(distance, self.start) != next || self.passed[voxel as usize] <= distance;
                if is_stale || bounds.is_some_and(|bounds| distance > bounds[voxel as usize]) {
                    continue;
                }
                self.passed[voxel as usize] = distance;
                self.pass_on(voxels, voxel, distance);
            }
        }
    }

    /// The first bucket from the current one on that holds anything; `waiting`: the first one that sources wait for.
    fn next_bucket(&self, waiting: Option<u64>) -> Option<u64> {
        if self.open_count == 0 {
            return waiting;
        }
        let open = (self.bucket..self.bucket + OPEN).find(|&bucket| !self.open[(bucket % OPEN) as usize].is_empty());
        open.into_iter().chain(waiting).min()
    }

    #[inline]
    fn pass_on(&mut self, voxels: &Voxels, voxel: u32, distance: f32) {
        let neighbours = &voxels.neighbours[voxel as usize];
        for (step, &other) in neighbours.iter().enumerate() {
            if other == NONE || self.distances[other as usize] <= distance {
                continue;
            }
            let found = if step < FACE_STEPS { self.upwind(&voxels.neighbours[other as usize]) } else { distance + LENGTHS[step] };
            if found < self.distances[other as usize] {
                self.improve(other, found);
            }
        }
    }

    #[inline]
    fn improve(&mut self, voxel: u32, distance: f32) {
        self.distances[voxel as usize] = distance;
        let bucket = index(distance, self.start);
        // Beside a voxel beyond its bound, which passed nothing on, a way may be found too late: nobody takes it.
        if bucket >= self.bucket {
            debug_assert!(bucket < self.bucket + OPEN);
            self.open[(bucket % OPEN) as usize].push(voxel);
            self.open_count += 1;
        }
    }

    /// Solution of Σ (d − dᵢ)₊² = 1 over the axes, dᵢ the smaller distance of the two neighbours along axis i.
    #[inline]
    fn upwind(&self, neighbours: &[u32; 26]) -> f32 {
        let near = |i: usize| {
            let of = |n: u32| if n == NONE { f32::INFINITY } else { self.distances[n as usize] };
            of(neighbours[2 * i]).min(of(neighbours[2 * i + 1]))
        };
        let (x, y, z) = (near(0), near(1), near(2));
        let (low, high) = (x.min(y), x.max(y));
        let (a, b, c) = (low.min(z), low.max(high.min(z)), high.max(z));
        if b >= a + 1.0 {
            return a + 1.0;
        }
        // About a, so that large distances do not lose digits.
        let (b, c) = (b - a, c - a);
        let two = 0.5 * (b + (2.0 - b * b).max(0.0).sqrt());
        if c >= two {
            return a + two;
        }
        let (sum, squares) = (b + c, b * b + c * c);
        a + (sum + (sum * sum - 3.0 * (squares - 1.0)).max(0.0).sqrt()) / 3.0
    }
}

#[inline]
fn index(distance: f32, start: f32) -> u64 {
    (((distance - start) / BUCKET) as u64).min(LAST)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(radius: f64) -> (Voxels, u32) {
        let size = 2 * radius as usize + 3;
        let middle = size as f64 / 2.0;
        let cells = (0..(size * size * size) as u32).filter(|&i| {
            let i = i as usize;
            let at = [i % size, i / size % size, i / size / size].map(|c| c as f64 + 0.5 - middle);
            at.iter().map(|x| x * x).sum::<f64>() <= radius * radius
        });
        let voxels = Voxels::new([size; 3], &[cells.collect()]);
        let centre = voxels.at([size as i64 / 2; 3]);
        (voxels, centre)
    }

    #[test]
    fn error_falls_with_the_voxels() {
        let error = |radius: f64| {
            let (voxels, centre) = ball(radius);
            let mut front = Front::default();
            let from = voxels.centre(centre);
            // As bones do, the front starts with what is seen.
            let all = (0..voxels.len() as u32).map(|voxel| (voxel, voxels.centre(voxel).distance(from)));
            let seen: Vec<(u32, f32)> = all.filter(|s| s.1 < 0.3 * radius).map(|s| (s.0, s.1 as f32)).collect();
            front.spread(&voxels, &seen, None);
            let errors = (0..voxels.len() as u32).map(|v| f64::from(front.distances[v as usize]) - voxels.centre(v).distance(from));
            let (mut low, mut high) = (f64::INFINITY, 0.0f64);
            for error in errors {
                low = low.min(error);
                high = high.max(error);
            }
            assert!(low > -1e-3, "a way shorter than straight: {low}");
            high / radius
        };
        let [coarse, fine, finest] = [6.0, 12.0, 24.0].map(error);
        assert!(fine < 0.65 * coarse && finest < 0.65 * fine, "{coarse} {fine} {finest}");
        assert!(finest < 0.025, "{finest}");
    }

    #[test]
    fn sources_may_begin_any_distance_apart() {
        // Two balls in one lattice, the second one beyond a gap, its source as far as any.
        let size = 24u32;
        let is_in = |&i: &u32| {
            let at = [i % size, i / size % size, i / size / size].map(|c| f64::from(c) + 0.5);
            [6.0, 18.0].iter().any(|&x| (at[0] - x).hypot(at[1] - 12.0).hypot(at[2] - 12.0) <= 5.0)
        };
        let voxels = Voxels::new([size as usize; 3], &[(0..size.pow(3)).filter(is_in).collect()]);
        assert_eq!(voxels.part_count, 2);
        let [near, far] = [6, 18].map(|x| voxels.at([x, 12, 12]));
        let spread = |sources: &[(u32, f32)]| {
            let mut front = Front::default();
            front.spread(&voxels, sources, None);
            assert!(front.open.iter().all(Vec::is_empty));
            front.distances
        };
        let alone = spread(&[(near, 0.25)]);
        for distance in [7.0, 1e3, 16_777_217.0, 1e9, 1e20] {
            let both = spread(&[(far, distance), (near, 0.25)]);
            for (voxel, (&found, &plain)) in both.iter().zip(&alone).enumerate() {
                if voxels.part[voxel] == voxels.part[near as usize] {
                    assert_eq!(found, plain);
                } else {
                    // Within the ball, and as steps are rounded.
                    assert!(found >= distance && found <= distance + 8.0 + distance * 1e-6, "{found}");
                }
            }
        }
    }

    #[test]
    fn ways_lead_through_corners_and_stop_at_gaps() {
        // Three voxels in a diagonal row, and one beyond a gap of one cell.
        let cell = |x: u32, y: u32, z: u32| (z * 5 + y) * 5 + x;
        let voxels = Voxels::new([5; 3], &[vec![cell(0, 0, 0), cell(1, 1, 1), cell(2, 2, 2), cell(4, 4, 4)]]);
        let mut front = Front::default();
        front.spread(&voxels, &[(0, 0.5)], None);
        assert!((front.distances[2] - (0.5 + 2.0 * 3.0f32.sqrt())).abs() < 1e-6);
        assert_eq!(front.distances[3], f32::INFINITY);
        assert_eq!(voxels.part, [0, 0, 0, 1]);
    }
}
