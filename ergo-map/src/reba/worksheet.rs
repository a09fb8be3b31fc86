use super::conditions::{Conditions, LegSupport};
use super::curve;
use super::score::{Reba, RebaSubScores};
use crate::error::{Result, angle};
use crate::posture::Posture;

/// A completed REBA sheet: the measured angles and the ticked boxes.
///
/// Angles in radians, flexion positive.
///
/// ```
/// use ergo_map::{Conditions, Worksheet};
/// let sheet = Worksheet {
///     trunk_flexion: 70_f64.to_radians(),
///     conditions: Conditions { load: 12.0, ..Default::default() },
///     ..Default::default()
/// };
/// let reba = sheet.score()?;
/// assert_eq!((reba.sub_scores.trunk, reba.table_a, reba.score_a), (4, 3, 5));
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(clippy::struct_excessive_bools)] // the tick boxes of the printed sheet
pub struct Worksheet {
    /// Inclination of the trunk from the vertical.
    pub trunk_flexion: f64,
    /// The trunk is twisted or bent sideways.
    pub trunk_twisted_or_bent: bool,
    /// Flexion of the neck.
    pub neck_flexion: f64,
    /// The neck is twisted or bent sideways.
    pub neck_twisted_or_bent: bool,
    /// Flexion of the knees.
    pub knee_flexion: f64,
    /// Flexion of the upper arm.
    pub upper_arm_flexion: f64,
    /// The upper arm is abducted or rotated.
    pub arm_abducted_or_rotated: bool,
    /// Flexion of the elbow.
    pub elbow_flexion: f64,
    /// Flexion of the wrist.
    pub wrist_flexion: f64,
    /// The wrist is deviated or twisted.
    pub wrist_deviated_or_twisted: bool,
    /// Conditions beside the angles: load, coupling, support and activity.
    pub conditions: Conditions,
}

impl Worksheet {
    /// Completes the sheet from a posture.
    ///
    /// The upper arm's flexion is its elevation, negative behind the trunk up to 70° (no shoulder
    /// extends further): see [`Posture::upper_arm_elevation`].
    ///
    /// Boxes are ticked above these magnitudes, a choice of this crate, since the sheet names no
    /// angle: trunk 10°, neck 20°, abduction 32.5°, rotation of the arm 45°, deviation of the wrist
    /// 10°, twist of the forearm 45°.
    ///
    /// Two thresholds are never crossed at once. The trunk's box needs 20° if the trunk is within
    /// 6° of a better class. The neck's box needs 36° within 11° of a better class. The upper arm's
    /// box needs an abduction of 42.5° within 7° of a better class. Joints that are displaced by a
    /// centimetre therefore change no sub-score by more than one.
    pub fn from_posture(posture: &Posture, conditions: Conditions) -> Self {
        let arm = posture.upper_arm();
        let side = if arm.is_behind() { &curve::UPPER_ARM_BEHIND } else { &curve::UPPER_ARM };
        let trunk_entered = curve::TRUNK.has_just_entered(posture.trunk_flexion);
        let neck_entered = curve::NECK.has_just_entered(posture.neck_flexion);
        let arm_entered = side.has_just_entered(arm.elevation());
        Self {
            trunk_flexion: posture.trunk_flexion,
            trunk_twisted_or_bent: [posture.trunk_side, posture.trunk_twist]
                .iter()
                .any(|angle| curve::TRUNK_BEND.is_ticked(*angle, trunk_entered)),
            neck_flexion: posture.neck_flexion,
            neck_twisted_or_bent: [posture.neck_side, posture.neck_twist]
                .iter()
                .any(|angle| curve::NECK_BEND.is_ticked(*angle, neck_entered)),
            knee_flexion: posture.knee_flexion,
            upper_arm_flexion: arm.sheet_flexion(),
            arm_abducted_or_rotated: curve::ABDUCTION.is_ticked(arm.abduction(), arm_entered)
                || curve::ARM_ROTATION.is_ticked(posture.upper_arm_rotation, arm_entered),
            elbow_flexion: posture.elbow_flexion,
            wrist_flexion: posture.wrist_flexion,
            wrist_deviated_or_twisted: curve::DEVIATION.is_ticked(posture.wrist_deviation, false)
                || curve::WRIST_TWIST.is_ticked(posture.wrist_twist, false),
            conditions,
        }
    }

    /// Returns the integer score with every sub-score.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if an angle or the load is invalid.
    pub fn score(&self) -> Result<Reba> {
        self.validate()?;
        Ok(Reba::new(self.sub_scores(), &self.conditions))
    }

    /// Checks that the angles are finite and at most a full turn, and that the load is in its
    /// range.
    ///
    /// # Errors
    /// Those of [`Worksheet::score`].
    pub fn validate(&self) -> Result<()> {
        angle("trunk_flexion", self.trunk_flexion)?;
        angle("neck_flexion", self.neck_flexion)?;
        angle("knee_flexion", self.knee_flexion)?;
        angle("upper_arm_flexion", self.upper_arm_flexion)?;
        angle("elbow_flexion", self.elbow_flexion)?;
        angle("wrist_flexion", self.wrist_flexion)?;
        self.conditions.validate()
    }

    fn sub_scores(&self) -> RebaSubScores {
        let knees = match self.conditions.support {
            LegSupport::Sitting | LegSupport::Walking => 0,
            LegSupport::Bilateral | LegSupport::Unilateral => curve::KNEE.class(self.knee_flexion),
        };
        let upper_arm =
            curve::UPPER_ARM.class(self.upper_arm_flexion) + u8::from(self.arm_abducted_or_rotated);
        RebaSubScores {
            neck: curve::NECK.class(self.neck_flexion) + u8::from(self.neck_twisted_or_bent),
            trunk: curve::TRUNK.class(self.trunk_flexion) + u8::from(self.trunk_twisted_or_bent),
            legs: 1 + u8::from(self.conditions.support == LegSupport::Unilateral) + knees,
            upper_arm: upper_arm.saturating_add_signed(self.conditions.arm_adjustment()).max(1),
            lower_arm: curve::LOWER_ARM.class(self.elbow_flexion),
            wrist: curve::WRIST.class(self.wrist_flexion)
                + u8::from(self.wrist_deviated_or_twisted),
        }
    }
}
