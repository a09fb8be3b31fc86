//! The frame of a standing person is still, for the camera of the shipped recording.

use ergo_map::PersonFrame;
use moca_model::{ControllerSettings, SharedSpace};
use moca_simulation::people::{Truth, Walker, WalkerSettings};
use nalgebra::Isometry3;

const PERIOD: f64 = 1e-3;

/// Number of frames after which a standing person has come to rest.
const SETTLED: usize = 40;

/// Returns true if the person stands and does not turn from this frame to the next.
fn stands([before, after]: [&Truth; 2]) -> bool {
    let turning = (after.heading - before.heading) / (after.time - before.time);
    before.velocity.norm() < 0.05 && turning.abs() < 0.05
}

#[test]
fn frame_of_a_standing_person_stands() {
    let mut walker = Walker::new(WalkerSettings::default()).unwrap();
    let frames: Vec<_> = std::iter::from_fn(|| walker.next_frame()).collect();
    let tool = Isometry3::translation(0.9, 0.0, 1.0);
    let mut space = SharedSpace::new(&ControllerSettings::default(), &tool).unwrap();
    let (mut still, mut ticks) = (0, 0.0);
    let mut squares = [0.0; 2];
    let mut before: Option<PersonFrame> = None;
    for pair in frames.windows(2) {
        let [(truth, percept), (next, _)] = pair else { continue };
        still = if stands([truth, next]) { still + 1 } else { 0 };
        if let Some(percept) = percept {
            space.observe(percept).unwrap();
        }
        let mut now = truth.time;
        while now < next.time - 0.5 * PERIOD {
            let situation = space.advance(now, PERIOD).unwrap();
            let frame = situation.frame;
            if let Some(before) = before
                && still > SETTLED
                && situation.freshness().is_usable()
            {
                let moved = frame.position() - before.position();
                let turned = frame.heading() - before.heading();
                squares[0] += (moved.norm() / PERIOD).powi(2);
                squares[1] += (turned.sin() / PERIOD).powi(2);
                ticks += 1.0;
            }
            before = Some(frame);
            now += PERIOD;
        }
    }
    let [speed, rate] = squares.map(|sum| f64::sqrt(sum / ticks));
    println!("{speed:.4} m/s, {rate:.4} rad/s in {:.1} s", ticks * PERIOD);
    assert!(ticks > 10_000.0, "{ticks}");
    assert!(speed <= 0.015 && rate <= 0.02, "{speed} m/s, {rate} rad/s");
}
