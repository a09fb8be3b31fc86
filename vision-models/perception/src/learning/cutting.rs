//! Creates data sets from frames whose truth is known: one folder per class.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::{
    error::Error,
    file::make_folder,
    frames::truth::TrueFilm,
    watch::{Event, Watch},
};

/// A sample of a data set.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Name of its class.
    pub class: String,
    /// Paths of its files, and their paths in the class's folder.
    pub files: Vec<(PathBuf, PathBuf)>,
}

/// The report of a created data set.
#[derive(Clone, Debug, Serialize)]
pub struct CutOut {
    /// Folder of the data set.
    pub output: PathBuf,
    /// Number of samples.
    pub samples: u64,
    /// Number of samples of each class.
    pub classes: BTreeMap<String, u64>,
}

/// Creates a data set from the samples of films, one folder per class. `what` names the samples in
/// messages.
///
/// Its files are links to those of the frames, or copies if the system has no links. The second
/// number is the number of all samples. Fewer are created if the call-back stops the work.
///
/// # Errors
/// Names the folder that is not empty, or the frame or truth that is wrong. An error if there are
/// no samples.
pub fn cut(
    films: &[PathBuf],
    output: &Path,
    what: &str,
    samples_of: impl Fn(&TrueFilm) -> Vec<Sample>,
    watch: &mut Watch<'_>,
) -> Result<(CutOut, u64), Error> {
    let empty = fs::read_dir(output).map_or(true, |mut entries| entries.next().is_none());
    if !empty {
        let found = "there are files already";
        return Err(Error::unfit(output.display(), found, "give a new folder"));
    }
    let samples: Vec<Sample> = TrueFilm::open_all(films)?.iter().flat_map(samples_of).collect();
    let all = samples.len() as u64;
    if all == 0 {
        let place = format!("no {what} in {} folders of frames", films.len());
        return Err(Error::at(place, "give frames that have some"));
    }
    let mut made = CutOut { output: output.to_owned(), samples: 0, classes: BTreeMap::new() };
    for Sample { class, files } in samples {
        if watch(Event::Progress { what, done: made.samples, all }).is_break() {
            break;
        }
        for (from, to) in files {
            put(&from, &output.join(&class).join(to))?;
        }
        *made.classes.entry(class).or_default() += 1;
        made.samples += 1;
    }
    let _ = watch(Event::Progress { what, done: all, all });
    Ok((made, all))
}

/// Links a file, or copies it.
fn put(from: &Path, to: &Path) -> Result<(), Error> {
    if let Some(folder) = to.parent() {
        make_folder(folder)?;
    }
    if fs::hard_link(from, to).is_err() {
        fs::copy(from, to).map_err(Error::read(from))?;
    }
    Ok(())
}
