//! Contacts with parts of a person: two masses with a spring between them.

use hrsw_safety::{BodyRegion, ContactKind, ContactLimit, ContactLimits, Error, RegionLimits};
use proptest::prelude::*;

/// Returns the largest force between two free masses that meet at `speed`, simulated step by step.
fn simulated_force(limit: &ContactLimit, robot_mass: f64, speed: f64) -> f64 {
    let reduced = limit.mass * robot_mass / (limit.mass + robot_mass);
    let step = 1e-4 * (reduced / limit.stiffness).sqrt();
    // Positions and velocities of robot and part along the line between them.
    let (mut places, mut velocities, mut largest) = ([0.0; 2], [speed, 0.0], 0.0_f64);
    loop {
        let force = limit.stiffness * (places[0] - places[1]);
        if force < 0.0 {
            return largest;
        }
        largest = largest.max(force);
        velocities[0] -= force / robot_mass * step;
        velocities[1] += force / limit.mass * step;
        for (place, velocity) in places.iter_mut().zip(velocities) {
            *place += velocity * step;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_allowed_speed_reaches_the_largest_force(
        force in 50.0..300.0_f64, stiffness in 1e4..1.5e5_f64, mass in 0.5..75.0_f64,
        robot in 0.5..300.0_f64,
    ) {
        let limit = ContactLimit { force, stiffness, mass };
        let reached = simulated_force(&limit, robot, limit.speed(robot));
        prop_assert!((reached / force - 1.0).abs() < 1e-3, "{reached} N of {force} N");
        prop_assert!(limit.speed(f64::INFINITY) < limit.speed(robot));
    }
}

/// Compares with F / √(k μ) computed by hand for transient contacts, with twice the quasi-static
/// forces. The robots are a Panda of 12 kg alone and one with a base of 169 kg behind it.
#[test]
fn contact_speeds_match_a_computation_by_hand() {
    let limits = ContactLimits::default().with_kind(ContactKind::Transient);
    for (region, robot, speed) in [
        (BodyRegion::Chest, 12.0, 0.58),
        (BodyRegion::Forearm, 12.0, 1.22),
        (BodyRegion::Hand, 12.0, 1.35),
        (BodyRegion::Chest, 181.0, 0.31),
        (BodyRegion::Thigh, 181.0, 0.27),
    ] {
        let allowed = limits.of(region).unwrap().speed(robot);
        assert!((allowed - speed).abs() < 0.01, "{region:?}: {allowed} m/s, not {speed}");
        let lasting = ContactLimits::default().of(region).unwrap().speed(robot);
        assert!((2.0 * lasting - allowed).abs() < 1e-12);
    }
}

#[test]
fn no_contact_with_the_head_is_planned() {
    let limits = ContactLimits::default();
    for region in BodyRegion::ALL {
        assert_eq!(limits.of(region).is_none(), region.is_of_the_head(), "{region:?}");
    }
    let soft = RegionLimits { force: 0.0, pressure: 1e6, stiffness: 1e4, mass: 10.0 };
    let limits = limits.with(BodyRegion::Abdomen, soft).unwrap();
    assert!(limits.of(BodyRegion::Abdomen).is_none());
    // The pressure limits a robot with a sharp edge: 200 N/cm² on 0.1 cm².
    let sharp = limits.with_area(1e-5).unwrap().of(BodyRegion::Hand).unwrap();
    assert!((sharp.force - 20.0).abs() < 1e-9);
}

#[test]
fn invalid_contact_limits_are_named() {
    let sound = RegionLimits { force: 100.0, pressure: 1e6, stiffness: 1e4, mass: 10.0 };
    for wrong in [
        RegionLimits { force: -1.0, ..sound },
        RegionLimits { force: f64::NAN, ..sound },
        RegionLimits { pressure: 0.0, ..sound },
        RegionLimits { stiffness: f64::INFINITY, ..sound },
        RegionLimits { mass: 0.0, ..sound },
    ] {
        let limits = ContactLimits::default().with(BodyRegion::Hand, wrong);
        assert!(matches!(limits, Err(Error::Value { .. })), "{wrong:?}");
    }
    for area in [0.0, -1.0, f64::NAN] {
        assert!(ContactLimits::default().with_area(area).is_err());
    }
}
