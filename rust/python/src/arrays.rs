//! numpy arrays in and out, with messages of our own: the default ones name neither shape nor dtype.

use glam::{DMat4, DVec3};
use numpy::ndarray::{Array1, Array2};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::TurgorError;

/// Any array-like as an aligned, C-contiguous array of `dtype`; arrays that already are one are not copied.
fn contiguous<'py>(value: &Bound<'py, PyAny>, what: &str, dtype: &str) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    let refused = |error: PyErr| TurgorError::new_err(format!("{what}: need an array of {dtype}, {error}"));
    let given = numpy.call_method1("asarray", (value,)).map_err(refused)?;
    // Numpy would drop what is imaginary.
    if kind_of(&given)? == 'c' {
        return Err(TurgorError::new_err(format!("{what}: need an array of {dtype}, got {}", describe(&given))));
    }
    let options = PyDict::new(value.py());
    options.set_item("dtype", dtype)?;
    let array = numpy.call_method("ascontiguousarray", (given,), Some(&options)).map_err(refused)?;
    if is_aligned(&array)? { Ok(array) } else { array.call_method0("copy") }
}

/// The letter of an array's kind of numbers.
fn kind_of(array: &Bound<'_, PyAny>) -> PyResult<char> {
    array.getattr("dtype")?.getattr("kind")?.extract()
}

fn is_aligned(array: &Bound<'_, PyAny>) -> PyResult<bool> {
    array.getattr("flags")?.getattr("aligned")?.extract()
}

/// The message of an output array that is none; `is_fit`: the type and shape are right.
fn check_output(array: &Bound<'_, PyAny>, needed: &str, is_fit: bool) -> PyResult<()> {
    let is_writable = || array.getattr("flags").and_then(|flags| flags.getattr("carray")?.extract()).unwrap_or(false);
    if is_fit && is_writable() {
        return Ok(());
    }
    let flags = if is_fit { ", which is not writable, aligned and C-contiguous" } else { "" };
    Err(TurgorError::new_err(format!("{needed}, got {}{flags}", describe(array))))
}

fn describe(array: &Bound<'_, PyAny>) -> String {
    let part = |name: &str| array.getattr(name).map_or_else(|_| String::from("?"), |v| v.to_string());
    format!("{} {}", part("dtype"), part("shape"))
}

/// A flat copy of an array whose shape `accepts` allows, and that shape; `needed` says which those are.
fn read_shaped<T: numpy::Element + Copy>(
    value: &Bound<'_, PyAny>,
    what: &str,
    dtype: &str,
    needed: &str,
    accepts: impl Fn(&[usize]) -> bool,
) -> PyResult<(Vec<T>, Vec<usize>)> {
    copy_shaped(value, what, dtype, needed, accepts, <[T]>::to_vec)
}

/// What `copy` makes of the values of an array whose shape `accepts` allows, and that shape.
fn copy_shaped<T: numpy::Element + Copy, U>(
    value: &Bound<'_, PyAny>,
    what: &str,
    dtype: &str,
    needed: &str,
    accepts: impl Fn(&[usize]) -> bool,
    copy_of: impl Fn(&[T]) -> U,
) -> PyResult<(U, Vec<usize>)> {
    let lies_well = |array: &&Bound<'_, PyArrayDyn<T>>| array.is_c_contiguous() && array.data().is_aligned();
    let copy;
    // Without a call of numpy where there is nothing to convert: frames come with such arrays.
    let array = if let Some(array) = value.cast::<PyArrayDyn<T>>().ok().filter(lies_well) {
        array
    } else {
        copy = contiguous(value, what, dtype)?;
        copy.cast::<PyArrayDyn<T>>().map_err(|_| TurgorError::new_err(format!("{what}: need {dtype}, got {}", describe(value))))?
    };
    if !accepts(array.shape()) {
        return Err(TurgorError::new_err(format!("{what}: need {dtype} {needed}, got {}", describe(value))));
    }
    let values = copy_of(array.try_readonly().map_err(|e| PyValueError::new_err(format!("{what}: {e}")))?.as_slice()?);
    Ok((values, array.shape().to_vec()))
}

/// As `read_shaped`, the values alone; an empty list serves as an empty array of any shape.
fn read<T: numpy::Element + Copy>(
    value: &Bound<'_, PyAny>,
    what: &str,
    dtype: &str,
    needed: &str,
    accepts: impl Fn(&[usize]) -> bool,
) -> PyResult<Vec<T>> {
    Ok(read_shaped(value, what, dtype, needed, |shape| accepts(shape) || shape == [0])?.0)
}

