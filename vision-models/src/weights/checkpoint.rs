//! An open checkpoint file: its contents, and its tensors one by one.

use std::{
    fs::File,
    io::{Read, Seek, SeekFrom, Write},
    path::Path,
};

use super::budget::Budget;
use super::contents::Contents;
use super::error::refused;
use super::input::reading;
use super::source::no_tensor;
use super::{safetensors, torch};
use crate::error::Error;
use crate::weights::contents::Format;
use crate::weights::source::TensorSource;
use crate::weights::tensor_info::TensorInfo;
use crate::weights::tensors::{Tensor, Tensors};

/// A checkpoint whose tensors are read from the file on demand.
///
/// The file may be a `.pth`, `.pt` or `.pyth` of `torch.save`, in the zip format or the older one,
/// or a `.safetensors`. Its first bytes tell which. Nothing in it is executed.
///
/// Opening it and reading all of it take at most four times its size and 16 MiB of memory. A file
/// that needs more is rejected when it is opened.
///
/// A state dict may be wrapped in a dict under `state_dict`, `model_state`, `model_state_dict` or
/// `model`. The prefixes `module.` and `_orig_mod.` of all names, from `DataParallel` and
/// `torch.compile`, are removed.
///
/// ```
/// use vision_models::Checkpoint;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/wrapped.pth");
/// let mut checkpoint = Checkpoint::open(file)?;
/// for (name, info) in checkpoint.tensors() {
///     println!("{name}: {} {:?}", info.element(), info.shape());
/// }
/// let bias = checkpoint.tensor("backbone.conv1.bn.bias")?;
/// assert_eq!(bias.shape(), [4]);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct Checkpoint<R = File> {
    source: R,
    contents: Contents,
    path: String,
}

impl Checkpoint {
    /// Opens a checkpoint file.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Checkpoint`] if it is rejected.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let file = File::open(&path);
        let path = path.as_ref().display().to_string();
        let file = file.map_err(|error| at_path(&path, reading(&error)))?;
        let contents = Self::read_contents(file).map_err(|error| at_path(&path, error));
        contents.map(|checkpoint| Self { path, ..checkpoint })
    }
}

impl<R: Read + Seek> Checkpoint<R> {
    /// Opens a checkpoint in memory or from any reader.
    ///
    /// # Errors
    /// Those of [`Checkpoint::open`].
    pub fn from_reader(source: R) -> Result<Self, Error> {
        Self::read_contents(source)
    }

    fn read_contents(mut source: R) -> Result<Self, Error> {
        let length = source.seek(SeekFrom::End(0)).map_err(|error| reading(&error))?;
        source.seek(SeekFrom::Start(0)).map_err(|error| reading(&error))?;
        let mut start = Vec::new();
        (&mut source).take(16).read_to_end(&mut start).map_err(|error| reading(&error))?;
        let mut budget = Budget::of_file(length);
        let mut contents = if start.starts_with(b"PK\x03\x04") {
            torch::read_archive(&mut source, length, &mut budget)?
        } else if torch::is_stream(&start) {
            torch::read_stream(&mut source, length, &mut budget)?
        } else if safetensors::is_safetensors(&start) {
            safetensors::read(&mut source, length, &mut budget)?
        } else {
            return Err(refused(
                "not a checkpoint",
                format_args!(
                    "it starts with {start:02x?}; give a .pth of torch.save (the zip format of \
                     PyTorch 1.6 or later, or the older stream) or a .safetensors"
                ),
            ));
        };
        contents.unwrap_names(&mut budget)?;
        // Views of one storage may overlap, and an axis of stride zero repeats its elements.
        let elements = contents
            .tensors
            .values()
            .fold(0_u64, |sum, info| sum.saturating_add(info.elements() as u64));
        if elements > length {
            return Err(refused(
                "tensors",
                format_args!(
                    "they have {elements} elements together, more than the file has bytes ({length}): \
                     overlapping views are read only up to that size"
                ),
            ));
        }
        // The memory that [`Self::read`] needs.
        for (name, info) in &contents.tensors {
            budget.take_tensor(name, info.shape())?;
        }
        budget.take(contents.tensors.values().map(TensorInfo::scratch).max().unwrap_or(0))?;
        Ok(Self { source, contents, path: String::new() })
    }

    /// Returns the file's format.
    pub fn format(&self) -> Format {
        self.contents.format
    }

