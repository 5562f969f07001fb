//! Folds that the correction makes: points back off, and the volume comes back elsewhere [MATH §8].

use glam::DVec3;

use super::Workspace;
use crate::binding::Binding;
use crate::fields::joint::Joint;
use crate::fields::supports::Supports;
use crate::folds::{BackOff, Search, Skin};
use crate::numeric::lanes;
use crate::surface::patches::NO_SLOT;

/// Relative error that the volume may have after repair; more is a failure of the repair.
const EXACT: f64 = 1e-12;
/// Times that the volume is given back with more and more points held.
const ROUNDS: usize = 16;
/// From this round on neighbours of folds are held too.
const PATIENCE: usize = 4;

impl Workspace {
    /// Repairs the folds of a solved frame, if asked to.
    ///
    /// Ends with no fold left, or with the fewest of all that keep the volume exactly; without folds no bit changes.
    pub(crate) fn repair_folds(&mut self, binding: &Binding, supports: &Supports, settings: &[Joint], is_asked: bool) {
        let report = &mut self.report;
        (report.folds_found, report.folds_left) = (0, 0);
        report.blocked_vertices.clear();
        if !is_asked {
            return;
        }
        let skin = binding.skin();
        let skinned = self.skinned_points(binding);
        let moves = self.moves_of_points(binding);
        let mut search = Search::new(skin, &skinned);
        let found = search.move_to(places(&skinned, &moves)).len();
        (self.report.folds_found, self.report.folds_left) = (found, found);
        if found > 0 {
            self.back_off(binding, supports, settings, (skin, &skinned, &moves), &mut search);
        }
    }

    fn back_off(
        &mut self,
        binding: &Binding,
        supports: &Supports,
        settings: &[Joint],
        (skin, skinned, moves): (&Skin, &[DVec3], &[DVec3]),
        search: &mut Search,
    ) {
        let first = self.outcome();
        let artists_mask = self.mask.clone();
        let mut back_off = BackOff::new(skin, skinned, moves);
        let shares = back_off.shares(search);
        let mut best = (self.report.folds_found, None);
        for round in 0..ROUNDS {
            self.mask.clone_from(&artists_mask);
            let is_exact = self.restore(binding, supports, settings, &first, (&shares, &back_off.freedom()), EXACT);
            let folds = search.move_to(places(skinned, &self.moves_of_points(binding))).len();
            if is_exact && folds < best.0 {
                best = (folds, Some((self.outcome(), self.mask.clone(), back_off.is_blocked().to_vec())));
            }
            // With fewer points free the volume would not be exact again.
            if !is_exact || folds == 0 || !back_off.block(search, round >= PATIENCE) {
                break;
            }
        }
        self.report.folds_left = best.0;
        let Some((outcome, mask, is_blocked)) = best.1 else {
            self.go_back_to(&first);
            self.mask = artists_mask;
            return;
        };
        self.go_back_to(&outcome);
        self.mask = mask;
        let has_slot = |&slot: &u32| slot != NO_SLOT;
        let mut of_slot = vec![false; binding.patches.slot_count()];
        for (slot, is_blocked) in binding.patches.slot_of_point.iter().zip(is_blocked).filter(|(slot, _)| has_slot(slot)) {
            of_slot[*slot as usize] = is_blocked;
        }
        let vertices = (0..).zip(&binding.slot_of_vertex).filter(|(_, slot)| has_slot(slot) && of_slot[**slot as usize]);
        self.report.blocked_vertices.extend(vertices.map(|(vertex, _)| vertex));
    }

    /// Skinned place of each point, about the palette's origin.
    fn skinned_points(&self, binding: &Binding) -> Vec<DVec3> {
        let origin = self.motions.palette.origin;
        binding.points(|slot| self.skinned.at(slot), |vertex| lanes::from(self.skinned_vertex(binding, vertex) - origin))
    }

    /// Displacement of each point as solved.
    fn moves_of_points(&self, binding: &Binding) -> Vec<DVec3> {
        binding.points(|slot| lanes::from(self.displacement(slot as u32, binding.patches.component_of_slot(slot))), |_| lanes::ZERO)
    }
}

fn places(skinned: &[DVec3], moves: &[DVec3]) -> Vec<DVec3> {
    skinned.iter().zip(moves).map(|(p, u)| *p + *u).collect()
}
