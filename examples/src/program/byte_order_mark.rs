//! The mark that some editors and spreadsheets put before the text.

use std::io::{self, BufRead, Chain, Cursor, Read};

/// What UTF-8 texts may begin with.
const MARK: [u8; 3] = [0xef, 0xbb, 0xbf];

/// A text without its byte-order mark.
pub type WithoutMark<R> = Chain<Cursor<Vec<u8>>, R>;

/// Skips the byte-order mark of UTF-8, if the text begins with one.
///
/// ```
/// use std::io::Read;
///
/// use examples::program::without_byte_order_mark;
///
/// let mut text = String::new();
/// without_byte_order_mark("\u{feff}hqpset".as_bytes())?.read_to_string(&mut text)?;
/// assert_eq!(text, "hqpset");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// What the system says when the first bytes cannot be read.
pub fn without_byte_order_mark<R: BufRead>(mut input: R) -> io::Result<WithoutMark<R>> {
    let mut head = Vec::with_capacity(MARK.len());
    input.by_ref().take(MARK.len() as u64).read_to_end(&mut head)?;
    if head == MARK {
        head.clear();
    }
    Ok(Cursor::new(head).chain(input))
}
