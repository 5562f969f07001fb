//! `turgor.Joint` and `turgor.JointField`.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use turgor::{Flesh, Profile, Profiles, Shares};

use crate::{TurgorError, arrays, refused};

/// How the volume lost at the joint at the head of a bone is given back.
#[pyclass(frozen, module = "turgor")]
pub struct Joint {
    pub inner: turgor::Joint,
}

/// "auto", three numbers, or four, the last of which is the automatic share.
pub fn read_shares(value: Option<&Bound<'_, PyAny>>) -> PyResult<Shares> {
    let Some(value) = value else { return Ok(Shares::AUTOMATIC) };
    if value.extract::<&str>().is_ok_and(|word| word == "auto") {
        return Ok(Shares::AUTOMATIC);
    }
    if let Ok([along, sideways, inside, automatic]) = value.extract::<[f64; 4]>() {
        return Ok(Shares { axes: [along, sideways, inside], automatic });
    }
    value
        .extract::<[f64; 3]>()
        .map(Shares::along)
        .map_err(|_| TurgorError::new_err(format!("shares: need \"auto\", three numbers or four, got {value}")))
}

pub fn bone_index(bone: i64) -> PyResult<usize> {
    usize::try_from(bone).map_err(|_| TurgorError::new_err(format!("bone: need an index of 0 or more, got {bone}")))
}

#[pymethods]
impl Joint {
    #[new]
    #[pyo3(signature = (bone, shares=None, profiles=None, *, folded_profiles=None, folded_loss_relative=0.1, strength=1.0, size=1.0, flex=0.0, flesh=0.0, outside=None, spread_twist=1.0, crease=1.0))]
    #[allow(clippy::too_many_arguments, reason = "keywords of a Python call")]
    fn new(
        bone: i64,
        shares: Option<&Bound<'_, PyAny>>,
        profiles: Option<&Bound<'_, PyAny>>,
        folded_profiles: Option<&Bound<'_, PyAny>>,
        folded_loss_relative: f64,
        strength: f64,
        size: f64,
        flex: f64,
        flesh: f64,
        outside: Option<f64>,
        spread_twist: f64,
        crease: f64,
    ) -> PyResult<Self> {
        let bone = bone_index(bone)?;
        let curves = |what: &str, value: &Bound<'_, PyAny>| {
            let three = value.extract::<[Bound<'_, PyAny>; 3]>();
            let [x, y, z] = three.map_err(|error| TurgorError::new_err(format!("{what}: need three curves, {error}")))?;
            let profile = |samples: &Bound<'_, PyAny>| Profile::new(&arrays::numbers(samples, what)?).map_err(refused);
            Ok::<_, PyErr>([profile(&x)?, profile(&y)?, profile(&z)?])
        };
        let folded = folded_profiles.map(|folded| curves("folded_profiles", folded)).transpose()?;
        let folded = folded.map(|folded| (folded, folded_loss_relative));
        let profiles = match profiles {
            Some(profiles) => Some(Profiles { axes: curves("profiles", profiles)?, folded }),
            None if folded.is_some() => {
                return Err(TurgorError::new_err("folded_profiles: need profiles too, got None: pass three curves"));
            }
            None => None,
        };
        let flesh = Flesh { amount: flesh, outside, spread_twist, crease };
        let joint = turgor::Joint { bone, shares: read_shares(shares)?, profiles, strength, size, flex, flesh };
        Ok(Self { inner: joint.checked().map_err(refused)? })
    }

    #[getter]
    fn bone(&self) -> usize {
        self.inner.bone
    }

    #[getter]
    fn strength(&self) -> f64 {
        self.inner.strength
    }

    #[getter]
    fn size(&self) -> f64 {
        self.inner.size
    }

    #[getter]
    fn flex(&self) -> f64 {
        self.inner.flex
    }

    #[getter]
    fn flesh(&self) -> f64 {
        self.inner.flesh.amount
    }

    #[getter]
    fn outside(&self) -> Option<f64> {
        self.inner.flesh.outside
    }

    #[getter]
    fn spread_twist(&self) -> f64 {
        self.inner.flesh.spread_twist
    }

    #[getter]
    fn crease(&self) -> f64 {
        self.inner.flesh.crease
    }

    #[getter]
    fn shares<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Shares { axes: [along, sideways, inside], automatic } = self.inner.shares;
        if automatic == 1.0 {
            Ok("auto".into_pyobject(py)?.into_any())
        } else if automatic == 0.0 {
            Ok((along, sideways, inside).into_pyobject(py)?.into_any())
        } else {
            Ok((along, sideways, inside, automatic).into_pyobject(py)?.into_any())
        }
    }
}

/// How one joint's field lies in one pose, object space.
#[pyclass(frozen, module = "turgor")]
pub struct JointField {
    pub inner: turgor::JointField,
}

#[pymethods]
impl JointField {
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::from_numbers(py, &self.inner.origin.to_array())
    }

    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::from_vectors(py, &self.inner.axes)
    }

    #[getter]
    fn axes_share(&self) -> f64 {
        self.inner.axes_share
    }

    #[getter]
    fn length(&self) -> f64 {
        self.inner.length
    }

    #[getter]
    fn gamma<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        arrays::from_numbers(py, &self.inner.gamma)
    }
}
