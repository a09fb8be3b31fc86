use super::conditions::{Conditions, LegSupport};
use super::curve::{self, Part};
use super::mode::Mode;
use super::smooth::{Dual, Smooth};
use super::table::{interpolate_a, interpolate_b, interpolate_c};
use super::worksheet::Worksheet;
use crate::error::Result;
use crate::posture::Posture;
use crate::upper_arm::UpperArm;

/// Contribution of each part of the body to `e_s`, where 0 is best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contributions {
    /// Arms: table B minus 1, 0 to 8.
    pub arms: f64,
    /// Trunk sub-score minus 1, 0 to 4.
    pub trunk: f64,
    /// Legs sub-score minus 1, 0 to 3.
    pub legs: f64,
    /// Neck sub-score minus 1, 0 to 2.
    pub neck: f64,
}

impl Contributions {
    /// Returns the paper's continuous score `e_s`: the mean of the four contributions, 0 to 4.25.
    pub fn mean(&self) -> f64 {
        0.25 * (self.arms + self.trunk + self.legs + self.neck)
    }
}

/// The continuous counterpart of [`crate::Reba`], with the same parts, tables and additions.
///
/// ```
/// use ergo_map::{Conditions, ContinuousReba, Mode, Posture};
/// let posture = Posture { trunk_flexion: 0.3, neck_flexion: 0.17, ..Default::default() };
/// let graded = ContinuousReba::of_posture(&posture, &Conditions::default(), Mode::Graded)?;
/// assert!(graded.trunk > 2.0 && graded.trunk < 2.5);
/// assert!(graded.contributions().mean() < 0.5);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuousReba {
    /// Neck sub-score.
    pub neck: f64,
    /// Trunk sub-score.
    pub trunk: f64,
    /// Legs sub-score.
    pub legs: f64,
    /// Upper-arm sub-score.
    pub upper_arm: f64,
    /// Lower-arm sub-score.
    pub lower_arm: f64,
    /// Wrist sub-score.
    pub wrist: f64,
    /// Table A plus load and shock.
    pub score_a: f64,
    /// Table B, interpolated.
    pub table_b: f64,
    /// Table B plus coupling.
    pub score_b: f64,
    /// Table C at scores A and B.
    pub score_c: f64,
    /// The score: score C plus activity.
    pub reba: f64,
}

impl ContinuousReba {
    /// Computes the continuous score of a posture. Adjustments that the sheet ticks (twisted,
    /// abducted, …) grow with the angle as well.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if an angle, the load or the mode's half width is invalid.
    pub fn of_posture(posture: &Posture, conditions: &Conditions, mode: Mode) -> Result<Self> {
        posture.validate()?;
        conditions.validate()?;
        mode.validate()?;
        Ok(whole(sub_scores(posture.to_array(), conditions, mode), conditions))
    }

    /// Computes the continuous score of a completed sheet. Angles count continuously, and boxes as
    /// ticked.
    ///
    /// # Errors
    /// Those of [`ContinuousReba::of_posture`].
    pub fn of_worksheet(sheet: &Worksheet, mode: Mode) -> Result<Self> {
        sheet.validate()?;
        mode.validate()?;
        let ticked = |flag: bool| f64::from(u8::from(flag));
        let angles = Angles {
            trunk_flexion: sheet.trunk_flexion,
            trunk_bend: ticked(sheet.trunk_twisted_or_bent),
            neck_flexion: sheet.neck_flexion,
            neck_bend: ticked(sheet.neck_twisted_or_bent),
            knee_flexion: sheet.knee_flexion,
            upper_arm: curve::UPPER_ARM.curve(sheet.upper_arm_flexion, mode).0,
            arm_turned: ticked(sheet.arm_abducted_or_rotated),
            elbow_flexion: sheet.elbow_flexion,
            wrist_flexion: sheet.wrist_flexion,
            wrist_turned: ticked(sheet.wrist_deviated_or_twisted),
        };
        Ok(whole(angles.sub_scores(&sheet.conditions, mode), &sheet.conditions))
    }

    /// Returns the paper's four contributions.
    pub fn contributions(&self) -> Contributions {
        Contributions {
            arms: self.table_b - 1.0,
            trunk: self.trunk.clamp(1.0, 5.0) - 1.0,
            legs: self.legs.clamp(1.0, 4.0) - 1.0,
            neck: self.neck.clamp(1.0, 3.0) - 1.0,
        }
    }
}

