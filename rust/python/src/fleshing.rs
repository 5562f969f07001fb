//! `turgor.Fleshing` and `turgor.flesh`.

use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use turgor::spine::{Blend, Flesh, FleshFrame, Kind, Match, Twist};

use crate::spine::{ClosestPoints, Spine, finite};
use crate::threads::detached;
use crate::{TurgorError, arrays, refused};

/// Points bound to a rest spine.
#[pyclass(frozen, module = "turgor")]
pub struct Fleshing {
    inner: turgor::spine::Fleshing,
    /// Buffers of calls that have ended, for the next ones.
    frames: Mutex<Vec<FleshFrame>>,
}

/// Pose of one frame, owned, so that the interpreter can be left.
struct PoseData {
    spine: Arc<turgor::spine::Spine>,
    twist: TwistData,
    slide: f64,
    stretch: bool,
}

enum TwistData {
    Ends([f64; 2]),
    Stations(Vec<f64>),
}

impl PoseData {
    fn read(spine: &Spine, twist: Option<&Bound<'_, PyAny>>, slide: f64, stretch: bool) -> PyResult<Self> {
        let twist = match twist {
            None => TwistData::Ends([0.0; 2]),
            Some(twist) => match arrays::number(twist) {
                Some(angle) => TwistData::Ends([0.0, angle]),
                None => match *arrays::numbers(twist, "twist")? {
                    [start, end] => TwistData::Ends([start, end]),
                    ref angles => TwistData::Stations(angles.to_vec()),
                },
            },
        };
        Ok(Self { spine: Arc::clone(&spine.inner), twist, slide, stretch })
    }

    fn flesh(&self) -> Flesh<'_> {
        let twist = match &self.twist {
            TwistData::Ends(angles) => Twist::Ends(*angles),
            TwistData::Stations(angles) => Twist::Stations(angles),
        };
        Flesh { spine: &self.spine, twist, slide: self.slide, stretch: self.stretch }
    }
}

fn blend_of(kind: Option<&Bound<'_, PyAny>>) -> PyResult<Blend> {
    let Some(kind) = kind else { return Ok(Blend::from(Kind::Radial)) };
    let needed = "kind: need \"radial\", \"normal\", \"binormal\" or three weights";
    match kind.extract::<&str>() {
        Ok("radial") => Ok(Blend::from(Kind::Radial)),
        Ok("normal") => Ok(Blend::from(Kind::Normal)),
        Ok("binormal") => Ok(Blend::from(Kind::Binormal)),
        Ok(name) => Err(TurgorError::new_err(format!("{needed}, got {name:?}"))),
        Err(_) => match *arrays::numbers(kind, "kind")? {
            [radial, normal, binormal] => Blend::new([radial, normal, binormal]).map_err(refused),
            ref weights => Err(TurgorError::new_err(format!("{needed}, got {} numbers", weights.len()))),
        },
    }
}

fn rule_of(name: &str) -> PyResult<Match> {
    match name {
        "stations" => Ok(Match::Stations),
        "relative_length" => Ok(Match::RelativeLength),
        "length" => Ok(Match::Length),
        _ => Err(TurgorError::new_err(format!("match: need \"stations\", \"relative_length\" or \"length\", got {name:?}"))),
    }
}

impl Fleshing {
    fn wrap(inner: turgor::spine::Fleshing) -> Self {
        Self { inner, frames: Mutex::new(Vec::new()) }
    }

    fn bind(
        py: Python<'_>,
        spine: &Spine,
        points: &Bound<'_, PyAny>,
        kind: Option<&Bound<'_, PyAny>>,
        rule: &str,
        influence: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let points = arrays::vectors(points, "points")?;
        let (blend, rule) = (blend_of(kind)?, rule_of(rule)?);
        let influence = influence.map(|influence| arrays::numbers(influence, "influence")).transpose()?;
        let spine = Arc::clone(&spine.inner);
        let inner = detached(py, || turgor::spine::Fleshing::bind(spine, points, blend, rule, influence))?;
        Ok(Self::wrap(inner))
    }

