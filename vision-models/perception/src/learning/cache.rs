//! Features on disk, keyed by the content of their source.
//!
//! A file begins with two lines: `features 1`, and the key that identifies how the features were
//! computed. Then come records with these parts, numbers little-endian:
//! - the SHA-256 of the features' source
//! - the number of features (u32)
//! - the features (f32)
//! - the first eight bytes of the SHA-256 of the features
//!
//! An incomplete record at the end is removed when the file is opened.

use std::{
    collections::HashMap,
    fs::File,
    io::{BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use super::digest::Digest;
use crate::{
    error::Error,
    watch::{Watch, warn},
};

const FIRST_LINE: &str = "features 1";
/// Largest number of features of a record.
const MOST: usize = 1 << 24;
/// Longest line of the head that is read (bytes).
const LONGEST_LINE: u64 = 4096;

/// The known features, and the file to which further ones are added.
///
/// ```
/// use human_perception::learning::{cache::FeatureCache, digest::Digest};
///
/// let folder = tempfile::tempdir()?;
/// let (path, image) = (folder.path().join("a.features"), Digest::of_bytes(b"an image"));
/// FeatureCache::open(&path, "resnet50")?.insert(image, vec![0.5, 1.0])?;
/// let again = FeatureCache::open(&path, "resnet50")?;
/// assert_eq!(again.get(&image), Some([0.5, 1.0].as_slice()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FeatureCache {
    path: PathBuf,
    file: File,
    known: HashMap<Digest, Vec<f32>>,
}

impl FeatureCache {
    /// Opens the file or creates it.
    ///
    /// # Errors
    /// Names the file if it cannot be read and written, has another format, or has features that
    /// were computed with another key.
    pub fn open(path: &Path, key: &str) -> Result<Self, Error> {
        let refuse = |source| Error::Read { path: path.to_owned(), source };
        let options = File::options().read(true).append(true).create(true).clone();
        let mut file = options.open(path).map_err(refuse)?;
        let own = file.try_clone().map_err(refuse)?;
        let mut cache = Self { path: path.to_owned(), file: own, known: HashMap::new() };
        if file.metadata().map_err(refuse)?.len() == 0 {
            file.write_all(format!("{FIRST_LINE}\n{key}\n").as_bytes()).map_err(refuse)?;
            return Ok(cache);
        }
        let mut reader = BufReader::new(&mut file);
        let mut head = [const { String::new() }; 2];
        for line in &mut head {
            let mut limited = (&mut reader).take(LONGEST_LINE);
            match limited.read_line(line) {
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::InvalidData => line.clear(),
                Err(error) => return Err(refuse(error)),
            }
        }
        let [first, own] = head.each_ref().map(|line| line.trim_end_matches('\n'));
        let shown = path.display();
        let wanted = "give another folder for the cache, or remove it";
        if first != FIRST_LINE {
            return Err(Error::unfit(shown, "no file of features", wanted));
        }
        if own != key {
            let found =
                format!("the features are of other weights: of \"{own}\", not of \"{key}\"");
            return Err(Error::unfit(shown, found, wanted));
        }
        let mut whole = (first.len() + own.len() + 2) as u64;
        while let Some((digest, features, length)) = record(&mut reader).map_err(refuse)? {
            whole += length;
            cache.known.insert(digest, features);
        }
        file.set_len(whole).map_err(refuse)?;
        file.seek(SeekFrom::End(0)).map_err(refuse)?;
        Ok(cache)
    }

    /// Returns the features of the source with this content.
    pub fn get(&self, digest: &Digest) -> Option<&[f32]> {
        self.known.get(digest).map(Vec::as_slice)
    }

    /// Reports by a warning where the features so far are.
    pub(crate) fn tell_kept(&self, watch: &mut Watch<'_>) {
        let kept = self.path.display();
        warn(watch, format_args!("the features so far are kept in {kept}"));
    }

    /// Stores features in memory and in the file.
    ///
    /// # Errors
    /// Names the file if it cannot be written.
    pub fn insert(&mut self, digest: Digest, features: Vec<f32>) -> Result<(), Error> {
        let count = u32::try_from(features.len()).ok().filter(|count| *count as usize <= MOST);
        let Some(count) = count else {
            let found = format!("{} features are too many to keep", features.len());
            return Err(Error::at(self.path.display(), found));
        };
        let numbers: Vec<u8> = features.iter().flat_map(|feature| feature.to_le_bytes()).collect();
        let mut bytes = digest.0.to_vec();
        bytes.extend(count.to_le_bytes());
        bytes.extend(&numbers);
        bytes.extend(check(&numbers));
        self.file.write_all(&bytes).map_err(Error::read(&self.path))?;
        self.known.insert(digest, features);
        Ok(())
    }
}

/// Returns the next record with its length in bytes, or none if the rest is incomplete.
fn record(reader: &mut impl Read) -> std::io::Result<Option<(Digest, Vec<f32>, u64)>> {
    let mut head = [0; 36];
    if !fill(reader, &mut head)? {
        return Ok(None);
    }
    let (digest, count) = head.split_at(32);
    let mut own = Digest([0; 32]);
    own.0.copy_from_slice(digest);
    let count = count.iter().rev().fold(0, |value, byte| value << 8 | usize::from(*byte));
    if count > MOST {
        return Ok(None);
    }
    let mut numbers = vec![0; 4 * count];
    let mut sum = [0; 8];
    if !fill(reader, &mut numbers)? || !fill(reader, &mut sum)? || check(&numbers) != sum {
        return Ok(None);
    }
    let (numbers, _) = numbers.as_chunks::<4>();
    let features = numbers.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    Ok(Some((own, features, 36 + 4 * count as u64 + 8)))
}

/// Fills `bytes`. Returns false if fewer bytes are left.
fn fill(reader: &mut impl Read, bytes: &mut [u8]) -> std::io::Result<bool> {
    match reader.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn check(numbers: &[u8]) -> [u8; 8] {
    let Digest(all) = Digest::of_bytes(numbers);
    let mut first = [0; 8];
    first.copy_from_slice(all.split_at(8).0);
    first
}
