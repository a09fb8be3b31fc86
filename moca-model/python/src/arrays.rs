//! Arrays of numbers from and to Python.

use ahqp_core::CoefficientMatrix;
use nalgebra::{Isometry3, Rotation3, Unit, UnitQuaternion, Vector3};
use numpy::ndarray::{ArrayView2, Axis, Ix1, Ix2};
use numpy::{Element, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray};
use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyException, PyMemoryError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::failure::{Failure, Result};

/// Largest number of entries. More would not fit into memory several times.
const MOST_ENTRIES: usize = 1 << 26;

/// Vector of the caller. Arrays of doubles are not copied, whatever their strides.
pub(crate) type Vector<'py> = PyReadonlyArray<'py, f64, Ix1>;

/// Reads a vector, of any length.
pub(crate) fn vector<'py>(name: &str, value: &Bound<'py, PyAny>) -> Result<Vector<'py>> {
    read(name, value, "one dimension")
}

/// Reads a vector of the given length.
pub(crate) fn vector_of<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    length: usize,
) -> Result<Vector<'py>> {
    let vector = vector(name, value)?;
    if vector.len() != length {
        let found = vector.len();
        return Err(Failure::value(format!("{name} has {found} entries; it must have {length}")));
    }
    Ok(vector)
}

/// Reads as many numbers as the result has.
pub(crate) fn numbers<const N: usize>(name: &str, value: &Bound<'_, PyAny>) -> Result<[f64; N]> {
    let vector = vector_of(name, value, N)?;
    let mut numbers = [0.0; N];
    numbers.iter_mut().zip(vector.as_array()).for_each(|(to, from)| *to = *from);
    Ok(numbers)
}

/// Calls `run` with the numbers of a vector. They are copied only if they are not contiguous.
pub(crate) fn with_slice<T>(vector: &Vector<'_>, run: impl FnOnce(&[f64]) -> T) -> T {
    match vector.as_slice() {
        Ok(slice) => run(slice),
        Err(_) => run(&vector.as_array().to_vec()),
    }
}

/// Matrix of the caller. Arrays of doubles are not copied, whatever their strides.
pub(crate) struct Matrix<'py>(PyReadonlyArray<'py, f64, Ix2>);

impl<'py> Matrix<'py> {
    pub(crate) fn read(name: &str, value: &Bound<'py, PyAny>) -> Result<Self> {
        read(name, value, "two dimensions").map(Self)
    }

    /// Returns a view of the numbers.
    pub(crate) fn view(&self) -> MatrixView<'_> {
        MatrixView(self.0.as_array())
    }

    /// Returns a copy as a matrix of nalgebra.
    pub(crate) fn to_nalgebra(&self) -> nalgebra::DMatrix<f64> {
        let view = self.0.as_array();
        nalgebra::DMatrix::from_fn(view.nrows(), view.ncols(), |row, column| view[[row, column]])
    }

    /// Returns some of the rows.
    pub(crate) fn rows(&self, rows: std::ops::Range<usize>) -> MatrixView<'_> {
        MatrixView(self.0.as_array().slice_axis_move(Axis(0), rows.into()))
    }

    /// Returns the pose of a homogeneous matrix, 4 × 4.
    pub(crate) fn to_pose(&self, name: &str) -> Result<Isometry3<f64>> {
        let matrix = self.to_nalgebra();
        let matrix = fixed::<4>(name, &matrix)?;
        if matrix.row(3) != nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0) {
            return Err(Failure::value(format!("the last row of {name} must be 0, 0, 0, 1")));
        }
        let rotation = rotation(name, &matrix.fixed_view::<3, 3>(0, 0).into_owned())?;
        Ok(Isometry3::from_parts(matrix.fixed_view::<3, 1>(0, 3).into_owned().into(), rotation))
    }
}

/// Reads a pose, a homogeneous matrix.
pub(crate) fn pose(name: &str, value: &Bound<'_, PyAny>) -> Result<Isometry3<f64>> {
    Matrix::read(name, value)?.to_pose(name)
}

/// Reads an orientation: a rotation matrix, or a unit quaternion x, y, z, w.
pub(crate) fn orientation(name: &str, value: &Bound<'_, PyAny>) -> Result<UnitQuaternion<f64>> {
    let array = doubles(name, value)?;
    if let Ok(vector) = vector(name, &array) {
        if vector.len() != 4 {
            let text = "must be a rotation matrix, (3, 3), or a quaternion x, y, z, w, (4,)";
            return Err(Failure::value(format!("{name} {text}")));
        }
        let [x, y, z, w] = numbers(name, &array)?;
        let quaternion = nalgebra::Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if (norm - 1.0).abs() < 1e-6 {
            return Ok(UnitQuaternion::from_quaternion(quaternion));
        }
        return Err(Failure::value(format!("{name} has norm {norm}; it must be 1")));
    }
    let matrix = Matrix::read(name, &array)?.to_nalgebra();
    rotation(name, &fixed::<3>(name, &matrix)?)
}

fn rotation(name: &str, matrix: &nalgebra::Matrix3<f64>) -> Result<UnitQuaternion<f64>> {
    let error = (matrix * matrix.transpose() - nalgebra::Matrix3::identity()).amax();
    if !(error < 1e-6 && matrix.determinant() > 0.0) {
        return Err(Failure::value(format!(
            "the rotation of {name} is none: R Rᵀ must be the identity and det R = 1, to 1e-6"
        )));
    }
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*matrix)))
}

