//! Bodies with ids: the same person, or another.

use vision_models::PersonId;

use super::*;

/// Beside each other, both could be one person who moved.
#[test]
fn another_id_is_another_person() {
    let mut tracker = tracker();
    let mut see = |frames: std::ops::Range<u32>, id: u64, y: f64| {
        for frame in frames {
            let body = standing_at(vector![2.0, y], 0.0).with_id(PersonId::new(id));
            tracker.update(&percept(FRAME * f64::from(frame), body)).unwrap();
        }
        (tracker.predict(10.0).map(|pose| pose.floor.y), tracker.stature(), tracker.id())
    };
    let (place, stature, id) = see(0..100, 7, 0.0);
    assert!(place.is_some() && stature.is_some());
    assert_eq!(id, Some(PersonId::new(7)));
    // Nothing is known of the second until they are acquired as the first was.
    assert_eq!(see(100..103, 8, 0.1), (None, None, Some(PersonId::new(8))));
    let (place, ..) = see(103..104, 8, 0.1);
    assert!(place.is_some_and(|y| (y - 0.1).abs() < 1e-9), "{place:?}");
}

/// One person alone has no id. They get a new one when somebody else comes.
#[test]
fn who_gets_an_id_stays_the_same_person() {
    let mut tracker = tracker();
    for frame in 0..60_u32 {
        let id = [Some(PersonId::new(1)), None, Some(PersonId::new(2))][frame as usize / 20];
        let body = standing_at(vector![2.0, 0.0], 0.0).with_id(id);
        let time = FRAME * f64::from(frame);
        tracker.update(&percept(time, body)).unwrap();
        assert_eq!(tracker.predict(time).is_some(), frame >= 3, "frame {frame}");
    }
}

/// A frame that is refused changes nothing, whoever it shows.
#[test]
fn a_refused_frame_of_another_changes_nothing() {
    let mut tracker = tracker();
    let body = standing_at(vector![2.0, 0.0], 0.0);
    for frame in 0..10_u32 {
        let body = body.clone().with_id(PersonId::new(1));
        tracker.update(&percept(FRAME * f64::from(frame), body)).unwrap();
    }
    let before = tracker.predict(0.5);
    let other = body.with_id(PersonId::new(2));
    assert!(tracker.update(&percept(0.1, other)).is_err());
    assert_eq!((tracker.predict(0.5), tracker.id()), (before, Some(PersonId::new(1))));
}
