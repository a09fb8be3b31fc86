//! The tables of a file of TensorFlow Lite, with the field numbers of its `schema.fbs`.
//!
//! `planus` checks every access against the file. An invalid one is an error.

use planus::errors::ErrorKind;
use planus::table_reader::Table as Reader;
use planus::{SliceWithStartOffset, TableRead, Vector, VectorRead};

use crate::error::Error;
use crate::weights::error::refused;

/// The identifier of the file format.
const IDENTIFIER: &[u8] = b"TFL3";

/// Returns true for the first bytes of a file of TensorFlow Lite.
pub(crate) fn is_tensorflow_lite(start: &[u8]) -> bool {
    start.get(4..8) == Some(IDENTIFIER)
}

/// A table of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table<'a>(Reader<'a>);

impl<'a> TableRead<'a> for Table<'a> {
    fn from_buffer(buffer: SliceWithStartOffset<'a>, offset: usize) -> Result<Self, ErrorKind> {
        Reader::from_buffer(buffer, offset).map(Self)
    }
}

impl<'a> Table<'a> {
    /// Returns the first table of a file.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if it is invalid.
    pub(super) fn root(file: &'a [u8]) -> Result<Self, Error> {
        let buffer = SliceWithStartOffset { buffer: file, offset_from_start: 0 };
        <Self as TableRead>::from_buffer(buffer, 0).map_err(|error| refused("model", error))
    }

    /// Returns a field, if it exists.
    fn get<T: TableRead<'a>>(&self, field: usize, name: &'static str) -> Result<Option<T>, Error> {
        self.0.access(field, name, "field").map_err(|error| {
            let place = format!("{name} at byte {}", error.source_location.byte_offset);
            refused(place, error.error_kind)
        })
    }

    /// Returns a number, or its default if it is missing.
    pub(super) fn number<T: TableRead<'a> + Default>(
        &self,
        field: usize,
        name: &'static str,
    ) -> Result<T, Error> {
        self.get(field, name).map(Option::unwrap_or_default)
    }

    /// Returns a table within the table.
    pub(super) fn table(&self, field: usize, name: &'static str) -> Result<Option<Self>, Error> {
        self.get(field, name)
    }

    /// Returns numbers, or none if they are missing.
    pub(super) fn numbers<T: VectorRead<'a>>(
        &self,
        field: usize,
        name: &'static str,
    ) -> Result<Vector<'a, T>, Error> {
        let vector = self.get(field, name)?;
        Ok(vector.unwrap_or_else(Vector::new_empty))
    }

    /// Returns bytes, or none if they are missing.
    pub(super) fn bytes(&self, field: usize, name: &'static str) -> Result<&'a [u8], Error> {
        self.number(field, name)
    }

    /// Returns tables, or none if they are missing.
    pub(super) fn tables(&self, field: usize, name: &'static str) -> Result<Tables<'a>, Error> {
        let tables = self.get::<Tables<'a>>(field, name)?;
        let none = SliceWithStartOffset { buffer: &[], offset_from_start: 0 };
        Ok(tables.unwrap_or(Tables { offsets: none, count: 0 }))
    }
}

/// A vector of tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tables<'a> {
    /// The bytes from the first offset to the end of the file.
    offsets: SliceWithStartOffset<'a>,
    count: usize,
}

impl<'a> TableRead<'a> for Tables<'a> {
    fn from_buffer(buffer: SliceWithStartOffset<'a>, offset: usize) -> Result<Self, ErrorKind> {
        // Read as a vector of numbers, whose length is checked.
        let count = Vector::<u32>::from_buffer(buffer, offset)?.len();
        let start = <u32 as TableRead>::from_buffer(buffer, offset)? as usize;
        let offsets = buffer.advance(offset)?.advance(start)?.advance(size_of::<u32>())?;
        Ok(Self { offsets, count })
    }
}

impl<'a> Tables<'a> {
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Returns the table of this number.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] if there is no such table, or it is invalid.
    pub(super) fn get(&self, index: usize, name: &str) -> Result<Table<'a>, Error> {
        if index >= self.count {
            let problem = format!("there are {} of them", self.count);
            return Err(refused(format_args!("{name} {index}"), problem));
        }
        let table = Table::from_buffer(self.offsets, index * size_of::<u32>());
        table.map_err(|error| refused(format_args!("{name} {index}"), error))
    }
}
