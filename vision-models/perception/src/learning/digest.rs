//! Keys computed from content.

use std::{
    fmt::{self, Write as _},
    fs::File,
    io::Read,
    path::Path,
};

use sha2::{Digest as _, Sha256};

use crate::{
    error::Error,
    watch::{Watch, go_on},
};

/// The SHA-256 of some content.
///
/// ```
/// use human_perception::learning::digest::Digest;
///
/// assert!(Digest::of_bytes(b"abc").to_string().starts_with("ba7816bf"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    /// Returns the digest of bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }

    /// Returns the digest of a file, which is read piece by piece.
    ///
    /// # Errors
    /// [`Error::Read`] if the file cannot be read, [`Error::Stopped`] if the call-back stops the
    /// work.
    pub fn of_file(path: &Path, watch: &mut Watch<'_>) -> Result<Self, Error> {
        let mut file = File::open(path).map_err(Error::read(path))?;
        let mut hash = Sha256::new();
        let mut piece = vec![0; 1 << 20];
        loop {
            go_on(watch)?;
            let read = file.read(&mut piece).map_err(Error::read(path))?;
            if read == 0 {
                return Ok(Self(hash.finalize().into()));
            }
            hash.update(piece.get(..read).unwrap_or_default());
        }
    }

    /// Returns the digest of these digests in order.
    pub fn of_all(digests: impl IntoIterator<Item = Self>) -> Self {
        let mut hash = Sha256::new();
        digests.into_iter().for_each(|digest| hash.update(digest.0));
        Self(hash.finalize().into())
    }
}

/// Hexadecimal digits.
impl fmt::Display for Digest {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        for byte in self.0 {
            write!(text, "{byte:02x}")?;
        }
        formatter.pad(&text)
    }
}
