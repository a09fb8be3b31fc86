//! Classes of `ahqp.simulation`: people who are led, and the camera that sees them.

pub(crate) mod person;
