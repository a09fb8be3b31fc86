//! Recordings of what cameras reported.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use std::sync::Arc;

use percept_recording::{Completeness, Header, IfPartial, Timing, Writer, open};
use pyo3::prelude::*;
use pyo3::types::PyList;

use super::scene::Scene;
use crate::failure::{Failure, Result};

/// Camera frames in the order of their times, as the programs read and write them.
///
/// `Recording(scenes, *, stature=None, rate=20.0)`
///
/// Parameters
/// ----------
/// scenes : sequence of Scene
///     Each with a time.
/// stature : float, optional
///     Of the person [m].
/// rate : float
///     Of the camera [Hz], for information only.
///
/// >>> from ahqp.collaboration import Recording, Scene
/// >>> len(Recording([Scene(time=0.0), Scene(time=0.05)]).scenes)
/// 2
#[pyclass(frozen, module = "ahqp.collaboration")]
pub(crate) struct Recording {
    scenes: Vec<Py<Scene>>,
    header: Header,
    is_complete: bool,
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (scenes, *, stature=None, rate=20.0))]
    fn new(scenes: Vec<Py<Scene>>, stature: Option<f64>, rate: f64) -> Result<Self> {
        if let Some(index) = scenes.iter().position(|scene| !scene.get().is_timed) {
            let text = format!("scene {index} has no time; give each one: Scene(…, time=…)");
            return Err(Failure::value(text));
        }
        let header = Header { stature, rate, ..Header::default() };
        Ok(Self { scenes, header, is_complete: true })
    }

    /// Reads a recording. `partial=True` takes one that was interrupted, up to its last whole frame.
    #[staticmethod]
    #[pyo3(signature = (path, *, partial=false))]
    fn read(py: Python<'_>, path: PathBuf, partial: bool) -> Result<Self> {
        let if_partial = if partial { IfPartial::Take } else { IfPartial::Refuse };
        let read = py.detach(|| percept_recording::Recording::read(open(path)?, if_partial))?;
        let scene = |(percept, others): (_, Vec<_>)| {
            Py::new(py, Scene { percept, others: Arc::from(others), is_timed: true })
        };
        let scenes = read.percepts.into_iter().zip(read.others).map(scene);
        Ok(Self {
            scenes: scenes.collect::<PyResult<_>>()?,
            header: read.header,
            is_complete: read.completeness != Completeness::Partial,
        })
    }

    /// Writes the recording to a file.
    fn write(&self, path: PathBuf) -> Result<()> {
        let mut writer = Writer::new(BufWriter::new(File::create(path)?), &self.header)?;
        for scene in &self.scenes {
            let scene = scene.get();
            writer.write_people(&scene.percept, &scene.others, &Timing::default())?;
        }
        writer.finish()?;
        Ok(())
    }

    /// The camera frames.
    #[getter]
    fn scenes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, &self.scenes)
    }

    /// Stature of the person [m], None if it is not known.
    #[getter]
    fn stature(&self) -> Option<f64> {
        self.header.stature
    }

    /// Rate of the camera [Hz].
    #[getter]
    fn rate(&self) -> f64 {
        self.header.rate
    }

    /// True if the recording was not interrupted.
    #[getter]
    fn is_complete(&self) -> bool {
        self.is_complete
    }

    fn __repr__(&self) -> String {
        format!("<ahqp.collaboration.Recording: {} scenes>", self.scenes.len())
    }
}
