//! Every tick as a line of comma-separated values.

use std::io::Write;

use super::{ReportError, TickRow};

/// Joints of MOCA with their units, for [`TickTable::new`].
pub const MOCA_COLUMNS: [(&str, &str); 10] = [
    ("base_x", "m"),
    ("base_y", "m"),
    ("base_yaw", "rad"),
    ("joint1", "rad"),
    ("joint2", "rad"),
    ("joint3", "rad"),
    ("joint4", "rad"),
    ("joint5", "rad"),
    ("joint6", "rad"),
    ("joint7", "rad"),
];

/// Writes a header with names and units, then a line for each tick.
///
/// ```
/// use moca_replay::report::{TickRow, TickTable};
///
/// let mut table = TickTable::new(Vec::new(), &[])?;
/// table.write(&TickRow { time: 0.5, reba: 3, ..TickRow::default() })?;
/// let text = String::from_utf8(table.finish()?).expect("ASCII");
/// assert_eq!(text.lines().count(), 2);
/// # Ok::<(), moca_replay::report::ReportError>(())
/// ```
#[derive(Debug)]
pub struct TickTable<W: Write> {
    writer: csv::Writer<W>,
    joints: usize,
    cell: Vec<u8>,
}

impl<W: Write> TickTable<W> {
    /// Writes the header. `joints` has names and units, `m` or `rad`.
    ///
    /// # Errors
    /// [`ReportError::Table`]
    pub fn new(output: W, joints: &[(&str, &str)]) -> Result<Self, ReportError> {
        let mut writer = csv::Writer::from_writer(output);
        writer.write_record(header(joints))?;
        Ok(Self { writer, joints: joints.len(), cell: Vec::new() })
    }

    /// Writes a tick with six decimals: micrometres and microradians.
    ///
    /// # Errors
    /// [`ReportError::Table`]; [`ReportError::Size`] if the number of joints differs from the header. Nothing is
    /// written then.
    pub fn write(&mut self, row: &TickRow) -> Result<(), ReportError> {
        let TickRow { desired, actual, workspace_min, workspace_max, q, qdot, slack, .. } = row;
        for (what, got) in [("the q of a row", q.len()), ("the q̇ of a row", qdot.len())] {
            if got != self.joints {
                return Err(ReportError::Size { what, got, wanted: self.joints });
            }
        }
        self.number(row.time)?;
        for value in [desired, actual, workspace_min, workspace_max].into_iter().flatten() {
            self.number(*value)?;
        }
        self.number(row.score)?;
        self.cell(format_args!("{}", row.reba))?;
        match row.reba_measured {
            Some(reba) => self.cell(format_args!("{reba}"))?,
            None => self.cell(format_args!(""))?,
        }
        self.cell(format_args!("{}", u8::from(row.collaborating)))?;
        for value in q.iter().chain(qdot).chain(slack) {
            self.number(*value)?;
        }
        self.cell(format_args!("{:.1}", row.solve_time_us))?;
        // An empty record ends the line of single fields.
        self.writer.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// Flushes the output and returns it.
    ///
    /// # Errors
    /// [`ReportError::Table`]
    pub fn finish(self) -> Result<W, ReportError> {
        self.writer.into_inner().map_err(|error| csv::Error::from(error.into_error()).into())
    }

    fn number(&mut self, value: f64) -> Result<(), ReportError> {
        self.cell(format_args!("{value:.6}"))
    }

    fn cell(&mut self, text: std::fmt::Arguments<'_>) -> Result<(), ReportError> {
        self.cell.clear();
        self.cell.write_fmt(text).map_err(csv::Error::from)?;
        Ok(self.writer.write_field(&self.cell)?)
    }
}

fn header(joints: &[(&str, &str)]) -> Vec<String> {
    let axes = |of: &'static str| ["x", "y", "z"].map(|axis| format!("{of}_{axis}_m"));
    let q = joints.iter().map(|(joint, unit)| format!("q_{joint}_{unit}"));
    let qdot = joints.iter().map(|(joint, unit)| format!("qdot_{joint}_{unit}_s"));
    let turn = ["rx", "ry", "rz"].map(|axis| format!("slack_{axis}_rad"));
    std::iter::once("time_s".to_owned())
        .chain(["desired", "actual", "workspace_min", "workspace_max"].into_iter().flat_map(axes))
        .chain(["score", "reba", "reba_measured", "collaborating"].map(str::to_owned))
        .chain(q)
        .chain(qdot)
        .chain(axes("slack"))
        .chain(turn)
        .chain(["solve_time_us".to_owned()])
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn every_number_is_under_its_name() {
        let row = TickRow {
            time: 1.5,
            desired: [1.0, 2.0, 3.0],
            actual: [4.0, 5.0, 6.0],
            workspace_min: [f64::NAN; 3],
            workspace_max: [7.0, 8.0, 9.0],
            score: 0.25,
            reba: 4,
            reba_measured: Some(5),
            collaborating: true,
            q: (0..10).map(|joint| 10.0 + f64::from(joint)).collect(),
            qdot: (0..10).map(|joint| -f64::from(joint) - 0.5).collect(),
            slack: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
            solve_time_us: 31.25,
        };
        let mut table = TickTable::new(Vec::new(), &MOCA_COLUMNS).unwrap();
        table.write(&row).unwrap();
        let rest = vec![0.0; 10];
        table.write(&TickRow { q: rest.clone(), qdot: rest, ..TickRow::default() }).unwrap();
        assert!(table.write(&TickRow::default()).is_err(), "no joints");
        let bytes = table.finish().unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let names = reader.headers().unwrap().clone();
        let records: Vec<_> = reader.records().collect::<Result<_, _>>().unwrap();
        assert_eq!((names.len(), records.len()), (44, 2));
        let cell = |name: &str| {
            let column = names.iter().position(|found| found == name).unwrap();
            records[0][column].parse::<f64>().unwrap()
        };
        for (name, value) in [
            ("time_s", 1.5),
            ("desired_y_m", 2.0),
            ("actual_z_m", 6.0),
            ("workspace_max_x_m", 7.0),
            ("score", 0.25),
            ("reba", 4.0),
            ("reba_measured", 5.0),
            ("collaborating", 1.0),
            ("q_base_yaw_rad", 12.0),
            ("q_joint1_rad", 13.0),
            ("qdot_base_x_m_s", -0.5),
            ("qdot_joint7_rad_s", -9.5),
            ("slack_z_m", 0.3),
            ("slack_rx_rad", 0.4),
            ("solve_time_us", 31.2),
        ] {
            assert!((cell(name) - value).abs() < 1e-6, "{name} is {}", cell(name));
        }
        assert!(cell("workspace_min_x_m").is_nan());
    }
}
