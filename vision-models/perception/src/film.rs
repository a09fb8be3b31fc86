//! People on film: from images of one or several cameras, or files of joints, to the posture along time.

mod images;
mod posture;
mod score_figure;
mod view;

pub use images::FilmImages;
pub use posture::{Film, FilmSettings, FilmedPosture};
pub use score_figure::score_figure;
pub use view::View;
