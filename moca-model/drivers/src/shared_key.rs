//! A key that loop and robot share.

use std::fmt;
use std::path::Path;

use hmac::{Hmac, Mac};
use sha2::Sha256;

/// The bytes of a code.
pub(super) const CODE: usize = 32;
/// The fewest bytes of a key.
const SHORTEST: usize = 32;
/// The most: a file of something else is longer.
const LONGEST: u64 = 4096;

/// A key that loop and robot share: each packet ends with its HMAC-SHA-256 (RFC 2104).
#[derive(Clone)]
pub struct SharedKey(Hmac<Sha256>);

/// Why a file or a text is no key.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// The file cannot be read.
    #[error("the key cannot be read: {0}")]
    File(#[from] std::io::Error),
    /// It is too short or too long.
    #[error(
        "the key has {found} bytes, expected {SHORTEST} to {LONGEST}: make one by \
         `head -c 32 /dev/urandom > robot.key`"
    )]
    Size {
        /// Its bytes.
        found: u64,
    },
}

impl SharedKey {
    /// The key of these bytes, as they are.
    ///
    /// # Errors
    /// [`KeyError::Size`]
    pub fn new(bytes: &[u8]) -> Result<Self, KeyError> {
        let found = bytes.len() as u64;
        let keyed = Hmac::new_from_slice(bytes).ok();
        let fits = bytes.len() >= SHORTEST && found <= LONGEST;
        keyed.filter(|_| fits).map(Self).ok_or(KeyError::Size { found })
    }

    /// The key of a file's bytes, as they are.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        use std::io::Read;
        let mut bytes = Vec::new();
        std::fs::File::open(path)?.take(LONGEST + 1).read_to_end(&mut bytes)?;
        Self::new(&bytes)
    }

    /// The code of these bytes.
    pub(super) fn code(&self, bytes: &[u8]) -> [u8; CODE] {
        self.0.clone().chain_update(bytes).finalize().into_bytes().into()
    }

    /// Returns true if the code is that of these bytes; takes as long for a wrong one.
    pub(super) fn agrees(&self, bytes: &[u8], code: &[u8; CODE]) -> bool {
        self.0.clone().chain_update(bytes).verify(code.into()).is_ok()
    }
}

impl fmt::Debug for SharedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedKey")
    }
}
