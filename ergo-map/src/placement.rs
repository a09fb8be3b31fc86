use core::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use crate::error::{Result, within};
use crate::person_frame::PersonFrame;
use crate::quadratic::ErgonomicsQuadratic;

/// How fast a placed quadratic may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacementLimits {
    /// Speed of the person's frame \[m/s\]. Above a walk, so that only jumps of the tracking are
    /// held back.
    pub speed: f64,
    /// Turning rate of the person's frame \[rad/s\].
    pub turn_rate: f64,
    /// Rate of the Hessian (Frobenius norm) when the quadratic itself is replaced \[1/(m² s)\].
    pub hessian_rate: f64,
    /// Rate of the gradient at the person's origin when the quadratic itself is replaced
    /// \[1/(m s)\].
    pub gradient_rate: f64,
}

impl Default for PlacementLimits {
    fn default() -> Self {
        Self { speed: 2.5, turn_rate: 4.0, hessian_rate: 20.0, gradient_rate: 20.0 }
    }
}

impl PlacementLimits {
    /// Checks that every limit is positive and finite.
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`] or [`crate::Error::OutOfRange`] with the name of the limit.
    pub fn validate(&self) -> Result<()> {
        within("speed", self.speed, [1e-6, 1e6], "m/s")?;
        within("turn_rate", self.turn_rate, [1e-6, 1e6], "rad/s")?;
        within("hessian_rate", self.hessian_rate, [1e-6, 1e9], "1/(m² s)")?;
        within("gradient_rate", self.gradient_rate, [1e-6, 1e9], "1/(m s)")?;
        Ok(())
    }
}

/// The quadratic of a tracked person in the world, with bounded rates of change.
///
/// [`observe`](Placement::observe) takes what the tracker says, whenever it says it;
/// [`advance`](Placement::advance) is called every tick and moves the person's frame towards the
/// last observation no faster than the limits. The world's Hessian is always a rotated convex
/// combination of convex ones, hence convex.
///
/// ```
/// use ergo_map::{ErgonomicsQuadratic, PersonFrame, Placement, PlacementLimits};
/// use nalgebra::{Matrix3, Vector3};
/// let quadratic = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::zeros(), 0.0)?;
/// let here = PersonFrame::new(Vector3::zeros(), 0.0)?;
/// let mut placement = Placement::new(quadratic, here, PlacementLimits::default())?;
/// placement.observe(PersonFrame::new(Vector3::new(3.0, 0.0, 0.0), 0.0)?); // the tracker jumps
/// placement.advance(0.001)?;
/// assert!(placement.frame().position().x <= 0.0025 + 1e-12);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Placement {
    limits: PlacementLimits,
    frame: PersonFrame,
    observed: PersonFrame,
    quadratic: ErgonomicsQuadratic,
    replacement: ErgonomicsQuadratic,
    world: ErgonomicsQuadratic,
}

impl Placement {
    /// A person's quadratic (in their frame), placed where they stand.
    ///
    /// # Errors
    /// See [`PlacementLimits::validate`].
    pub fn new(
        quadratic: ErgonomicsQuadratic,
        frame: PersonFrame,
        limits: PlacementLimits,
    ) -> Result<Self> {
        limits.validate()?;
        let world = quadratic.placed(&frame);
        Ok(Self { limits, frame, observed: frame, quadratic, replacement: quadratic, world })
    }

    /// Takes the newest frame of the person.
    pub fn observe(&mut self, frame: PersonFrame) {
        self.observed = frame;
    }

    /// Takes another quadratic in the person's frame: another person's, or a local refit.
    pub fn replace(&mut self, quadratic: ErgonomicsQuadratic) {
        self.replacement = quadratic;
    }

    /// Moves on by one tick of `dt` \[s\] and returns the quadratic in the world. Allocates
    /// nothing.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for a tick that is not in (0, 1] s.
    pub fn advance(&mut self, dt: f64) -> Result<&ErgonomicsQuadratic> {
        let dt = within("dt", dt, [1e-9, 1.0], "s")?;
        self.move_frame(dt)?;
        self.blend(dt);
        self.world = self.quadratic.placed(&self.frame);
        Ok(&self.world)
    }

    /// The quadratic in the world as of the last tick.
    pub fn world(&self) -> &ErgonomicsQuadratic {
        &self.world
    }

    /// The person's frame as of the last tick.
    pub fn frame(&self) -> &PersonFrame {
        &self.frame
    }

    /// A bound on the rate of the world's Hessian, Frobenius norm \[1/(m² s)\].
    pub fn hessian_rate_bound(&self) -> f64 {
        let largest = self.quadratic.hessian().norm().max(self.replacement.hessian().norm());
        2.0 * self.limits.turn_rate * largest + self.limits.hessian_rate
    }

    /// A bound on the rate of the world gradient at a world point no further than `distance` \[m\]
    /// from the person \[1/(m s)\].
    pub fn gradient_rate_bound(&self, distance: f64) -> f64 {
        let hessian = self.quadratic.hessian().norm().max(self.replacement.hessian().norm());
        let gradient = self.quadratic.gradient().norm().max(self.replacement.gradient().norm());
        let PlacementLimits { speed, turn_rate, hessian_rate, gradient_rate } = self.limits;
        hessian * speed
            + turn_rate * (2.0 * hessian * distance + gradient)
            + hessian_rate * distance
            + gradient_rate
    }

    fn move_frame(&mut self, dt: f64) -> Result<()> {
        let way: Vector3<f64> = self.observed.position() - self.frame.position();
        let distance = way.norm();
        let most = self.limits.speed * dt;
        let position = if distance <= most {
            *self.observed.position()
        } else {
            self.frame.position() + way * (most / distance)
        };
        // The shorter way round, in [-π, π).
        let turn = (self.observed.heading() - self.frame.heading() + PI).rem_euclid(TAU) - PI;
        let most = self.limits.turn_rate * dt;
        self.frame = PersonFrame::new(position, self.frame.heading() + turn.clamp(-most, most))?;
        Ok(())
    }

    fn blend(&mut self, dt: f64) {
        if self.quadratic == self.replacement {
            return;
        }
        let hessian = (self.replacement.hessian() - self.quadratic.hessian()).norm();
        let gradient = (self.replacement.gradient() - self.quadratic.gradient()).norm();
        let PlacementLimits { hessian_rate, gradient_rate, .. } = self.limits;
        let share = (hessian_rate * dt / hessian).min(gradient_rate * dt / gradient);
        // Both distances zero give NaN: then only the constant differs.
        self.quadratic = if share.is_nan() || share >= 1.0 {
            self.replacement
        } else {
            self.quadratic.blended(&self.replacement, share)
        };
    }
}
