//! Models from URDFs.

use std::path::Path;

use super::assembly;
use super::description::Description;
use super::model::Model;
use crate::error::Error;
use crate::urdf::document;

impl Model {
    /// Reads the robot that `description` sees in the text of a URDF.
    ///
    /// Acceleration, deceleration and jerk of `<limit>` count in every version of URDF.
    ///
    /// # Errors
    /// Each of [`Error`]'s variants about a URDF or a description.
    pub fn from_urdf(text: &str, description: &Description) -> Result<Self, Error> {
        assembly::assemble(&document::read(text)?, description)
    }

    /// The same from a file; bytes that are not UTF-8 count as unknown characters.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::InFile`] with what is wrong in it.
    pub fn from_urdf_file(
        path: impl AsRef<Path>,
        description: &Description,
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        let bytes =
            std::fs::read(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Self::from_urdf(&String::from_utf8_lossy(&bytes), description)
            .map_err(|source| Error::InFile { path: path.to_owned(), source: Box::new(source) })
    }
}
