//! Limits of wheels under a base that moves on a plane.

use nalgebra::Vector3;

use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::model::Model;
use crate::tasks::input::TaskInput;
use crate::tasks::rows::TaskRows;
use crate::tasks::task::{Limit, Task};

/// Limits how fast each wheel of a planar base turns: |c · (v_x, v_y, ω)| ≤ speed, the velocity
/// being in the base's own axes.
///
/// It holds exactly where the base's joints have acceleration limits and no jerk limits. Jerk
/// limits along the world's axes keep a base that turns from taking its velocity along at once; the
/// wheels then exceed their speed by what is missing.
///
/// ```
/// use whole_body::WheelLimit;
///
/// // A mecanum base whose wheels reach 3.46 m/s, with a lever of 0.427 m: the sum of half the
/// // distances between its axles and between its wheels.
/// let summit = WheelLimit::mecanum(3.46, 0.427);
/// // Three omni wheels 0.2 m from the centre.
/// let omni = WheelLimit::omni(1.0, 0.2, &[0.0, 2.0944, -2.0944]);
/// // Two driven wheels 0.5 m apart: it cannot move sideways.
/// let tiago = WheelLimit::differential(1.0, 0.5);
/// # let _ = (summit, omni, tiago);
/// ```
#[derive(Debug, Clone)]
pub struct WheelLimit {
    wheels: Vec<Wheel>,
}

/// A wheel, or a direction in which a base cannot move.
#[derive(Debug, Clone, Copy)]
struct Wheel {
    coefficients: Vector3<f64>,
    speed: f64,
}

impl WheelLimit {
    /// Of four mecanum wheels whose rims reach `speed` \[m/s\]: |v_x| + |v_y| + lever |ω| ≤ speed,
    /// `lever` \[m\] being half the wheelbase and half the track together (Taheri, Qiao, Ghaeminezhad,
    /// "Kinematic model of a four mecanum wheeled mobile robot", 2015, eq. 20).
    pub fn mecanum(speed: f64, lever: f64) -> Self {
        let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let wheel = |(y, turn): (f64, f64)| Wheel {
            coefficients: Vector3::new(1.0, y, turn * lever),
            speed,
        };
        Self { wheels: signs.map(wheel).to_vec() }
    }

    /// Of omni wheels whose rims reach `speed` \[m/s\], at a distance of `radius` \[m\] from the
    /// centre in the directions `angles` \[rad, from the base's x axis\], driving at right angles to
    /// them (Siegwart, Nourbakhsh, Scaramuzza, *Introduction to Autonomous Mobile Robots*, 2011,
    /// Sec. 3.2.3).
    pub fn omni(speed: f64, radius: f64, angles: &[f64]) -> Self {
        let wheel = |angle: &f64| Wheel {
            coefficients: Vector3::new(-angle.sin(), angle.cos(), radius),
            speed,
        };
        Self { wheels: angles.iter().map(wheel).collect() }
    }

    /// Of two driven wheels on the base's y axis, `track` \[m\] apart, whose rims reach `speed`
    /// \[m/s\]; the base does not move sideways.
    pub fn differential(speed: f64, track: f64) -> Self {
        let half = 0.5 * track;
        let sideways = Wheel { coefficients: Vector3::new(0.0, 1.0, 0.0), speed: 0.0 };
        let [left, right] =
            [-half, half].map(|lever| Wheel { coefficients: Vector3::new(1.0, 0.0, lever), speed });
        Self { wheels: vec![left, right, sideways] }
    }
}

impl Task for WheelLimit {
    fn dimension(&self, _model: &Model) -> usize {
        self.wheels.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        if model.base() != Base::Planar {
            return Err(Error::NoPlanarBase { robot: model.name().to_owned() });
        }
        let sideways = Vector3::new(0.0, 1.0, 0.0);
        for wheel in &self.wheels {
            let numbers = wheel.coefficients.iter().all(|number| number.is_finite());
            let drives = wheel.speed > 0.0 && wheel.speed.is_finite();
            if !(numbers && (drives || wheel.coefficients == sideways)) {
                let (what, expected) = ("the speed of a wheel", "positive and finite");
                return Err(Error::Parameter { what, value: wheel.speed, expected });
            }
        }
        Ok(())
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let yaw = input.posed().configuration().get(2).copied().unwrap_or_default();
        let (sine, cosine) = yaw.sin_cos();
        for (row, wheel) in self.wheels.iter().enumerate() {
            let (x, y, z) = (wheel.coefficients.x, wheel.coefficients.y, wheel.coefficients.z);
            // v_base = R(yaw)ᵀ v_world.
            rows.set_coefficients(row, &[x * cosine - y * sine, x * sine + y * cosine, z]);
            rows.set_range(row, -wheel.speed, wheel.speed);
        }
        Ok(())
    }
}

impl Limit for WheelLimit {}
