use thiserror::Error;

/// What can be wrong with a request to this crate.
///
/// Lengths are in metres and positions in the person's frame unless a variant says otherwise.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{name} is {value}: give a finite number")]
    NotFinite {
        /// The quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number lies outside the interval that makes sense for it.
    #[error("{name} is {value} {unit}: it must lie in [{min}, {max}] {unit}")]
    OutOfRange {
        /// The quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Smallest value allowed.
        min: f64,
        /// Largest value allowed.
        max: f64,
        /// Unit of the three numbers.
        unit: &'static str,
    },
    /// Body heights that must increase from the floor up do not.
    #[error("{lower} ({lower_value} m) must be below {upper} ({upper_value} m)")]
    HeightOrder {
        /// Name of the landmark that must be lower.
        lower: &'static str,
        /// Its height.
        lower_value: f64,
        /// Name of the landmark that must be higher.
        upper: &'static str,
        /// Its height.
        upper_value: f64,
    },
    /// The hand cannot be there.
    #[error("the hand cannot be at ({x:.3}, {y:.3}, {z:.3}) m: {reason}")]
    Unreachable {
        /// Requested hand position, person's frame.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
        /// Why not.
        reason: Unreachable,
    },
    /// The map knows nothing about this hand position.
    #[error("({x:.3}, {y:.3}, {z:.3}) m is outside the map's domain: ask `contains` first")]
    OutOfDomain {
        /// Requested hand position, person's frame.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
    },
    /// Too few samples for what is asked of them.
    #[error("{what} needs at least {needed} samples and got {found}: widen the region or add data")]
    TooFewSamples {
        /// What was to be computed.
        what: &'static str,
        /// Smallest workable number.
        needed: usize,
        /// Number given.
        found: usize,
    },
    /// The samples do not determine a quadratic, for example because they all lie in one plane.
    #[error(
        "the samples do not determine a quadratic in three dimensions: spread them in x, y and z"
    )]
    DegenerateSamples,
    /// A Hessian is not symmetric.
    #[error("the Hessian differs from its transpose by {asymmetry}: symmetrise it")]
    NotSymmetric {
        /// A difference between mirrored entries, beyond 1e-9 of √(Hᵢᵢ Hⱼⱼ).
        asymmetry: f64,
    },
    /// A Hessian is not positive semidefinite.
    #[error(
        "the Hessian, scaled to ones on its diagonal, has the eigenvalue {eigenvalue}: all must be at least 0"
    )]
    NotConvex {
        /// The smallest eigenvalue of the matrix Hᵢⱼ / √(Hᵢᵢ Hⱼⱼ); negative infinity where a diagonal entry
        /// leaves no room for the others in its row.
        eigenvalue: f64,
    },
    /// A map file cannot be read or written.
    #[error("{path}: {kind}")]
    Io {
        /// The file.
        path: String,
        /// What the operating system says.
        kind: std::io::ErrorKind,
    },
    /// A file or byte string is not a usable map.
    #[error("not a usable ergonomics map: {0}")]
    MapFile(MapFileProblem),
    /// A table of recorded samples is malformed.
    #[error("line {line}, column {column:?}: {problem}")]
    Samples {
        /// Line of the table, the header being 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// A region of space is empty.
    #[error("{name}: {axis} runs from {min} to {max}: the minimum must be below the maximum")]
    EmptyRegion {
        /// The region.
        name: &'static str,
        /// The axis on which it is empty.
        axis: char,
        /// Its minimum there.
        min: f64,
        /// Its maximum there.
        max: f64,
    },
    /// A grid would have more nodes than is sensible.
    #[error("the grid would have {nodes} nodes, more than {max}: use a coarser spacing")]
    GridTooLarge {
        /// Nodes asked for.
        nodes: f64,
        /// Nodes allowed.
        max: usize,
    },
}

/// What is wrong with a map file.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum MapFileProblem {
    /// The first eight bytes are not those of a map.
    #[error("it does not start with the mark of a map file")]
    Foreign,
    /// The format is another version's.
    #[error("its format has version {found}; this program reads version {supported}")]
    Version {
        /// Version of the file.
        found: u32,
        /// Version that can be read.
        supported: u32,
    },
    /// The file has another length than its header announces.
    #[error("it has {found} bytes where {expected} are announced: it was cut or extended")]
    Length {
        /// Bytes announced.
        expected: u64,
        /// Bytes there.
        found: u64,
    },
    /// The contents changed since the file was written.
    #[error("its checksum is {found:#010x} where {expected:#010x} is stored: it was damaged")]
    Checksum {
        /// Checksum stored in the file.
        expected: u32,
        /// Checksum of the contents.
        found: u32,
    },
    /// A field holds what no map has.
    #[error("its {field} makes no sense")]
    Field {
        /// The field.
        field: &'static str,
    },
}

/// Why the hand cannot be somewhere.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Unreachable {
    /// The joints' limits keep the hand away from the target.
    #[error("the closest posture leaves it {distance:.4} m away")]
    TooFar {
        /// Distance left between hand and target \[m\].
        distance: f64,
    },
    /// The hand can get there but not in the wanted orientation.
    #[error("the closest posture leaves its orientation {angle:.3} rad away")]
    Orientation {
        /// Angle left between the hand's orientation and the wanted one \[rad\].
        angle: f64,
    },
    /// The person would fall: with the centre of mass at heel or toe, the hand is not there yet.
    #[error("the closest posture in balance leaves it {distance:.4} m away")]
    Balance {
        /// Distance left between hand and target \[m\].
        distance: f64,
    },
    /// The point lies inside the person's own trunk.
    #[error("it lies inside the person's trunk")]
    InsideBody,
}

/// The crate's result.
pub(crate) type Result<T> = core::result::Result<T, Error>;

/// The value itself if it is finite.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::NotFinite { name, value }) }
}

/// The value itself if it is an angle of at most a full turn: more is degrees by mistake.
pub(crate) fn angle(name: &'static str, value: f64) -> Result<f64> {
    use core::f64::consts::TAU;
    within(name, value, [-TAU, TAU], "rad")
}

/// The value itself if it is finite and within the interval.
pub(crate) fn within(
    name: &'static str,
    value: f64,
    [min, max]: [f64; 2],
    unit: &'static str,
) -> Result<f64> {
    finite(name, value)?;
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(Error::OutOfRange { name, value, min, max, unit })
    }
}
