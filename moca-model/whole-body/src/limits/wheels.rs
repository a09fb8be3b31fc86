//! Wheel speed limits of a base that moves on a plane.

use nalgebra::Vector3;

use super::joint_intervals::heading::turning_acceleration;
use crate::error::Error;
use crate::robot::model::Model;
use crate::tasks::input::TaskInput;
use crate::tasks::rows::TaskRows;
use crate::tasks::task::{Limit, Task};

/// Limits the speed of each wheel of a planar base: |c · (v_x, v_y, ω)| ≤ speed, with the velocity in the base's own
/// axes.
///
/// **Jerk limits.** Jerk limits along the world's axes prevent a base that rotates from rotating its velocity at once.
/// If the base's joints have them, a stricter limit is used that holds at every yaw: |c_xy| ‖v_xy‖ + |c_ω ω| ≤ speed. A
/// polygon of 16 sides approximates the norm. Mecanum wheels then lose up to 30 % of their speed along the base's axes.
/// A base that cannot move sideways cannot have such joints and is refused.
///
/// The polygon is approached so that all accelerations of the base can fade together in front of it: a ← a T/(T + Δt).
/// Here T is the longest time a/j that one of its joints needs. If v and v + T a are within the limit, all following
/// velocities are. The limit then holds exactly, and the distance to it shrinks by at most the share Δt/(T + Δt) a
/// step.
///
/// **Bases that cannot move sideways.** A velocity v along the heading rotates with the base, which takes accelerations
/// of its joints along x and y. Such a base keeps |v ω| ≤ 0.6 a, where a is the smaller of the two limits, and never
/// slides. The rows |v/v₀ ± ω/ω₀| ≤ 2 with v₀ ω₀ = 0.6 a suffice, because the geometric mean is at most the arithmetic
/// one. The ratio v₀/ω₀ is that of the largest values in the next period.
///
/// ```
/// use whole_body::limits::WheelLimit;
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
    /// A velocity of the base that the limit is to admit, in world axes.
    admitted: Option<Vector3<f64>>,
}

/// A wheel, or a direction in which a base is slower or cannot move.
#[derive(Debug, Clone, Copy)]
struct Wheel {
    coefficients: Vector3<f64>,
    speed: f64,
}

impl WheelLimit {
    /// Creates the limit of four mecanum wheels whose rims reach `speed` \[m/s\]: |v_x| + |v_y| + lever |ω| ≤ speed.
    ///
    /// `lever` \[m\] is half the sum of wheelbase and track (Taheri, Qiao, Ghaeminezhad, "Kinematic model of a four
    /// mecanum wheeled mobile robot", 2015, eq. 20).
    pub fn mecanum(speed: f64, lever: f64) -> Self {
        let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let wheel = |(y, turn): (f64, f64)| Wheel {
            coefficients: Vector3::new(1.0, y, turn * lever),
            speed,
        };
        Self::of(signs.map(wheel).to_vec())
    }

    /// Creates the limit of omni wheels whose rims reach `speed` \[m/s\].
    ///
    /// The wheels are `radius` \[m\] from the centre in the directions `angles` \[rad, from the base's x axis\]. They
    /// drive at right angles to these (Siegwart, Nourbakhsh, Scaramuzza, *Introduction to Autonomous Mobile Robots*,
    /// 2011, Sec. 3.2.3).
    pub fn omni(speed: f64, radius: f64, angles: &[f64]) -> Self {
        let wheel = |angle: &f64| Wheel {
            coefficients: Vector3::new(-angle.sin(), angle.cos(), radius),
            speed,
        };
        Self::of(angles.iter().map(wheel).collect())
    }

    /// Creates the limit of two driven wheels on the base's y axis, `track` \[m\] apart, whose rims reach `speed`
    /// \[m/s\]. The base does not move sideways.
    pub fn differential(speed: f64, track: f64) -> Self {
        let half = 0.5 * track;
        let sideways = Wheel { coefficients: Vector3::new(0.0, 1.0, 0.0), speed: 0.0 };
        let [left, right] =
            [-half, half].map(|lever| Wheel { coefficients: Vector3::new(1.0, 0.0, lever), speed });
        Self::of(vec![left, right, sideways])
    }

