//! Key that loop and robot share.

use std::fmt;
use std::path::Path;

use hmac::{Hmac, Mac};
use sha2::Sha256;
use vision_models::file::read_bytes;

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
    /// [`Error::KeyFile`], also for a file that is too long; [`Error::Size`]
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::new(&read_bytes(path, LONGEST as u64).map_err(Error::KeyFile)?)
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
