//! Frames of a simulated camera.

use std::{fs, path::Path, sync::OnceLock};

use super::Runs;

/// A folder of small frames of a walk of 20 s, made once in a run of the tests.
pub(crate) fn small_frames() -> &'static str {
    static FOLDER: OnceLock<String> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("small-frames");
        let folder = folder.to_str().unwrap().to_owned();
        // The files of an earlier run may come from another version of the program.
        drop(fs::remove_dir_all(&folder));
        let film = ["--frames", &folder, "--size=32x32", "--duration=20", "--walk"];
        Runs::new("record").with(&film).run().done();
        folder
    })
}
