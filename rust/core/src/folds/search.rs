//! Which triangles pass through each other now and did not when skinned, kept up to date while points move.

use glam::DVec3;
use rayon::prelude::*;

use super::crossing::cross;
use super::skin::Skin;
use super::tree::Fitted;

/// Triangles of a parallel piece, at least.
const CHUNK: usize = 4096;

/// The search for folds of one frame.
pub(crate) struct Search<'a> {
    pub skin: &'a Skin,
    pub skinned: &'a [DVec3],
    places: Vec<DVec3>,
    fitted: Vec<Fitted>,
    pairs: Vec<(u32, u32)>,
}

impl<'a> Search<'a> {
    /// At the skinned places, where there is no fold.
    pub fn new(skin: &'a Skin, skinned: &'a [DVec3]) -> Self {
        Self { skin, skinned, places: skinned.to_vec(), fitted: skin.tree.fit(&skin.triangles, skinned), pairs: Vec::new() }
    }

    /// Folds of the present places, in order.
    pub fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Folds with the points elsewhere: the same as found anew, but only triangles that moved are looked at.
    pub fn move_to(&mut self, places: Vec<DVec3>) -> &[(u32, u32)] {
        let Self { skin, skinned, fitted, pairs, .. } = self;
        let (before, triangles) = (&self.places, &skin.triangles);
        let moved: Vec<bool> = before.iter().zip(&places).map(|(before, now)| before != now).collect();
        if moved.contains(&true) {
            let is_moved = |corners: &[u32; 3]| corners.iter().any(|&i| moved[i as usize]);
            let has_moved: Vec<bool> = triangles.par_iter().with_min_len(CHUNK).map(is_moved).collect();
            pairs.retain(|&(a, b)| !has_moved[a as usize] && !has_moved[b as usize]);
            skin.tree.refit(fitted, triangles, &places, &has_moved);
            let is_new = |a: u32, b: u32| {
                let (a, b) = (triangles[a as usize], triangles[b as usize]);
                cross(&places, a, b) && !cross(skinned, a, b)
            };
            pairs.extend(skin.tree.pairs(fitted, is_new));
            pairs.sort_unstable();
        }
        self.places = places;
        &self.pairs
    }

    /// Corners of a fold.
    pub fn corners(&self, (a, b): (u32, u32)) -> impl Iterator<Item = u32> {
        let triangles = &self.skin.triangles;
        triangles[a as usize].into_iter().chain(triangles[b as usize])
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numeric::csr::Csr;

    const POINTS: usize = 90;

    fn places() -> impl Strategy<Value = Vec<DVec3>> {
        proptest::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array), POINTS)
    }

    /// Triangles that follow one another with corners in common, and all over the place.
    fn skin(rest: &[DVec3]) -> Skin {
        let mut faces = Csr::default();
        for i in 0..POINTS as u32 - 2 {
            faces.push_row([i, i + 1, (i + 2 + i % 7) % POINTS as u32]);
        }
        Skin::new(&faces, rest)
    }

    proptest! {
        #[test]
        fn what_is_kept_up_to_date_is_what_all_pairs_say(first in places(), steps in proptest::collection::vec((places(), 0..POINTS), 1..5)) {
            let skin = skin(&first);
            let mut search = Search::new(&skin, &first);
            let mut now = first.clone();
            for (places, count) in steps {
                now[..count].copy_from_slice(&places[..count]);
                let triangles = &skin.triangles;
                let all = (0..triangles.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
                let mut expected: Vec<(u32, u32)> = all
                    .filter(|&(a, b)| cross(&now, triangles[a], triangles[b]) && !cross(&first, triangles[a], triangles[b]))
                    .map(|(a, b)| (a as u32, b as u32))
                    .collect();
                expected.sort_unstable();
                prop_assert_eq!(search.move_to(now.clone()), &expected[..]);
            }
            prop_assert!(search.move_to(first.clone()).is_empty());
        }
    }
}
