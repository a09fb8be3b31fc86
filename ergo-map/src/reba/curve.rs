//! Scores of angles, part by part: the printed classes as steps, and the same classes as curves.
//!
//! At a threshold a graded curve passes half-way between the two classes. It rises from the neutral
//! angle to the end of the range of motion. Its shape within a class is free. It is chosen so that
//! `e_s`, which weighs its parts equally, orders postures as the tables do. The last class is
//! nearly reached soon after its threshold. The knees' first class, the neck's second and the upper
//! arm's last are approached late in the class before.
//!
//! The rank correlation with the integer score is .91 on independent uniform angles. Straight lines
//! throughout would give .85.

use crate::reba::mode::Mode;
use crate::steps::Steps;
use crate::upper_arm::LARGEST_EXTENSION;

/// One body part: its printed classes, and the knots (degrees, value) of the graded curve.
pub(super) struct Part {
    steps: Steps,
    knots: &'static [(f64, f64)],
    /// Largest change of the angle if every measured joint is displaced by a centimetre \[°\].
    margin: f64,
    /// Midpoint of the best class \[°\].
    neutral: f64,
}

/// An angle that is never reached \[°\].
const NEVER: f64 = 1e3;

/// Trunk: upright (within 5°) 1; up to 20° 2; 20-60° flexion or more than 20° extension 3; more 4.
pub(super) const TRUNK: Part = Part {
    steps: Steps::new(3.0, &[(-20.0, -1.0), (-5.0, -1.0), (5.0, 1.0), (20.0, 1.0), (60.0, 1.0)]),
    knots: &[
        (-30.0, 3.4),
        (-20.0, 2.5),
        (-5.0, 1.5),
        (0.0, 1.0),
        (5.0, 1.5),
        (20.0, 2.5),
        (60.0, 3.5),
        (68.0, 4.3),
        (100.0, 4.49),
    ],
    margin: 6.0,
    neutral: 0.0,
};
/// Neck: 0-20° flexion 1; more, or extension, 2.
pub(super) const NECK: Part = Part {
    steps: Steps::new(2.0, &[(0.0, -1.0), (20.0, 1.0)]),
    knots: &[
        (-45.0, 2.49),
        (-8.0, 2.3),
        (0.0, 1.5),
        (4.0, 1.1),
        (10.0, 1.0),
        (16.0, 1.1),
        (20.0, 1.5),
        (28.0, 2.3),
        (45.0, 2.49),
    ],
    margin: 11.0,
    neutral: 10.0,
};
/// Knees, added to the legs: 30-60° 1; more 2.
pub(super) const KNEE: Part = Part {
    steps: Steps::new(0.0, &[(30.0, 1.0), (60.0, 1.0)]),
    knots: &[
        (0.0, 0.0),
        (26.0, 0.1),
        (30.0, 0.5),
        (36.0, 1.2),
        (60.0, 1.5),
        (68.0, 2.3),
        (130.0, 2.49),
    ],
    margin: 0.0,
    neutral: 0.0,
};
/// Upper arm: within 20° 1; 20-45° flexion or more than 20° extension 2; 45-90° 3; more 4.
pub(super) const UPPER_ARM: Part = Part {
    steps: Steps::new(2.0, &[(-20.0, -1.0), (20.0, 1.0), (45.0, 1.0), (90.0, 1.0)]),
    knots: &[
        (-60.0, 2.49),
        (-20.0, 1.5),
        (0.0, 1.0),
        (20.0, 1.5),
        (45.0, 2.5),
        (82.0, 3.1),
        (90.0, 3.5),
        (180.0, 3.8),
    ],
    margin: 7.0,
    neutral: 0.0,
};
/// Upper arm behind the trunk, by its elevation: within 20° 1; extension, up to 70°, 2. An arm that
/// is higher has come over the head.
pub(super) const UPPER_ARM_BEHIND: Part = Part {
    steps: Steps::new(1.0, &[(20.0, 1.0), (LARGEST_EXTENSION, 1.0), (90.0, 1.0)]),
    knots: &[
        (0.0, 1.0),
        (20.0, 1.5),
        (60.0, 2.45),
        (LARGEST_EXTENSION, 2.5),
        (82.0, 3.1),
        (90.0, 3.5),
        (180.0, 3.8),
    ],
    margin: 7.0,
    neutral: 0.0,
};
/// Share of the arm in front of the trunk, by the sine of its angle to the trunk's frontal plane: 1
/// in front of it, 0 behind.
pub(super) const IN_FRONT: Part = Part {
    steps: Steps::new(0.0, &[(0.0, 1.0)]),
    knots: &[(-10.0, 0.0), (10.0, 1.0)],
    margin: 0.0,
    neutral: 0.0,
};
/// Lower arm: elbow flexion 60-100° 1, otherwise 2.
pub(super) const LOWER_ARM: Part = Part {
    steps: Steps::new(2.0, &[(60.0, -1.0), (100.0, 1.0)]),
    knots: &[(0.0, 2.49), (60.0, 1.5), (80.0, 1.0), (100.0, 1.5), (145.0, 2.49)],
    margin: 0.0,
    neutral: 0.0,
};
/// Wrist: within 15° 1, otherwise 2.
pub(super) const WRIST: Part = Part {
    steps: Steps::new(2.0, &[(-15.0, -1.0), (15.0, 1.0)]),
    knots: &[
        (-75.0, 2.49),
        (-22.0, 2.2),
        (-15.0, 1.5),
        (0.0, 1.0),
        (15.0, 1.5),
        (22.0, 2.2),
        (75.0, 2.49),
    ],
    margin: 0.0,
    neutral: 0.0,
};

