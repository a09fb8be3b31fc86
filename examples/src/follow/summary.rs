//! A run in a few numbers.

use std::fmt;

use serde::Serialize;

use super::limits::Margins;

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Simulated time \[s\].
    pub duration: f64,
    /// Time in which person and robot worked together \[s\].
    pub together: f64,
    /// Mean of e_s while working together \[-\].
    pub score_mean: f64,
    /// Greatest e_s while working together \[-\].
    pub score_max: f64,
    /// Mean of the integer REBA while working together \[-\].
    pub reba_mean: f64,
    /// Greatest integer REBA while working together \[-\].
    pub reba_max: u8,
    /// Root mean square of the distance from the actual to the desired position \[mm\].
    pub tracking_error_rms_mm: f64,
    /// Time of working together with x_d out of the shared workspace by over a millimetre or
    /// milliradian \[s\].
    pub outside: f64,
    /// Time of working together in which the person's hand could not reach the tool \[s\].
    pub out_of_reach: f64,
    /// The worst margins.
    pub margins: Margins,
    /// Ticks with a violated limit or a command that was not finite.
    pub limit_violations: u64,
    /// Ticks whose hierarchy was not solved to its optimum.
    pub solver_failures: u64,
    /// Median, 99th percentile and maximum of the controller's time a tick \[µs\].
    pub tick_us: [f64; 3],
    /// Time that the loop took \[s\].
    pub wall: f64,
}

/// Ergonomics on and off, side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// With ergonomics on the third level.
    pub on: Summary,
    /// With the benchmark min ‖ẋ_d‖² there.
    pub off: Summary,
}

/// The one line of `--json`.
#[derive(Debug, Serialize)]
struct Line {
    score_mean_on: f64,
    score_mean_off: f64,
    reba_max_on: u8,
    reba_max_off: u8,
    tracking_error_rms_mm: f64,
    limit_violations: u64,
    solver_failures: u64,
    tick_us_p50: f64,
    tick_us_p99: f64,
    tick_us_max: f64,
    speedup: f64,
}

impl Comparison {
    /// Simulated seconds a wall second, both runs counted.
    pub fn speedup(&self) -> f64 {
        (self.on.duration + self.off.duration) / (self.on.wall + self.off.wall)
    }

    /// The summary as one JSON object in one line; of both runs the worse, where there is no
    /// key for each.
    ///
    /// # Errors
    /// None for finite numbers.
    pub fn json(&self) -> serde_json::Result<String> {
        let (on, off) = (&self.on, &self.off);
        serde_json::to_string(&Line {
            score_mean_on: on.score_mean,
            score_mean_off: off.score_mean,
            reba_max_on: on.reba_max,
            reba_max_off: off.reba_max,
            tracking_error_rms_mm: on.tracking_error_rms_mm.max(off.tracking_error_rms_mm),
            limit_violations: on.limit_violations + off.limit_violations,
            solver_failures: on.solver_failures + off.solver_failures,
            tick_us_p50: on.tick_us[0].max(off.tick_us[0]),
            tick_us_p99: on.tick_us[1].max(off.tick_us[1]),
            tick_us_max: on.tick_us[2].max(off.tick_us[2]),
            speedup: self.speedup(),
        })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (on, off) = (&self.on, &self.off);
        let mut row = |name: &str, a: String, b: String| writeln!(f, "{name:<42}{a:>12}{b:>12}");
        row("ergonomics", "on".into(), "off".into())?;
        let mut number = |name: &str, digits: usize, a: f64, b: f64| {
            // Adding zero drops the sign of a zero that rounding has left.
            let round = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
            row(name, format!("{:.digits$}", round(a)), format!("{:.digits$}", round(b)))
        };
        number("e_s mean (0 good, 4.25 bad)", 2, on.score_mean, off.score_mean)?;
        number("e_s maximum", 2, on.score_max, off.score_max)?;
        number("REBA mean (1 good, 15 bad)", 1, on.reba_mean, off.reba_mean)?;
        number("REBA maximum", 0, f64::from(on.reba_max), f64::from(off.reba_max))?;
        number(
            "tracking error, root mean square [mm]",
            3,
            on.tracking_error_rms_mm,
            off.tracking_error_rms_mm,
        )?;
        number("working together [s]", 1, on.together, off.together)?;
        number("  of it outside the shared workspace [s]", 1, on.outside, off.outside)?;
        number("  of it tool out of reach [s]", 1, on.out_of_reach, off.out_of_reach)?;
        number(
            "worst position margin [%]",
            1,
            100.0 * on.margins.position,
            100.0 * off.margins.position,
        )?;
        number(
            "worst velocity margin [%]",
            1,
            100.0 * on.margins.velocity,
            100.0 * off.margins.velocity,
        )?;
        number(
            "worst acceleration margin [%]",
            1,
            100.0 * on.margins.acceleration,
            100.0 * off.margins.acceleration,
        )?;
        #[expect(clippy::cast_precision_loss, reason = "counts of ticks are small")]
        {
            number(
                "ticks with a violated limit",
                0,
                on.limit_violations as f64,
                off.limit_violations as f64,
            )?;
            number("ticks not solved", 0, on.solver_failures as f64, off.solver_failures as f64)?;
        }
        number("tick, median [µs]", 1, on.tick_us[0], off.tick_us[0])?;
        number("tick, 99th percentile [µs]", 1, on.tick_us[1], off.tick_us[1])?;
        number("tick, maximum [µs]", 1, on.tick_us[2], off.tick_us[2])?;
        write!(f, "{:.0} simulated seconds a wall second", self.speedup())
    }
}