pub fn vectors(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<DVec3>> {
    let flat: Vec<f64> = read(value, what, "float64", "(N, 3)", |shape| shape.len() == 2 && shape[1] == 3)?;
    Ok(flat.chunks_exact(3).map(DVec3::from_slice).collect())
}

pub fn float_rows(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[f32; 3]>> {
    let accepts = |shape: &[usize]| matches!(*shape, [0] | [_, 3]);
    Ok(copy_shaped(value, what, "float32", "(N, 3)", accepts, |flat: &[f32]| flat.as_chunks::<3>().0.to_vec())?.0)
}

/// Rows of three numbers of each of so many frames, or the same for all; whether they are of each.
pub fn float_rows_of_frames(value: &Bound<'_, PyAny>, what: &str, frames: usize) -> PyResult<(Vec<[f32; 3]>, bool)> {
    let accepts = |shape: &[usize]| matches!(*shape, [0] | [_, 3]) || matches!(*shape, [count, _, 3] if count == frames);
    let needed = format!("(N, 3) or ({frames}, N, 3)");
    let (rows, shape) = copy_shaped(value, what, "float32", &needed, accepts, |flat: &[f32]| flat.as_chunks::<3>().0.to_vec())?;
    Ok((rows, shape.len() == 3))
}

pub fn vector_rows(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Vec<DVec3>>> {
    let array = contiguous(value, what, "float64")?;
    array.try_iter()?.map(|row| vectors(&row?, what)).collect()
}

pub fn matrices(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<DMat4>> {
    let flat: Vec<f64> = read(value, what, "float64", "(B, 4, 4)", |shape| shape.len() == 3 && shape[1..] == [4, 4])?;
    Ok(from_rows(&flat))
}

/// Matrices from their rows, one after the other.
pub fn from_rows(flat: &[f64]) -> Vec<DMat4> {
    flat.chunks_exact(16).map(|rows| DMat4::from_cols_slice(rows).transpose()).collect()
}

pub fn matrix(value: Option<&Bound<'_, PyAny>>, what: &str) -> PyResult<DMat4> {
    let Some(value) = value else { return Ok(DMat4::IDENTITY) };
    let flat: Vec<f64> = read(value, what, "float64", "(4, 4)", |shape| shape == [4, 4])?;
    if flat.is_empty() {
        return Err(TurgorError::new_err(format!("{what}: need float64 (4, 4), got {}", describe(value))));
    }
    Ok(DMat4::from_cols_slice(&flat).transpose())
}

pub fn numbers(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    read(value, what, "float64", "(N,)", |shape| shape.len() == 1)
}

pub fn floats(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f32>> {
    read(value, what, "float32", "(N,)", |shape| shape.len() == 1)
}

pub fn numbers_and_shape(
    value: &Bound<'_, PyAny>,
    what: &str,
    needed: &str,
    accepts: impl Fn(&[usize]) -> bool,
) -> PyResult<(Vec<f64>, Vec<usize>)> {
    read_shaped(value, what, "float64", needed, accepts)
}

pub fn vector(value: &Bound<'_, PyAny>, what: &str) -> PyResult<DVec3> {
    let flat: Vec<f64> = read(value, what, "float64", "(3,)", |shape| shape == [3])?;
    match *flat {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err(TurgorError::new_err(format!("{what}: need float64 (3,), got {}", describe(value)))),
    }
}

/// Hands the rows of a float32 array to `write`, in place.
pub fn with_rows_mut<T>(array: &Bound<'_, PyAny>, what: &str, write: impl FnOnce(&mut [[f32; 3]]) -> PyResult<T>) -> PyResult<T> {
    let needed = format!("{what}: need a writable C-contiguous float32 array (N, 3)");
    let typed = array.cast::<PyArray2<f32>>().ok();
    check_output(array, &needed, typed.is_some_and(|array| array.shape()[1] == 3))?;
    let array = array.cast::<PyArray2<f32>>().map_err(PyErr::from)?;
    let mut view = array.try_readwrite().map_err(|error| TurgorError::new_err(format!("{needed}: {error}")))?;
    let (rows, _) = view.as_slice_mut()?.as_chunks_mut::<3>();
    write(rows)
}

/// Hands the numbers of an int32 array of this shape to `write`, in place.
pub fn with_numbers_mut<T>(
    array: &Bound<'_, PyAny>,
    what: &str,
    shape: (usize, usize),
    write: impl FnOnce(&mut [i32]) -> PyResult<T>,
) -> PyResult<T> {
    let needed = format!("{what}: need a writable C-contiguous int32 array {shape:?}");
    let typed = array.cast::<PyArray2<i32>>().ok();
    check_output(array, &needed, typed.is_some_and(|array| array.shape() == [shape.0, shape.1]))?;
    let array = array.cast::<PyArray2<i32>>().map_err(PyErr::from)?;
    let mut view = array.try_readwrite().map_err(|error| TurgorError::new_err(format!("{needed}: {error}")))?;
    write(view.as_slice_mut()?)
}

pub fn indices(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<i32>> {
    let is_vector = |shape: &[usize]| shape.len() == 1;
    if value.cast::<PyArray1<i32>>().is_ok() {
        return read(value, what, "int32", "(N,)", is_vector);
    }
    // Numpy would cut off fractions and the upper half of what is too large.
    let numbers = read::<f64>(value, what, "float64", "(N,)", is_vector)?;
    let whole = |(row, &number): (usize, &f64)| {
        let index = number as i32;
        if f64::from(index) == number {
            return Ok(index);
        }
        Err(TurgorError::new_err(format!("{what}: entry {row} is {number}, need a whole number that fits int32")))
    };
    numbers.iter().enumerate().map(whole).collect()
}

/// One number, not an array of one.
pub fn number(value: &Bound<'_, PyAny>) -> Option<f64> {
    if value.len().is_ok() { None } else { value.extract().ok() }
}

/// A number of things.
pub fn count(value: i64, what: &str) -> PyResult<usize> {
    usize::try_from(value).map_err(|_| TurgorError::new_err(format!("{what}: need a whole number of 0 or more, got {value}")))
}

pub fn flags(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<bool>> {
    read(value, what, "bool", "(N,)", |shape| shape.len() == 1)
}

pub fn from_vectors<'py>(py: Python<'py>, vectors: &[DVec3]) -> Bound<'py, PyArray2<f64>> {
    let flat: Vec<f64> = vectors.iter().flat_map(DVec3::to_array).collect();
    shaped(py, flat)
}

pub fn from_floats<'py>(py: Python<'py>, rows: &[[f32; 3]]) -> Bound<'py, PyArray2<f32>> {
    shaped(py, rows.as_flattened().to_vec())
}

fn shaped<T: numpy::Element>(py: Python<'_>, flat: Vec<T>) -> Bound<'_, PyArray2<T>> {
    let rows = flat.len() / 3;
    // The length is a multiple of 3 by construction.
    Array2::from_shape_vec((rows, 3), flat).unwrap_or_else(|_| unreachable!("rows of three")).into_pyarray(py)
}

/// One row per item of `rows`, each of `width` numbers.
pub fn from_table<'py, T: numpy::Element + Copy>(py: Python<'py>, rows: &[&[T]], width: usize) -> Bound<'py, PyArray2<T>> {
    // Every row is of that width by construction.
    Array2::from_shape_vec((rows.len(), width), rows.concat()).unwrap_or_else(|_| unreachable!("rows of one width")).into_pyarray(py)
}

/// (F, N, 3), to be written by `with_frames_mut`: that of the caller, or a new one. shape: F, N.
pub fn frames<'py>(
    py: Python<'py>,
    own: Option<&Bound<'py, PyAny>>,
    what: &str,
    shape: (usize, usize),
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let Some(own) = own else { return Ok(PyArray3::zeros(py, [shape.0, shape.1, 3], false)) };
    let needed = format!("{what}: need a writable C-contiguous float32 array {:?}", (shape.0, shape.1, 3));
    let typed = own.cast::<PyArray3<f32>>().ok();
    check_output(own, &needed, typed.is_some_and(|array| array.shape() == [shape.0, shape.1, 3]))?;
    Ok(own.cast::<PyArray3<f32>>().map_err(PyErr::from)?.clone())
}

/// Hands the rows of `frames` to `write`, in place.
pub fn with_frames_mut<T>(
    frames: &Bound<'_, PyArray3<f32>>,
    what: &str,
    write: impl FnOnce(&mut [[f32; 3]]) -> PyResult<T>,
) -> PyResult<T> {
    let mut view = frames.try_readwrite().map_err(|error| TurgorError::new_err(format!("{what}: need a writable array: {error}")))?;
    let (rows, _) = view.as_slice_mut()?.as_chunks_mut::<3>();
    write(rows)
}

pub fn from_numbers<'py, T: numpy::Element + Copy>(py: Python<'py>, numbers: &[T]) -> Bound<'py, PyArray1<T>> {
    Array1::from(numbers.to_vec()).into_pyarray(py)
}
