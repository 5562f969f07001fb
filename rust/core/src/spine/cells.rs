//! A spine as frames need it: short cells, each with its polynomial and its rotation-minimising frame.
//!
//! Frames go from cell to cell by two double reflections. Within a cell the start's frame follows the tangent by the least
//! rotation and turns by a small angle about it: a polynomial of degree five that reaches the next frame, with no rate of
//! turning against a rotation-minimising frame at either end, nor a change of that rate. Frames are twice differentiable by
//! the parameter.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use glam::DVec3;

use crate::numeric::real::{LANES, Real, Vector};
use crate::spine::frames::{TURNED_BACK, carried};
use crate::spine::quintic::Quintic;

/// At least so many cells to a spine: one that turns a full circle turns less than six degrees in each.
const CELLS_MIN: usize = 64;
/// At least so many cells to a piece.
const CELLS_PER_PIECE_MIN: usize = 2;
/// Speeds below this part of the cell's size count as it: where the curve stands still it has no tangent.
const SLOW: f64 = 1e-8;

/// Numbers of one cell: six coefficients; tangent and normal at its start; three of the angle; 1 / width; the square
/// of the least speed.
const NUMBERS: usize = 29;
const FRAME: usize = 18;
const ANGLE: usize = 24;
const RATE: usize = 27;
const SLOWEST: usize = 28;

/// One cell; u runs from 0 to 1 within it. The two outermost are rays: 0 back to −∞, and 0 on to ∞.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell([f64; NUMBERS]);

/// A cell, or one per lane, ready for evaluation.
#[derive(Clone, Copy)]
pub(crate) struct CellAt<R> {
    coefficients: [Vector<R>; 6],
    tangent: Vector<R>,
    normal: Vector<R>,
    angle: [R; 3],
    rate: R,
    slowest: R,
}

/// A place of a spine. The frame of the normal plane is the one of least rotation from the start of the cell; the
/// rotation-minimising one is ahead of it by `angle`.
#[derive(Clone, Copy)]
pub(crate) struct Station<R> {
    pub position: Vector<R>,
    pub tangent: Vector<R>,
    pub normal: Vector<R>,
    pub binormal: Vector<R>,
    /// Curvature vector along normal and binormal.
    pub curvature: [R; 2],
    pub angle: R,
    /// Length per parameter.
    pub speed: R,
}

impl Cell {
    /// `start`: tangent and normal at u = 0; `end`: normal at u = 1, None on a ray, whose frame does not turn.
    fn new(piece: &Quintic, width: f64, start: [DVec3; 2], end: Option<DVec3>) -> Self {
        let mut cell = Self([0.0; NUMBERS]);
        let [tangent, normal] = start;
        for (i, c) in piece.0.iter().chain([&tangent, &normal]).enumerate() {
            c.write_to_slice(&mut cell.0[3 * i..3 * i + 3]);
        }
        let size = piece.0[1..].iter().map(|c| c.length()).fold(0.0, f64::max);
        cell.0[RATE] = 1.0 / width;
        cell.0[SLOWEST] = (SLOW * size).powi(2).max(f64::MIN_POSITIVE);
        if let Some(end) = end {
            cell.set_angle(piece, tangent, end);
        }
        cell
    }

    /// The angle Σ aᵢ u³⁺ⁱ that reaches the frame at the end.
    fn set_angle(&mut self, piece: &Quintic, start: DVec3, end_normal: DVec3) {
        let at_end = CellAt::from(&*self).at(1.0);
        let (normal, binormal): (DVec3, DVec3) = (at_end.normal.into(), at_end.binormal.into());
        let angle = end_normal.dot(binormal).atan2(end_normal.dot(normal));
        let [_, d1, d2, d3] = piece.derivatives(1.0);
        let speed = d1.length().max(self.0[SLOWEST].sqrt());
        let tangent = d1 / speed;
        let acceleration = d2.dot(tangent);
        let tangent1 = (d2 - acceleration * tangent) / speed;
        let tangent2 = (d3 - (d3.dot(tangent) + d2.dot(tangent1)) * tangent - 2.0 * acceleration * tangent1) / speed;
        // Least rotation turns against a rotation-minimising frame by −(a × t)·t′ / (1 + a·t).
        let one = (1.0 + start.dot(tangent)).max(TURNED_BACK);
        let across = start.cross(tangent);
        let rate = across.dot(tangent1) / one;
        let rate1 = across.dot(tangent2) / one - rate * start.dot(tangent1) / one;
        let a = [10.0 * angle - 4.0 * rate + 0.5 * rate1, -15.0 * angle + 7.0 * rate - rate1, 6.0 * angle - 3.0 * rate + 0.5 * rate1];
        // A cell that turns back has a frame, but none to be smooth with.
        if a.iter().all(|a| a.abs() < 1e3) {
            self.0[ANGLE..RATE].copy_from_slice(&a);
        }
    }
}

