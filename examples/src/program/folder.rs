//! Checks of output folders before the work.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::ProgramError;

/// Checks that files can be written into a folder, or that it can be made. Leaves nothing behind.
///
/// # Errors
/// [`ProgramError::NotAFolder`] or [`ProgramError::Write`].
pub fn check_folder(path: impl AsRef<Path>) -> Result<(), ProgramError> {
    let path = path.as_ref();
    let nearest = nearest(path).map_err(|source| ProgramError::write(path, source))?;
    if !nearest.is_dir() {
        return Err(ProgramError::NotAFolder { path: nearest });
    }
    // The system removes the file as soon as it is closed.
    tempfile::tempfile_in(&nearest).map(drop).map_err(|source| ProgramError::write(path, source))
}

/// The deepest part of a path that exists.
fn nearest(path: &Path) -> io::Result<PathBuf> {
    let start = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    for ancestor in start.ancestors() {
        let ancestor = if ancestor.as_os_str().is_empty() { Path::new(".") } else { ancestor };
        match fs::metadata(ancestor) {
            Ok(_) => return Ok(ancestor.to_owned()),
            // A path below a file does not exist; the file itself is found further up.
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
                ) => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::NotFound.into())
}
