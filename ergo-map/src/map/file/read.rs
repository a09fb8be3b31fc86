//! Reading of maps from bytes. Each field is checked before it is used.

use nalgebra::Vector3;

use super::super::ErgonomicsMap;
use super::super::grid::{Grid, MAX_NODES};
use super::super::nodes::Nodes;
use super::{HEADER, MARK, NODE, PERSON, VERSION};
use crate::error::{Error, Result};
use crate::joints::{DOF, JointAngles, JointRanges};
use crate::person::{Person, Proportions};
use crate::reba::Mode;
use crate::side::Side;

/// Largest value of `e_s`.
const WORST: f64 = 4.25;

/// Returns the length of the file according to the header in its first bytes.
pub(super) fn announced(start: &[u8]) -> Result<usize> {
    let header = Header::read(&mut Reader { rest: start, all: start.len() })?;
    Ok(header.length)
}

impl ErgonomicsMap {
    /// Creates the map from the bytes of a map file, of version 1 or 2 of the format.
    ///
    /// # Errors
    /// [`Error::MapFile`] with the fault.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let mut reader = Reader { rest: bytes, all: bytes.len() };
        let header = Header::read(&mut reader)?;
        // The file must have the announced length before anything is allocated.
        if header.length != bytes.len() {
            return Err(length(header.length, bytes.len()));
        }
        let (contents, sum) = bytes.split_at(bytes.len() - size_of::<u32>());
        let stored = Reader { rest: sum, all: bytes.len() }.u32()?;
        let found = crc32fast::hash(contents);
        if stored != found {
            return Err(unusable(format!(
                "its checksum is {found:#010x} where {stored:#010x} is stored: it was damaged"
            )));
        }
        let reachable = header.reachable;
        let (side, mode) = (header.side()?, header.mode()?);
        let (person, grid) = (header.person()?, header.grid()?);
        let mut nodes = Nodes::with_capacity(grid.len(), reachable);
        for _ in 0..grid.len() {
            nodes.push(reader.node()?);
            if nodes.reachable() > reachable {
                return Err(field("number of reachable nodes"));
            }
        }
        let map = Self { person, side, mode, grid, nodes };
        if map.len() == reachable { Ok(map) } else { Err(field("number of reachable nodes")) }
    }
}

/// The fields before the nodes, unconverted.
struct Header {
    /// Length of the whole file (bytes).
    length: usize,
    flags: [u8; 4],
    half_width: f64,
    person: Vec<f64>,
    origin: Vector3<f64>,
    spacing: f64,
    size: [usize; 3],
    reachable: usize,
}

impl Header {
    fn read(reader: &mut Reader) -> Result<Self> {
        if reader.take::<8>().ok() != Some(MARK) {
            return Err(unusable("it does not start with the mark of a map file".into()));
        }
        let found = reader.u32()?;
        let numbers = match found.checked_sub(1).and_then(|version| usize::try_from(version).ok()) {
            Some(version) => PERSON.get(version).copied(),
            None => None,
        };
        let Some(numbers) = numbers else {
            return Err(unusable(format!(
                "its format has version {found}; this program reads version {VERSION}"
            )));
        };
        let (flags, half_width) = (reader.take()?, reader.f64()?);
        let person = (0..numbers).map(|_| reader.f64()).collect::<Result<Vec<_>>>()?;
        let origin = Vector3::new(reader.f64()?, reader.f64()?, reader.f64()?);
        let spacing = reader.f64()?;
        let counts = [reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?];
        let [nx, ny, nz, reachable] = counts.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let nodes = nx.saturating_mul(ny).saturating_mul(nz);
        if nodes > MAX_NODES || [nx, ny, nz].into_iter().any(|n| n < 2) {
            return Err(field("size"));
        }
        if reachable > nodes {
            return Err(field("number of reachable nodes"));
        }
        let length = HEADER + 8 * numbers + nodes + reachable * NODE + size_of::<u32>();
        let size = [nx, ny, nz];
        Ok(Self { length, flags, half_width, person, origin, spacing, size, reachable })
    }

    fn side(&self) -> Result<Side> {
        match self.flags {
            [0, ..] => Ok(Side::Left),
            [1, ..] => Ok(Side::Right),
            _ => Err(field("side")),
        }
    }

    fn mode(&self) -> Result<Mode> {
        let half_width = self.half_width;
        match self.flags {
            [_, 0, ..] => Ok(Mode::Graded),
            [_, 1, ..] if half_width > 0.0 && half_width <= 0.5 => {
                Ok(Mode::Faithful { half_width })
            }
            _ => Err(field("scoring mode")),
        }
    }

    fn person(&self) -> Result<Person> {
        let mut numbers = self.person.iter().copied();
        let person = Person::new(numbers.next().unwrap_or_default());
        let person = person.map_err(|_| field("stature"))?;
        let Some(mass) = numbers.next() else { return Ok(person) };
        let person = person.with_mass(mass).map_err(|_| field("mass"))?;
        let proportions = Proportions::from_array(array(&mut numbers));
        let person = person.with_proportions(proportions).ok_or_else(|| field("segments"))?;
        let [min, max] = [(); 2].map(|()| JointAngles::from_array(array(&mut numbers)));
        person.with_ranges(JointRanges { min, max }).map_err(|_| field("ranges of motion"))
    }

    fn grid(&self) -> Result<Grid> {
        let Self { origin, spacing, size, .. } = *self;
        if !origin.iter().all(|x| x.abs() < 100.0) {
            return Err(field("origin"));
        }
        if !(1e-3..=0.5).contains(&spacing) {
            return Err(field("spacing"));
        }
        Ok(Grid { origin, spacing, size })
    }
}

/// Returns the next numbers. Missing ones are NaN, which no field accepts.
fn array<const N: usize>(numbers: &mut impl Iterator<Item = f64>) -> [f64; N] {
    core::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN))
}

/// The bytes that are still to be read.
struct Reader<'a> {
    rest: &'a [u8],
    all: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (head, rest) = self
            .rest
            .split_first_chunk::<N>()
            .ok_or_else(|| length(HEADER + size_of::<u32>(), self.all))?;
        self.rest = rest;
        Ok(*head)
    }

    fn u32(&mut self) -> Result<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f64(&mut self) -> Result<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn node(&mut self) -> Result<Option<(f64, [f64; DOF])>> {
        match self.take::<1>()? {
            [0] => Ok(None),
            [1] => {
                let score = self.f64()?;
                let mut angles = [0.0; DOF];
                for angle in &mut angles {
                    *angle = self.f64()?;
                }
                if !(0.0..=WORST).contains(&score) {
                    return Err(field("score of a node"));
                }
                if !angles.iter().all(|angle| angle.abs() <= core::f64::consts::TAU) {
                    return Err(field("joint angle of a node"));
                }
                Ok(Some((score, angles)))
            }
            _ => Err(field("reachability of a node")),
        }
    }
}

fn field(field: &'static str) -> Error {
    unusable(format!("its {field} makes no sense"))
}

fn length(expected: usize, found: usize) -> Error {
    unusable(format!("it has {found} bytes where {expected} are announced: it was cut or extended"))
}

fn unusable(problem: String) -> Error {
    Error::MapFile { problem }
}
