//! Finds equal images in several parts of a data set. A measurement with such an image uses an
//! image of the training.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
};

use super::{digest::Digest, split::Part};
use crate::{
    error::Error,
    watch::{Watch, go_on},
};

/// Two files of the same content in different parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Twins {
    /// The first file.
    pub first: PathBuf,
    /// The second file.
    pub second: PathBuf,
}

/// Finds files with an equal file in another part. Only files of the same length are read. A file
/// that cannot be read is ignored.
///
/// # Errors
/// [`Error::Stopped`] if the call-back stops the work.
pub fn twins(files: &[(&Path, Part)], watch: &mut Watch<'_>) -> Result<Vec<Twins>, Error> {
    let mut by_length = HashMap::<u64, Vec<usize>>::new();
    for (index, (path, _)) in files.iter().enumerate() {
        if let Ok(found) = fs::metadata(path) {
            by_length.entry(found.len()).or_default().push(index);
        }
    }
    let mut candidates: Vec<usize> =
        by_length.into_values().filter(|same| same.len() > 1).flatten().collect();
    candidates.sort_unstable();
    let mut known = HashMap::<Digest, (usize, Part)>::new();
    let mut found = Vec::new();
    for index in candidates {
        let Some(&(path, part)) = files.get(index) else { continue };
        go_on(watch)?;
        let Ok(digest) = Digest::of_file(path, watch) else { continue };
        let (first, of_first) = *known.entry(digest).or_insert((index, part));
        if of_first != part
            && let Some((first, _)) = files.get(first)
        {
            found.push(Twins { first: (*first).to_owned(), second: path.to_owned() });
        }
    }
    Ok(found)
}
