//! Record of a loop's tick, for a thread that records and shows it.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use hrsw_safety::{Cause, SafetyState};
use moca_model::{Command, Controller, Phase, Transition};
use moca_replay::report::{TickRow, Together};
use nalgebra::{Isometry3, Vector6};
use vision_models::TrackedPerson;

/// Ticks that may wait: two seconds at 1 kHz.
const WAITING: usize = 2000;

/// Record of the controller's tick.
#[derive(Clone, Debug)]
pub struct LoopTick {
    /// Poses, workspace and joints, on the clock of the loop. The scores of the person are left to the reader.
    pub row: TickRow,
    /// Pose of the tool in the world.
    pub tool: Isometry3<f64>,
    /// ẋ_d, linear, then angular, in world axes \[m/s, rad/s\].
    pub desired_twist: Vector6<f64>,
    /// Phase of the interaction.
    pub phase: Phase,
    /// Change of the phase in this tick.
    pub transition: Option<Transition>,
    /// Safety state.
    pub safety: SafetyState,
    /// Cause of the safety state.
    pub cause: Option<Cause>,
    /// True if a stop waits for an acknowledgement.
    pub waits: bool,
    /// The person as tracked.
    pub person: Option<TrackedPerson>,
    /// True if the controller knows of an object in the gripper.
    pub holds: bool,
}

impl LoopTick {
    fn new(controller: &Controller) -> Self {
        let mut tick = Self {
            row: TickRow::default(),
            tool: Isometry3::identity(),
            desired_twist: Vector6::zeros(),
            phase: Phase::Apart,
            transition: None,
            safety: SafetyState::Normal,
            cause: None,
            waits: false,
            person: None,
            holds: false,
        };
        tick.write(0.0, controller, &controller.command().joint_position, 0.0);
        tick
    }

    fn write(&mut self, now: f64, controller: &Controller, position: &[f64], step_us: f64) {
        let hand = controller.actual().translation.vector;
        self.row.write(now, controller, (&hand, position), step_us);
        let &Command { desired_twist, phase, transition, safety, .. } = controller.command();
        let supervisor = controller.safety().supervisor();
        self.tool = *controller.robot().world_from_tool();
        (self.desired_twist, self.phase, self.transition) = (desired_twist, phase, transition);
        (self.safety, self.cause) = (safety, supervisor.cause().copied());
        self.waits = supervisor.unacknowledged().is_some();
        self.person = controller.situation().worker;
        self.holds = controller.object().is_some();
    }
}

/// The loop's end of the ticks. It never waits and allocates nothing: ticks that were read come back to be written again.
#[derive(Debug)]
pub(crate) struct TickSender {
    written: SyncSender<LoopTick>,
    spare: Receiver<LoopTick>,
    together: Together,
}

/// The ticks of an [`AnnouncedLaw`](super::AnnouncedLaw), for the thread that reads them.
#[derive(Debug)]
pub struct Ticks {
    written: Receiver<LoopTick>,
    spare: SyncSender<LoopTick>,
}

/// Creates both ends for a controller that has not made a step.
pub(crate) fn tick_channel(controller: &Controller) -> (TickSender, Ticks) {
    let (written, reader) = sync_channel(WAITING);
    let (spare, writer) = sync_channel(WAITING);
    for _ in 0..WAITING {
        // There is room for as many.
        let _ = spare.try_send(LoopTick::new(controller));
    }
    let sender = TickSender { written, spare: writer, together: Together::default() };
    (sender, Ticks { written: reader, spare })
}

impl TickSender {
    /// Sends a tick, unless nobody has read for two seconds.
    pub(crate) fn send(
        &mut self,
        now: f64,
        controller: &Controller,
        position: &[f64],
        step_us: f64,
    ) {
        let together = self.together.update(controller);
        let Ok(mut tick) = self.spare.try_recv() else { return };
        tick.write(now, controller, position, step_us);
        tick.row.collaborating = together;
        let _ = self.written.try_send(tick);
    }
}

impl Ticks {
    /// Reads the ticks that have come. Never waits. To be called at least once a second, as later ticks are left out.
    pub fn read(&self, mut each: impl FnMut(&mut LoopTick)) {
        while let Ok(mut tick) = self.written.try_recv() {
            each(&mut tick);
            // The loop may have ended.
            let _ = self.spare.try_send(tick);
        }
    }
}
