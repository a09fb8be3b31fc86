//! Cameras of a loop in real time. Each reads its ticks as well.

use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(feature = "ros2")]
use std::time::Duration;

#[cfg(feature = "ros2")]
use moca_drivers::ros2::{Ros2People, SeenPeople};
#[cfg(feature = "ros2")]
use moca_model::Scene;
use moca_model::whole_body::control_loop::{Clock, MonotonicClock};
#[cfg(feature = "ros2")]
use vision_models::Percept;

use super::attendant::Attendant;

/// Longest time between two looks at the ticks \[s\].
const READS: f64 = 0.01;

/// Longest time after which a camera without listeners notices the end of the loop.
#[cfg(feature = "ros2")]
const WAKES: Duration = Duration::from_millis(50);

/// A camera that plays the recording in real time, and reads the ticks meanwhile.
pub fn recorded(attendant: &mut Attendant<'_>, ended: &AtomicBool, mut clock: MonotonicClock) {
    let mut camera = attendant.camera();
    while !ended.load(Ordering::Acquire) {
        attendant.attend();
        let now = clock.now();
        let (_, next) = camera.show(now, |frame| attendant.show(frame));
        clock.sleep_until(next.min(now + READS));
    }
}

/// A camera of another node on the ROS 2 graph.
#[cfg(feature = "ros2")]
pub fn seen_by_others(
    people: &Ros2People,
    attendant: &mut Attendant<'_>,
    ended: &AtomicBool,
    clock: MonotonicClock,
) {
    while !ended.load(Ordering::Acquire) {
        attendant.attend();
        people.tell(attendant.state());
        if people.acknowledgements.try_recv().is_ok() {
            attendant.acknowledge();
        }
        let Ok(seen) = people.seen.recv_timeout(WAKES) else { continue };
        let SeenPeople { taken, body, others, action, surface } = seen;
        let age = taken.elapsed().map_or(0.0, |age| age.as_secs_f64());
        let percept = Percept { time: clock.now() - age, body, action, surface };
        attendant.see(Scene::from(percept).with_others(&others));
    }
}
