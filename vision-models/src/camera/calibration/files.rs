//! Calibrations in files.

use std::path::Path;

use super::{CalibratedCamera, qualisys, yaml};
use crate::error::Error;
use crate::file::{in_file, read_text};

/// The largest file (bytes).
const LARGEST: u64 = 4 << 20;

impl CalibratedCamera {
    /// Reads the cameras of a file: Qualisys' `.qca.txt` with the video cameras of a system, or the YAML of a camera that
    /// OpenCV or ROS wrote. A camera in YAML is called by its `camera_name` or by its file.
    ///
    /// # Errors
    /// [`Error::File`], and [`Error::Malformed`] or [`Error::Value`] with the file's name.
    pub fn read(path: impl AsRef<Path>) -> Result<Vec<Self>, Error> {
        let path = path.as_ref();
        let text = read_text(path, LARGEST).map_err(in_file(path))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Self::parse(&text, &name).map_err(|error| match error {
            Error::Malformed { what, problem } => {
                Error::Malformed { what: format!("{}: {what}", path.display()), problem }
            }
            Error::Value { what, got, wanted } => {
                Error::Value { what: format!("{}: {what}", path.display()), got, wanted }
            }
            other => other,
        })
    }

    /// Reads the cameras of a text in a format of [`read`](Self::read). `name` is for a camera
    /// without one.
    ///
    /// - Qualisys: lengths in millimetres and pixels in 64ths, as the program writes them. Cameras for markers are left
    ///   out where there are some for video. Views that the program rotates are refused.
    /// - YAML: `image_width`, `image_height`, `camera_matrix`, `distortion_coefficients`, and `distortion_model` if it is
    ///   no `plumb_bob`. The pose is that of OpenCV: `rvec` (a rotation vector) or `R` (a matrix), and `tvec` or `T` in
    ///   metres, from the world to the camera. `rectification_matrix` and `projection_matrix` are not read.
    ///
    /// # Errors
    /// [`Error::Malformed`] and [`Error::Value`], with the camera and what would be right.
    pub fn parse(text: &str, name: &str) -> Result<Vec<Self>, Error> {
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            qualisys::cameras(text)
        } else {
            Ok(vec![yaml::camera(text, name)?])
        }
    }
}
