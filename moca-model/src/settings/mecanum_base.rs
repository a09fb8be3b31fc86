//! Limits of a base on mecanum wheels.

use whole_body::limits::WheelLimit;

use crate::error::{Error, check_positive, check_settings};
use crate::robot::moca::{MOCA_AXIS_SPEED, MOCA_WHEEL_LEVER, MOCA_WHEEL_SPEED};

/// The limits of a mecanum base. Its wheels limit |v_x| + |v_y| + lever |ω| in its own frame, and its controller limits
/// |v_x| and |v_y|.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MecanumBase {
    /// Largest value of the sum \[m/s\].
    pub speed: f64,
    /// Lever of the yaw rate \[m\].
    pub lever: f64,
    /// Largest speed along each of the base's own axes \[m/s\].
    pub axis_speed: f64,
}

impl Default for MecanumBase {
    /// The limits of the SUMMIT-XL STEEL.
    fn default() -> Self {
        Self { speed: MOCA_WHEEL_SPEED, lever: MOCA_WHEEL_LEVER, axis_speed: MOCA_AXIS_SPEED }
    }
}

impl MecanumBase {
    /// The limit of the base's velocity.
    pub(crate) fn limit(&self) -> WheelLimit {
        WheelLimit::mecanum(self.speed, self.lever).with_axis_speed(self.axis_speed)
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        check_positive([("base.speed", self.speed), ("base.axis_speed", self.axis_speed)])?;
        let lever = [("base.lever", self.lever)];
        check_settings(lever, "from 0 to 1000 m", |value| (0.0..=1e3).contains(&value))
    }
}

#[cfg(test)]
mod tests {
    use ahqp_core::Rows;
    use proptest::prelude::*;
    use whole_body::stack::{TaskLevel, TaskStack};
    use whole_body::tasks::VariableLayout;
    use whole_body::{Data, Model};

    use super::*;
    use crate::robot::moca::{MOCA_HOME, MOCA_URDF, moca, moca_description};

    /// The rows at a yaw, if they are to admit a velocity of the base.
    fn rows(yaw: f64, admitted: [f64; 3]) -> Rows {
        rows_of(&moca().unwrap(), yaw, admitted)
    }

    fn rows_of(model: &Model, yaw: f64, admitted: [f64; 3]) -> Rows {
        let mut limit = MecanumBase::default().limit();
        limit.admit(admitted.into());
        let mut level = TaskLevel::new("wheels");
        level.constrain("wheels", limit);
        let variables = VariableLayout::new(model);
        let mut stack =
            TaskStack::new(model, &variables, vec![level], ahqp_core::Settings::default()).unwrap();
        let mut q = MOCA_HOME;
        q[2] = yaw;
        let mut data = Data::new(model);
        stack.write(&mut data.pose(model, &q).unwrap(), &[0.0; 10], 1e-3).unwrap();
        stack.hierarchy().levels()[0].constraints().clone()
    }

    fn value(row: &[f64], velocity: [f64; 3]) -> f64 {
        row.iter().zip(velocity).map(|(a, b)| a * b).sum()
    }

    proptest! {
        #[test]
        fn rows_are_wheel_limits_in_base_frame(
            yaw in -4.0..4.0_f64, v in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let base = MecanumBase::default();
            let rows = rows(yaw, [0.0; 3]);
            let values: Vec<f64> = rows.iter().map(|(row, _, _)| value(row, v).abs()).collect();
            let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
            let (sine, cosine) = yaw.sin_cos();
            let (x, y) = (cosine * v[0] + sine * v[1], cosine * v[1] - sine * v[0]);
            let wheels = x.abs() + y.abs() + base.lever * v[2].abs();
            prop_assert!((largest(&values[..4]) - wheels).abs() < 1e-12);
            prop_assert!((largest(&values[4..]) - x.abs().max(y.abs())).abs() < 1e-12);
            for (row, (_, lower, upper)) in rows.iter().enumerate() {
                let speed = if row < 4 { base.speed } else { base.axis_speed };
                prop_assert_eq!((lower, upper), (-speed, speed));
            }
        }

        #[test]
        fn the_braking_velocity_is_always_admitted(
            yaw in -4.0..4.0_f64, braked in prop::array::uniform3(-9.0..9.0_f64),
        ) {
            for (row, lower, upper) in rows(yaw, braked).iter() {
                let value = value(row, braked);
                prop_assert!(lower - 1e-12 <= value && value <= upper + 1e-12);
            }
        }
    }

    /// A base of another URDF may end its yaw by limits.
    #[test]
    fn a_yaw_with_limits_changes_no_row() {
        let limited = MOCA_URDF
            .replace("name=\"base_yaw\" type=\"continuous\"", "name=\"base_yaw\" type=\"revolute\"")
            .replace("<limit velocity=\"3\"", "<limit lower=\"-6\" upper=\"6\" velocity=\"3\"");
        assert_ne!(limited, MOCA_URDF);
        let model = Model::from_urdf(&limited, &moca_description()).unwrap();
        assert_eq!(rows_of(&model, 0.7, [0.0; 3]), rows(0.7, [0.0; 3]));
    }
}
