//! Room in front of a limit for accelerations that cannot end at once.

use ahqp_core::Rows;

use super::joint_intervals::JointIntervals;

/// Narrows the rows of limits so that their values come to rest at the limit, and not beyond it,
/// where jerks are limited.
///
/// A value s = Σ cᵢ q̇ᵢ grows by Σ cᵢ q̈ᵢ²/(2jᵢ), over the joints that drive it towards its limit,
/// while these bring their accelerations to zero. With the jerk j of s for which that is S²/(2j),
/// S = Σ cᵢ q̈ᵢ, the acceleration α allowed next is that of a single joint in front of its velocity
/// limit: α Δt + α²/(2j) = limit − s. Without jerk limits nothing changes.
pub(crate) fn anticipate(
    rows: &mut Rows,
    velocity: &[f64],
    acceleration: &[f64],
    joints: &JointIntervals,
    period: f64,
) {
    for index in 0..rows.len() {
        let row = rows.row(index).unwrap_or_default();
        let value: f64 = row.iter().zip(velocity).map(|(c, v)| c * v).sum();
        let room = |limit: f64, sign: f64| {
            let (mut driving, mut overrun) = (0.0, 0.0);
            for (entry, (c, a)) in row.iter().zip(acceleration).enumerate() {
                let part = (sign * c * a).max(0.0);
                driving += part;
                overrun += 0.5 * part * a.abs() / joints.jerk(entry);
            }
            let excess = sign * (limit - value);
            if overrun <= 0.0 || excess <= 0.0 || excess.is_infinite() {
                return limit;
            }
            let jerk = 0.5 * driving * driving / overrun;
            let root = (period * period + 2.0 * excess / jerk).sqrt();
            let next = value + sign * (2.0 * excess / (period + root)) * period;
            if sign > 0.0 { limit.min(next) } else { limit.max(next) }
        };
        let (lower, upper) = (rows.lower()[index], rows.upper()[index]);
        let (lower, upper) = (room(lower, -1.0), room(upper, 1.0));
        (rows.lower_mut()[index], rows.upper_mut()[index]) = (lower, upper.max(lower));
    }
}
