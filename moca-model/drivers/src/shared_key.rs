//! Key that loop and robot share.

use std::fmt;
use std::path::Path;

use hmac::{Hmac, Mac};
use sha2::Sha256;

/// Number of bytes of a code.
pub(super) const CODE: usize = 32;
/// Smallest number of bytes of a key.
const SHORTEST: usize = 32;
/// Largest number of bytes of a key. A longer file contains something else.
const LONGEST: u64 = 4096;

/// Key that loop and robot share. Each packet then ends with its HMAC-SHA-256 (RFC 2104).
#[derive(Clone)]
pub struct SharedKey(Hmac<Sha256>);

/// Reason why a file or a text is no valid key.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KeyError {
    /// The file cannot be read.
    #[error("the key cannot be read: {0}")]
    File(#[from] std::io::Error),
    /// The key is too short or too long.
    #[error(
        "the key has {found} bytes, expected {SHORTEST} to {LONGEST}: make one by \
         `head -c 32 /dev/urandom > robot.key`"
    )]
    Size {
        /// Number of bytes.
        found: u64,
    },
}

impl SharedKey {
    /// Creates a key from bytes, which are used unchanged.
    ///
    /// # Errors
    /// [`KeyError::Size`]
    pub fn new(bytes: &[u8]) -> Result<Self, KeyError> {
        let found = bytes.len() as u64;
        let keyed = Hmac::new_from_slice(bytes).ok();
        let fits = bytes.len() >= SHORTEST && found <= LONGEST;
        keyed.filter(|_| fits).map(Self).ok_or(KeyError::Size { found })
    }

    /// Reads a key from a file, whose bytes are used unchanged.
    ///
    /// # Errors
    /// [`KeyError`]
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        use std::io::Read;
        let mut bytes = Vec::new();
        std::fs::File::open(path)?.take(LONGEST + 1).read_to_end(&mut bytes)?;
        Self::new(&bytes)
    }

    /// Returns the code of these bytes.
    pub(super) fn code(&self, bytes: &[u8]) -> [u8; CODE] {
        self.0.clone().chain_update(bytes).finalize().into_bytes().into()
    }

    /// Returns true if the code belongs to these bytes. A wrong code takes as long as a right one.
    pub(super) fn agrees(&self, bytes: &[u8], code: &[u8; CODE]) -> bool {
        self.0.clone().chain_update(bytes).verify(code.into()).is_ok()
    }
}

impl fmt::Debug for SharedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SharedKey")
    }
}
