//! Map files.
//!
//! All numbers are little-endian. The header is: mark `ERGOMAP\0` (8 bytes), version u32 = 2, side
//! u8 (0 left, 1 right), mode u8 (0 graded, 1 faithful), and two zero bytes. Then comes the half
//! width of the faithful mode f64 (0 if graded).
//!
//! The person follows, in f64: stature, mass, ten segments as fractions of stature in the order of
//! [`crate::Segments`], then the smallest and the largest angles of the fifteen joints. The grid
//! has an origin x y z f64 and a spacing f64, in statures. The numbers of nodes along x, y and z
//! and of reachable nodes are u32.
//!
//! The nodes follow, x slowest, z fastest. A node is one byte, 1 if reachable. A reachable node
//! then has its score f64 and its fifteen joint angles f64. The last field is a CRC-32 (IEEE 802.3)
//! u32 of everything before.
//!
//! Version 1 contains only the stature of the person, who has average proportions.

mod read;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::ErgonomicsMap;
use crate::error::{Error, Result};
use crate::joints::DOF;
use crate::person::SEGMENTS;
use crate::reba::Mode;
use crate::side::Side;

const MARK: [u8; 8] = *b"ERGOMAP\0";
const VERSION: u32 = 2;
/// Number of the person's values in version 1 and in version 2.
const PERSON: [usize; 2] = [1, 2 + SEGMENTS + 2 * DOF];
/// Bytes before the nodes, without those of the person.
const HEADER: usize = 8 + 4 + 4 + 8 + 4 * 8 + 4 * 4;
/// Bytes of a reachable node after its flag.
const NODE: usize = 8 * (1 + DOF);

impl ErgonomicsMap {
    /// Writes the map to a file. The book's page on this crate describes the format.
    ///
    /// # Errors
    /// [`Error::Io`] with the path.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.to_bytes()).map_err(|error| io(path, &error))
    }

    /// Reads a map from a file. It reads the header first, and at most as much as that announces.
    /// An endless device or a large file of another kind is therefore not read to its end.
    ///
    /// # Errors
    /// [`Error::Io`] with the path. [`Error::MapFile`] with the fault in the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let mut file = File::open(path).map_err(|error| io(path, &error))?;
        let mut bytes = Vec::new();
        let mut read = |limit: usize, bytes: &mut Vec<u8>| {
            let left = limit.saturating_sub(bytes.len()) as u64;
            let read = file.by_ref().take(left).read_to_end(bytes);
            read.map(drop).map_err(|error| io(path, &error))
        };
        read(HEADER + 8 * PERSON[1], &mut bytes)?;
        let announced = read::announced(&bytes)?;
        // One extra byte shows whether the file is too long.
        read(announced.saturating_add(1), &mut bytes)?;
        Self::from_bytes(&bytes)
    }

    /// Returns the bytes of a map file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let (mode, half_width) = match self.mode {
            Mode::Graded => (0, 0.0),
            Mode::Faithful { half_width } => (1, half_width),
        };
        let mut out = Vec::with_capacity(
            HEADER + 8 * PERSON[1] + self.grid.len() + self.len() * NODE + size_of::<u32>(),
        );
        out.extend(MARK);
        out.extend(VERSION.to_le_bytes());
        out.extend([u8::from(self.side == Side::Right), mode, 0, 0]);
        let person = &self.person;
        let ranges = [person.ranges().min.to_array(), person.ranges().max.to_array()];
        let grid = [self.grid.origin.x, self.grid.origin.y, self.grid.origin.z, self.grid.spacing];
        let numbers = [half_width, person.stature(), person.mass()]
            .into_iter()
            .chain(person.proportions().to_array())
            .chain(ranges.into_iter().flatten())
            .chain(grid);
        out.extend(numbers.flat_map(f64::to_le_bytes));
        // The numbers are at most `MAX_NODES`.
        #[allow(clippy::cast_possible_truncation)]
        let counts = self.grid.size.into_iter().chain([self.len()]).map(|n| n as u32);
        out.extend(counts.flat_map(u32::to_le_bytes));
        for node in self.nodes.iter() {
            out.push(u8::from(node.is_some()));
            if let Some((score, angles)) = node {
                out.extend([score].iter().chain(angles).copied().flat_map(f64::to_le_bytes));
            }
        }
        let sum = crc32fast::hash(&out);
        out.extend(sum.to_le_bytes());
        out
    }
}

fn io(path: &Path, error: &std::io::Error) -> Error {
    Error::Io { path: path.display().to_string(), kind: error.kind() }
}
