//! Clips as folders of frames.

use std::path::{Path, PathBuf};

use vision_models::{Action, ClassNames};

use crate::{
    error::Error,
    networks::folders::{folders_in, images_in, list_classes},
    watch::Watch,
};

/// A folder of frames of a known class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledClip {
    /// Its name: the path within the data set's folder.
    pub name: String,
    /// The folder with its frames.
    pub folder: PathBuf,
    /// The index of its class.
    pub label: usize,
}

/// Classes and clips of a data set.
#[derive(Clone, Debug)]
pub struct ClipSet {
    /// The names of the classes, HRI30's as the paper writes them.
    pub classes: Vec<String>,
    /// The clips, by class and name.
    pub clips: Vec<LabelledClip>,
}

/// HRI30's class as the paper writes it, whatever the copy; any other name as it is.
pub fn class_name(label: &str) -> String {
    Action::from_label(label).map_or_else(|_| label.to_owned(), |action| action.name().to_owned())
}

impl ClipSet {
    /// FOLDER/CLASS/CLIP/frames.
    ///
    /// # Errors
    /// Names the folder that cannot be read, or has too few classes, no clips or a class twice.
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

    /// FOLDER/CLIP/frames for the clips of a list: a line each, its name and its class, with a comma between, as in
    /// HRI30's `train_set_labels.csv`. The clip's extension is left out.
    ///
    /// # Errors
    /// With the line or the clip that is wrong.
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

/// The frames of a clip, at least `least`.
///
/// # Errors
/// Names the folder, if it has fewer.
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
