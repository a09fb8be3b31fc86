//! Friction in a joint.

/// A smooth model of a joint's friction:
/// τ_f = φ₁ / (1 + exp(−φ₂ (q̇ + φ₃))) − φ₁ / (1 + exp(−φ₂ φ₃)).
///
/// Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca, "Dynamic identification of the Franka Emika
/// Panda robot with retrieval of feasible parameters using penalty-based optimization", RA-L 2019.
///
/// ```
/// use whole_body::robot::JointFriction;
///
/// let elbow = JointFriction::PANDA[3];
/// assert_eq!(elbow.torque(0.0), 0.0);
/// assert!(elbow.torque(1.0) > 0.5 && elbow.torque(-1.0) < -0.5); // Nm, against the motor
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointFriction {
    /// φ₁: difference between the friction at high speed in both directions \[Nm or N\].
    pub range: f64,
    /// φ₂: steepness at low speed \[s/rad or s/m\].
    pub steepness: f64,
    /// φ₃: asymmetry of both directions \[rad/s or m/s\].
    pub shift: f64,
}

impl JointFriction {
    /// The seven joints of a Franka Emika Panda, as identified in the paper.
    pub const PANDA: [Self; 7] = [
        Self { range: 0.54615, steepness: 5.1181, shift: 0.039533 },
        Self { range: 0.87224, steepness: 9.0657, shift: 0.025882 },
        Self { range: 0.64068, steepness: 10.136, shift: -0.04607 },
        Self { range: 1.2794, steepness: 5.5903, shift: 0.036194 },
        Self { range: 0.83904, steepness: 8.3469, shift: 0.026226 },
        Self { range: 0.30301, steepness: 17.133, shift: -0.021047 },
        Self { range: 0.56489, steepness: 10.336, shift: 0.0035526 },
    ];

    /// The friction that a motor must overcome at `velocity` \[rad/s or m/s\]; it has the sign of the velocity \[Nm or
    /// N\].
    pub fn torque(&self, velocity: f64) -> f64 {
        let sigmoid =
            |velocity: f64| 1.0 / (1.0 + (-self.steepness * (velocity + self.shift)).exp());
        self.range * (sigmoid(velocity) - sigmoid(0.0))
    }
}
