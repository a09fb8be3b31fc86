//! Torques that follow velocities, and external torques from torques and motion.

pub(crate) mod contact_force;
pub(crate) mod control;
pub(crate) mod delay_probe;
pub(crate) mod impedance;
mod joints;
pub(crate) mod law;
pub(crate) mod measurement_watch;
pub(crate) mod momentum_observer;
pub(crate) mod prediction;
pub(crate) mod resynchronisation;
pub(crate) mod support;

pub use contact_force::ContactForce;
pub use control::TorqueControl;
pub use delay_probe::{DelayProbe, ProbeAnswer};
pub use impedance::{ImpedanceSettings, JointImpedance, JointState, RateLimit};
pub use law::{TorqueLaw, TorqueSettings};
pub use measurement_watch::{MeasurementFault, MeasurementWatch};
pub use momentum_observer::{MomentumObserver, ObservedFriction, ObserverSettings};
pub use prediction::StatePrediction;
pub use resynchronisation::{Following, FollowingErrorSettings, Resynchronisation};
pub use support::{CompensatedBy, Compensation, SupportTorque, SupportedMotion};
