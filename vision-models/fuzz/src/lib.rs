//! Shared by the targets: checks of the memory that the book promises.

use std::io::Cursor;

use vision_models::Checkpoint;

/// Runs `read` and checks that it takes at most this much memory (bytes).
pub fn within(limit: usize, read: impl FnOnce()) {
    let held = allocation_counter::measure(read).bytes_max;
    assert!(held <= limit as u64, "{held} bytes of memory, {limit} are promised");
}

/// Opens a checkpoint and reads all of it, within four times its size and 16 MiB, not counting the
/// file itself.
pub fn checkpoint(file: Vec<u8>) {
    let limit = 4 * file.len() + (16 << 20);
    within(limit, || drop(Checkpoint::from_reader(Cursor::new(&file)).and_then(Checkpoint::read)));
}
