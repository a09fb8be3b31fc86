//! Data of a page: one JSON object. Numbers of samples are base64 of little-endian f32 or u16.

use base64::{Engine, engine::general_purpose::STANDARD};
use ergo_map::Side;
use nalgebra::Isometry3;
use serde::Serialize;

use super::Results;
use crate::recorded::{
    BODY_POINTS, BodyPart, Encoding, Group, LIMBS, Lane, MapGrid, Replay, ReplayError, Role, Shape,
    Solid, Table,
};

/// Step that stands for an unknown number.
const UNKNOWN: u16 = u16::MAX;
/// Highest step.
const LAST: f64 = 65534.0;

#[derive(Serialize)]
struct Data<'a> {
    stature: f64,
    side: &'static str,
    points: &'a [&'a str],
    limbs: Vec<LimbData>,
    map: MapData,
    runs: Vec<RunData<'a>>,
    results: &'a Results,
}

#[derive(Serialize)]
struct LimbData {
    ends: [usize; 2],
    radii: [f64; 2],
    /// Index among the columns of "parts".
    part: usize,
    /// Side of an arm: 1 left, -1 right; 0 for other parts.
    side: i8,
}

#[derive(Serialize)]
struct MapData {
    origin: [f64; 3],
    spacing: f64,
    counts: [usize; 3],
    greatest: f64,
    scores: String,
}

#[derive(Serialize)]
struct RunData<'a> {
    title: &'a str,
    solids: Vec<SolidData<'a>>,
    samples: TableData<'a>,
    person: TableData<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    others: Option<TableData<'a>>,
    lanes: &'a [Lane],
}

#[derive(Serialize)]
struct SolidData<'a> {
    name: &'a str,
    role: Role,
    frame: usize,
    position: [f64; 3],
    rotation: [f64; 4],
    shape: Shape,
    colour: [f64; 3],
}

#[derive(Serialize)]
struct TableData<'a> {
    count: usize,
    times: String,
    groups: Vec<GroupData<'a>>,
}

#[derive(Serialize)]
struct GroupData<'a> {
    name: &'a str,
    columns: &'a [String],
    size: usize,
    /// Least value and step of each number of a row, if the group is stored in steps; empty if it is exact.
    low: Vec<f64>,
    step: Vec<f64>,
    data: String,
}

/// Returns the data as JSON that may stand in a script element.
pub(super) fn json(runs: &[&Replay], results: &Results) -> Result<String, ReplayError> {
    let first = runs.first().ok_or(ReplayError::Nothing)?;
    let data = Data {
        stature: first.stature,
        side: if first.side == Side::Left { "left" } else { "right" },
        points: &BODY_POINTS,
        limbs: limbs(),
        map: map(&first.map),
        runs: runs.iter().map(|run| run_data(run)).collect(),
        results,
    };
    // "<" occurs only in texts. A script element ends at the first "</script".
    Ok(serde_json::to_string(&data)?.replace('<', "\\u003c"))
}

fn limbs() -> Vec<LimbData> {
    let sign = |side: Side| if side == Side::Left { 1 } else { -1 };
    let data = LIMBS.iter().map(|limb| {
        let (part, side) = match limb.part {
            BodyPart::Neck => (0, 0),
            BodyPart::Trunk => (1, 0),
            BodyPart::Legs => (2, 0),
            BodyPart::UpperArm(side) => (3, sign(side)),
            BodyPart::LowerArm(side) => (4, sign(side)),
            BodyPart::Wrist(side) => (5, sign(side)),
        };
        LimbData { ends: limb.ends, radii: limb.radii, part, side }
    });
    data.collect()
}

fn map(grid: &MapGrid) -> MapData {
    MapData {
        origin: grid.origin.into(),
        spacing: grid.spacing,
        counts: grid.counts,
        greatest: grid.greatest,
        scores: STANDARD.encode(&grid.scores),
    }
}

fn run_data(run: &Replay) -> RunData<'_> {
    RunData {
        title: &run.title,
        solids: run.stage.solids().iter().map(solid).collect(),
        samples: table(&run.samples),
        person: table(&run.person),
        others: run.others.as_ref().map(table),
        lanes: &run.lanes,
    }
}

fn solid(solid: &Solid) -> SolidData<'_> {
    let Solid { name, role, frame, frame_from_shape, shape, colour } = solid;
    let Isometry3 { rotation, translation } = frame_from_shape;
    SolidData {
        name,
        role: *role,
        frame: *frame,
        position: translation.vector.into(),
        rotation: [rotation.i, rotation.j, rotation.k, rotation.w],
        shape: *shape,
        colour: *colour,
    }
}

fn table(table: &Table) -> TableData<'_> {
    let times = table.times().iter().flat_map(|time| time.to_le_bytes());
    TableData {
        count: table.len(),
        times: STANDARD.encode(times.collect::<Vec<u8>>()),
        groups: table.group_places().map(|(place, group)| encoded(table, place, group)).collect(),
    }
}

fn encoded<'a>(table: &Table, place: usize, group: &'a Group) -> GroupData<'a> {
    let width = group.width();
    let rows = || (0..table.len()).map(|index| table.row(index));
    let rows = || rows().map(|row| row.get(place..place + width).unwrap_or_default());
    let (mut low, mut step, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    match group.encoding {
        Encoding::Exact => {
            bytes.extend(rows().flatten().flat_map(|value| value.to_le_bytes()));
        }
        Encoding::Steps => {
            for column in 0..width {
                let known = rows().filter_map(|row| row.get(column)).filter(|v| v.is_finite());
                let (least, most) = known.fold((f32::INFINITY, f32::NEG_INFINITY), |range, v| {
                    (range.0.min(*v), range.1.max(*v))
                });
                let range = f64::from(most) - f64::from(least);
                low.push(if least.is_finite() { f64::from(least) } else { 0.0 });
                step.push(if range > 0.0 { range / LAST } else { 1.0 });
            }
            for row in rows() {
                let scales = low.iter().zip(&step);
                bytes.extend(row.iter().zip(scales).flat_map(|(value, (low, step))| {
                    stepped(f64::from(*value), *low, *step).to_le_bytes()
                }));
            }
        }
    }
    let data = STANDARD.encode(bytes);
    GroupData { name: group.name, columns: &group.columns, size: group.size, low, step, data }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
fn stepped(value: f64, low: f64, step: f64) -> u16 {
    if value.is_finite() { ((value - low) / step).round().clamp(0.0, LAST) as u16 } else { UNKNOWN }
}
