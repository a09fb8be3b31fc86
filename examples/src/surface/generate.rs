//! Generated pictures of smooth and drilled surfaces, a folder for each class.

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Serialize;
use vision_models::Surface;

use human_perception::surface::picture::picture;

use crate::program::{Ending, OutputFile, Printing, Seed, Session, check_folder};

/// Draws pictures of plates, smooth and drilled: light, pose, background, blur and noise differ.
///
/// They are for trying the program. Success with them does not imply success with photographs.
#[derive(Args, Debug)]
pub struct Generate {
    /// The folder, which gets the folders `smooth` and `drilled`.
    folder: PathBuf,
    /// Pictures of each class, 1 to 100,000.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    count: u32,
    /// Side of the square pictures (pixels), 16 to 4,096.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    #[command(flatten)]
    seed: Seed,
    #[command(flatten)]
    printing: Printing,
}

/// The JSON object of `--json`.
#[derive(Serialize)]
struct Generated {
    folder: PathBuf,
    /// Number of all pictures.
    images: u64,
}

impl Generate {
    /// Draws the pictures.
    ///
    /// # Errors
    /// The place that cannot be written; a folder that already has pictures.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        check_folder(&self.folder)?;
        let classes = [Surface::Smooth, Surface::Drilled];
        for surface in classes {
            let folder = self.folder.join(surface.name());
            let empty = fs::read_dir(&folder).map_or(true, |mut entries| entries.next().is_none());
            ensure!(empty, "{}: there are files already; give a new folder", folder.display());
            fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        }
        let all = u64::from(self.count) * classes.len() as u64;
        let progress = session.progress("pictures", all);
        let mut done = 0;
        'all: for number in 0..self.count {
            for (stream, surface) in (0..).zip(classes) {
                if session.interrupt().requested() {
                    break 'all;
                }
                let stream = u64::from(number) * classes.len() as u64 + stream;
                let name = format!("{}/{number:05}.png", surface.name());
                self.draw(&self.folder.join(name), surface, stream)?;
                done += 1;
                progress.set(done);
            }
        }
        progress.finish();
        let ending = if done < all { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session.warn(format_args!("interrupted after {done} of {all} pictures"));
        }
        let shown = self.folder.display();
        writeln!(session.output(), "{done} pictures of smooth and drilled surfaces in {shown}")?;
        session.conclude(self.printing, &Generated { folder: self.folder, images: done }, ending)
    }

    fn draw(&self, path: &Path, surface: Surface, stream: u64) -> Result<()> {
        let png = picture(surface, self.size, self.seed.seed, stream)?;
        OutputFile::write_whole(path, &png)?;
        Ok(())
    }
}
