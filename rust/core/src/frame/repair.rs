//! Folds that the correction makes: points back off, and the volume comes back elsewhere [MATH §8].

use glam::DVec3;

use super::Problem;
use super::buffers::{Correction, Posed, Solution};
use super::solved::Solved;
use crate::binding::Binding;
use crate::folds::{BackOff, Search, Skin};
use crate::numeric::lanes;
use crate::report::Report;
use crate::surface::patches::NO_SLOT;

/// Relative error that the volume may have after repair; more is a failure of the repair.
const EXACT: f64 = 1e-12;
/// Times that the volume is given back with more and more points held.
const ROUNDS: usize = 16;
/// From this round on neighbours of folds are held too.
const PATIENCE: usize = 4;

impl Solution {
    /// Repairs the folds of a solved frame, if asked to.
    ///
    /// Ends with no fold left, or with the fewest of all that keep the volume exactly; without folds no bit changes.
    pub(super) fn repair_folds(&mut self, problem: Problem, posed: &Posed, is_asked: bool, report: &mut Report) {
        (report.folds_found, report.folds_left) = (0, 0);
        report.blocked_vertices.clear();
        if !is_asked {
            return;
        }
        let binding = problem.bound.binding;
        let skin = binding.skin();
        let skinned =
            Solved { binding, posed, flesh: problem.flesh, skinned: problem.skinned, correction: &self.correction }.skinned_points();
        let moves = self.correction.moves_of_points(binding);
        let mut search = Search::new(skin, &skinned);
        let found = search.move_to(places(&skinned, &moves)).len();
        (report.folds_found, report.folds_left) = (found, found);
        if found > 0 {
            self.back_off(problem, (skin, &skinned, &moves), &mut search, report);
        }
    }

    fn back_off(
        &mut self,
        problem: Problem,
        (skin, skinned, moves): (&Skin, &[DVec3], &[DVec3]),
        search: &mut Search,
        report: &mut Report,
    ) {
        let binding = problem.bound.binding;
        let first = self.correction.outcome();
        let mut back_off = BackOff::new(skin, skinned, moves);
        let shares = back_off.shares(search);
        let mut best = (report.folds_found, None);
        for round in 0..ROUNDS {
            let is_exact = self.restore(problem, &first, (&shares, &back_off.freedom()), EXACT);
            let folds = search.move_to(places(skinned, &self.correction.moves_of_points(binding))).len();
            if is_exact && folds < best.0 {
                best = (folds, Some((self.correction.outcome(), back_off.is_blocked().to_vec())));
            }
            // With fewer points free the volume would not be exact again.
            if !is_exact || folds == 0 || !back_off.block(search, round >= PATIENCE) {
                break;
            }
        }
        report.folds_left = best.0;
        let Some((outcome, is_blocked)) = best.1 else {
            self.correction.go_back_to(&first);
            return;
        };
        self.correction.go_back_to(&outcome);
        let has_slot = |&slot: &u32| slot != NO_SLOT;
        let mut of_slot = vec![false; binding.patches.slot_count()];
        for (slot, is_blocked) in binding.patches.slot_of_point.iter().zip(is_blocked).filter(|(slot, _)| has_slot(slot)) {
            of_slot[*slot as usize] = is_blocked;
        }
        let vertices = (0..).zip(&binding.slot_of_vertex).filter(|(_, slot)| has_slot(slot) && of_slot[**slot as usize]);
        report.blocked_vertices.extend(vertices.map(|(vertex, _)| vertex));
    }
}

impl Solved<'_> {
    /// Skinned place of each point, about the palette's origin.
    fn skinned_points(&self) -> Vec<DVec3> {
        let origin = self.posed.motions.palette.origin;
        self.binding.points(|slot| self.skinned.places.at(slot), |vertex| lanes::from(self.skinned_vertex(vertex) - origin))
    }
}

impl Correction {
    /// Displacement of each point as solved.
    fn moves_of_points(&self, binding: &Binding) -> Vec<DVec3> {
        binding.points(|slot| lanes::from(self.displacement(slot as u32, binding.patches.component_of_slot(slot))), |_| lanes::ZERO)
    }
}

fn places(skinned: &[DVec3], moves: &[DVec3]) -> Vec<DVec3> {
    skinned.iter().zip(moves).map(|(p, u)| *p + *u).collect()
}
