//! Colours of the pictures: those of the page in its light theme.

/// Red, green and blue, each from 0 to 1.
pub(super) type Colour = [f64; 3];

/// Ramp from good to bad. Colour-blind people can tell the ends apart.
const RAMP: [Colour; 6] = [
    [0.290, 0.624, 0.831],
    [0.659, 0.827, 0.878],
    [0.957, 0.890, 0.631],
    [0.941, 0.678, 0.306],
    [0.867, 0.420, 0.173],
    [0.651, 0.169, 0.227],
];

/// Highest sub-score of each part, in the order of the columns.
const WORST: [f64; 6] = [3.0, 5.0, 4.0, 6.0, 2.0, 3.0];

/// Colour of parts without a score.
pub(super) const GREY: Colour = [0.72, 0.74, 0.77];

/// Colours of the runs, in their order, in the notation of SVG.
pub(super) const RUNS: [&str; 4] = ["#0065b3", "#cc5a00", "#6a51a3", "#4d4d4d"];
/// Dashes of the runs.
pub(super) const DASHES: [&str; 4] = ["none", "6 3", "2 2", "8 3 2 3"];

/// Returns the colour of a part of the body with a sub-score.
pub(super) fn part(part: usize, score: f32) -> Colour {
    let worst = WORST.get(part).copied().unwrap_or(6.0);
    if score.is_nan() { GREY } else { ramp((f64::from(score) - 1.0) / (worst - 1.0)) }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 4")]
fn ramp(share: f64) -> Colour {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let index = (place as usize).min(RAMP.len() - 2);
    let part = place - index as f64;
    let (low, high) = (RAMP[index], RAMP[index + 1]);
    [0, 1, 2].map(|k: usize| low[k] + (high[k] - low[k]) * part)
}

/// Returns a colour in the notation of SVG, `light` times as bright.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
pub(super) fn css(colour: Colour, light: f64) -> String {
    let [red, green, blue] =
        colour.map(|value| (255.0 * (value * light).clamp(0.0, 1.0)).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}
