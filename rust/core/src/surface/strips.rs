//! Quads in strips: neighbours share an edge, so that a sweep reads two new points per quad instead of four.

/// Two points side by side, in each of four strips: left ones, right ones. Quads lie between a rung and the next, with corners
/// left, next left, next right, right.
pub(crate) type Rung = [[u8; 4]; 2];

/// Strips that are cut to equal lengths come four at a time, one to a lane.
const LANES: usize = 4;

/// Edges across which a strip goes, one more than quads.
type Strip = Vec<[u8; 2]>;

/// All quads in strips, long ones first. Lanes without a quad have quads of one point.
pub(crate) fn strips(quads: &[[u8; 4]]) -> Vec<Vec<Rung>> {
    let mut left = longest_first(single_strips(quads));
    let mut result = Vec::new();
    while let Some(longest) = left.first().map(|strip| strip.len() - 1) {
        let shortest = left.get(LANES - 1).map_or(0, |strip| strip.len() - 1);
        // Lanes that would idle, or long strips cut short, cost more than one rung read twice.
        if longest > 1 && 2 * shortest < longest {
            let (first, second) = cut(&left[0], longest / 2);
            left.splice(..1, [first, second]);
        } else {
            let length = shortest.max(1);
            let lanes: Vec<Strip> = left.drain(..left.len().min(LANES)).collect();
            let point = |lane: usize, rung: usize, side: usize| lanes.get(lane).map_or(0, |strip| strip[rung][side]);
            let rung = |rung: usize| std::array::from_fn(|side| std::array::from_fn(|lane| point(lane, rung, side)));
            result.push((0..=length).map(rung).collect());
            left.extend(lanes.iter().filter(|strip| strip.len() > length + 1).map(|strip| cut(strip, length).1));
        }
        left = longest_first(left);
    }
    result
}

fn longest_first(mut strips: Vec<Strip>) -> Vec<Strip> {
    strips.sort_by_key(|strip| std::cmp::Reverse(strip.len()));
    strips
}

/// Both parts have the edge between them.
fn cut(strip: &[[u8; 2]], quads: usize) -> (Strip, Strip) {
    (strip[..=quads].to_vec(), strip[quads..].to_vec())
}

/// Strips as long as they go; where two cross, the longer one.
fn single_strips(quads: &[[u8; 4]]) -> Vec<Strip> {
    let mut sides: Vec<([u8; 2], usize, usize)> = quads
        .iter()
        .enumerate()
        .flat_map(|(quad, corners)| (0..4).map(move |side| ([corners[side], corners[(side + 1) % 4]], quad, side)))
        .collect();
    sides.sort_unstable();
    let mut walk = Walk { quads, sides: &sides, walked: vec![0; quads.len()], walks: 0, is_taken: vec![false; quads.len()] };
    let mut result = Vec::new();
    for quad in 0..quads.len() {
        if walk.is_taken[quad] {
            continue;
        }
        let [along, across] = [0, 1].map(|side| walk.strip(quad, side));
        let strip = if across.len() > along.len() { across } else { along };
        for &(quad, _) in &strip {
            walk.is_taken[quad] = true;
        }
        let (last, side) = strip[strip.len() - 1];
        let entered = strip.iter().map(|&(quad, side)| [quads[quad][side], quads[quad][(side + 3) % 4]]);
        result.push(entered.chain([[quads[last][(side + 1) % 4], quads[last][(side + 2) % 4]]]).collect());
    }
    result
}

struct Walk<'a> {
    quads: &'a [[u8; 4]],
    /// Directed edges, sorted, with their quad and the corner where they start in it.
    sides: &'a [([u8; 2], usize, usize)],
    /// Per quad: the last walk that came by.
    walked: Vec<usize>,
    walks: usize,
    is_taken: Vec<bool>,
}

impl Walk<'_> {
    /// Quads that follow one another both ways, each with its corner at the left of the edge by which it is entered.
    fn strip(&mut self, quad: usize, side: usize) -> Vec<(usize, usize)> {
        self.walks += 1;
        self.walked[quad] = self.walks;
        let mut strip = Vec::new();
        let mut at = (quad, side);
        // Entered by their next left and next right, quads before this one turn up as quads after it would.
        while let Some((quad, start)) = self.behind(at.0, (at.1 + 3) % 4) {
            at = (quad, (start + 3) % 4);
            strip.push(at);
        }
        strip.reverse();
        strip.push((quad, side));
        at = (quad, side);
        while let Some((quad, start)) = self.behind(at.0, (at.1 + 1) % 4) {
            at = (quad, (start + 1) % 4);
            strip.push(at);
        }
        strip
    }

    /// A free quad behind the edge that starts at a corner of a quad, and the corner where the edge starts there.
    fn behind(&mut self, quad: usize, corner: usize) -> Option<(usize, usize)> {
        let corners = self.quads[quad];
        let edge = [corners[(corner + 1) % 4], corners[corner]];
        let first = self.sides.partition_point(|side| side.0 < edge);
        let mut same = self.sides[first..].iter().take_while(|side| side.0 == edge);
        let &(_, quad, start) = same.find(|side| !self.is_taken[side.1] && self.walked[side.1] != self.walks)?;
        self.walked[quad] = self.walks;
        Some((quad, start))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn quads_between(strips: &[Vec<Rung>]) -> Vec<[u8; 4]> {
        let mut quads = Vec::new();
        for pair in strips.iter().flat_map(|strip| strip.windows(2)) {
            for lane in 0..LANES {
                let [left, right] = pair[0].map(|side| side[lane]);
                let [next_left, next_right] = pair[1].map(|side| side[lane]);
                quads.push([left, next_left, next_right, right]);
            }
        }
        quads
    }

    /// From its smallest corner: the same for all ways to write a quad.
    fn turned(quad: [u8; 4]) -> [u8; 4] {
        (0..4).map(|first| std::array::from_fn(|i| quad[(first + i) % 4])).min().unwrap_or(quad)
    }

    proptest! {
        #[test]
        fn every_quad_is_in_one_strip_and_keeps_its_winding(quads in prop::collection::vec(prop::array::uniform4(1u8..30), 0..60)) {
            let mut found: Vec<_> = quads_between(&strips(&quads)).into_iter().filter(|quad| *quad != [0; 4]).map(turned).collect();
            let mut given: Vec<_> = quads.iter().copied().map(turned).collect();
            found.sort_unstable();
            given.sort_unstable();
            prop_assert_eq!(found, given);
        }
    }

    #[test]
    fn a_grid_becomes_few_long_strips() {
        let at = |i: u8, j: u8| 1 + 16 * i + j;
        let cells = (0..15).flat_map(|i| (0..14).map(move |j| (i, j)));
        let grid: Vec<_> = cells.map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect();
        let rungs: usize = strips(&grid).iter().map(Vec::len).sum();
        // Four quads to a rung, and one rung more for each of the strips.
        assert!(rungs <= grid.len() / 4 + 8, "{rungs} rungs for {} quads", grid.len());
    }
}