fn fixed<const N: usize>(
    name: &str,
    matrix: &nalgebra::DMatrix<f64>,
) -> Result<nalgebra::SMatrix<f64, N, N>> {
    if matrix.shape() != (N, N) {
        let (rows, columns) = matrix.shape();
        let text = format!("{name} has shape ({rows}, {columns}); it must be ({N}, {N})");
        return Err(Failure::value(text));
    }
    Ok(matrix.fixed_view::<N, N>(0, 0).into_owned())
}

/// View of a matrix's rows, as the solver reads them.
pub(crate) struct MatrixView<'a>(ArrayView2<'a, f64>);

impl CoefficientMatrix for MatrixView<'_> {
    fn nrows(&self) -> usize {
        self.0.nrows()
    }

    fn ncols(&self) -> usize {
        self.0.ncols()
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self.0[[row, column]]
    }
}

/// Converts a pose to an array, 4 × 4.
pub(crate) fn pose_to_array<'py>(
    py: Python<'py>,
    pose: &Isometry3<f64>,
) -> Bound<'py, PyArray2<f64>> {
    to_array(py, &pose.to_homogeneous())
}

/// Converts a matrix of nalgebra to an array.
pub(crate) fn to_array<
    'py,
    R: nalgebra::Dim,
    C: nalgebra::Dim,
    S: nalgebra::RawStorage<f64, R, C>,
>(
    py: Python<'py>,
    matrix: &nalgebra::Matrix<f64, R, C, S>,
) -> Bound<'py, PyArray2<f64>> {
    let array = numpy::ndarray::Array2::from_shape_fn(matrix.shape(), |index| matrix[index]);
    PyArray2::from_owned_array(py, array)
}

/// Converts numbers to an array.
pub(crate) fn to_vector<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, numbers)
}

/// Returns the array itself if it is an array of doubles, else one that is made of it.
fn read<'py, D: numpy::ndarray::Dimension>(
    name: &str,
    value: &Bound<'py, PyAny>,
    dimensions: &str,
) -> Result<PyReadonlyArray<'py, f64, D>> {
    if let Ok(array) = value.cast::<PyArray<f64, D>>()
        && is_aligned(array)
    {
        return borrow(name, array);
    }
    let array = doubles(name, value)?;
    let Ok(array) = array.cast::<PyArray<f64, D>>() else {
        let shape = array.getattr("shape")?;
        return Err(Failure::value(format!("{name} has shape {shape}; it must have {dimensions}")));
    };
    borrow(name, array)
}

fn borrow<'py, D: numpy::ndarray::Dimension>(
    name: &str,
    array: &Bound<'py, PyArray<f64, D>>,
) -> Result<PyReadonlyArray<'py, f64, D>> {
    let entries = array.len();
    if entries > MOST_ENTRIES {
        return Err(Failure::value(format!(
            "{name} has {entries} entries; it must have {MOST_ENTRIES} at most"
        )));
    }
    let busy = |_| Failure::runtime(format!("another thread is writing {name}"));
    array.try_readonly().map_err(busy)
}

/// Returns true if the array is aligned. Views of packed records may not be.
fn is_aligned<T: Element, D: numpy::ndarray::Dimension>(array: &Bound<'_, PyArray<T, D>>) -> bool {
    let size = align_of::<T>();
    let whole = |stride: &isize| stride.unsigned_abs().is_multiple_of(size);
    (array.data() as usize).is_multiple_of(size) && array.strides().iter().all(whole)
}

/// Converts anything that numpy takes for integers or real numbers to an array of doubles.
fn doubles<'py>(name: &str, value: &Bound<'py, PyAny>) -> Result<Bound<'py, PyAny>> {
    Ok(real(name, value)?.call_method1("astype", ("float64",))?)
}

/// Returns anything that numpy takes for integers or real numbers as an array of its own type.
pub(crate) fn real<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
) -> Result<Bound<'py, PyUntypedArray>> {
    static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = value.py();
    let asarray = ASARRAY.import(py, "numpy", "asarray")?;
    let array = asarray.call1((value,)).map_err(|error| {
        // An interrupt, or a lack of memory, within the object's own `__array__` is no wrong argument.
        let is_of_argument =
            error.is_instance_of::<PyException>(py) && !error.is_instance_of::<PyMemoryError>(py);
        if is_of_argument {
            Failure::type_of_argument(format!("{name} must be an array of numbers: {error}"))
        } else {
            error.into()
        }
    })?;
    let array = array.cast_into::<PyUntypedArray>().map_err(PyErr::from)?;
    let entries = array.shape().iter().try_fold(1_usize, |all, &size| all.checked_mul(size));
    if entries.is_none_or(|entries| entries > MOST_ENTRIES) {
        let text = format!("{name} is too large; it must have {MOST_ENTRIES} entries at most");
        return Err(Failure::value(text));
    }
    let kind: String = array.dtype().getattr("kind")?.extract()?;
    // An empty list is an array of doubles.
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        let kind = array.dtype();
        return Err(Failure::type_of_argument(format!(
            "{name} must be an array of real numbers; it is one of {kind}"
        )));
    }
    Ok(array)
}

/// Reads a vector that is not zero.
pub(crate) fn direction(name: &str, value: &Bound<'_, PyAny>) -> Result<Unit<Vector3<f64>>> {
    let vector = Vector3::from(numbers::<3>(name, value)?);
    let unit = Unit::try_new(vector, 1e-9).filter(|unit| unit.iter().all(|x| x.is_finite()));
    unit.ok_or_else(|| Failure::value(format!("{name} must be finite and not zero")))
}