/// The +1 adjustments by the magnitude of an angle. The printed sheets only say "twisted",
/// "abducted" and so on. The threshold is the midpoint of the ramp.
pub(super) const TRUNK_BEND: Part = Part {
    steps: Steps::new(0.0, &[(10.0, 1.0)]),
    knots: &[(5.0, 0.0), (15.0, 1.0)],
    margin: 10.0,
    neutral: 0.0,
};
/// Neck twisted or bent sideways.
pub(super) const NECK_BEND: Part = Part {
    steps: Steps::new(0.0, &[(20.0, 1.0)]),
    knots: &[(10.0, 0.0), (30.0, 1.0)],
    margin: 16.0,
    neutral: 0.0,
};
/// Upper arm abducted.
pub(super) const ABDUCTION: Part = Part {
    steps: Steps::new(0.0, &[(32.5, 1.0)]),
    knots: &[(20.0, 0.0), (45.0, 1.0)],
    margin: 10.0,
    neutral: 0.0,
};
/// Upper arm rotated.
pub(super) const ARM_ROTATION: Part = Part {
    steps: Steps::new(0.0, &[(45.0, 1.0)]),
    knots: &[(30.0, 0.0), (60.0, 1.0)],
    margin: NEVER,
    neutral: 0.0,
};
/// Wrist deviated.
pub(super) const DEVIATION: Part = Part {
    steps: Steps::new(0.0, &[(10.0, 1.0)]),
    knots: &[(5.0, 0.0), (15.0, 1.0)],
    margin: 0.0,
    neutral: 0.0,
};
/// Forearm twisted.
pub(super) const WRIST_TWIST: Part = Part {
    steps: Steps::new(0.0, &[(45.0, 1.0)]),
    knots: &[(30.0, 0.0), (60.0, 1.0)],
    margin: 0.0,
    neutral: 0.0,
};

impl Part {
    /// Returns the printed class.
    pub(super) fn class(&self, angle: f64) -> u8 {
        self.steps.class(angle)
    }

    /// Returns true if the box for an angle \[rad\] is ticked. If the part of the box has only just
    /// entered its class, the angle must be larger. An error of a centimetre then never counts
    /// twice.
    pub(super) fn is_ticked(&self, angle: f64, just_entered: bool) -> bool {
        let needed = if just_entered { self.margin.to_radians() } else { 0.0 };
        self.class(angle.abs() - needed) > 0
    }

    /// Returns true if the angle \[rad\] is within the margin of a better class.
    pub(super) fn has_just_entered(&self, angle: f64) -> bool {
        self.class(angle) > self.class(self.nearer_neutral(angle))
    }

    /// Returns the continuous counterpart of [`Part::has_just_entered`], 0 to 1, and its derivative
    /// \[1/rad\]. Graded curves have no classes to enter, so it is 0.
    pub(super) fn entering(&self, angle: f64, mode: Mode) -> (f64, f64) {
        let Mode::Faithful { half_width } = mode else { return (0.0, 0.0) };
        let nearer = self.nearer_neutral(angle);
        let (there, rate) = self.steps.softened(angle, half_width);
        let (back, back_rate) = self.steps.softened(nearer, half_width);
        let moves = f64::from(u8::from(nearer != self.neutral()));
        let share = there - back;
        if (0.0..=1.0).contains(&share) {
            (share, rate - moves * back_rate)
        } else {
            (share.clamp(0.0, 1.0), 0.0)
        }
    }

    /// Returns the angle \[rad\] moved towards the neutral one by the margin.
    fn nearer_neutral(&self, angle: f64) -> f64 {
        let away = angle - self.neutral();
        self.neutral() + away.signum() * (away.abs() - self.margin.to_radians()).max(0.0)
    }

    /// Returns the neutral angle \[rad\].
    fn neutral(&self) -> f64 {
        self.neutral.to_radians()
    }

    /// Returns the continuous value and derivative of a box that needs an additional margin, see
    /// [`Part::is_ticked`].
    pub(super) fn curve_with_margin(&self, angle: f64, mode: Mode) -> (f64, f64) {
        self.curve(angle - self.margin.to_radians(), mode)
    }

    /// Returns the continuous value and its derivative \[1/rad\].
    pub(super) fn curve(&self, angle: f64, mode: Mode) -> (f64, f64) {
        match mode {
            Mode::Graded => piecewise_linear(self.knots, angle),
            Mode::Faithful { half_width } => self.steps.softened(angle, half_width),
        }
    }
}

/// Interpolates linearly between knots (degrees, value), with constant values beyond the ends. At a
/// knot the derivative is that to its right.
fn piecewise_linear(knots: &[(f64, f64)], angle: f64) -> (f64, f64) {
    let degrees = angle.to_degrees();
    let mut left: Option<(f64, f64)> = None;
    for &(x, y) in knots {
        if degrees < x {
            return match left {
                None => (y, 0.0),
                Some((x0, y0)) => {
                    let slope = (y - y0) / (x - x0);
                    (y0 + slope * (degrees - x0), slope.to_degrees())
                }
            };
        }
        left = Some((x, y));
    }
    (left.map_or(0.0, |(_, y)| y), 0.0)
}
