//! Construction of models from URDFs.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

use super::assembly;
use super::description::Description;
use super::model::Model;
use crate::error::{Error, urdf::UrdfError};
use crate::urdf::document;

/// The largest accepted URDF (bytes). Public robots have at most some hundred kilobytes.
const LARGEST: u64 = 64 << 20;

/// Reads a file, up to the largest accepted size. Devices and pipes do not report a length.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    let too_large = || {
        let text = format!("larger than a URDF can be: at most {LARGEST} bytes are read");
        io::Error::new(io::ErrorKind::FileTooLarge, text)
    };
    let file = File::open(path)?;
    if file.metadata()?.len() > LARGEST {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    file.take(LARGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST { Err(too_large()) } else { Ok(bytes) }
}

impl Model {
    /// Creates the model that `description` selects in the text of a URDF.
    ///
    /// Acceleration, deceleration and jerk of `<limit>` count in every version of URDF.
    ///
    /// # Errors
    /// Every variant of [`Error`] about a URDF or a description.
    pub fn from_urdf(text: &str, description: &Description) -> Result<Self, Error> {
        assembly::assemble(&document::read(text)?, description)
    }

    /// Creates the model from a robot that `urdf-rs` has read or that was built from its types. Errors name line 0.
    ///
    /// # Errors
    /// Those of [`from_urdf`](Self::from_urdf) that do not concern the text.
    #[cfg(feature = "urdf-rs")]
    pub fn from_parsed(robot: &urdf_rs::Robot, description: &Description) -> Result<Self, Error> {
        assembly::assemble(&robot.into(), description)
    }

    /// Creates the model from a file of at most 64 MiB. Bytes that are not UTF-8 count as unknown characters.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::InFile`] with what is wrong in it.
    pub fn from_urdf_file(
        path: impl AsRef<Path>,
        description: &Description,
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        let bytes = read(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        let in_file = |source| Error::InFile { path: path.to_owned(), source: Box::new(source) };
        if let Some(found) = other_encoding(&bytes) {
            return Err(in_file(Error::from(UrdfError::Encoding { found })));
        }
        Self::from_urdf(&String::from_utf8_lossy(&bytes), description).map_err(in_file)
    }
}

/// Returns the name of a UTF-16 or UTF-32 encoding, by the byte order mark or the first character, `<`.
fn other_encoding(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] | [b'<', 0, 0, 0, ..] => Some("UTF-32"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [b'<', 0, ..] | [0, b'<', ..] => Some("UTF-16"),
        _ => None,
    }
}
