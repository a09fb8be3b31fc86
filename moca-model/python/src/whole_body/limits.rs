//! Hard limits in addition to those of the joints.

use hrsw_safety::LinkCapsule;
use nalgebra::Vector3;
use pyo3::prelude::*;
use whole_body::ik::IkBuilder;

use super::bodies::{BodyOfLink, body};
use super::targets::Target;
use super::tasks::VelocityTask;
use crate::arrays::{numbers, vector, with_slice};
use crate::failure::Result;

/// Speed limits of the wheels of a planar base: `mecanum`, `omni` or `differential`.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct WheelLimit(whole_body::limits::WheelLimit);

#[pymethods]
impl WheelLimit {
    /// Four mecanum wheels whose rims reach `speed` [m/s]: |v_x| + |v_y| + lever |ω| ≤ speed. `lever` [m] is half the
    /// sum of wheelbase and track.
    #[staticmethod]
    fn mecanum(speed: f64, lever: f64) -> Self {
        Self(whole_body::limits::WheelLimit::mecanum(speed, lever))
    }

    /// Omni wheels whose rims reach `speed` [m/s], `radius` [m] from the centre in the directions
    /// `angles`, (wheels,) [rad from the base's x axis].
    #[staticmethod]
    fn omni(speed: f64, radius: f64, angles: &Bound<'_, PyAny>) -> Result<Self> {
        let angles = vector("angles", angles)?;
        Ok(Self(with_slice(&angles, |angles| {
            whole_body::limits::WheelLimit::omni(speed, radius, angles)
        })))
    }

    /// Two driven wheels, `track` [m] apart, whose rims reach `speed` [m/s]; no motion sideways.
    #[staticmethod]
    fn differential(speed: f64, track: f64) -> Self {
        Self(whole_body::limits::WheelLimit::differential(speed, track))
    }
}

/// The largest velocity of a frame along and about the world's axes, or its own with `local=True`.
///
/// `FrameVelocityLimit(frame, linear, angular, *, local=False)`: (3,) [m/s] and (3,) [rad/s]; inf for
/// none.
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct FrameVelocityLimit {
    frame: String,
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    local: bool,
}

#[pymethods]
impl FrameVelocityLimit {
    #[new]
    #[pyo3(signature = (frame, linear, angular, *, local=false))]
    fn new(
        frame: String,
        linear: &Bound<'_, PyAny>,
        angular: &Bound<'_, PyAny>,
        local: bool,
    ) -> Result<Self> {
        let linear = numbers::<3>("linear", linear)?.into();
        Ok(Self { frame, linear, angular: numbers::<3>("angular", angular)?.into(), local })
    }
}

/// Keeps pairs of links apart: bodies on them stay at least `distance` from each other, whatever the tasks ask for.
///
/// `SelfCollisionLimit(bodies, pairs, *, distance=0.03)`
///
/// Parameters
/// ----------
/// bodies : sequence of (str, array_like, array_like, float)
///     Capsules: link, start and end in the link's frame, (3,) [m], radius [m]. A sphere has equal ends. A link may have
///     several.
/// pairs : sequence of (str, str)
///     Links that stay apart, each capsule on one from each on the other.
/// distance : float
///     Least distance of the surfaces [m].
///
/// All joints can brake before it within their limits of acceleration and jerk.
///
/// >>> from ahqp.whole_body import SelfCollisionLimit
/// >>> hand, base = ("panda_hand", [0, 0, 0], [0, 0, 0.1], 0.08), ("panda_link0", [-0.1, 0, 0.1], [0, 0, 0.1], 0.1)
/// >>> limit = SelfCollisionLimit([hand, base], [("panda_hand", "panda_link0")])
#[pyclass(frozen, module = "ahqp.whole_body")]
pub(crate) struct SelfCollisionLimit {
    bodies: Vec<LinkCapsule>,
    pairs: Vec<(String, String)>,
    distance: f64,
}

#[pymethods]
impl SelfCollisionLimit {
    #[new]
    #[pyo3(signature = (bodies, pairs, *, distance=0.03))]
    fn new(
        bodies: Vec<BodyOfLink<'_>>,
        pairs: Vec<(String, String)>,
        distance: f64,
    ) -> Result<Self> {
        let bodies = bodies.into_iter().map(body).collect::<Result<Vec<_>>>()?;
        Ok(Self { bodies, pairs, distance })
    }
}

/// A limit of any kind.
#[derive(FromPyObject)]
pub(crate) enum Limit<'py> {
    Wheels(PyRef<'py, WheelLimit>),
    Frame(PyRef<'py, FrameVelocityLimit>),
    OwnBodies(PyRef<'py, SelfCollisionLimit>),
    Rows(PyRef<'py, VelocityTask>),
}

impl Limit<'_> {
    /// Adds the limit. The result sets its rows, if it has rows of the caller.
    pub(crate) fn add(
        &self,
        model: &whole_body::Model,
        name: &str,
        builder: &mut IkBuilder,
    ) -> Result<Option<Target>> {
        match self {
            Self::Rows(task) => {
                let id = builder.limit(name, task.rows()?);
                return Ok(Some(Target::Velocity(id, task.count())));
            }
            Self::Wheels(limit) => {
                builder.limit(name, limit.0.clone());
            }
            Self::Frame(limit) => {
                let frame = model.frame_id(&limit.frame)?;
                let task =
                    whole_body::limits::FrameVelocityLimit::new(frame, limit.linear, limit.angular);
                builder.limit(name, if limit.local { task.in_local_axes() } else { task });
            }
            Self::OwnBodies(limit) => {
                let SelfCollisionLimit { bodies, pairs, distance } = &**limit;
                let limit = moca_model::SelfCollisionLimit::new(model, bodies, pairs, *distance)?;
                builder.limit(name, limit);
            }
        }
        Ok(None)
    }
}
