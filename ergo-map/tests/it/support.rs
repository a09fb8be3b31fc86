//! Helpers of the integration tests: reading golden tables, and reproducible random numbers.

use std::{collections::HashMap, sync::LazyLock};

use ergo_map::{ErgonomicsMap, MapOptions, Person, Posture};

/// Map of the average person with default options, built once.
pub(crate) static MAP: LazyLock<ErgonomicsMap> = LazyLock::new(|| {
    ErgonomicsMap::build(&Person::average(), &MapOptions::default(), None).unwrap()
});

/// Returns the rows of a golden table by column name.
pub(crate) fn rows(
    table: &'static str,
) -> impl Iterator<Item = HashMap<&'static str, &'static str>> {
    let mut lines = table.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    lines.map(move |line| header.iter().copied().zip(line.split(',')).collect())
}

/// Returns a number of a row.
pub(crate) fn number(row: &HashMap<&str, &str>, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// Returns a small integer of a row.
pub(crate) fn whole(row: &HashMap<&str, &str>, name: &str) -> u8 {
    row[name].parse().unwrap()
}

/// Returns a box of a row.
pub(crate) fn ticked(row: &HashMap<&str, &str>, name: &str) -> bool {
    whole(row, name) == 1
}

/// SplitMix64 generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn uniform(&mut self, min: f64, max: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        min + (max - min) * ((z >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Returns a posture from easy to extreme: a uniform one scaled by a uniform severity.
    pub(crate) fn graded_posture(&mut self) -> Posture {
        let severity = self.uniform(0.0, 1.0);
        Posture::from_array(self.posture().to_array().map(|angle| angle * severity))
    }

    /// Returns a posture with every angle uniform over approximately its range of motion.
    pub(crate) fn posture(&mut self) -> Posture {
        const DEGREES: [(f64, f64); Posture::LEN] = [
            (-25.0, 90.0),
            (-30.0, 30.0),
            (-40.0, 40.0),
            (-30.0, 50.0),
            (-40.0, 40.0),
            (-60.0, 60.0),
            (0.0, 120.0),
            (-50.0, 170.0),
            (-20.0, 90.0),
            (-70.0, 60.0),
            (0.0, 145.0),
            (-60.0, 60.0),
            (-20.0, 30.0),
            (-80.0, 80.0),
        ];
        Posture::from_array(DEGREES.map(|(min, max)| self.uniform(min, max).to_radians()))
    }
}

/// Returns Spearman's rank correlation. Tied values share their mean rank.
pub(crate) fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let rank = |values: &[f64]| -> Vec<f64> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let shared = |v: &f64| {
            let below = sorted.partition_point(|o| o < v);
            let up_to = sorted.partition_point(|o| o <= v);
            (below + up_to - 1) as f64 / 2.0
        };
        values.iter().map(shared).collect()
    };
    let (a, b) = (rank(a), rank(b));
    let n = a.len() as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let cov = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    cov(&a, ma, &b, mb) / (cov(&a, ma, &a, ma) * cov(&b, mb, &b, mb)).sqrt()
}
