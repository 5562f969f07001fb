//! Twist about the tangent along the rest spine: radians, a smooth function of its parameter, constant beyond its ends.

use glam::DVec3;

use crate::error::{Error, Result, check_numbers};
use crate::spine::interpolation::{End, interpolate};
use crate::spine::quintic::Quintic;

/// Twist of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Twist<'a> {
    /// Angles at the first and the last station: it changes from one to the other without a jump of its rate.
    Ends([f64; 2]),
    /// Angle at each station.
    Stations(&'a [f64]),
}

impl Default for Twist<'_> {
    fn default() -> Self {
        Self::Ends([0.0; 2])
    }
}

/// Twist as a function of the parameter; angles are the first coordinates.
pub(crate) struct TwistCurve {
    parameters: Vec<f64>,
    pieces: Vec<Quintic>,
}

impl TwistCurve {
    /// None where nothing is twisted.
    ///
    /// # Errors
    /// Another number of angles than stations, angles that are not finite.
    pub fn new(stations: &[f64], twist: Twist) -> Result<Option<Self>> {
        let (parameters, angles) = match twist {
            Twist::Ends(angles) => (vec![stations[0], stations[stations.len() - 1]], angles.to_vec()),
            Twist::Stations(angles) => (stations.to_vec(), angles.to_vec()),
        };
        if angles.len() != parameters.len() {
            return Err(Error::Length { what: "twist", found: angles.len(), needed: parameters.len() });
        }
        check_numbers("twist", &angles)?;
        if angles.iter().all(|&angle| angle == 0.0) {
            return Ok(None);
        }
        let points: Vec<DVec3> = angles.iter().map(|&angle| DVec3::new(angle, 0.0, 0.0)).collect();
        // Neither rate nor change of rate at the ends: beyond them the twist is constant.
        let pieces = interpolate(&parameters, &points, [End::Fixed(DVec3::ZERO, DVec3::ZERO); 2]);
        Ok(Some(Self { parameters, pieces }))
    }

    /// Angle at a parameter.
    pub fn at(&self, parameter: f64) -> f64 {
        let last = self.pieces.len() - 1;
        let piece = self.parameters.partition_point(|&t| t <= parameter).clamp(1, last + 1) - 1;
        let (start, end) = (self.parameters[piece], self.parameters[piece + 1]);
        self.pieces[piece].at(((parameter - start) / (end - start)).clamp(0.0, 1.0)).x
    }
}
