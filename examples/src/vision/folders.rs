//! Images in folders, one folder a class, and images that cannot be read.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use vision_models::ImageFolder;

use super::errors::in_file;
use crate::program::{Progress, warn};

/// An image of a known class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledImage {
    /// The file.
    pub path: PathBuf,
    /// The index of its class.
    pub label: usize,
}

/// The folders in a folder, by name, but for hidden ones: at least two classes. Images beside them are counted on
/// standard error.
///
/// # Errors
/// With the folder's name, if it cannot be read, has too few folders, or one whose name cannot be
/// a class's.
pub fn list_classes(folder: &Path) -> Result<Vec<String>> {
    let shown = folder.display();
    let found = open(folder)?;
    let mut classes = Vec::new();
    for path in found.folders {
        let name = path.file_name().unwrap_or_default();
        match name.to_str() {
            Some(name) if name.trim() == name && !name.contains(['\n', '\r']) => {
                classes.push(name.to_owned());
            }
            _ => bail!(
                "{shown}: the folder \"{}\" is no class name: give names in UTF-8, of one line and \
                 without spaces around them",
                name.to_string_lossy().escape_debug()
            ),
        }
    }
    ensure!(
        classes.len() >= 2,
        "{shown}: {} folders with images, give one for each of at least two classes",
        classes.len()
    );
    if !found.images.is_empty() {
        let count = found.images.len();
        warn(format_args!("{shown}: left out {count} images beside the folders of the classes"));
    }
    classes.sort();
    Ok(classes)
}

/// The images in the folders of these classes. Files of other types are counted on standard error.
///
/// # Errors
/// With the folder that cannot be read or has none.
pub fn list_images(folder: &Path, classes: &[String]) -> Result<Vec<LabelledImage>> {
    let mut images = Vec::new();
    for (label, class) in classes.iter().enumerate() {
        let paths = images_in(&folder.join(class))?;
        images.extend(paths.into_iter().map(|path| LabelledImage { path, label }));
    }
    Ok(images)
}

/// The images in a folder, by name, but for hidden ones. Files of other types are counted on standard error.
///
/// # Errors
/// Errors carry the folder's name, if it cannot be read or has none.
pub fn images_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let ImageFolder { images, others, .. } = open(folder)?;
    let shown = folder.display();
    ensure!(
        !images.is_empty() || others.is_empty(),
        "{shown}: no JPEG or PNG files, but {others}: convert them"
    );
    ensure!(!images.is_empty(), "{shown}: no JPEG or PNG files");
    if !others.is_empty() {
        warn(format_args!("{shown}: left out {others}: only JPEG and PNG are read"));
    }
    Ok(images)
}

/// The folders in a folder, by name, but for hidden ones.
///
/// # Errors
/// Errors carry the folder's name, if it cannot be read.
pub fn folders_in(folder: &Path) -> Result<Vec<PathBuf>> {
    Ok(open(folder)?.folders)
}

fn open(folder: &Path) -> Result<ImageFolder> {
    ImageFolder::open(folder).map_err(|error| in_file(folder, error))
}

/// Images that cannot be read: named on standard error and counted.
#[derive(Debug)]
pub struct Unreadable {
    /// Whether the first one ends the program.
    strict: bool,
    count: usize,
}

impl Unreadable {
    /// None so far.
    pub fn new(strict: bool) -> Self {
        Self { strict, count: 0 }
    }

    /// How many there were.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Leaves one out.
    ///
    /// # Errors
    /// If the first one ends the program.
    pub fn leave_out(
        &mut self,
        progress: &Progress,
        path: &Path,
        error: vision_models::Error,
    ) -> Result<()> {
        let error = in_file(path, error);
        if self.strict {
            return Err(error);
        }
        self.count += 1;
        progress.note(format_args!("left out: {error:#}"));
        Ok(())
    }
}
