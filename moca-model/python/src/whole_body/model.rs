//! Robots.

use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use whole_body::robot::JointLimits;

use super::description::Keywords;
use crate::arrays::{to_vector, vector_of, with_slice};
use crate::failure::Result;

/// Reads one of a joint's limits.
type Part = fn(&JointLimits) -> f64;

/// A robot: a tree of joints, the bodies that they move, and frames on these. It does not change.
///
/// `Model(urdf, *, base="fixed", root=None, tips=(), joints=(), locked=None, origins=None, limits=None,
/// frames=None, gravity=None, time_to_full_speed=None, ignore_unusable_limits=False)`
///
/// Parameters
/// ----------
/// urdf : str
///     The text of a URDF; `Model.from_file` reads one.
/// base : str
///     "fixed"; "planar", with the joints base_x, base_y [m] and base_yaw [rad]; or "floating", with
///     position and quaternion x, y, z, w at the beginning of q, and twists in the world's axes.
/// root : str
///     The link to start from; None for the URDF's.
/// tips : sequence of str
///     The links that should move; empty for all.
/// joints : sequence of str
///     The joints of q, to fix their order; empty for all joints that move.
/// locked : dict of str to float
///     Joints that stay at a position [rad or m].
/// origins : dict of str to array, (4, 4)
///     Joint origins that replace the URDF's.
/// limits : dict of str to dict
///     Limits of a joint: position (a pair), velocity, acceleration, jerk, effort.
/// frames : dict of str to (str, array)
///     Additional frames: the link or frame that carries it, and its pose there, (4, 4).
/// gravity : array, (3,)
///     Acceleration of free fall in the world [m/s²]; None for (0, 0, -9.81).
/// time_to_full_speed : float
///     Time in which joints without an acceleration limit reach their speed limit [s]; inf for no limit.
/// ignore_unusable_limits : bool
///     Whether unusable limits are ignored with a warning instead of raising an error.
///
/// SI units, radians. Twists are linear then angular.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct Model(pub(crate) whole_body::Model);

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (urdf, *, base="fixed", root=None, tips=Vec::new(), joints=Vec::new(), locked=None, origins=None, limits=None, frames=None, gravity=None, time_to_full_speed=None, ignore_unusable_limits=false))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn new(
        urdf: &str,
        base: &str,
        root: Option<String>,
        tips: Vec<String>,
        joints: Vec<String>,
        locked: Option<Bound<'_, PyDict>>,
        origins: Option<Bound<'_, PyDict>>,
        limits: Option<Bound<'_, PyDict>>,
        frames: Option<Bound<'_, PyDict>>,
        gravity: Option<Bound<'_, PyAny>>,
        time_to_full_speed: Option<f64>,
        ignore_unusable_limits: bool,
    ) -> Result<Self> {
        let keywords = Keywords {
            base: base.to_owned(),
            root,
            tips,
            joints,
            locked,
            origins,
            limits,
            frames,
            gravity,
            time_to_full_speed,
            ignore_unusable_limits,
        };
        Ok(Self(whole_body::Model::from_urdf(urdf, &keywords.description()?)?))
    }

    /// Reads a robot from a file.
    #[staticmethod]
    #[pyo3(signature = (path, *, base="fixed", root=None, tips=Vec::new(), joints=Vec::new(), locked=None, origins=None, limits=None, frames=None, gravity=None, time_to_full_speed=None, ignore_unusable_limits=false))]
    #[allow(clippy::too_many_arguments)] // keywords of Python
    fn from_file(
        path: std::path::PathBuf,
        base: &str,
        root: Option<String>,
        tips: Vec<String>,
        joints: Vec<String>,
        locked: Option<Bound<'_, PyDict>>,
        origins: Option<Bound<'_, PyDict>>,
        limits: Option<Bound<'_, PyDict>>,
        frames: Option<Bound<'_, PyDict>>,
        gravity: Option<Bound<'_, PyAny>>,
        time_to_full_speed: Option<f64>,
        ignore_unusable_limits: bool,
    ) -> Result<Self> {
        let keywords = Keywords {
            base: base.to_owned(),
            root,
            tips,
            joints,
            locked,
            origins,
            limits,
            frames,
            gravity,
            time_to_full_speed,
            ignore_unusable_limits,
        };
        Ok(Self(whole_body::Model::from_urdf_file(path, &keywords.description()?)?))
    }

    /// The robot's name in the URDF.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// The size of q.
    #[getter]
    fn position_count(&self) -> usize {
        self.0.position_count()
    }

    /// The size of q̇, the number of degrees of freedom.
    #[getter]
    fn velocity_count(&self) -> usize {
        self.0.velocity_count()
    }

    /// The names of the joints that move by themselves, in the order of q; the base's come first.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.0.joints().iter().map(|joint| joint.name.as_str()).collect()
    }

    /// The names of all frames: the links from the root down, then the added ones.
    #[getter]
    fn frames(&self) -> Vec<&str> {
        self.0.frames().map(|(_, name)| name).collect()
    }

    /// Limits of the entries of q̇: a dict of arrays, shape (velocity_count,), named lower, upper [rad or
    /// m], velocity, acceleration, jerk and effort; infinite where there is none.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let limits = PyDict::new(py);
        let parts: [(&str, Part); 6] = [
            ("lower", |limits| limits.lower),
            ("upper", |limits| limits.upper),
            ("velocity", |limits| limits.velocity),
            ("acceleration", |limits| limits.acceleration),
            ("jerk", |limits| limits.jerk),
            ("effort", |limits| limits.effort),
        ];
        for (name, part) in parts {
            let values: Vec<f64> = self.0.limits().iter().map(part).collect();
            limits.set_item(name, to_vector(py, &values))?;
        }
        Ok(limits)
    }

    /// Mass of all links that move [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass()
    }

    /// Oddities of the URDF that do not make it unusable.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    /// q with all joints at zero, shape (position_count,).
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_vector(py, &self.0.neutral())
    }

    /// q, shape (position_count,), moved by the displacement v·Δt, shape (velocity_count,).
    fn integrate<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        displacement: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray1<f64>>> {
        let mut q = vector_of("q", q, self.0.position_count())?.as_array().to_vec();
        let displacement = vector_of("displacement", displacement, self.0.velocity_count())?;
        with_slice(&displacement, |displacement| self.0.integrate(&mut q, displacement))?;
        Ok(to_vector(py, &q))
    }

    /// The displacement, shape (velocity_count,), from q = start to q = end.
    fn difference<'py>(
        &self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        end: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray1<f64>>> {
        let start = vector_of("start", start, self.0.position_count())?;
        let end = vector_of("end", end, start.len())?;
        let mut out = vec![0.0; self.0.velocity_count()];
        with_slice(&start, |start| {
            with_slice(&end, |end| self.0.difference(start, end, &mut out))
        })?;
        Ok(to_vector(py, &out))
    }

    fn __repr__(&self) -> String {
        let (name, joints) = (self.0.name(), self.0.velocity_count());
        format!("<ahqp.whole_body.Model: {name}, {joints} degrees of freedom>")
    }
}
