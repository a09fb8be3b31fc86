//! The images of a film, from a folder or by ffmpeg.

use std::{
    fs::File,
    io::{BufRead, BufReader, ErrorKind, Read, Seek},
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, Stdio},
};

use ndarray::Array3;
use vision_models::{file::Excerpt, list_frames, read_image};

use crate::error::Error;

/// The program that takes videos apart.
const PROGRAM: &str = "ffmpeg";
/// The longest side and the most pixels of an image.
const MAX_SIDE: usize = 16_384;
const MAX_PIXELS: usize = 64 << 20;
/// Length of what is kept of a program's messages about an error (bytes).
const SAID: u64 = 2000;

/// The images of a film, one after the other: the JPEG and PNG files of a folder by their names, or the images of a video
/// that `ffmpeg` takes apart, so many a second.
#[derive(Debug)]
pub struct FilmImages {
    source: Source,
}

#[derive(Debug)]
enum Source {
    Folder(std::vec::IntoIter<PathBuf>),
    Video(Video),
}

#[derive(Debug)]
struct Video {
    path: PathBuf,
    program: Child,
    images: BufReader<ChildStdout>,
    /// Messages of the program.
    said: File,
}

impl FilmImages {
    /// Opens a folder or a video, of which so many images a second are taken.
    ///
    /// # Errors
    /// A file that is not there, a folder without images, and a machine without `ffmpeg`, by their names.
    pub fn open(path: &Path, rate: f64) -> Result<Self, Error> {
        let source = if path.metadata().map_err(Error::read(path))?.is_dir() {
            Source::Folder(list_frames(path).map_err(Error::content(path))?.into_iter())
        } else {
            Source::Video(Video::open(path, rate)?)
        };
        Ok(Self { source })
    }

    /// The next image, height × width × 3: red, green, blue; `None` at the end.
    ///
    /// # Errors
    /// An image that cannot be read, and what `ffmpeg` says of a file that is no video.
    pub fn next_image(&mut self) -> Result<Option<Array3<u8>>, Error> {
        match &mut self.source {
            Source::Folder(files) => Ok(files.next().map(read_image).transpose()?),
            Source::Video(video) => video.next_image(),
        }
    }
}

impl Video {
    fn open(path: &Path, rate: f64) -> Result<Self, Error> {
        let said = tempfile::tempfile().map_err(Error::read(path))?;
        let errors = said.try_clone().map_err(Error::read(path))?;
        // "file:" keeps it from taking a name for an address.
        let mut input = std::ffi::OsString::from("file:");
        input.push(path);
        let started = Command::new(PROGRAM)
            .args(["-nostdin", "-v", "error", "-i"])
            .arg(input)
            .args(["-vf", &format!("fps={rate}"), "-f", "image2pipe", "-c:v", "ppm", "pipe:1"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(errors)
            .spawn();
        let mut program = started.map_err(|error| match error.kind() {
            ErrorKind::NotFound => Error::unfit(
                path.display(),
                format!("no {PROGRAM} on the PATH, which takes videos apart"),
                "install it, or give a folder of images",
            ),
            _ => Error::Read { path: PROGRAM.into(), source: error },
        })?;
        let images = program.stdout.take().map(BufReader::new);
        let images = images.ok_or_else(|| Error::at(path.display(), "no pipe to read from"))?;
        Ok(Self { path: path.to_owned(), program, images, said })
    }

    fn next_image(&mut self) -> Result<Option<Array3<u8>>, Error> {
        match read_ppm(&mut self.images) {
            Ok(Some(image)) => Ok(Some(image)),
            Ok(None) => self.end().map(|()| None),
            Err(source) => {
                self.end()?;
                Err(Error::Read { path: self.path.clone(), source })
            }
        }
    }

    /// Waits for the program, and gives what it says if it failed.
    fn end(&mut self) -> Result<(), Error> {
        let status = self.program.wait().map_err(Error::read(&self.path))?;
        if status.success() {
            return Ok(());
        }
        let mut said = String::new();
        let read = self
            .said
            .rewind()
            .and_then(|()| self.said.try_clone()?.take(SAID).read_to_string(&mut said));
        let said = if read.is_ok() { said.trim() } else { "" };
        Err(Error::at(self.path.display(), format!("{PROGRAM} says: {}", Excerpt(said))))
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// Reads an image of the Portable Pixmap format; `None` at the end of the stream.
fn read_ppm(stream: &mut impl BufRead) -> std::io::Result<Option<Array3<u8>>> {
    let wrong = |what: String| std::io::Error::new(ErrorKind::InvalidData, what);
    let mut magic = [0; 2];
    let Some(first) = stream.bytes().next() else { return Ok(None) };
    magic[0] = first?;
    stream.read_exact(&mut magic[1..])?;
    if &magic != b"P6" {
        return Err(wrong("no image where one should be".to_owned()));
    }
    let mut number = || -> std::io::Result<usize> {
        let mut text = String::new();
        for byte in stream.bytes() {
            match byte? {
                digit if digit.is_ascii_digit() && text.len() < 9 => text.push(digit.into()),
                space if space.is_ascii_whitespace() && text.is_empty() => {}
                space if space.is_ascii_whitespace() => break,
                other => return Err(wrong(format!("byte {other} in the head of an image"))),
            }
        }
        text.parse().map_err(|_| wrong("an image without a size".to_owned()))
    };
    let [width, height, levels] = [number()?, number()?, number()?];
    let sides = [width, height];
    if !sides.iter().all(|side| (1..=MAX_SIDE).contains(side)) || width * height > MAX_PIXELS {
        return Err(wrong(format!("an image of {width} × {height} pixels")));
    }
    if levels != 255 {
        return Err(wrong(format!("{levels} levels, not 255")));
    }
    let mut pixels = vec![0; 3 * width * height];
    stream.read_exact(&mut pixels)?;
    let image = Array3::from_shape_vec((height, width, 3), pixels);
    image.map(Some).map_err(|error| wrong(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixmaps_follow_one_another() {
        let mut stream: &[u8] = b"P6\n2 1\n255\nabcdefP6 1 1 255 xyz";
        let first = read_ppm(&mut stream).ok().flatten();
        assert_eq!(first, Array3::from_shape_vec((1, 2, 3), b"abcdef".to_vec()).ok());
        assert_eq!(read_ppm(&mut stream).ok().flatten().map(|image| image.dim()), Some((1, 1, 3)));
        assert!(matches!(read_ppm(&mut stream), Ok(None)));
        for broken in [
            "P5 1 1 255 xyz",
            "P6 1",
            "P6 1 1 65535 xyz",
            "P6 0 1 255 ",
            "P6 1 1 255 xy",
            "P6 99999 99999 255 ",
        ] {
            assert!(read_ppm(&mut broken.as_bytes()).is_err(), "{broken}");
        }
    }
}