impl From<&Cell> for CellAt<f64> {
    fn from(cell: &Cell) -> Self {
        Self::load(|i| cell.0[i])
    }
}

impl<R> CellAt<R> {
    #[inline(always)]
    fn load(number: impl Fn(usize) -> R) -> Self {
        let vector = |i: usize| Vector { x: number(i), y: number(i + 1), z: number(i + 2) };
        Self {
            coefficients: [vector(0), vector(3), vector(6), vector(9), vector(12), vector(15)],
            tangent: vector(FRAME),
            normal: vector(FRAME + 3),
            angle: [number(ANGLE), number(ANGLE + 1), number(ANGLE + 2)],
            rate: number(RATE),
            slowest: number(SLOWEST),
        }
    }
}

impl<S: Simd> CellAt<f64x8<S>> {
    /// The same cell in all lanes.
    #[inline(always)]
    pub fn splat(simd: S, cell: &Cell) -> Self {
        Self::load(|i| f64x8::splat(simd, cell.0[i]))
    }

    /// One cell per lane.
    #[inline(always)]
    pub fn gather(simd: S, cells: &[Cell], indices: [u32; LANES]) -> Self {
        let cell = indices.map(|i| &cells[i as usize].0);
        Self::load(|i| f64x8::simd_from(simd, cell.map(|numbers| numbers[i])))
    }
}

impl<R: Real> CellAt<R> {
    /// The station at u.
    #[inline(always)]
    pub fn at(&self, u: R) -> Station<R> {
        let c = &self.coefficients;
        let (mut p, mut first) = (c[5] * u + c[4], c[5]);
        let mut half_second = first;
        first = first * u + p;
        p = p * u + c[3];
        half_second = half_second * u + first;
        first = first * u + p;
        p = p * u + c[2];
        half_second = half_second * u + first;
        first = first * u + p;
        p = p * u + c[1];
        half_second = half_second * u + first;
        first = first * u + p;
        p = p * u + c[0];

        let one = u.constant(1.0);
        let per_speed = one / first.dot(first).max(self.slowest).sqrt();
        let tangent = first * per_speed;
        let along = self.normal.dot(tangent);
        let turn = along / (one + self.tangent.dot(tangent)).max(u.constant(TURNED_BACK));
        let normal = self.normal - (self.tangent + tangent) * turn;
        let binormal = tangent.cross(normal);
        let bend = (per_speed * per_speed) * u.constant(2.0);
        let curvature = [half_second.dot(normal) * bend, half_second.dot(binormal) * bend];
        let [a, b, g] = self.angle;
        let angle = (u * u * u) * ((g * u + b) * u + a);
        Station { position: p, tangent, normal, binormal, curvature, angle, speed: self.rate / per_speed }
    }
}

/// All cells of a spine, in order, between two rays.
#[derive(Debug)]
pub(crate) struct Cells {
    all: Vec<Cell>,
    /// Polynomials of the cells between the rays.
    parts: Vec<Quintic>,
    /// Parameters of the ends of the pieces.
    breaks: Vec<f64>,
    per_piece: usize,
}

