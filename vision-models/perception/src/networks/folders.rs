//! Images in folders, one folder per class, and images that cannot be read.

use std::path::{Path, PathBuf};

use vision_models::ImageFolder;

use crate::{
    error::Error,
    watch::{Watch, warn},
};

/// An image with a known class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledImage {
    /// The file.
    pub path: PathBuf,
    /// Index of the class.
    pub label: usize,
}

/// Returns the folders in a folder, sorted by name, without hidden ones: at least two classes. A
/// warning counts images beside them.
///
/// # Errors
/// Names the folder if it cannot be read, has too few folders, or has a folder whose name cannot be
/// a class's.
pub(crate) fn list_classes(folder: &Path, watch: &mut Watch<'_>) -> Result<Vec<String>, Error> {
    let shown = folder.display();
    let found = open(folder)?;
    let mut classes = Vec::new();
    for path in found.folders {
        let name = path.file_name().unwrap_or_default();
        match name.to_str() {
            Some(name) if name.trim() == name && !name.contains(['\n', '\r']) => {
                classes.push(name.to_owned());
            }
            _ => {
                let name = name.to_string_lossy();
                return Err(Error::unfit(
                    shown,
                    format!("the folder \"{}\" is no class name", name.escape_debug()),
                    "give names in UTF-8, of one line and without spaces around them",
                ));
            }
        }
    }
    if classes.len() < 2 {
        let count = classes.len();
        let found =
            format!("{count} folders with images, give one for each of at least two classes");
        return Err(Error::at(shown, found));
    }
    if !found.images.is_empty() {
        let count = found.images.len();
        warn(
            watch,
            format_args!("{shown}: left out {count} images beside the folders of the classes"),
        );
    }
    classes.sort();
    Ok(classes)
}

/// Returns the images in the folders of these classes. A warning counts files of other types.
///
/// # Errors
/// Names the folder if it cannot be read or has no images.
pub(crate) fn list_images(
    folder: &Path,
    classes: &[String],
    watch: &mut Watch<'_>,
) -> Result<Vec<LabelledImage>, Error> {
    let mut images = Vec::new();
    for (label, class) in classes.iter().enumerate() {
        let paths = images_in(&folder.join(class), watch)?;
        images.extend(paths.into_iter().map(|path| LabelledImage { path, label }));
    }
    Ok(images)
}

/// Returns the images in a folder, sorted by name, without hidden ones. A warning counts files of
/// other types.
///
/// # Errors
/// Names the folder if it cannot be read or has no images.
pub(crate) fn images_in(folder: &Path, watch: &mut Watch<'_>) -> Result<Vec<PathBuf>, Error> {
    let ImageFolder { images, others, .. } = open(folder)?;
    let shown = folder.display();
    if images.is_empty() {
        return Err(if others.is_empty() {
            Error::at(shown, "no JPEG or PNG files")
        } else {
            Error::unfit(shown, format!("no JPEG or PNG files, but {others}"), "convert them")
        });
    }
    if !others.is_empty() {
        warn(watch, format_args!("{shown}: left out {others}: only JPEG and PNG are read"));
    }
    Ok(images)
}

/// Returns the folders in a folder, sorted by name, without hidden ones.
///
/// # Errors
/// Names the folder if it cannot be read.
pub(crate) fn folders_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    Ok(open(folder)?.folders)
}

fn open(folder: &Path) -> Result<ImageFolder, Error> {
    ImageFolder::open(folder).map_err(Error::content(folder))
}

/// Counter of images that cannot be read. Warnings name them.
#[derive(Clone, Copy, Debug)]
pub struct Unreadable {
    /// True if the first one is an error.
    strict: bool,
    count: usize,
}

impl Unreadable {
    /// Creates a counter at zero.
    pub fn new(strict: bool) -> Self {
        Self { strict, count: 0 }
    }

    /// Returns their number.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Leaves an image out.
    ///
    /// # Errors
    /// The error itself, in strict mode.
    pub fn leave_out(&mut self, error: Error, watch: &mut Watch<'_>) -> Result<(), Error> {
        if self.strict {
            return Err(error);
        }
        self.count += 1;
        warn(watch, format_args!("left out: {error}"));
        Ok(())
    }
}