/// Returns the paper's score `e_s` of a posture, 0 to 4.25: the mean of arms, trunk, legs and neck
/// (Sec. III-B). See [`Contributions`]. Load, coupling and activity have no effect.
///
/// Angles must be finite. A NaN angle gives a NaN score.
pub fn ergonomics_score(posture: &Posture, conditions: &Conditions, mode: Mode) -> f64 {
    mean(sub_scores(posture.to_array(), conditions, mode))
}

/// Returns `e_s` and its gradient with respect to the posture's angles \[1/rad\]. At a knot of a
/// graded curve the gradient does not exist. It is then between the two one-sided derivatives.
pub fn ergonomics_score_gradient(
    posture: &Posture,
    conditions: &Conditions,
    mode: Mode,
) -> (f64, Posture) {
    let score = mean(sub_scores(Dual::angles(posture), conditions, mode));
    (score.value, Posture::from_array(score.gradient))
}

/// The sub-scores in the order neck, trunk, legs, upper arm, lower arm, wrist.
type SubScores<S> = [S; 6];

/// Inputs of the curves: angles \[rad\], and adjustments from 0 to 1.
struct Angles<S> {
    trunk_flexion: S,
    trunk_bend: S,
    neck_flexion: S,
    neck_bend: S,
    knee_flexion: S,
    /// Score of the flexion alone, without adjustments.
    upper_arm: S,
    arm_turned: S,
    elbow_flexion: S,
    wrist_flexion: S,
    wrist_turned: S,
}

impl<S: Smooth> Angles<S> {
    fn sub_scores(self, conditions: &Conditions, mode: Mode) -> SubScores<S> {
        let class = |part: &Part, angle: S| apply(part, angle, mode);
        let legs = match conditions.support {
            LegSupport::Bilateral => class(&curve::KNEE, self.knee_flexion).shifted(1.0),
            LegSupport::Unilateral => class(&curve::KNEE, self.knee_flexion).shifted(2.0),
            LegSupport::Sitting | LegSupport::Walking => self.knee_flexion.chain(1.0, 0.0),
        };
        [
            class(&curve::NECK, self.neck_flexion).plus(self.neck_bend),
            class(&curve::TRUNK, self.trunk_flexion).plus(self.trunk_bend),
            legs,
            self.upper_arm
                .plus(self.arm_turned)
                .shifted(f64::from(conditions.arm_adjustment()))
                .clamped(1.0, f64::INFINITY),
            class(&curve::LOWER_ARM, self.elbow_flexion),
            class(&curve::WRIST, self.wrist_flexion).plus(self.wrist_turned),
        ]
    }
}

fn apply<S: Smooth>(part: &Part, angle: S, mode: Mode) -> S {
    let (value, slope) = part.curve(angle.value(), mode);
    angle.chain(value, slope)
}