impl Cells {
    /// `normal` is the frame's first axis at the start of piece `origin`, a unit vector across the tangent.
    pub fn new(breaks: &[f64], pieces: &[Quintic], origin: usize, normal: DVec3) -> Self {
        let per_piece = per_piece(pieces.len());
        let part = |piece: &Quintic, j: usize| piece.part(j as f64 / per_piece as f64, (j + 1) as f64 / per_piece as f64);
        let parts: Vec<Quintic> = pieces.iter().flat_map(|piece| (0..per_piece).map(move |j| part(piece, j))).collect();
        let count = parts.len();
        let [end, last, ..] = parts[count - 1].derivatives(1.0);
        let mut tangents: Vec<DVec3> = parts.iter().map(|part| part.0[1]).chain([last]).collect();
        let mut known = DVec3::X;
        for tangent in &mut tangents {
            *tangent = tangent.try_normalize().unwrap_or(known);
            known = *tangent;
        }
        let mut normals = vec![normal; count + 1];
        let first = origin * per_piece;
        for i in first..count {
            normals[i + 1] = carried(&parts[i], [tangents[i], tangents[i + 1]], normals[i]);
        }
        for i in (0..first).rev() {
            normals[i] = carried(&parts[i].part(1.0, 0.0), [-tangents[i + 1], -tangents[i]], normals[i + 1]);
        }
        let width = |i: usize| (breaks[i / per_piece + 1] - breaks[i / per_piece]) / per_piece as f64;
        let ray = |i: usize, position: DVec3, width: f64, speed: f64| {
            let tangent = tangents[i];
            let line = Quintic([position, tangent * speed, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO]);
            Cell::new(&line, width, [tangent, normals[i]], None)
        };
        let mut cells = Vec::with_capacity(count + 2);
        cells.push(ray(0, parts[0].0[0], width(0), parts[0].0[1].length()));
        cells.extend((0..count).map(|i| Cell::new(&parts[i], width(i), [tangents[i], normals[i]], Some(normals[i + 1]))));
        cells.push(ray(count, end, width(count - 1), last.length()));
        Self { all: cells, parts, breaks: breaks.to_vec(), per_piece }
    }

    /// With the rays.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    pub fn all(&self) -> &[Cell] {
        &self.all
    }

    /// Polynomials of the cells between the rays; that of cell i is `parts()[i − 1]`.
    pub fn parts(&self) -> &[Quintic] {
        &self.parts
    }

    /// The first cell of a piece.
    pub fn first_of_piece(&self, piece: usize) -> usize {
        piece * self.per_piece
    }

    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Cell of a parameter, and place in it.
    pub fn place(&self, parameter: f64) -> (usize, f64) {
        let last = self.breaks.len() - 1;
        if parameter < self.breaks[0] {
            return (0, (parameter - self.breaks[0]) * self.all[0].0[RATE]);
        }
        if parameter > self.breaks[last] {
            return (self.all.len() - 1, (parameter - self.breaks[last]) * self.all[self.all.len() - 1].0[RATE]);
        }
        let piece = self.breaks.partition_point(|&b| b <= parameter).clamp(1, last) - 1;
        let (start, end) = (self.breaks[piece], self.breaks[piece + 1]);
        let x = (parameter - start) / (end - start) * self.per_piece as f64;
        let j = (x.floor() as usize).min(self.per_piece - 1);
        (1 + piece * self.per_piece + j, x - j as f64)
    }

    /// Parameter of a place.
    pub fn parameter(&self, cell: usize, u: f64) -> f64 {
        let last = self.breaks.len() - 1;
        if cell == 0 {
            return self.breaks[0] + u / self.all[0].0[RATE];
        }
        if cell == self.all.len() - 1 {
            return self.breaks[last] + u / self.all[cell].0[RATE];
        }
        let (piece, j) = ((cell - 1) / self.per_piece, (cell - 1) % self.per_piece);
        let (start, end) = (self.breaks[piece], self.breaks[piece + 1]);
        start + (j as f64 + u) / self.per_piece as f64 * (end - start)
    }

    /// 1 / width of a cell: derivative of u by the parameter.
    pub fn rate(&self, cell: usize) -> f64 {
        self.all[cell].0[RATE]
    }

    /// The station at a place.
    pub fn station(&self, cell: usize, u: f64) -> Station<f64> {
        CellAt::from(&self.all[cell]).at(u)
    }

    /// Cells whose tangent turns by more than a right angle.
    pub fn fold_count(&self) -> usize {
        let turned = |part: &&Quintic| part.0[1].dot(part.derivatives(1.0)[1]) <= 0.0;
        self.parts.iter().filter(turned).count()
    }

    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.all) + size_of_val(&*self.parts) + size_of_val(&*self.breaks)
    }
}

fn per_piece(piece_count: usize) -> usize {
    CELLS_MIN.div_ceil(piece_count).max(CELLS_PER_PIECE_MIN)
}