    /// Returns the tensors in the order of their names.
    pub fn tensors(&self) -> impl Iterator<Item = (&str, &TensorInfo)> {
        self.contents.tensors.iter().map(|(name, info)| (name.as_str(), info))
    }

    /// Returns the keys under which the state dict was found, the outermost first.
    pub fn wrappers(&self) -> &[&'static str] {
        &self.contents.wrappers
    }

    /// Returns other contents of the file, which are not read: keys beside the state dict, and its
    /// entries that are no tensors of a known type. At most 64 of each, each of at most 64
    /// characters.
    pub fn others(&self) -> &[String] {
        &self.contents.others
    }

    /// Returns entries of the state dict that are not read: entries that are no tensors, and
    /// tensors whose type no layer has, such as complex numbers. They are also among the
    /// [others](Self::others).
    pub fn unread(&self) -> &[String] {
        &self.contents.unread
    }

    /// Reads a tensor as f32.
    ///
    /// # Errors
    /// - [`Error::Name`] if there is no such tensor.
    /// - [`Error::File`] if it cannot be read.
    /// - [`Error::Checkpoint`] if its checksum is wrong.
    pub fn tensor(&mut self, name: &str) -> Result<Tensor, Error> {
        let info = self.info(name)?;
        let mut values = Vec::with_capacity(info.elements());
        let read = info.read(name, &mut self.source, |bytes| {
            info.element().decode(bytes, &mut values);
            Ok(())
        });
        read.map_err(|error| at_path(&self.path, error))?;
        Tensor::new(info.shape().to_vec(), values)
    }

    /// Reads all tensors.
    ///
    /// # Errors
    /// Those of [`Checkpoint::tensor`].
    pub fn read(mut self) -> Result<Tensors, Error> {
        let mut tensors = Tensors::new();
        while let Some(name) = self.contents.tensors.first_key_value().map(|(name, _)| name.clone())
        {
            tensors.insert(name.clone(), self.tensor(&name)?)?;
            self.contents.tensors.remove(&name);
        }
        Ok(tensors)
    }

    /// Writes the tensors as safetensors, each with its element type.
    ///
    /// # Errors
    /// - [`Error::File`] if reading or writing fails.
    /// - [`Error::Checkpoint`] if a checksum is wrong.
    pub fn write_safetensors(&mut self, mut writer: impl Write) -> Result<(), Error> {
        let entries = self.tensors().map(|(name, info)| (name, info.element(), info.shape()));
        safetensors::write_header(&mut writer, entries)?;
        for (name, info) in &self.contents.tensors {
            let mut is_written = true;
            let copied = info.read(name, &mut self.source, |bytes| {
                let written = writer.write_all(bytes);
                is_written = written.is_ok();
                written.map_err(|error| reading(&error))
            });
            // The checkpoint's path is added only to errors of the checkpoint.
            copied.map_err(|error| if is_written { at_path(&self.path, error) } else { error })?;
        }
        writer.flush().map_err(|error| reading(&error))
    }

    fn info(&self, name: &str) -> Result<TensorInfo, Error> {
        let info = self.contents.tensors.get(name).cloned();
        info.ok_or_else(|| no_tensor(name))
    }
}

impl<R: Read + Seek> TensorSource for Checkpoint<R> {
    fn names(&self) -> Vec<&str> {
        self.tensors().map(|(name, _)| name).collect()
    }

    fn shape(&self, name: &str) -> Option<&[usize]> {
        self.contents.tensors.get(name).map(TensorInfo::shape)
    }

    fn is_counter(&self, name: &str) -> bool {
        self.contents.tensors.get(name).is_some_and(|info| info.element().is_whole())
    }

    fn take(&mut self, name: &str) -> Result<Tensor, Error> {
        self.tensor(name)
    }
}

impl Tensors {
    /// Reads all tensors of a checkpoint file; see [`Checkpoint`] for the formats.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, [`Error::Checkpoint`] if it is rejected.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Checkpoint::open(path)?.read()
    }

    /// Writes the tensors as safetensors.
    ///
    /// # Errors
    /// [`Error::File`] if writing fails.
    pub fn write_safetensors(&self, mut writer: impl Write) -> Result<(), Error> {
        safetensors::write(&mut writer, self)
    }
}

/// Adds the path to the operating system's error.
fn at_path(path: &str, error: Error) -> Error {
    match error {
        Error::File { path: inner, reason } if inner.is_empty() => {
            Error::File { path: path.into(), reason }
        }
        other => other,
    }
}
