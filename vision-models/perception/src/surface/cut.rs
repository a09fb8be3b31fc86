//! Selects images of surfaces by class from frames whose truth is known.

use vision_models::Percept;

use crate::{frames::truth::TrueFilm, learning::cutting::Sample};

/// Returns the images of the on-board camera, one of every `every` frames. They are not cropped,
/// because that camera faces the object. Images in which the robot does not hold it are left out.
pub fn images_of(film: &TrueFilm, every: usize) -> Vec<Sample> {
    let image = |(entry, truth): &(_, Percept)| {
        let class = truth.surface?.surface.name().to_owned();
        let from = film.reader().surface(entry);
        let name = from.file_name()?.to_string_lossy();
        let to = format!("{}-{name}", film.name).into();
        Some(Sample { class, files: vec![(from, to)] })
    };
    film.frames.iter().step_by(every.max(1)).filter_map(image).collect()
}
