//! `turgor.Spine` and the results of asking it.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use turgor::spine::{KnotFlags, Method, Parameters, Resolution};

use crate::threads::detached;
use crate::{TurgorError, arrays, refused};

/// The open curve that drives fleshing.
#[pyclass(frozen, module = "turgor")]
pub struct Spine {
    pub inner: Arc<turgor::spine::Spine>,
}

/// A cyclic curve has no first and no last station.
fn refuse_cyclic(cyclic: bool) -> PyResult<()> {
    if cyclic {
        return Err(TurgorError::new_err("curve is cyclic, need an open one: a spine has a first and a last station; open the curve"));
    }
    Ok(())
}

fn resolution_of(samples: Option<i64>, tolerance: f64) -> PyResult<Resolution> {
    Ok(match samples {
        Some(samples) => Resolution::Samples(arrays::count(samples, "resolution")?),
        None => Resolution::Tolerance(tolerance),
    })
}

fn normal_of(normal: Option<&Bound<'_, PyAny>>) -> PyResult<Option<DVec3>> {
    normal.map(|normal| arrays::vector(normal, "normal")).transpose()
}

impl Spine {
    fn wrap(py: Python<'_>, make: impl FnOnce() -> turgor::Result<turgor::spine::Spine> + Send) -> PyResult<Self> {
        Ok(Self { inner: Arc::new(detached(py, make)?) })
    }
}

#[pymethods]
impl Spine {
    #[new]
    #[pyo3(signature = (points, method="spline", *, parameters=None, normal=None))]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        method: &str,
        parameters: Option<&Bound<'_, PyAny>>,
        normal: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let method = match method {
            "spline" => Method::Spline,
            "polynomial" => Method::Polynomial,
            "b_spline" => Method::BSpline,
            _ => return Err(TurgorError::new_err(format!("method: need \"spline\", \"polynomial\" or \"b_spline\", got {method:?}"))),
        };
        let (points, normal) = (arrays::vectors(points, "points")?, normal_of(normal)?);
        let given;
        let parameters = match parameters {
            None => Parameters::Chord,
            Some(parameters) => match parameters.extract::<&str>() {
                Ok("chord") => Parameters::Chord,
                Ok("centripetal") => Parameters::Centripetal,
                Ok(name) => {
                    let message = format!("parameters: need \"chord\", \"centripetal\" or numbers, got {name:?}");
                    return Err(TurgorError::new_err(message));
                }
                Err(_) => {
                    given = arrays::numbers(parameters, "parameters")?;
                    Parameters::Given(&given)
                }
            },
        };
        Self::wrap(py, || turgor::spine::Spine::new(&points, method, parameters, normal))
    }

    #[staticmethod]
    #[pyo3(signature = (points, left_handles, right_handles, *, cyclic=false, tolerance=1e-3, resolution=None, normal=None))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn from_bezier(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        left_handles: &Bound<'_, PyAny>,
        right_handles: &Bound<'_, PyAny>,
        cyclic: bool,
        tolerance: f64,
        resolution: Option<i64>,
        normal: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        refuse_cyclic(cyclic)?;
        let (points, normal) = (arrays::vectors(points, "points")?, normal_of(normal)?);
        let left = arrays::vectors(left_handles, "left_handles")?;
        let right = arrays::vectors(right_handles, "right_handles")?;
        let resolution = resolution_of(resolution, tolerance)?;
        Self::wrap(py, || turgor::spine::Spine::from_bezier(&points, &left, &right, resolution, normal))
    }

    #[staticmethod]
    #[pyo3(signature = (points, weights=None, *, order=4, use_endpoint=true, use_bezier=false, cyclic=false, tolerance=1e-3, resolution=None, normal=None))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn from_nurbs(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        order: i64,
        use_endpoint: bool,
        use_bezier: bool,
        cyclic: bool,
        tolerance: f64,
        resolution: Option<i64>,
        normal: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        refuse_cyclic(cyclic)?;
        let (points, normal) = (arrays::vectors(points, "points")?, normal_of(normal)?);
        let weights = weights.map_or_else(|| Ok(vec![1.0; points.len()]), |weights| arrays::numbers(weights, "weights"))?;
        let flags = KnotFlags { use_endpoint, use_bezier };
        let (order, resolution) = (arrays::count(order, "order")?, resolution_of(resolution, tolerance)?);
        Self::wrap(py, || turgor::spine::Spine::from_nurbs(&points, &weights, order, flags, resolution, normal))
    }

    #[staticmethod]
    #[pyo3(signature = (points, *, cyclic=false, resolution=1, normal=None))]
    fn from_poly(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        cyclic: bool,
        resolution: i64,
        normal: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        refuse_cyclic(cyclic)?;
        let (points, normal) = (arrays::vectors(points, "points")?, normal_of(normal)?);
        let resolution = resolution_of(Some(resolution), 0.0)?;
        Self::wrap(py, || turgor::spine::Spine::from_poly(&points, resolution, normal))
    }

    #[pyo3(signature = (points, *, normal=None))]
    fn posed(&self, py: Python<'_>, points: &Bound<'_, PyAny>, normal: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let (points, normal) = (arrays::vectors(points, "points")?, normal_of(normal)?);
        Self::wrap(py, || self.inner.posed(&points, normal))
    }

    fn trimmed(&self, py: Python<'_>, start: f64, end: f64) -> PyResult<Self> {
        Self::wrap(py, || self.inner.trimmed(start, end))
    }

    #[getter]
    fn station_count(&self) -> usize {
        self.inner.station_count()
    }

    #[getter]
    fn station_parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, self.inner.stations())
    }

    #[getter]
    fn station_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let lengths: Vec<f64> = self.inner.stations().iter().map(|&t| self.inner.arc_length_at(t)).collect();
        arrays::from_numbers(py, &lengths)
    }

    #[getter]
    fn parameter_range(&self) -> (f64, f64) {
        self.inner.parameter_range().into()
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length()
    }

    #[getter]
    fn resolution(&self) -> usize {
        self.inner.resolution()
    }

    #[getter]
    fn deviation(&self, py: Python<'_>) -> PyResult<f64> {
        detached(py, || Ok(self.inner.deviation()))
    }

    #[getter]
    fn fold_count(&self) -> usize {
        self.inner.fold_count()
    }

    fn evaluate(&self, parameters: &Bound<'_, PyAny>) -> PyResult<SpineFrames> {
        let parameters = finite(parameters, "parameters")?;
        let spine = &self.inner;
        Ok(SpineFrames {
            positions: parameters.iter().map(|&t| spine.position(t)).collect(),
            frames: parameters.iter().map(|&t| spine.frame(t)).collect(),
            curvatures: parameters.iter().map(|&t| spine.curvature(t)).collect(),
            speeds: parameters.iter().map(|&t| spine.speed(t)).collect(),
        })
    }

    fn parameters_at<'py>(&self, py: Python<'py>, arc_lengths: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let lengths = finite(arc_lengths, "arc_lengths")?;
        Ok(arrays::from_numbers(py, &lengths.iter().map(|&s| self.inner.parameter_at(s)).collect::<Vec<f64>>()))
    }

    fn arc_lengths_at<'py>(&self, py: Python<'py>, parameters: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let parameters = finite(parameters, "parameters")?;
        Ok(arrays::from_numbers(py, &parameters.iter().map(|&t| self.inner.arc_length_at(t)).collect::<Vec<f64>>()))
    }

    fn closest(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<ClosestPoints> {
        let points = arrays::vectors(points, "points")?;
        Ok(ClosestPoints { rows: detached(py, || self.inner.closest(&points))? })
    }
}

