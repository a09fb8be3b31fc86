//! What can be wrong with a checkpoint file.

use crate::excerpt::Excerpt;

/// A checkpoint that is refused. Nothing of it is used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// A file of another kind.
    #[error(
        "not a checkpoint: it starts with {start:02x?}; give a .pth of torch.save (the zip format \
         of PyTorch 1.6 or later, or the older stream) or a .safetensors"
    )]
    UnknownFormat {
        /// The first bytes, at most sixteen.
        start: Vec<u8>,
    },
    /// A file that ends too early, or a length in it that is too large.
    #[error(
        "{what} at byte {position} takes {needed} bytes, but {available} are left: \
         the file is cut off or corrupted"
    )]
    Truncated {
        /// The part of the file.
        what: &'static str,
        /// Where it starts.
        position: u64,
        /// Its size by what the file says (bytes).
        needed: u64,
        /// What there is (bytes).
        available: u64,
    },
    /// A zip archive that contradicts itself, or has what `torch.save` never writes.
    #[error("zip archive, entry \"{}\": {problem}", Excerpt(.entry))]
    Archive {
        /// The entry's name; empty for the archive itself.
        entry: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A pickle that is no pickle, or does what no state dict does.
    #[error("pickle, byte {position}: {problem}")]
    Pickle {
        /// Where in the pickle.
        position: u64,
        /// What is wrong.
        problem: PickleProblem,
    },
    /// A pickle without weights.
    #[error(
        "no state dict: the file holds {}; save it with torch.save(model.state_dict(), path), \
         bare or under one of the keys {wrappers:?}", Excerpt(.found)
    )]
    NoStateDict {
        /// What there is instead.
        found: String,
        /// The keys under which a state dict is looked for.
        wrappers: &'static [&'static str],
    },
    /// A storage that the archive lacks, or that has another size than the pickle says.
    #[error("storage \"{}\": {problem}", Excerpt(.key))]
    Storage {
        /// The storage's key.
        key: String,
        /// What is wrong.
        problem: String,
    },
    /// A tensor that does not lie within its storage.
    #[error(
        "tensor \"{}\" of shape {shape:?}, strides {strides:?} and offset {offset} \
         does not lie within its storage of {storage} elements", Excerpt(.name)
    )]
    OutsideStorage {
        /// The tensor's name.
        name: String,
        /// Its shape.
        shape: Vec<usize>,
        /// The step along each axis (elements).
        strides: Vec<usize>,
        /// Where it starts (elements).
        offset: usize,
        /// The storage's size (elements).
        storage: usize,
    },
    /// Two tensors of one name.
    #[error("two tensors are named \"{}\"", Excerpt(.name))]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// Tensors that overlap so much that reading them would take far more memory than the file.
    #[error(
        "the tensors have {elements} elements together, more than the file has bytes ({bytes}): \
         overlapping views are read only up to that size"
    )]
    Inflated {
        /// The number of elements of all tensors.
        elements: u64,
        /// The file's size (bytes).
        bytes: u64,
    },
    /// Weights that are not what was written.
    #[error("tensor \"{}\": its bytes have another checksum than the archive says", Excerpt(.name))]
    Checksum {
        /// The tensor's name.
        name: String,
    },
    /// The header of a safetensors file that breaks the format.
    #[error("safetensors header: {problem}")]
    Header {
        /// What is wrong.
        problem: String,
    },
    /// A part of the file beyond what this reader takes.
    #[error("{what}: {value}, more than the {limit} that are accepted")]
    Limit {
        /// The part of the file.
        what: &'static str,
        /// Its size.
        value: u64,
        /// The largest that is accepted.
        limit: u64,
    },
    /// A file of a big-endian machine.
    #[error("the file was written on a big-endian machine: only little-endian ones are read")]
    BigEndian,
}

/// What is wrong at a place in a pickle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PickleProblem {
    /// A byte that is no opcode of protocols 1 to 5.
    #[error("0x{0:02x} is no opcode of pickle protocols 1 to 5")]
    Opcode(u8),
    /// An opcode that takes more values than there are.
    #[error("the stack is empty")]
    EmptyStack,
    /// An opcode that goes back to a mark that was never set.
    #[error("there is no mark on the stack")]
    NoMark,
    /// A memo that was never filled.
    #[error("memo {0} is empty")]
    EmptyMemo(u64),
    /// A value of another kind than the opcode takes.
    #[error("expected {0}")]
    Expected(&'static str),
    /// Text that is not UTF-8.
    #[error("text that is not UTF-8")]
    Text,
    /// A protocol from after this reader was written.
    #[error("pickle protocol {0}: only 0 to 5 exist")]
    Protocol(u8),
}
