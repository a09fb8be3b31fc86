//! Kinds of input files of networks.

use std::path::Path;

use crate::error::Error;

/// The kind of a network's input file.
///
/// ```
/// use human_perception::networks::Input;
///
/// assert_eq!(Input::of("photo.JPG".as_ref())?, Input::Image);
/// assert_eq!(Input::of(std::env::temp_dir().as_ref())?, Input::Clip);
/// # Ok::<(), human_perception::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A file with the extension of a JPEG or PNG.
    Image,
    /// A folder of frames.
    Clip,
    /// Any other file, or a pipe: an array in NumPy's format.
    Array,
}

impl Input {
    /// Returns the kind of this file.
    ///
    /// # Errors
    /// [`Error::Read`] if an array or a clip does not exist.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().unwrap_or_default();
        let is_folder = path.is_dir();
        if !is_folder
            && ["jpg", "jpeg", "png"].iter().any(|end| extension.eq_ignore_ascii_case(end))
        {
            return Ok(Self::Image);
        }
        path.metadata().map_err(Error::read(path))?;
        Ok(if is_folder { Self::Clip } else { Self::Array })
    }
}