/// Numbers that are all finite, and not too large.
pub fn finite(value: &Bound<'_, PyAny>, what: &'static str) -> PyResult<Vec<f64>> {
    let numbers = arrays::numbers(value, what)?;
    turgor::check_numbers(what, &numbers).map_err(refused)?;
    Ok(numbers)
}

/// Points of a spine with their frames.
#[pyclass(frozen, module = "turgor")]
pub struct SpineFrames {
    positions: Vec<DVec3>,
    frames: Vec<[DVec3; 3]>,
    curvatures: Vec<DVec3>,
    speeds: Vec<f64>,
}

impl SpineFrames {
    fn axis<'py>(&self, py: Python<'py>, axis: usize) -> Bound<'py, PyArray2<f64>> {
        let axes: Vec<DVec3> = self.frames.iter().map(|frame| frame[axis]).collect();
        arrays::from_vectors(py, &axes)
    }
}

#[pymethods]
impl SpineFrames {
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, &self.positions)
    }

    #[getter]
    fn tangents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.axis(py, 0)
    }

    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.axis(py, 1)
    }

    #[getter]
    fn binormals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.axis(py, 2)
    }

    #[getter]
    fn curvatures<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, &self.curvatures)
    }

    #[getter]
    fn speeds<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.speeds)
    }
}

/// Closest points of a spine.
#[pyclass(frozen, module = "turgor")]
pub struct ClosestPoints {
    pub rows: Vec<turgor::spine::ClosestPoint>,
}

impl ClosestPoints {
    fn column<'py, T: numpy::Element + Copy>(
        &self,
        py: Python<'py>,
        value: impl Fn(&turgor::spine::ClosestPoint) -> T,
    ) -> Bound<'py, PyArray1<T>> {
        arrays::from_numbers(py, &self.rows.iter().map(value).collect::<Vec<T>>())
    }
}

#[pymethods]
impl ClosestPoints {
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |row| row.parameter)
    }

    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let positions: Vec<DVec3> = self.rows.iter().map(|row| row.position).collect();
        arrays::from_vectors(py, &positions)
    }

    #[getter]
    fn distances<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |row| row.distance)
    }

    #[getter]
    fn is_beyond_ends<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        self.column(py, |row| row.is_beyond_ends)
    }

    #[getter]
    fn is_ambiguous<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        self.column(py, |row| row.is_ambiguous)
    }
}