    /// Runs a frame away from the interpreter, in a buffer of an earlier one.
    fn run<T: Send>(&self, py: Python<'_>, frame: impl FnOnce(&mut FleshFrame) -> turgor::Result<T> + Send) -> PyResult<T> {
        detached(py, || {
            let lock = || self.frames.lock().unwrap_or_else(PoisonError::into_inner);
            let spare = lock().pop();
            let mut buffer = spare.unwrap_or_default();
            let result = frame(&mut buffer);
            lock().push(buffer);
            result
        })
    }

    fn write(&self, py: Python<'_>, pose: &PoseData, offsets: &mut [[f32; 3]]) -> PyResult<FleshingReport> {
        let inner = self.run(py, |frame| self.inner.deform(&pose.flesh(), frame, offsets))?;
        Ok(FleshingReport { inner })
    }

    fn positions<'py>(&self, py: Python<'py>, pose: &PoseData) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions = self.run(py, |frame| self.inner.positions(&pose.flesh(), frame))?;
        Ok(arrays::from_vectors(py, &positions))
    }
}

#[pymethods]
impl Fleshing {
    #[new]
    #[pyo3(signature = (rest_spine, points, kind=None, *, r#match="stations", influence=None))]
    fn new(
        py: Python<'_>,
        rest_spine: &Spine,
        points: &Bound<'_, PyAny>,
        kind: Option<&Bound<'_, PyAny>>,
        r#match: &str,
        influence: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::bind(py, rest_spine, points, kind, r#match, influence)
    }

    #[getter]
    fn rest_spine(&self) -> Spine {
        Spine { inner: Arc::clone(self.inner.rest_spine()) }
    }

    #[getter]
    fn point_count(&self) -> usize {
        self.inner.rest().len()
    }

    #[getter]
    fn stations(&self, py: Python<'_>) -> PyResult<ClosestPoints> {
        Ok(ClosestPoints { rows: detached(py, || Ok(self.inner.stations()))? })
    }

    #[getter]
    fn memory_bytes(&self) -> usize {
        self.inner.memory_bytes()
    }

    fn with_kind(&self, py: Python<'_>, kind: &Bound<'_, PyAny>) -> PyResult<Self> {
        let blend = blend_of(Some(kind))?;
        Ok(Self::wrap(detached(py, || Ok(self.inner.with_blend(blend)))?))
    }

    #[pyo3(signature = (posed_spine, *, twist=None, slide=0.0, stretch=true))]
    fn deform<'py>(
        &self,
        py: Python<'py>,
        posed_spine: &Spine,
        twist: Option<&Bound<'py, PyAny>>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.positions(py, &PoseData::read(posed_spine, twist, slide, stretch)?)
    }

    #[pyo3(signature = (offsets, posed_spine, *, twist=None, slide=0.0, stretch=true))]
    fn deform_into(
        &self,
        py: Python<'_>,
        offsets: &Bound<'_, PyAny>,
        posed_spine: &Spine,
        twist: Option<&Bound<'_, PyAny>>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<FleshingReport> {
        let pose = PoseData::read(posed_spine, twist, slide, stretch)?;
        arrays::with_rows_mut(offsets, "offsets", |rows| self.write(py, &pose, rows))
    }

