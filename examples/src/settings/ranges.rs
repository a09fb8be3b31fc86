//! The ranges of all numbers of the settings in one table.
//!
//! The programs run with values in these ranges; some combinations are restricted further.

use toml::{Table, Value};

/// A number outside its range.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OutOfRange {
    /// The setting, without indices of lists.
    pub(super) path: String,
    /// Fault of the number, and its range.
    pub(super) reason: String,
}

/// The end of a setting's path, and its range with both ends.
type Range = (&'static str, f64, f64);

/// Largest value of times that may be infinite (s).
const FOR_EVER: f64 = f64::MAX;

/// The ranges. The longest path end that fits a setting decides.
const RANGES: &[Range] = &[
    ("controller.period", 1e-4, 0.1),
    ("controller.gain", 0.0, 1e3),
    ("controller.horizon", 1e-4, 100.0),
    ("controller.on_board_camera", -100.0, 100.0),
    ("desired.velocity", 1e-3, 10.0),
    ("desired.acceleration", 1e-2, 1e3),
    ("desired.angular_velocity", 1e-3, 20.0),
    ("desired.angular_acceleration", 1e-2, 2e3),
    ("space.min", -100.0, 100.0),
    ("space.max", -100.0, 100.0),
    ("space.tool", -1.0, 1.0),
    ("space.turn", 0.0, std::f64::consts::PI),
    ("space.lead", 0.0, 10.0),
    ("space.margin", 0.0, 10.0),
    ("hand.drill", 0.0, 2.0),
    ("hand.polisher", 0.0, 2.0),
    ("controller.base.speed", 1e-3, 100.0),
    ("controller.base.lever", 0.0, 10.0),
    ("controller.base.axis_speed", 1e-3, 100.0),
    ("posture.configuration", -1e3, 1e3),
    ("posture.gain", 0.0, 1e3),
    ("posture.weight", 0.0, 1e4),
    ("budget.iterations", 1.0, 1e9),
    ("budget.time", 1e-6, 1e3),
    ("following_error.prismatic", 1e-6, 100.0),
    ("following_error.revolute", 1e-6, 100.0),
    ("safety.contact_speed", 0.0, 10.0),
    ("safety.own_pairs", 0.0, 1e4),
    ("capsule.start", -10.0, 10.0),
    ("capsule.end", -10.0, 10.0),
    ("capsule.radius", 0.0, 10.0),
    ("separation.human_speed", 0.0, 10.0),
    ("separation.arm_speed", 0.0, 20.0),
    ("separation.reaction_time", 1e-4, 10.0),
    ("separation.deceleration", 1e-3, 1e3),
    ("separation.base.joints", 0.0, 1e3),
    ("separation.base.deceleration", 1e-3, 1e3),
    ("separation.intrusion", 0.0, 10.0),
    ("separation.human_uncertainty", 0.0, 10.0),
    ("separation.robot_uncertainty", 0.0, 10.0),
    ("contact.area", 1e-8, 1.0),
    ("force", 0.1, 1e5),
    ("pressure", 1.0, 1e9),
    ("stiffness", 1.0, 1e8),
    ("mass", 1e-3, 1e4),
    ("supervisor.reduced_age", 1e-3, FOR_EVER),
    ("supervisor.stop_age", 1e-3, FOR_EVER),
    ("supervisor.contact_force", 1e-3, 1e6),
    ("position_sigma", 1e-6, 10.0),
    ("camera.pose", -1e3, 1e3),
    ("torque.rotor_inertia", 0.0, 1e3),
    ("torque.delay", 0.0, 0.0045),
    ("delay.known", 0.0, 0.0045),
    ("impedance.stiffness", 0.0, 1e5),
    ("impedance.damping", 0.0, 1e4),
    ("impedance.torque_rate", 1e-3, 1e7),
];

/// The range of a setting; `None` if it is not a number.
pub(super) fn range_of(path: &str) -> Option<[f64; 2]> {
    let is_end = |end: &str| {
        path.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('.'))
    };
    // The longest end counts: the damping of contacts is not that of joints.
    let fits = RANGES.iter().filter(|(end, ..)| is_end(end));
    fits.max_by_key(|(end, ..)| end.len()).map(|&(_, low, high)| [low, high])
}

/// The words for a range.
pub(super) fn words([low, high]: [f64; 2]) -> String {
    let number = |value: f64| {
        if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
            value.to_string()
        } else {
            format!("{value:e}")
        }
    };
    if high >= FOR_EVER {
        format!("at least {}", number(low))
    } else {
        format!("{} to {}", number(low), number(high))
    }
}

/// Checks every number.
///
/// # Errors
/// The first number that is outside its range, or has no known range.
pub(super) fn check(settings: &Table) -> Result<(), OutOfRange> {
    settings.iter().try_for_each(|(name, value)| check_value(name, value))
}

fn check_value(path: &str, value: &Value) -> Result<(), OutOfRange> {
    let number = match value {
        Value::Table(table) => {
            return table
                .iter()
                .try_for_each(|(name, value)| check_value(&format!("{path}.{name}"), value));
        }
        Value::Array(items) => {
            return items.iter().try_for_each(|item| check_value(path, item));
        }
        #[expect(clippy::cast_precision_loss, reason = "it is compared with small numbers")]
        Value::Integer(number) => *number as f64,
        Value::Float(number) => *number,
        _ => return Ok(()),
    };
    let wrong = |reason| Err(OutOfRange { path: path.to_owned(), reason });
    match range_of(path) {
        Some([low, high]) if (low..=high).contains(&number) => Ok(()),
        Some(range) => wrong(format!("{path} is {value}: give {}", words(range))),
        None => wrong(format!("{path} is {value}, and no range of it is known")),
    }
}
