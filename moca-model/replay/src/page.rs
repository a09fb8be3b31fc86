//! Interactive page: one HTML file that shows runs in three dimensions, with their plots and states under one time
//! cursor. It needs only a browser with WebGL 2, and no network.
//!
//! ```
//! use moca_replay::page::{Results, page};
//! use moca_replay::recorded::ReplayError;
//!
//! let nothing = page("No run", &[], &Results::default());
//! assert!(matches!(nothing, Err(ReplayError::Nothing)));
//! ```

mod data;

use serde::Serialize;

use crate::recorded::{Replay, ReplayError};

const HTML: &str = include_str!("page/page.html");
/// The styles of every page that shows a scene.
pub const SCENE_STYLES: [&str; 3] = [
    include_str!("page/colours.css"),
    include_str!("page/layout.css"),
    include_str!("page/cards.css"),
];
const STYLES: [&str; 2] = [include_str!("page/tracks.css"), include_str!("page/media.css")];
/// Scripts that draw a scene: `Renderer`, `Camera`, `Scene`, and what they stand on. In an order in which a file uses only
/// what stands before it.
pub const SCENE_SCRIPTS: [&str; 8] = [
    include_str!("page/elements.js"),
    include_str!("page/data.js"),
    include_str!("page/colours.js"),
    include_str!("page/mathematics.js"),
    include_str!("page/meshes.js"),
    include_str!("page/renderer.js"),
    include_str!("page/camera.js"),
    include_str!("page/scene.js"),
];
/// Likewise.
const SCRIPTS: [&str; 7] = [
    include_str!("page/axis.js"),
    include_str!("page/lanes.js"),
    include_str!("page/limits.js"),
    include_str!("page/plots.js"),
    include_str!("page/panel.js"),
    include_str!("page/player.js"),
    include_str!("page/main.js"),
];

/// Results of the runs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Results {
    /// Table, row by row.
    pub rows: Vec<ResultRow>,
    /// The results as one JSON object.
    pub summary: serde_json::Value,
    /// Text about further runs; may be empty.
    pub text: String,
}

/// Row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultRow {
    /// Name of the quantity, with the unit.
    pub name: String,
    /// Number of decimals.
    pub digits: usize,
    /// Value of each run; `None` where a run has no such value.
    pub values: Vec<Option<f64>>,
}

/// Creates the page of some runs of one person and one robot, side by side. Returns the text of the file.
///
/// # Errors
/// [`ReplayError::Nothing`] without runs or with a run without samples; [`ReplayError::Json`].
pub fn page(title: &str, runs: &[&Replay], results: &Results) -> Result<String, ReplayError> {
    if runs.is_empty() || runs.iter().any(|run| run.samples.is_empty()) {
        return Err(ReplayError::Nothing);
    }
    let data = data::json(runs, results)?;
    let style = [SCENE_STYLES.concat(), STYLES.concat()].concat();
    let script = [SCENE_SCRIPTS.concat(), SCRIPTS.concat()].concat();
    let title = escaped(title);
    Ok(filled(
        HTML,
        &[
            ("{{title}}", &title),
            ("{{style}}", &style),
            ("{{title}}", &title),
            ("{{data}}", &data),
            ("{{script}}", &script),
        ],
    ))
}

/// The data of a page as JSON, for a script that draws runs itself.
///
/// # Errors
/// [`ReplayError::Nothing`] without a run; [`ReplayError::Json`].
pub fn data(runs: &[&Replay], results: &Results) -> Result<String, ReplayError> {
    data::json(runs, results)
}

/// A page with texts in place of placeholders, in their order. Each is put in once, so that no placeholder within
/// another text counts.
pub fn filled(html: &str, texts: &[(&str, &str)]) -> String {
    let length: usize = texts.iter().map(|(_, text)| text.len()).sum();
    let mut page = String::with_capacity(html.len() + length);
    let mut rest = html;
    for (placeholder, text) in texts {
        if let Some((before, after)) = rest.split_once(placeholder) {
            page.push_str(before);
            page.push_str(text);
            rest = after;
        }
    }
    page.push_str(rest);
    page
}

/// Escapes text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
