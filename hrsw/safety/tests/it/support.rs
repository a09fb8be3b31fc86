//! Random vectors and capsules.

use hrsw_safety::Capsule;
use nalgebra::{Vector3, Vector6};
use proptest::prelude::*;

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(move |v| Vector3::from(v) * size)
}

pub(crate) fn twist() -> impl Strategy<Value = Vector6<f64>> {
    prop::array::uniform6(-0.5..0.5_f64).prop_map(Vector6::from)
}

pub(crate) fn capsule(reach: f64) -> impl Strategy<Value = Capsule> {
    prop_oneof![
        (vector(reach), vector(reach), 0.02..0.4_f64)
            .prop_map(|(a, b, radius)| Capsule::new(a, b, radius).unwrap()),
        (vector(reach), 0.02..0.4_f64)
            .prop_map(|(center, radius)| Capsule::sphere(center, radius).unwrap()),
    ]
}
