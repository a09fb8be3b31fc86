//! Writes files completely or not at all.

use std::{fs, io, io::Write, path::Path};

use crate::error::Error;

/// Writes a file beside its place and moves it there when it is complete.
///
/// # Errors
/// [`Error::Write`] if the file cannot be written.
pub(crate) fn write_whole(path: &Path, contents: &[u8]) -> Result<(), Error> {
    let write = || -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.prefix(".").suffix(".unfinished").tempfile_in(folder)?;
        file.write_all(contents)?;
        file.as_file().sync_all()?;
        file.persist(path).map(drop).map_err(|error| error.error)
    };
    write().map_err(Error::write(path))
}

/// Creates a folder and its parents.
///
/// # Errors
/// [`Error::Write`] if a folder cannot be created.
pub(crate) fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(Error::write(path))
}
