//! Key that loop and robot share.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use hmac::{Hmac, Mac};
use sha2::Sha256;

use super::error::Error;

/// Number of bytes of a code.
pub(super) const CODE: usize = 32;
/// Smallest number of bytes of a key.
const SHORTEST: usize = 32;
/// Largest number of bytes of a key. A longer file contains something else.
const LONGEST: usize = 4096;

/// Key that loop and robot share. Each packet then ends with its HMAC-SHA-256 (RFC 2104).
#[derive(Clone)]
pub struct SharedKey(Hmac<Sha256>);

impl SharedKey {
    /// Creates a key from bytes, which are used unchanged.
    ///
    /// # Errors
    /// [`Error::Size`]
    pub fn new(bytes: &[u8]) -> Result<Self, Error> {
        let got = bytes.len();
        let keyed = Hmac::new_from_slice(bytes).ok();
        keyed.filter(|_| (SHORTEST..=LONGEST).contains(&got)).map(Self).ok_or_else(|| {
            let way = "make one by `head -c 32 /dev/urandom > robot.key`";
            let wanted = format!("{SHORTEST} to {LONGEST}: {way}");
            Error::Size { what: "the key", got, wanted }
        })
    }

    /// Reads a key from a file, whose bytes are used unchanged.
    ///
    /// # Errors
    /// [`Error::KeyFile`], [`Error::Size`]
    pub fn read(path: &Path) -> Result<Self, Error> {
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(LONGEST as u64 + 1).read_to_end(&mut bytes))
            .map_err(Error::KeyFile)?;
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