    fn of(wheels: Vec<Wheel>) -> Self {
        Self { wheels, admitted: None }
    }

    /// Also limits the speed along each of the base's own axes \[m/s\]. The rows of a base with jerk limits hold at every
    /// yaw. They then limit the translation in all directions to the lower of the speeds, together with the rotation.
    #[must_use]
    pub fn with_axis_speed(mut self, speed: f64) -> Self {
        let axes = [Vector3::x(), Vector3::y()];
        self.wheels.extend(axes.map(|coefficients| Wheel { coefficients, speed }));
        self
    }

    /// Widens the limit so that it admits this velocity of the base, (v_x, v_y, ω) in world axes. A base that turns while
    /// it drives at the limit cannot turn its velocity at once. The bounds of a [`TaskStack`](crate::stack::TaskStack)
    /// may then contradict the limit.
    pub fn admit(&mut self, velocity: Vector3<f64>) {
        self.admitted = Some(velocity);
    }
}

/// Half the number of sides of the polygon that approximates a circle. Each row has two sides.
const SIDES: u32 = 8;

/// True if joints of the base have jerk limits.
fn has_jerk_limits(model: &Model) -> bool {
    model.limits().iter().take(3).any(|limits| limits.jerk.is_finite())
}

impl WheelLimit {
    /// The rows that hold for every yaw, in world axes, each with its bound.
    fn rows_of_any_yaw(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        // The wheel that reaches its limit first counts, for translation and for rotation.
        let most = |part: fn(&Vector3<f64>) -> f64| {
            let parts = self.wheels.iter().map(|wheel| part(&wheel.coefficients) / wheel.speed);
            parts.fold(0.0, f64::max)
        };
        let (straight, turning) = (most(|c| c.xy().norm()), most(|c| c.z.abs()));
        (0..SIDES).flat_map(move |side| {
            let half = std::f64::consts::FRAC_PI_2 / f64::from(SIDES);
            let (sine, cosine) = (2.0 * half * f64::from(side)).sin_cos();
            let along = straight / half.cos();
            [turning, -turning].map(|turn| (Vector3::new(along * cosine, along * sine, turn), 1.0))
        })
    }

    /// Writes the two rows of a base whose velocity rotates with it.
    fn write_turning(
        &self,
        input: &TaskInput<'_, '_>,
        [sine, cosine]: [f64; 2],
        rows: &mut TaskRows<'_>,
    ) {
        let (Some([x, y, yaw]), Some(&[vx, vy, turn])) =
            (input.posed().model().limits().first_chunk(), input.velocity().first_chunk())
        else {
            return;
        };
        let product = turning_acceleration(x.acceleration.min(y.acceleration));
        // The largest speeds that the wheels allow, for translation and for rotation.
        let fastest = |part: fn(&Vector3<f64>) -> f64| {
            let driven = self.wheels.iter().filter(|wheel| wheel.speed > 0.0);
            let speeds = driven.map(|wheel| wheel.speed / part(&wheel.coefficients));
            speeds.fold(f64::INFINITY, f64::min)
        };
        let next = |now: f64, acceleration: f64, most: f64| {
            (now.abs() + acceleration * input.period()).min(most)
        };
        let speed = next(cosine * vx + sine * vy, x.acceleration, fastest(|c| c.x.abs()));
        let turn = next(turn, yaw.acceleration, fastest(|c| c.z.abs()));
        let (speed, turn) = ((product * speed / turn).sqrt(), (product * turn / speed).sqrt());
        for (row, sign) in (self.wheels.len()..).zip([1.0, -1.0]) {
            let mut coefficients = Vector3::zeros();
            if speed.is_finite() && turn.is_finite() {
                coefficients = Vector3::new(cosine / speed, sine / speed, sign / turn);
                rows.set_coefficients(row, &coefficients);
            }
            self.set_range(rows, row, coefficients, [-2.0, 2.0]);
        }
    }

