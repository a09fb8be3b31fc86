//! Clips as folders of frames.

use std::path::{Path, PathBuf};

use vision_models::{Action, ClassNames};

use crate::{
    error::Error,
    networks::folders::{folders_in, images_in, list_classes},
    watch::Watch,
};

/// A folder of frames with a known class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledClip {
    /// Name: the path within the data set's folder.
    pub name: String,
    /// The folder with the frames.
    pub folder: PathBuf,
    /// Index of the class.
    pub label: usize,
}

/// The classes and clips of a data set.
#[derive(Clone, Debug)]
pub struct ClipSet {
    /// Names of the classes. HRI30's are written as in the paper.
    pub classes: Vec<String>,
    /// The clips, sorted by class and name.
    pub clips: Vec<LabelledClip>,
}

/// Returns HRI30's class as written in the paper, whatever the copy. Any other name is returned
/// unchanged.
pub(crate) fn class_name(label: &str) -> String {
    Action::from_label(label).map_or_else(|_| label.to_owned(), |action| action.name().to_owned())
}

impl ClipSet {
    /// Reads FOLDER/CLASS/CLIP/frames.
    ///
    /// # Errors
    /// Names the folder if it cannot be read, has too few classes or no clips, or has a class
    /// twice.
    pub fn of_folders(folder: &Path, watch: &mut Watch<'_>) -> Result<Self, Error> {
        let folders = list_classes(folder, watch)?;
        let classes: Vec<String> = folders.iter().map(|class| class_name(class)).collect();
        for (place, class) in classes.iter().enumerate() {
            let twice = classes.iter().take(place).any(|other| other == class);
            if twice {
                let found = format!("two folders are of the class \"{class}\"");
                return Err(Error::at(folder.display(), found));
            }
        }
        let mut clips = Vec::new();
        for (label, class) in folders.iter().enumerate() {
            let own = folder.join(class);
            let name = |folder: PathBuf| Some(folder.file_name()?.to_string_lossy().into_owned());
            let mut names: Vec<_> = folders_in(&own)?.into_iter().filter_map(name).collect();
            if names.is_empty() {
                let wanted = "give a folder for each clip";
                return Err(Error::unfit(own.display(), "no folders of frames", wanted));
            }
            names.sort();
            clips.extend(names.into_iter().map(|clip| LabelledClip {
                folder: own.join(&clip),
                name: format!("{class}/{clip}"),
                label,
            }));
        }
        Ok(Self { classes, clips })
    }

    /// Reads FOLDER/CLIP/frames for the clips of a list. Each line has a clip's name and its class,
    /// separated by a comma, as in HRI30's `train_set_labels.csv`. The clip's extension is ignored.
    ///
    /// # Errors
    /// Names the line or the clip that is wrong.
    pub fn of_list(folder: &Path, list: &Path, names: &ClassNames) -> Result<Self, Error> {
        let labelled = names.read_clips(list).map_err(Error::content(list))?;
        let classes = names.names().iter().map(|name| class_name(name)).collect();
        let mut clips = Vec::new();
        for (clip, label) in labelled {
            let name = clip.rsplit_once('.').map_or(clip.as_str(), |(stem, _)| stem).to_owned();
            let own = folder.join(&name);
            if !own.is_dir() {
                let own = own.display();
                let found = format!("there is no folder {own} with the frames of \"{clip}\"");
                return Err(Error::at(list.display(), found));
            }
            clips.push(LabelledClip { folder: own, name, label });
        }
        if clips.is_empty() {
            return Err(Error::at(list.display(), "no clips"));
        }
        Ok(Self { classes, clips })
    }
}

/// Returns the frames of a clip, at least `least`.
///
/// # Errors
/// Names the folder if it has fewer.
pub fn frames_of(
    folder: &Path,
    least: usize,
    watch: &mut Watch<'_>,
) -> Result<Vec<PathBuf>, Error> {
    let frames = images_in(folder, watch)?;
    if frames.len() >= least {
        return Ok(frames);
    }
    let found = format!("{} frames are fewer than the {least} of a window", frames.len());
    let wanted = "give a longer clip, or a smaller length";
    Err(Error::unfit(folder.display(), found, wanted))
}
