//! The bare correction of a mesh with any weights, without bones [RHC09 §4, MATH §2].

use glam::DVec3;

use crate::error::{Error, LARGEST, Result};
use crate::fields::joint::Shares;
use crate::surface::measures;
use crate::surface::mesh::Mesh;

/// An axis whose capacity is below this part of the whole one cannot take its share.
const HOLD_MIN: f64 = 1e-12;

/// Volume that `correct` is to reach.
#[derive(Debug, Clone, Copy)]
pub enum Target<'a> {
    /// Sum over sound components; each takes the part of the change that it can take with the least displacement.
    Total(f64),
    /// One per component; those of unsound ones are not looked at.
    PerComponent(&'a [f64]),
}

impl Mesh {
    /// Positions with the target volume: each vertex moves by γ times its gradient, along `axes` (any three directions,
    /// by `shares`, each step on the mesh so far) or freely. Exact in one step per axis, whatever γ.
    ///
    /// # Errors
    /// Wrong lengths, values that are not finite or negative γ, a component whose volume γ cannot change.
    pub fn correct(
        &self,
        positions: &[DVec3],
        target: Target,
        gamma: &[f64],
        axes: Option<[DVec3; 3]>,
        shares: Shares,
    ) -> Result<Vec<DVec3>> {
        if gamma.len() != positions.len() {
            return Err(Error::Length { what: "gamma", found: gamma.len(), needed: positions.len() });
        }
        if let Some(&found) = gamma.iter().find(|g| !(**g >= 0.0 && **g <= LARGEST)) {
            return Err(Error::Value { what: "gamma", found, needed: "numbers from 0 to 1e15" });
        }
        let start = self.centred_points(positions)?;
        let gamma: Vec<f64> = self
            .topology()
            .vertices_of_point
            .rows()
            .map(|coincident| coincident.iter().map(|&v| gamma[v as usize]).sum::<f64>() / coincident.len() as f64)
            .collect();
        let mut solve = Solve::new(self, start.clone(), gamma);
        let changes = solve.changes(target)?;
        match axes {
            None => solve.free_step(&changes)?,
            Some(axes) => {
                let units = axes.map(DVec3::normalize_or_zero);
                solve.axis_steps(&changes, units, shares)?;
            }
        }
        let moved = self.topology().point_of_vertex.iter().map(|&p| solve.points[p as usize] - start[p as usize]);
        let corrected: Vec<DVec3> = positions.iter().zip(moved).map(|(&p, u)| p + u).collect();
        if corrected.iter().all(|p| p.is_finite()) { Ok(corrected) } else { Err(Error::Beyond { what: "target_volume" }) }
    }
}

/// One run of `Mesh::correct`.
struct Solve<'a> {
    mesh: &'a Mesh,
    points: Vec<DVec3>,
    gamma: Vec<f64>,
    gradient: Vec<DVec3>,
    volumes: Vec<f64>,
}

impl<'a> Solve<'a> {
    fn new(mesh: &'a Mesh, points: Vec<DVec3>, gamma: Vec<f64>) -> Self {
        let mut solve = Self { gradient: Vec::new(), volumes: Vec::new(), mesh, points, gamma };
        solve.update();
        solve
    }

    fn update(&mut self) {
        self.volumes = measures::volumes(self.mesh.topology(), &self.points);
        self.gradient = measures::gradient(self.mesh.topology(), &self.points);
    }

    /// Σ γ f(g) over each component.
    fn capacities(&self, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut capacities = vec![0.0; self.volumes.len()];
        for (point, gamma) in self.gamma.iter().enumerate() {
            if let Some(capacity) = capacities.get_mut(self.mesh.topology().component_of_point[point] as usize) {
                *capacity += gamma * f(self.gradient[point]);
            }
        }
        capacities
    }

