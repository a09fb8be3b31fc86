//! A robot that stays behind by the following distance stops in time, and is never asked to go
//! back.

use hrsw_safety::{BaseBraking, FollowingDistance, SeparationSettings};
use proptest::prelude::*;

const PERIOD: f64 = 1e-3;

/// Generates terms of S_p, the clearance, and the speeds of the person with the number of ticks for
/// each.
fn walks() -> impl Strategy<Value = (SeparationSettings, f64, Vec<(f64, u32)>)> {
    let terms = (0.05..0.4, 0.3..3.0, 0.0..0.2, 0.0..0.1, prop::option::of(0.3..2.0)).prop_map(
        |(reaction_time, deceleration, intrusion, human_uncertainty, base)| SeparationSettings {
            reaction_time,
            deceleration,
            intrusion,
            human_uncertainty,
            base: base.map(|deceleration| BaseBraking { joints: 3, deceleration }),
            ..SeparationSettings::default()
        },
    );
    let walk = prop::collection::vec((-1.0..1.6, 1..3000_u32), 1..6);
    // The robot may be at rest at its place of work.
    (terms, 0.31..0.6, walk)
}

/// Returns S_p for a person who stands still, without the margins \[m\].
fn stopping(terms: &SeparationSettings, speed: f64) -> f64 {
    let deceleration = terms.base.map_or(terms.deceleration, |base| base.deceleration);
    speed * terms.reaction_time + speed * speed / (2.0 * deceleration)
}

fn margin(terms: &SeparationSettings) -> f64 {
    terms.intrusion + terms.human_uncertainty + terms.robot_uncertainty
}

proptest! {
    /// Whenever the person stands still, a robot that kept the following distance so far stops in
    /// front of them.
    #[test]
    fn a_robot_at_the_following_distance_stops((terms, clearance, walk) in walks()) {
        let mut following = FollowingDistance::new(terms, clearance).unwrap();
        for (speed, ticks) in walk {
            for _ in 0..ticks {
                let before = following.distance();
                following.advance(speed, PERIOD).unwrap();
                let growth = (following.distance() - before) / PERIOD;
                let follows = speed.max(0.0) - growth;
                prop_assert!(follows > -1e-9, "it goes back at {follows} m/s");
                let rest = clearance + before - stopping(&terms, follows) - margin(&terms);
                prop_assert!(rest > -1e-9, "it comes too near by {rest} m");
                // The robot may also move as fast at the place that the camera shows T_r late.
                let seen = rest - speed.max(0.0) * terms.reaction_time;
                prop_assert!(seen > -1e-9 || follows < 1e-9, "it seems too near by {seen} m");
            }
        }
    }

    /// The person walks on at one speed and is seen T_r late. The following distance becomes what
    /// S_p demands beyond the clearance.
    #[test]
    fn it_settles_at_the_protective_distance((terms, clearance, walk) in walks(), period in 1e-3..0.5) {
        let mut following = FollowingDistance::new(terms, clearance).unwrap();
        for &(speed, _) in &walk {
            for _ in 0..100_000 {
                following.advance(speed, period).unwrap();
            }
            let speed = speed.max(0.0);
            let needed = stopping(&terms, speed) + margin(&terms) + speed * terms.reaction_time;
            let expected = (needed - clearance).max(0.0);
            prop_assert!((following.distance() - expected).abs() < 1e-6);
            prop_assert!((following.at(speed) - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn invalid_motions_change_nothing() {
    let terms = SeparationSettings::default();
    let mut following = FollowingDistance::new(terms, 0.2).unwrap();
    following.advance(1.0, 0.5).unwrap();
    let before = following;
    for (speed, period) in
        [(f64::NAN, PERIOD), (f64::INFINITY, PERIOD), (1.0, 0.0), (1.0, -1.0), (1.0, f64::NAN)]
    {
        assert!(following.advance(speed, period).is_err());
        assert_eq!(following, before);
    }
    assert!(FollowingDistance::new(terms, -0.1).is_err());
    assert!(FollowingDistance::new(terms, f64::NAN).is_err());
    assert!(
        FollowingDistance::new(SeparationSettings { deceleration: 0.0, ..terms }, 0.2).is_err()
    );
}
