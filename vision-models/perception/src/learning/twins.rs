//! The same picture in several parts of a data set: what is measured with it was seen in training.

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

/// Two files of the same content in different parts, training and validation or either and test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Twins {
    /// The one that comes first.
    pub first: PathBuf,
    /// The other.
    pub second: PathBuf,
}

/// Finds the files of which another of the same content is in another part. Only files of the same length are read;
/// one that cannot be read is like no other.
///
/// # Errors
/// [`Error::Stopped`].
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