    #[pyo3(signature = (offsets_address, point_count, posed_spine, *, twist=None, slide=0.0, stretch=true))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn deform_into_address(
        &self,
        py: Python<'_>,
        offsets_address: i64,
        point_count: i64,
        posed_spine: &Spine,
        twist: Option<&Bound<'_, PyAny>>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<FleshingReport> {
        let pose = PoseData::read(posed_spine, twist, slide, stretch)?;
        let (offsets_address, point_count) =
            (arrays::count(offsets_address, "offsets_address")?, arrays::count(point_count, "point_count")?);
        if point_count == 0 {
            return self.write(py, &pose, &mut []);
        }
        if offsets_address == 0 || !offsets_address.is_multiple_of(align_of::<f32>()) {
            return Err(TurgorError::new_err(format!(
                "offsets_address: need the address of {point_count} rows of float32, got {offsets_address:#x}"
            )));
        }
        // SAFETY: the caller promises `point_count` rows of three floats, alive and unaliased during the call.
        let rows = unsafe { std::slice::from_raw_parts_mut(offsets_address as *mut [f32; 3], point_count) };
        self.write(py, &pose, rows)
    }

    #[pyo3(signature = (points, posed_spine, *, twist=None, slide=0.0, stretch=true))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        posed_spine: &Spine,
        twist: Option<&Bound<'py, PyAny>>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = arrays::vectors(points, "points")?;
        let pose = PoseData::read(posed_spine, twist, slide, stretch)?;
        let origins = detached(py, || self.inner.inverse(&pose.flesh(), &points))?;
        Ok(arrays::from_vectors(py, &origins))
    }

    #[pyo3(signature = (posed_spine, *, twist=None, slide=0.0, stretch=true))]
    fn validity(
        &self,
        py: Python<'_>,
        posed_spine: &Spine,
        twist: Option<&Bound<'_, PyAny>>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<Validity> {
        let pose = PoseData::read(posed_spine, twist, slide, stretch)?;
        Ok(Validity { inner: self.run(py, |frame| self.inner.validity(&pose.flesh(), frame))? })
    }

    #[pyo3(signature = (posed_spine, parameters, *, slide=0.0, stretch=true))]
    fn valid_radii<'py>(
        &self,
        py: Python<'py>,
        posed_spine: &Spine,
        parameters: &Bound<'py, PyAny>,
        slide: f64,
        stretch: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let parameters = finite(parameters, "parameters")?;
        let pose = PoseData::read(posed_spine, None, slide, stretch)?;
        let radii = detached(py, || self.inner.valid_radii(&pose.flesh(), &parameters))?;
        Ok(arrays::from_numbers(py, &radii))
    }
}

/// Bind and deform in one call.
#[pyfunction]
#[pyo3(signature = (points, rest_spine, posed_spine, kind=None, *, r#match="stations", influence=None, twist=None, slide=0.0, stretch=true))]
#[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
pub fn flesh<'py>(
    py: Python<'py>,
    points: &Bound<'py, PyAny>,
    rest_spine: &Spine,
    posed_spine: &Spine,
    kind: Option<&Bound<'py, PyAny>>,
    r#match: &str,
    influence: Option<&Bound<'py, PyAny>>,
    twist: Option<&Bound<'py, PyAny>>,
    slide: f64,
    stretch: bool,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let pose = PoseData::read(posed_spine, twist, slide, stretch)?;
    Fleshing::bind(py, rest_spine, points, kind, r#match, influence)?.positions(py, &pose)
}

/// Figures of one frame of fleshing.
#[pyclass(frozen, module = "turgor")]
pub struct FleshingReport {
    inner: turgor::spine::FleshingReport,
}

#[pymethods]
impl FleshingReport {
    #[getter]
    fn clamped_count(&self) -> usize {
        self.inner.clamped_count
    }

    #[getter]
    fn max_offset(&self) -> f64 {
        self.inner.max_offset
    }
}

/// Where a frame of fleshing is exact.
#[pyclass(frozen, module = "turgor")]
pub struct Validity {
    inner: turgor::spine::Validity,
}

#[pymethods]
impl Validity {
    #[getter]
    fn is_clamped<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.is_clamped)
    }

    #[getter]
    fn is_overlapping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.is_overlapping)
    }

    #[getter]
    fn is_ambiguous<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.is_ambiguous)
    }

    #[getter]
    fn is_beyond_ends<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        arrays::from_numbers(py, &self.inner.is_beyond_ends)
    }

    #[getter]
    fn usage<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.usage)
    }

    #[getter]
    fn valid_count(&self) -> usize {
        self.inner.valid_count()
    }
}
