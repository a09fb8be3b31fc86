//! Maps as files.
//!
//! Little-endian. Mark `ERGOMAP\0` (8 bytes); version u32 = 1; side u8 (0 left, 1 right); mode u8
//! (0 graded, 1 faithful); two zero bytes; half width of the faithful mode f64 (0 if graded);
//! stature f64; origin of the grid, x y z, f64, and spacing f64, in statures; nodes along x, y and
//! z, u32; number of reachable nodes u32. Then each node, x slowest, z fastest: one byte, 1 if
//! reachable; if so its score f64 and its fifteen joint angles f64. Last, CRC-32 (IEEE 802.3) of
//! everything before, u32.

use std::path::Path;

use nalgebra::Vector3;

use super::ErgonomicsMap;
use super::grid::{Grid, MAX_NODES};
use crate::error::{Error, MapFileProblem, Result};
use crate::joints::{DOF, JointAngles};
use crate::person::Person;
use crate::reba::Mode;
use crate::side::Side;

const MARK: [u8; 8] = *b"ERGOMAP\0";
const VERSION: u32 = 1;
/// Bytes before the nodes.
const HEADER: usize = 8 + 4 + 4 + 8 + 8 + 4 * 8 + 4 * 4;
/// Bytes of a reachable node after its flag.
const NODE: usize = 8 * (1 + DOF);
/// Largest value of `e_s`.
const WORST: f64 = 4.25;

impl ErgonomicsMap {
    /// Writes the map to a file; the book's page on this crate describes the format.
    ///
    /// # Errors
    /// [`Error::Io`] with the path.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.to_bytes()).map_err(|error| io(path, &error))
    }

    /// Reads a map from a file.
    ///
    /// # Errors
    /// [`Error::Io`] with the path; [`Error::MapFile`] with what is wrong in the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::from_bytes(&std::fs::read(path).map_err(|error| io(path, &error))?)
    }

    /// The map as the bytes of a map file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEADER + self.scores.len() * (NODE + 1) + 4);
        out.extend(MARK);
        out.extend(VERSION.to_le_bytes());
        let (mode, half_width) = match self.mode {
            Mode::Graded => (0, 0.0),
            Mode::Faithful { half_width } => (1, half_width),
        };
        out.extend([u8::from(self.side == Side::Right), mode, 0, 0]);
        let numbers = [half_width, self.stature];
        let grid = [self.grid.origin.x, self.grid.origin.y, self.grid.origin.z, self.grid.spacing];
        out.extend(numbers.into_iter().chain(grid).flat_map(f64::to_le_bytes));
        // At most MAX_NODES.
        #[allow(clippy::cast_possible_truncation)]
        let counts = self.grid.size.into_iter().chain([self.len()]).map(|n| n as u32);
        out.extend(counts.flat_map(u32::to_le_bytes));
        for (score, angles) in self.scores.iter().zip(&self.angles) {
            out.push(u8::from(!score.is_nan()));
            if !score.is_nan() {
                out.extend([*score].iter().chain(angles).copied().flat_map(f64::to_le_bytes));
            }
        }
        let sum = crc32(&out);
        out.extend(sum.to_le_bytes());
        out
    }

    /// The map from the bytes of a map file.
    ///
    /// # Errors
    /// [`Error::MapFile`] with what is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let mut reader = Reader { rest: bytes, all: bytes.len() };
        if reader.take::<8>().ok() != Some(MARK) {
            return Err(Error::MapFile(MapFileProblem::Foreign));
        }
        let version = reader.u32()?;
        if version != VERSION {
            let problem = MapFileProblem::Version { found: version, supported: VERSION };
            return Err(Error::MapFile(problem));
        }
        let [side, mode, _, _] = reader.take::<4>()?;
        let (half_width, stature) = (reader.f64()?, reader.f64()?);
        let origin = Vector3::new(reader.f64()?, reader.f64()?, reader.f64()?);
        let spacing = reader.f64()?;
        let counts = [reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?];
        let [nx, ny, nz, reachable] = counts.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let nodes = nx.saturating_mul(ny).saturating_mul(nz);
        // Before anything is allocated: the file must be as long as it says.
        let expected =
            reachable.saturating_mul(NODE).saturating_add(nodes).saturating_add(HEADER + 4);
        if expected != bytes.len() {
            return Err(length(expected, bytes.len()));
        }
        let (contents, sum) = bytes.split_at(bytes.len() - 4);
        let stored = Reader { rest: sum, all: bytes.len() }.u32()?;
        let found = crc32(contents);
        if stored != found {
            return Err(Error::MapFile(MapFileProblem::Checksum { expected: stored, found }));
        }

        let side = match side {
            0 => Side::Left,
            1 => Side::Right,
            _ => return Err(field("side")),
        };
        let mode = match mode {
            0 => Mode::Graded,
            1 if half_width > 0.0 && half_width <= 0.5 => Mode::Faithful { half_width },
            _ => return Err(field("scoring mode")),
        };
        Person::new(stature).map_err(|_| field("stature"))?;
        if !origin.iter().all(|x| x.abs() < 100.0) {
            return Err(field("origin"));
        }
        if !(1e-3..=0.5).contains(&spacing) {
            return Err(field("spacing"));
        }
        if [nx, ny, nz].into_iter().any(|n| n < 2) || nodes > MAX_NODES {
            return Err(field("size"));
        }
        let (scores, angles) = reader.nodes(nodes)?;
        let grid = Grid { origin, spacing, size: [nx, ny, nz] };
        let map = Self { stature, side, mode, grid, scores, angles };
        if map.len() == reachable { Ok(map) } else { Err(field("number of reachable nodes")) }
    }
}

/// What is left to read.
struct Reader<'a> {
    rest: &'a [u8],
    all: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (head, rest) =
            self.rest.split_first_chunk::<N>().ok_or_else(|| length(HEADER + 4, self.all))?;
        self.rest = rest;
        Ok(*head)
    }

    fn u32(&mut self) -> Result<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn nodes(&mut self, nodes: usize) -> Result<(Vec<f64>, Vec<[f64; JointAngles::LEN]>)> {
        let mut scores = Vec::with_capacity(nodes);
        let mut angles = Vec::with_capacity(nodes);
        for _ in 0..nodes {
            let [reachable] = self.take::<1>()?;
            let mut node = [0.0; DOF];
            let mut score = f64::NAN;
            match reachable {
                0 => {}
                1 => {
                    score = self.f64()?;
                    for angle in &mut node {
                        *angle = self.f64()?;
                    }
                    if !(0.0..=WORST).contains(&score) {
                        return Err(field("score of a node"));
                    }
                    if !node.iter().all(|angle| angle.abs() <= core::f64::consts::TAU) {
                        return Err(field("joint angle of a node"));
                    }
                }
                _ => return Err(field("reachability of a node")),
            }
            scores.push(score);
            angles.push(node);
        }
        Ok((scores, angles))
    }
}

fn io(path: &Path, error: &std::io::Error) -> Error {
    Error::Io { path: path.display().to_string(), kind: error.kind() }
}

fn field(field: &'static str) -> Error {
    Error::MapFile(MapFileProblem::Field { field })
}

fn length(expected: usize, found: usize) -> Error {
    let (expected, found) = (expected as u64, found as u64);
    Error::MapFile(MapFileProblem::Length { expected, found })
}

/// CRC-32 of IEEE 802.3: reflected, polynomial 0x04c11db7.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn crc_of_the_usual_check_string() {
        assert_eq!(super::crc32(b"123456789"), 0xcbf4_3926);
    }
}
