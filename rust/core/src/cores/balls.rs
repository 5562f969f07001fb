//! The largest ball that touches the skin at a point from below, its radius evened out along the skin.

use glam::DVec3;
use rayon::prelude::*;

use crate::cores::largest_ball::SkinTree;
use crate::cores::rest::RestSurface;
use crate::surface::volume::{face_area_vector, face_volume};

/// Radii are evened out over this part of the ball.
const EVENED_OVER: f64 = 0.5;
/// Relative accuracy of evened radii, and steps towards it at most: on a very dense skin they are evened over less.
const EVEN_ERROR: f64 = 1e-9;
const EVEN_STEPS: usize = 64;
/// Cells that a mesh may have, about: where balls are thinner than so many of them can see, they count as thicker.
const CELLS_MAX: f64 = 16_384.0;
/// A ball is at least this part of the mean one.
const THINNEST: f64 = 1e-3;

/// Per slot.
pub(crate) struct Balls {
    pub radii: Vec<f64>,
    pub centres: Vec<DVec3>,
}

impl Balls {
    pub fn new(rest: &RestSurface) -> Self {
        let inwards = inwards(rest);
        let mut largest = vec![0.0; rest.places.len()];
        for slots in rest.slots_of_component.rows() {
            let places = || slots.iter().map(|&slot| rest.places[slot as usize]);
            let (low, high) = places().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            let start = 0.5 * low.distance(high);
            let tree = SkinTree::new(&rest.places, &inwards, slots.to_vec());
            let radius = |&slot: &u32| {
                let inwards = inwards[slot as usize];
                if inwards == DVec3::ZERO { 0.0 } else { tree.radius(rest.places[slot as usize], inwards, start) }
            };
            let radii: Vec<f64> = slots.par_iter().with_min_len(256).map(radius).collect();
            for (&slot, radius) in slots.iter().zip(radii) {
                largest[slot as usize] = radius;
            }
        }
        let mut radii = evened(rest, &largest);
        let thinnest = thinnest(rest, &radii);
        for radius in &mut radii {
            *radius = radius.max(thinnest);
        }
        let centres = (0..rest.places.len()).map(|slot| rest.places[slot] + inwards[slot] * radii[slot]).collect();
        Self { radii, centres }
    }
}

/// Unit vectors into the flesh, whichever way faces are turned; 0 where there is no direction.
fn inwards(rest: &RestSurface) -> Vec<DVec3> {
    let mut outwards = vec![DVec3::ZERO; rest.places.len()];
    let mut component_of_slot = vec![0usize; rest.places.len()];
    let mut centres = Vec::new();
    for (component, slots) in rest.slots_of_component.rows().enumerate() {
        for &slot in slots {
            component_of_slot[slot as usize] = component;
        }
        centres.push(slots.iter().map(|&slot| rest.places[slot as usize]).sum::<DVec3>() / slots.len().max(1) as f64);
    }
    let mut volumes = vec![0.0; centres.len()];
    for face in rest.faces.rows() {
        let component = component_of_slot[face[0] as usize];
        volumes[component] += face_volume(&rest.places, face, centres[component]);
        let area = face_area_vector(&rest.places, face);
        for &slot in face {
            outwards[slot as usize] += area;
        }
    }
    let sign = |slot: usize| if volumes[component_of_slot[slot]] < 0.0 { 1.0 } else { -1.0 };
    outwards.iter().enumerate().map(|(slot, n)| n.try_normalize().map_or(DVec3::ZERO, |n| n * sign(slot))).collect()
}

/// Solves (A + L) r = A r₀ by conjugate gradients: heat that flows along the skin, as far as the thinner ball of both ends of an
/// edge says, or the edge. Each edge conducts by its dual length over its own.
fn evened(rest: &RestSurface, largest: &[f64]) -> Vec<f64> {
    let mut edges = Vec::new();
    for face in rest.faces.rows() {
        let mean = face.iter().map(|&slot| rest.places[slot as usize]).sum::<DVec3>() / face.len() as f64;
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            let (from, along) = (rest.places[a as usize], rest.places[b as usize] - rest.places[a as usize]);
            let conductance = along.cross(mean - from).length() / along.length_squared();
            // On a coarse skin at least to the next points: a cell sees more than one.
            let reach = (EVENED_OVER * largest[a as usize].min(largest[b as usize])).max(along.length());
            let flow = conductance * reach * reach;
            if flow.is_finite() && flow > 0.0 {
                edges.push((a as usize, b as usize, flow));
            }
        }
    }
    let count = rest.places.len();
    let apply = |x: &[f64]| {
        let mut result: Vec<f64> = x.iter().zip(&rest.areas).map(|(x, area)| x * area).collect();
        for &(a, b, flow) in &edges {
            let passed = flow * (x[a] - x[b]);
            result[a] += passed;
            result[b] -= passed;
        }
        result
    };
    let mut diagonal = rest.areas.clone();
    for &(a, b, flow) in &edges {
        diagonal[a] += flow;
        diagonal[b] += flow;
    }
    let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect() };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut x = largest.to_vec();
    let wanted: Vec<f64> = largest.iter().zip(&rest.areas).map(|(radius, area)| radius * area).collect();
    let mut left: Vec<f64> = wanted.iter().zip(apply(&x)).map(|(wanted, found)| wanted - found).collect();
    let enough = EVEN_ERROR * EVEN_ERROR * dot(&scaled(&wanted), &wanted);
    let mut step_along = scaled(&left);
    let mut square = dot(&step_along, &left);
    for _ in 0..EVEN_STEPS {
        if square.is_nan() || square <= enough {
            break;
        }
        let image = apply(&step_along);
        let length = square / dot(&step_along, &image);
        for i in 0..count {
            x[i] += length * step_along[i];
            left[i] -= length * image[i];
        }
        let improved = scaled(&left);
        let next = dot(&improved, &left);
        for i in 0..count {
            step_along[i] = improved[i] + next / square * step_along[i];
        }
        square = next;
    }
    // Heat stays between its extremes; what is no number is as it was.
    let highest = largest.iter().copied().fold(0.0, f64::max);
    x.iter().zip(largest).map(|(x, &before)| if (0.0..=highest).contains(x) { *x } else { before }).collect()
}

/// The least radius with which about `CELLS_MAX` cells cover the mesh, wherever its core is a sheet.
fn thinnest(rest: &RestSurface, radii: &[f64]) -> f64 {
    let whole: f64 = rest.areas.iter().sum();
    if whole <= 0.0 {
        return 0.0;
    }
    let mean = rest.areas.iter().zip(radii).map(|(area, radius)| area * radius).sum::<f64>() / whole;
    let cells = |least: f64| -> f64 {
        let of = |(area, radius): (&f64, &f64)| if *area > 0.0 { 4.0 * area / radius.max(least).powi(2) } else { 0.0 };
        rest.areas.iter().zip(radii).map(of).sum()
    };
    let least = THINNEST * mean;
    if cells(least) <= CELLS_MAX {
        return least;
    }
    let (mut low, mut high) = (least, (4.0 * whole / CELLS_MAX).sqrt().max(least));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if cells(middle) > CELLS_MAX { low = middle } else { high = middle }
    }
    high
}