    /// Volume each component is to gain.
    fn changes(&self, target: Target) -> Result<Vec<f64>> {
        let sound = |component: usize| self.mesh.topology().components[component].is_sound();
        match target {
            Target::PerComponent(targets) => {
                if targets.len() != self.volumes.len() {
                    return Err(Error::Length { what: "target_volume", found: targets.len(), needed: self.volumes.len() });
                }
                if let Some(row) = targets.iter().position(|t| !t.is_finite()) {
                    return Err(Error::NotFinite { what: "target_volume", row });
                }
                Ok((0..targets.len()).map(|c| if sound(c) { targets[c] - self.volumes[c] } else { 0.0 }).collect())
            }
            Target::Total(total) => {
                if !total.is_finite() {
                    return Err(Error::NotFinite { what: "target_volume", row: 0 });
                }
                let change = total - self.volumes.iter().sum::<f64>();
                let capacities = self.capacities(DVec3::length_squared);
                let sum: f64 = capacities.iter().sum();
                if sum > 0.0 {
                    return Ok(capacities.iter().map(|h| change * h / sum).collect());
                }
                if change == 0.0 { Ok(vec![0.0; capacities.len()]) } else { Err(Error::NothingToMove { component: 0, volume: change }) }
            }
        }
    }

    /// Along γ∇V, by the exact cubic.
    fn free_step(&mut self, changes: &[f64]) -> Result<()> {
        let capacities = self.capacities(DVec3::length_squared);
        let field: Vec<DVec3> = (0..self.points.len())
            .map(|point| {
                let component = self.mesh.topology().component_of_point[point] as usize;
                let scale = capacities.get(component).filter(|h| **h > 0.0).map_or(0.0, |h| self.gamma[point] / h);
                self.gradient[point] * scale
            })
            .collect();
        let cubics = measures::cubics(self.mesh.topology(), &self.points, &field);
        let mut steps = vec![None; changes.len()];
        for (component, (cubic, &change)) in cubics.iter().zip(changes).enumerate() {
            if change == 0.0 {
                continue;
            }
            let target = self.volumes[component] + change;
            steps[component] = cubic.root_nearest_zero(target);
            if steps[component].is_none() {
                return Err(Error::NothingToMove { component, volume: change });
            }
        }
        for (point, p) in self.points.iter_mut().enumerate() {
            let component = self.mesh.topology().component_of_point[point] as usize;
            if let Some(&Some(step)) = steps.get(component) {
                *p += field[point] * step;
            }
        }
        Ok(())
    }

    /// Along three directions, one after the other; V is linear in each.
    fn axis_steps(&mut self, changes: &[f64], axes: [DVec3; 3], shares: Shares) -> Result<()> {
        let along = axes.map(|e| self.capacities(|g| g.dot(e).powi(2)));
        let free = self.capacities(DVec3::length_squared);
        let parts: Vec<[f64; 3]> = (0..changes.len())
            .map(|c| {
                let able: [bool; 3] = std::array::from_fn(|i| along[i][c] > HOLD_MIN * free[c]);
                let total: f64 = (0..3).filter(|&i| able[i]).map(|i| along[i][c]).sum();
                let wanted: [f64; 3] =
                    std::array::from_fn(|i| if able[i] { shares.axes[i] + shares.automatic * (along[i][c] / total) } else { 0.0 });
                let sum: f64 = wanted.iter().sum();
                let able_count = able.iter().filter(|a| **a).count() as f64;
                std::array::from_fn(|i| match sum > 0.0 {
                    true => wanted[i] / sum,
                    // What was to take all cannot: the axes that can share alike.
                    false if able[i] => 1.0 / able_count,
                    false => 0.0,
                })
            })
            .collect();
        for (component, (&change, part)) in changes.iter().zip(&parts).enumerate() {
            if change != 0.0 && part.iter().all(|p| *p == 0.0) {
                return Err(Error::NothingToMove { component, volume: change });
            }
        }
        let targets: Vec<f64> = self.volumes.iter().zip(changes).map(|(v, c)| v + c).collect();
        for (axis, e) in axes.into_iter().enumerate() {
            if parts.iter().all(|p| p[axis] == 0.0) {
                continue;
            }
            self.update();
            let capacities = self.capacities(|g| g.dot(e).powi(2));
            let is_last = |c: usize| parts[c][axis + 1..].iter().all(|p| *p == 0.0);
            for point in 0..self.points.len() {
                let component = self.mesh.topology().component_of_point[point] as usize;
                let Some(&capacity) = capacities.get(component).filter(|h| **h > 0.0) else { continue };
                let part = parts[component][axis];
                if part == 0.0 {
                    continue;
                }
                // The last axis takes what is left, so that rounding of the others does not stay.
                let change = if is_last(component) { targets[component] - self.volumes[component] } else { changes[component] * part };
                let slope = self.gradient[point].dot(e);
                self.points[point] += e * (change * self.gamma[point] * slope / capacity);
            }
        }
        Ok(())
    }
}
