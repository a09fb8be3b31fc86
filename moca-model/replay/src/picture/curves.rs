//! Plots beside the scene.

use super::colours::{DASHES, RUNS};
use crate::recorded::Replay;

/// Position and contents of a plot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot<'a> {
    pub(super) title: &'a str,
    pub(super) column: &'a str,
    /// Left, top, width and height \[pixels\].
    pub(super) place: [f64; 4],
    /// Begin and end \[s\].
    pub(super) time: [f64; 2],
}

impl Plot<'_> {
    pub(super) fn x(&self, time: f64) -> f64 {
        let [left, _, width, _] = self.place;
        let [begin, end] = self.time;
        left + width * ((time - begin) / (end - begin).max(1e-9)).clamp(0.0, 1.0)
    }

    /// Returns the SVG elements of the plot.
    pub(super) fn draw(&self, replays: &[&Replay]) -> String {
        let [left, top, width, height] = self.place;
        let most = replays
            .iter()
            .flat_map(|replay| self.values(replay))
            .fold(0.5, |most, (_, value)| if value > most { value } else { most });
        let y = |value: f64| top + height * (1.0 - value / (1.08 * most));
        let mut svg = vec![format!(
            "<text x=\"{left}\" y=\"{:.0}\" class=\"b\">{}</text>\n",
            top - 8.0,
            self.title
        )];
        let step = if most > 4.0 { 2.0 } else { 1.0 };
        let mut value = 0.0;
        while value <= most {
            let at = y(value);
            let right = left + width;
            svg.push(format!("<path d=\"M{left} {at:.1}H{right}\" stroke=\"#e2e7ec\"/>\n"));
            svg.push(format!(
                "<text x=\"{:.0}\" y=\"{:.1}\" class=\"s e\">{value}</text>\n",
                left - 6.0,
                at + 4.0
            ));
            value += step;
        }
        for (index, replay) in replays.iter().enumerate().rev() {
            let mut path = Vec::new();
            let mut gap = true;
            for (time, value) in self.values(replay) {
                if value.is_nan() {
                    gap = true;
                    continue;
                }
                path.push(format!(
                    "{}{:.1} {:.1}",
                    if gap { "M" } else { "L" },
                    self.x(time),
                    y(value)
                ));
                gap = false;
            }
            let (colour, dashes) = (RUNS[index % RUNS.len()], DASHES[index % DASHES.len()]);
            svg.push(format!(
                "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" \
                 stroke-dasharray=\"{dashes}\"/>\n",
                path.concat(),
            ));
        }
        svg.concat()
    }

    /// Returns times and values with at most one point per pixel: the greatest of those at a pixel.
    fn values(&self, replay: &Replay) -> Vec<(f64, f64)> {
        let [begin, end] = self.time;
        let place = replay.samples.place("series", self.column);
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (index, &time) in replay.samples.times().iter().enumerate() {
            if time < begin || time > end {
                continue;
            }
            let row = replay.samples.row(index);
            let value = place.and_then(|place| row.get(place));
            let value = value.map_or(f64::NAN, |value| f64::from(*value));
            match points.last_mut() {
                Some(last)
                    if self.x(time) - self.x(last.0) < 1.5 && last.1.is_nan() == value.is_nan() =>
                {
                    last.1 = if value > last.1 { value } else { last.1 };
                }
                _ => points.push((time, value)),
            }
        }
        points
    }
}
