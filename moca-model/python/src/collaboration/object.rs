//! The object that the robot holds.

use moca_model::{BoxSide, WorkFace};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{numbers, pose, pose_to_array};
use crate::ergo::keywords::word;
use crate::failure::Result;

/// The sides of a box by their names.
const SIDES: [(&str, BoxSide); 6] = [
    ("front", BoxSide::Front),
    ("back", BoxSide::Back),
    ("left", BoxSide::Left),
    ("right", BoxSide::Right),
    ("top", BoxSide::Top),
    ("bottom", BoxSide::Bottom),
];

/// The object that the robot holds for the person to work on: a box of uniform density.
///
/// `GraspedObject(*, size=None, mass=None, pose=None, faces=None)`
///
/// Parameters
/// ----------
/// size : array_like, (3,), optional
///     Edges [m]; 0.12, 0.2, 0.15 if not given.
/// mass : float, optional
///     [kg]; 1 if not given.
/// pose : array_like, (4, 4), optional
///     Of its middle in the frame of the robot's tool; 0.05 m below the fingertips if not given.
/// faces : dict of str to str, optional
///     The surface of each side to work on: sides "front" (+x), "back", "left" (+y), "right", "top" (+z), "bottom",
///     surfaces "drilled" and "smooth". The first is shown to the person.
///
/// >>> from ahqp.collaboration import GraspedObject
/// >>> GraspedObject(mass=2.0).faces
/// {'front': 'drilled', 'back': 'smooth'}
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct GraspedObject(pub(crate) moca_model::GraspedObject);

#[pymethods]
impl GraspedObject {
    #[new]
    #[pyo3(signature = (*, size=None, mass=None, pose=None, faces=None))]
    fn new(
        size: Option<&Bound<'_, PyAny>>,
        mass: Option<f64>,
        pose: Option<&Bound<'_, PyAny>>,
        faces: Option<&Bound<'_, PyDict>>,
    ) -> Result<Self> {
        let mut object = moca_model::GraspedObject::default();
        if let Some(size) = size {
            object.size = numbers::<3>("size", size)?.into();
        }
        if let Some(mass) = mass {
            object.mass = mass;
        }
        if let Some(pose) = pose {
            object.tool_from_object = self::pose("pose", pose)?;
        }
        if let Some(faces) = faces {
            let face = |(side, surface): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
                let (side, surface): (String, String) = (side.extract()?, surface.extract()?);
                Ok(WorkFace { side: word("side", &side, &SIDES)?, surface: surface.parse()? })
            };
            object.faces = faces.iter().map(face).collect::<Result<_>>()?;
        }
        object.validate()?;
        Ok(Self(object))
    }

    /// Edges [m], (3,).
    #[getter]
    fn size<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        crate::arrays::to_vector(py, self.0.size.as_slice())
    }

    /// Mass [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass
    }

    /// Pose of its middle in the frame of the robot's tool, (4, 4).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        pose_to_array(py, &self.0.tool_from_object)
    }

    /// The surface of each side to work on.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let faces = PyDict::new(py);
        for face in &self.0.faces {
            let name = SIDES.iter().find(|(_, side)| *side == face.side).map(|(name, _)| *name);
            faces.set_item(name, face.surface.name())?;
        }
        Ok(faces)
    }
}
