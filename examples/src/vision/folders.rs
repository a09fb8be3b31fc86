//! Images in folders, one folder a class, and images that cannot be read.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use vision_models::list_frames;

use super::errors::in_file;
use crate::program::Progress;

/// An image of a known class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledImage {
    /// The file.
    pub path: PathBuf,
    /// The index of its class.
    pub label: usize,
}

/// The folders in a folder, by name: at least two classes.
///
/// # Errors
/// With the folder's name, if it cannot be read, has too few folders, or one whose name cannot be
/// a class's.
pub fn list_classes(folder: &Path) -> Result<Vec<String>> {
    let shown = folder.display();
    let mut classes = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| shown.to_string())? {
        let entry = entry.with_context(|| shown.to_string())?;
        if !entry.path().is_dir() {
            continue;
        }
        match entry.file_name().into_string() {
            Ok(name) if name.trim() == name && !name.contains(['\n', '\r']) => classes.push(name),
            _ => bail!(
                "{shown}: the folder \"{}\" is no class name: give names in UTF-8, of one line and \
                 without spaces around them",
                entry.file_name().to_string_lossy().escape_debug()
            ),
        }
    }
    ensure!(
        classes.len() >= 2,
        "{shown}: {} folders with images, give one for each of at least two classes",
        classes.len()
    );
    classes.sort();
    Ok(classes)
}

/// The images in the folders of these classes.
///
/// # Errors
/// With the folder that cannot be read or has none.
pub fn list_images(folder: &Path, classes: &[String]) -> Result<Vec<LabelledImage>> {
    let mut images = Vec::new();
    for (label, class) in classes.iter().enumerate() {
        let folder = folder.join(class);
        let paths = list_frames(&folder).map_err(|error| in_file(&folder, error))?;
        images.extend(paths.into_iter().map(|path| LabelledImage { path, label }));
    }
    Ok(images)
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
