//! The contents of a folder of images.

use std::{
    cmp::Ordering,
    collections::BTreeMap,
    ffi::OsStr,
    fmt, fs,
    path::{Path, PathBuf},
};

use crate::error::Error;

/// The extensions of the images that are read.
const EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];

/// Names that systems and programs use for their own files, beside names that begin with a point,
/// `@`, `#` or `$`.
const SYSTEM: [&str; 5] =
    ["__MACOSX", "Thumbs.db", "desktop.ini", "lost+found", "System Volume Information"];

/// Returns true for entries of a folder that are no data: names that begin with a point (`.git`,
/// `._x.png`), and files of the operating system (`@eaDir`, `Thumbs.db`).
///
/// ```
/// use vision_models::is_hidden;
///
/// assert!(is_hidden(".ipynb_checkpoints".as_ref()) && is_hidden("@eaDir".as_ref()));
/// assert!(!is_hidden("drilled".as_ref()));
/// ```
pub fn is_hidden(name: &OsStr) -> bool {
    name.as_encoded_bytes().first().is_some_and(|first| b".@#$".contains(first))
        || SYSTEM.iter().any(|system| name.eq_ignore_ascii_case(system))
}

/// The contents of a folder of images. Hidden entries ([`is_hidden`]) are left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImageFolder {
    /// The JPEG and PNG files, sorted by name. Numbers in names are compared as numbers, so
    /// `frame_10` comes after `frame_9`.
    pub images: Vec<PathBuf>,
    /// The folders, in the same order.
    pub folders: Vec<PathBuf>,
    /// The number of other files by their extensions in lower case.
    pub others: OtherFiles,
}

/// The number of files of other types by their extensions in lower case. Displayed as
/// `20 .bmp, 1 .txt`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OtherFiles(BTreeMap<String, usize>);

impl ImageFolder {
    /// Reads the entries of a folder.
    ///
    /// # Errors
    /// [`Error::File`] if the folder cannot be read.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, Error> {
        let folder = folder.as_ref();
        let of_file = |error: std::io::Error| Error::File {
            path: folder.display().to_string(),
            reason: error.to_string(),
        };
        let mut found = Self::default();
        for entry in fs::read_dir(folder).map_err(of_file)? {
            let entry = entry.map_err(of_file)?;
            if is_hidden(&entry.file_name()) {
                continue;
            }
            let path = entry.path();
            let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
            if path.is_dir() {
                found.folders.push(path);
            } else if EXTENSIONS.iter().any(|own| extension == **own) {
                found.images.push(path);
            } else {
                let extension = extension.to_string_lossy().chars().take(16).collect();
                *found.others.0.entry(extension).or_default() += 1;
            }
        }
        found.images.sort_by(|one, other| by_name(one, other));
        found.folders.sort_by(|one, other| by_name(one, other));
        Ok(found)
    }
}

impl OtherFiles {
    /// Returns true if there are no other files.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the number of other files.
    pub fn count(&self) -> usize {
        self.0.values().sum()
    }
}

impl fmt::Display for OtherFiles {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (extension, count)) in self.0.iter().enumerate() {
            let separator = if index > 0 { ", " } else { "" };
            match extension.as_str() {
                "" => write!(formatter, "{separator}{count} without an extension")?,
                extension => write!(formatter, "{separator}{count} .{}", extension.escape_debug())?,
            }
        }
        Ok(())
    }
}

/// Returns the JPEG and PNG files of a folder, sorted by name; see [`ImageFolder`].
///
/// # Errors
/// [`Error::File`] if the folder cannot be read, [`Error::NoFrames`] if it has no such files.
pub fn list_frames(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
    let images = ImageFolder::open(folder)?.images;
    if images.is_empty() { Err(Error::NoFrames) } else { Ok(images) }
}

fn by_name(one: &Path, other: &Path) -> Ordering {
    by_number(&one.to_string_lossy(), &other.to_string_lossy()).then_with(|| one.cmp(other))
}

/// Compares texts. Runs of digits are compared as numbers.
fn by_number(mut one: &str, mut other: &str) -> Ordering {
    loop {
        let (digits, others) = (number(one), number(other));
        let order = if digits.is_empty() || others.is_empty() {
            let order = one.chars().next().cmp(&other.chars().next());
            if order.is_ne() || one.is_empty() {
                return order;
            }
            one = skip(one, one.chars().next().map_or(0, char::len_utf8));
            other = skip(other, other.chars().next().map_or(0, char::len_utf8));
            order
        } else {
            let values = [digits, others].map(|digits| digits.trim_start_matches('0'));
            one = skip(one, digits.len());
            other = skip(other, others.len());
            values[0].len().cmp(&values[1].len()).then_with(|| values[0].cmp(values[1]))
        };
        if order.is_ne() {
            return order;
        }
    }
}

/// Returns the digits at the start.
fn number(text: &str) -> &str {
    let end = text.find(|character: char| !character.is_ascii_digit()).unwrap_or(text.len());
    text.get(..end).unwrap_or_default()
}

fn skip(text: &str, bytes: usize) -> &str {
    text.get(bytes..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::by_number;

    #[test]
    fn numbers_count_as_numbers() {
        let mut names = ["f10.png", "f9.png", "f009a.png", "g1", "f", "", "f09.png", "10", "9"];
        names.sort_by(|one, other| by_number(one, other));
        assert_eq!(names, ["", "9", "10", "f", "f9.png", "f09.png", "f009a.png", "f10.png", "g1"]);
    }
}