fn sub_scores<S: Smooth>(
    posture: [S; Posture::LEN],
    conditions: &Conditions,
    mode: Mode,
) -> SubScores<S> {
    let [
        trunk_flexion,
        trunk_side,
        trunk_twist,
        neck_flexion,
        neck_side,
        neck_twist,
        knee_flexion,
        upper_arm_flexion,
        abduction,
        rotation,
        elbow_flexion,
        wrist_flexion,
        deviation,
        wrist_twist,
    ] = posture;
    let arm = UpperArm::of_angles(upper_arm_flexion.value(), abduction.value());
    let pair = [upper_arm_flexion, abduction, abduction];
    let elevation = elevation(arm, pair);
    let (sin, cos) = (abduction.value().sin(), abduction.value().cos());
    let down = upper_arm_flexion.value().cos() * cos;
    let sideways = -upper_arm_flexion.value().sin() * sin;
    let forward = S::chain3(pair, arm.forward, [down, sideways, 0.0]);
    let in_front = apply(&curve::IN_FRONT, forward, mode);
    let mix = |behind: S, front: S| blend(behind, front, in_front);
    let of_arm = |part: &Part| apply(part, elevation, mode);
    let entering = |part: &Part, angle: S| {
        let (value, slope) = part.entering(angle.value(), mode);
        angle.chain(value, slope)
    };
    let of_trunk = entering(&curve::TRUNK, trunk_flexion);
    let of_neck = entering(&curve::NECK, neck_flexion);
    let behind_entering = entering(&curve::UPPER_ARM_BEHIND, elevation);
    let arm_entering = mix(behind_entering, entering(&curve::UPPER_ARM, elevation));
    let outward = abduction.chain(arm.abduction(), if cos < 0.0 { -1.0 } else { 1.0 });
    let none = elbow_flexion.chain(0.0, 0.0);
    let bend = |part: &Part, x: S, y: S, entering: S| {
        turned(part, x, entering, mode).larger(turned(part, y, entering, mode))
    };
    Angles {
        trunk_flexion,
        trunk_bend: bend(&curve::TRUNK_BEND, trunk_side, trunk_twist, of_trunk),
        neck_flexion,
        neck_bend: bend(&curve::NECK_BEND, neck_side, neck_twist, of_neck),
        knee_flexion,
        upper_arm: mix(of_arm(&curve::UPPER_ARM_BEHIND), of_arm(&curve::UPPER_ARM)),
        // Either of the two adds 1, but not both.
        arm_turned: turned(&curve::ABDUCTION, outward, arm_entering, mode).larger(turned(
            &curve::ARM_ROTATION,
            rotation,
            arm_entering,
            mode,
        )),
        elbow_flexion,
        wrist_flexion,
        wrist_turned: turned(&curve::DEVIATION, deviation, none, mode).larger(turned(
            &curve::WRIST_TWIST,
            wrist_twist,
            none,
            mode,
        )),
    }
    .sub_scores(conditions, mode)
}

/// Returns the elevation of an arm of this flexion and abduction. At its singularities, hanging and
/// straight up, the derivative is 0, which is between the one-sided ones.
fn elevation<S: Smooth>(arm: UpperArm, [flexion, abduction, other]: [S; 3]) -> S {
    let level = arm.forward.hypot(arm.outward);
    let rates = if level < 1e-9 {
        [0.0; 3]
    } else {
        [arm.forward / level, flexion.value().cos() * abduction.value().sin() / level, 0.0]
    };
    S::chain3([flexion, abduction, other], arm.elevation(), rates)
}

/// Returns an adjustment by the magnitude of an angle. If the part is just entering its class, the
/// angle must exceed the threshold by a margin.
fn turned<S: Smooth>(part: &Part, angle: S, entering: S, mode: Mode) -> S {
    let magnitude = angle.chain(angle.value().abs(), angle.value().signum());
    let (value, slope) = part.curve_with_margin(magnitude.value(), mode);
    blend(apply(part, magnitude, mode), magnitude.chain(value, slope), entering)
}

/// Returns the first number if `share` is 0, the second if it is 1.
fn blend<S: Smooth>(first: S, second: S, share: S) -> S {
    let (from, to, by) = (first.value(), second.value(), share.value());
    S::chain3([first, second, share], from + by * (to - from), [1.0 - by, by, to - from])
}

fn mean<S: Smooth>([neck, trunk, legs, upper_arm, lower_arm, wrist]: SubScores<S>) -> S {
    let arms = interpolate_b([upper_arm, lower_arm, wrist]);
    let sum = arms
        .plus(trunk.clamped(1.0, 5.0))
        .plus(legs.clamped(1.0, 4.0))
        .plus(neck.clamped(1.0, 3.0))
        .shifted(-4.0);
    sum.chain(0.25 * sum.value(), 0.25)
}

fn whole(scores: SubScores<f64>, conditions: &Conditions) -> ContinuousReba {
    let [neck, trunk, legs, upper_arm, lower_arm, wrist] = scores;
    let score_a = interpolate_a([neck, trunk, legs]) + f64::from(conditions.load_score());
    let table_b = interpolate_b([upper_arm, lower_arm, wrist]);
    let score_b = table_b + f64::from(conditions.coupling.score());
    let score_c = interpolate_c([score_a, score_b]);
    let reba = score_c + f64::from(conditions.activity_score());
    ContinuousReba {
        neck,
        trunk,
        legs,
        upper_arm,
        lower_arm,
        wrist,
        score_a,
        table_b,
        score_b,
        score_c,
        reba,
    }
}