    /// Writes the range of a row, widened to include the admitted velocity.
    fn set_range(
        &self,
        rows: &mut TaskRows<'_>,
        row: usize,
        coefficients: Vector3<f64>,
        [lower, upper]: [f64; 2],
    ) {
        let admitted = self.admitted.map(|velocity| coefficients.dot(&velocity));
        let [least, most] = [lower, upper].map(|bound| admitted.unwrap_or(bound));
        rows.set_range(row, lower.min(least), upper.max(most));
    }

    /// Writes rows within which all accelerations of the base can fade together.
    fn write_fading(&self, input: &TaskInput<'_, '_>, rows: &mut TaskRows<'_>) {
        let (model, v) = (input.posed().model(), input.velocity());
        let share = input.period() / (input.period() + model.base_fading_time());
        let speeds = model.limits().iter().take(3).map(|limits| limits.velocity).enumerate();
        let axes = speeds.map(|(axis, speed)| (Vector3::ith(axis, 1.0), speed));
        for (row, (coefficients, speed)) in self.rows_of_any_yaw().chain(axes).enumerate() {
            rows.set_coefficients(row, coefficients.iter());
            let value: f64 = coefficients.iter().zip(v).map(|(c, v)| c * v).sum();
            // A value beyond the limit returns to it as fast as the joints allow.
            let value = value.max(-speed).min(speed);
            let towards = |bound: f64| value + (bound - value) * share;
            self.set_range(rows, row, coefficients, [towards(-speed), towards(speed)]);
        }
    }
}

impl Task for WheelLimit {
    fn dimension(&self, model: &Model) -> usize {
        if has_jerk_limits(model) {
            2 * SIDES as usize + 3
        } else {
            self.wheels.len() + if self.keeps_heading() { 2 } else { 0 }
        }
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        if !model.moves_on_a_plane() {
            return Err(Error::unsuitable(
                format!("robot `{}` has no planar base", model.name()),
                "read it with a planar one, or let its first joints slide, slide and turn",
            ));
        }
        let sideways = Vector3::new(0.0, 1.0, 0.0);
        for wheel in &self.wheels {
            let numbers = wheel.coefficients.iter().all(|number| number.is_finite());
            let drives = wheel.speed > 0.0 && wheel.speed.is_finite();
            if !(numbers && (drives || wheel.coefficients == sideways)) {
                let (what, expected) = ("the speed of a wheel", "positive and finite");
                return Err(Error::value(what, wheel.speed, expected));
            }
            if !drives && has_jerk_limits(model) {
                let what = format!(
                    "the base of robot `{}` has jerk limits along the world's axes, with which it cannot turn without \
                     moving sideways",
                    model.name()
                );
                return Err(Error::unsuitable(what, "leave them out"));
            }
        }
        Ok(())
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn anticipates(&self) -> bool {
        true
    }

    fn keeps_heading(&self) -> bool {
        self.wheels.iter().any(|wheel| wheel.speed == 0.0)
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        if has_jerk_limits(input.posed().model()) {
            self.write_fading(input, rows);
            return Ok(());
        }
        let yaw = input.posed().configuration().get(2).copied().unwrap_or_default();
        let (sine, cosine) = yaw.sin_cos();
        for (row, wheel) in self.wheels.iter().enumerate() {
            let (x, y, z) = (wheel.coefficients.x, wheel.coefficients.y, wheel.coefficients.z);
            // v_base = R(yaw)ᵀ v_world.
            let coefficients = Vector3::new(x * cosine - y * sine, x * sine + y * cosine, z);
            rows.set_coefficients(row, &coefficients);
            self.set_range(rows, row, coefficients, [-wheel.speed, wheel.speed]);
        }
        if self.keeps_heading() {
            self.write_turning(input, [sine, cosine], rows);
        }
        Ok(())
    }
}

impl Limit for WheelLimit {}
