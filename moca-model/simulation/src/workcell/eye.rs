//! The camera beside the workplace, and the way of its frames to the controller.

use simulated_people::{CameraSettings, FRAME_RATE, Perception, Person, Transport};
use vision_models::{Body, Percept, PersonId, Tool};

use super::faults::Faults;

/// Streams of random numbers.
const WORKER: u64 = 400;
const BYSTANDER: u64 = 410;
const TRANSPORT: u64 = 420;

/// One camera, which knows the person who works with the robot.
#[derive(Clone, Debug)]
pub(super) struct Eye {
    worker: Perception,
    bystander: Perception,
    transport: Transport,
    /// Ticks from one frame to the next.
    interval: u64,
}

impl Eye {
    pub(super) fn new(seed: u64, period: f64) -> Self {
        let faults = Faults::default();
        let perception = |stream, camera| {
            let eyes = [stream, stream + 1].map(|stream| simulated_people::generator(seed, stream));
            Perception::new(PersonId::new(stream), camera, 0.0, Tool::Drill, eyes)
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let interval = (1.0 / (FRAME_RATE * period)).round().max(1.0) as u64;
        Self {
            worker: perception(WORKER, faults.camera()),
            bystander: perception(BYSTANDER, of_bystander(&faults)),
            transport: Transport::new(simulated_people::generator(seed, TRANSPORT)),
            interval,
        }
    }

    /// Sees from now on as faults say.
    pub(super) fn set(&mut self, faults: &Faults) {
        self.worker.set_camera(faults.camera());
        self.bystander.set_camera(of_bystander(faults));
    }

    /// Takes a frame if one is due in a tick, at `now` \[s\].
    pub(super) fn look(
        &mut self,
        (tick, now): (u64, f64),
        worker: &Person,
        bystander: Option<&Person>,
        faults: &Faults,
    ) {
        if !tick.is_multiple_of(self.interval) {
            return;
        }
        let in_view = !faults.occluded;
        let other = bystander.and_then(|person| self.bystander.look(now, person, in_view));
        let others = other.and_then(|percept| percept.body).into_iter().collect();
        let percept = self.worker.look(now, worker, in_view);
        self.transport.send(percept.map(|percept| (percept, others)), faults.latency);
    }

    /// The next frame that has arrived by now \[s\], with the other people in it.
    pub(super) fn arrived(&mut self, now: f64) -> Option<(Percept, Vec<Body>)> {
        self.transport.arrived(now)
    }
}

/// The tracker of others is not simulated: nobody of them is lost from frame to frame.
fn of_bystander(faults: &Faults) -> CameraSettings {
    CameraSettings { drop: 0.0, ..faults.camera() }
}
