//! `ahqp.ergo`: REBA, RULA, posture prediction and maps.

pub(crate) mod keywords;
pub(crate) mod map;
pub(crate) mod person;
pub(crate) mod posture;
pub(crate) mod reba;
pub(crate) mod rula;
