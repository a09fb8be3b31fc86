//! Files that are written completely or not at all.

use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile};

use super::ProgramError;

/// A file that is written beside its place and moved there when it is complete. If it is dropped before, it leaves
/// nothing behind, and an existing file in its place stays.
///
/// ```
/// use std::io::Write;
///
/// use examples::program::OutputFile;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("table.csv");
/// let mut file = OutputFile::create(&path)?;
/// writeln!(file, "time_s,score")?;
/// assert!(!path.exists());
/// file.keep()?;
/// assert_eq!(std::fs::read_to_string(&path)?, "time_s,score\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    sink: Sink,
}

#[derive(Debug)]
enum Sink {
    /// A temporary file in the same folder.
    Beside(BufWriter<NamedTempFile>),
    /// A device or a pipe, which must not be replaced.
    Direct(BufWriter<File>),
}

impl OutputFile {
    /// Creates a file. Call this before the work, since the folder must exist and be writable.
    ///
    /// # Errors
    /// [`ProgramError`] with the reason why nothing can be written there.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, ProgramError> {
        let path = path.as_ref();
        let fail = |source| ProgramError::write(path, source);
        let found = fs::metadata(path).ok();
        if let Some(found) = &found {
            if found.is_dir() {
                return Err(ProgramError::IsFolder { path: path.to_owned() });
            }
            // A file without write permission must not be replaced either.
            let opened = File::options().write(true).open(path).map_err(fail)?;
            if !found.is_file() {
                let sink = Sink::Direct(BufWriter::new(opened));
                return Ok(Self { path: path.to_owned(), sink });
            }
        }
        // If the place is a link, its target is replaced and the link stays.
        let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let folder = match place.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            let (file, folder) = (path.to_owned(), folder.to_owned());
            return Err(ProgramError::NoFolder { file, folder });
        }
        let file = beside(&place, folder).map_err(fail)?;
        if let Some(found) = found {
            // The new file gets the permissions of the one that it replaces.
            file.as_file().set_permissions(found.permissions()).map_err(fail)?;
        }
        Ok(Self { path: place, sink: Sink::Beside(BufWriter::new(file)) })
    }

    /// Writes a complete file.
    ///
    /// # Errors
    /// As [`OutputFile::create`] and [`OutputFile::keep`].
    pub fn write_whole(path: impl AsRef<Path>, contents: &[u8]) -> Result<(), ProgramError> {
        let mut file = Self::create(path)?;
        file.push(contents)?;
        file.keep()
    }

    /// The place of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the complete file in its place, in place of an existing one.
    ///
    /// # Errors
    /// [`ProgramError::Write`]; nothing is then left behind.
    pub fn keep(self) -> Result<(), ProgramError> {
        let Self { path, sink } = self;
        sink.keep(&path).map_err(|source| ProgramError::write(&path, source))
    }

    /// Keeps a file that an interrupt has cut short under the name `NAME.partial.EXTENSION`, and returns that path. So
    /// it cannot be mistaken for a complete one, and an existing file in its place stays. A device or a pipe keeps what
    /// was written.
    ///
    /// # Errors
    /// [`ProgramError::Write`]; nothing is then left behind.
    pub fn keep_partial(self) -> Result<PathBuf, ProgramError> {
        let Self { path, sink } = self;
        let path = match sink {
            Sink::Beside(_) => partial_path(&path),
            Sink::Direct(_) => path,
        };
        sink.keep(&path).map_err(|source| ProgramError::write(&path, source))?;
        Ok(path)
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// [`ProgramError::Write`].
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), ProgramError> {
        self.sink.write_all(bytes).map_err(|source| ProgramError::write(&self.path, source))
    }
}

/// Creates a file beside the place, with the usual permissions of new files.
fn beside(place: &Path, folder: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = OsString::from(".");
    prefix.push(place.file_name().ok_or(io::ErrorKind::InvalidInput)?);
    prefix.push(".");
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(".unfinished");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(".partial");
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

impl Sink {
    fn keep(self, path: &Path) -> io::Result<()> {
        match self {
            Self::Direct(mut device) => device.flush(),
            Self::Beside(file) => {
                let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.as_file().sync_all()?;
                file.persist(path).map(drop).map_err(|error| error.error)
            }
        }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Beside(file) => file.write(bytes),
            Self::Direct(device) => device.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Beside(file) => file.flush(),
            Self::Direct(device) => device.flush(),
        }
    }
}

/// Errors contain the name of the file.
impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.sink.write(bytes);
        written.map_err(|source| ProgramError::write(&self.path, source).into_io())
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.sink.flush();
        flushed.map_err(|source| ProgramError::write(&self.path, source).into_io())
    }
}
