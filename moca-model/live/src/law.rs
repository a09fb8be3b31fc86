//! The workcell in real time.

use std::borrow::Cow;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use moca_drivers::FaultLog;
use moca_replay::recorded::Tone;
use moca_simulation::Error;
use moca_simulation::workcell::Workcell;
use whole_body::control_loop::{
    ControlLaw, JointCommand, JointMeasurement, Received, RobotSide, TimeHistogram,
};

use crate::desk::{Desk, Order};
use crate::error as live;
use crate::head::{Head, SettingsText, sampler};
use crate::picture::{Moment, Pace, Picture, began};
use crate::request::Request;
use crate::run::{INTERVAL, Run};

/// Largest number of periods that are made up for; a loop that is later goes on as if the time had stood still meanwhile.
const ASLEEP: u64 = 50;
/// Slower than this the robot is at rest \[m/s, rad/s\].
const REST: f64 = 5e-3;

/// A workcell as the law of a [`ControlLoop`](whole_body::control_loop::ControlLoop): each tick of the loop is a period
/// of robot, controller and people. Ticks that the loop misses are made up for in the next one.
#[derive(Debug)]
pub struct Law {
    run: Run,
    /// The same robot with the other choice of ergonomics, if a page asks for it.
    beside: Option<Box<Run>>,
    desk: Arc<Desk>,
    orders: Receiver<Order>,
    /// When the first period of this workcell began \[s\].
    begun: Option<f64>,
    head: u64,
    faults: FaultLog,
    pictures: u64,
    heard: u64,
    stops: bool,
    since: (Cow<'static, str>, Tone),
    durations: TimeHistogram,
    /// Ticks that came late, and those that never came.
    late: u64,
    lost: u64,
    next_picture: f64,
}

impl Law {
    /// Moves a workcell; gives the desk at which its pages get their pictures and leave their orders. They show and change
    /// its settings as text.
    ///
    /// # Errors
    /// A robot that cannot be shown, and settings that no file holds.
    pub fn new(cell: Workcell, text: SettingsText) -> Result<(Self, Arc<Desk>), live::Error> {
        let sampler = sampler(&cell)?;
        let head = Head::new(cell.setup(), &sampler, text)?;
        let number = head.number;
        let (desk, orders) = Desk::new(head);
        let law = Self {
            head: number,
            run: Run::new(cell, sampler),
            beside: None,
            desk: Arc::clone(&desk),
            orders,
            begun: None,
            faults: FaultLog::default(),
            pictures: 0,
            heard: 0,
            stops: false,
            since: ("from the beginning".into(), Tone::Quiet),
            durations: TimeHistogram::default(),
            late: 0,
            lost: 0,
            next_picture: 0.0,
        };
        Ok((law, desk))
    }

    /// The workcell.
    pub fn cell(&self) -> &Workcell {
        &self.run.cell
    }

    /// Faults so far.
    pub fn faults(&self) -> &FaultLog {
        &self.faults
    }

    fn listen(&mut self) -> Result<(), Error> {
        while let Ok(order) = self.orders.try_recv() {
            match order {
                Order::Request(request, number) => {
                    self.heard = number;
                    self.obey(&request)?;
                }
                Order::Replace(both, head) => {
                    let (cell, sampler) = *both;
                    self.run = Run::new(cell, sampler);
                    self.beside = None;
                    self.head = head;
                    self.begun = None;
                    self.next_picture = 0.0;
                    self.since = ("from the beginning".into(), Tone::Quiet);
                }
                // Somebody who does not wait for it any more has left.
                Order::Remember(to) => drop(to.try_send(self.cell().memory().clone())),
                Order::Abandon => self.runs().try_for_each(Run::stand)?,
            }
        }
        Ok(())
    }

    fn obey(&mut self, request: &Request) -> Result<(), Error> {
        self.run.obey(request)?;
        match (request, &mut self.beside) {
            (Request::Beside(on), beside) => *beside = on.then(|| Box::new(self.run.other())),
            // The one beside makes the other choice.
            (Request::Ergonomics(on), Some(beside)) => beside.obey(&Request::Ergonomics(!on))?,
            (_, Some(beside)) => beside.obey(request)?,
            (_, None) => {}
        }
        Ok(())
    }

    fn runs(&mut self) -> impl Iterator<Item = &mut Run> {
        std::iter::once(&mut self.run).chain(self.beside.as_deref_mut())
    }

    fn show(&mut self) -> Result<(), Error> {
        self.pictures += 1;
        let pace = Pace {
            ticks: self.durations.count(),
            late: self.late,
            lost: self.lost,
            median: 1e6 * self.durations.quantile(0.5),
            p99: 1e6 * self.durations.quantile(0.99),
        };
        let moment = Moment {
            number: self.pictures,
            head: self.head,
            heard: self.heard,
            since: self.since.clone(),
            pace,
        };
        self.desk.show(Picture::of(&mut self.run, self.beside.as_deref_mut(), moment)?);
        Ok(())
    }

    /// Goes on to a time \[s\].
    fn go_on(&mut self, now: f64) -> Result<(), Error> {
        self.listen()?;
        if self.stops {
            self.runs().for_each(|run| run.cell.request_stop());
        }
        let period = self.cell().period();
        let begun = *self.begun.get_or_insert(now);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
        let due = ((now - begun) / period).round().max(0.0) as u64;
        let late = due.saturating_sub(self.cell().tick());
        if late > ASLEEP {
            self.begun = Some(now - self.cell().time());
            self.lost += late - ASLEEP;
        }
        self.late += late;
        for _ in 0..=late.min(ASLEEP) {
            self.tick()?;
        }
        Ok(())
    }

    /// A period, and a picture when it is time for one.
    fn tick(&mut self) -> Result<(), Error> {
        let started = Instant::now();
        self.runs().try_for_each(Run::advance)?;
        self.durations.push(started.elapsed().as_secs_f64());
        if let Some(since) = began(self.cell().plant().command()) {
            self.since = since;
        }
        let (time, period) = (self.cell().time(), self.cell().period());
        if time >= self.next_picture {
            self.next_picture = time + INTERVAL - 0.5 * period;
            self.show()?;
        }
        Ok(())
    }
}

impl ControlLaw for Law {
    type Error = Error;

    fn begin(&mut self, _measured: &JointMeasurement) -> Result<(), Error> {
        Ok(())
    }

    fn step(
        &mut self,
        now: f64,
        _measured: &JointMeasurement,
        _command: &mut JointCommand,
    ) -> Result<(), Error> {
        self.go_on(now)?;
        self.faults.push(now, self.cell().plant().command().fault);
        Ok(())
    }

    fn longest_interval(&self) -> Option<f64> {
        None
    }

    fn measurement_age(&self, _measured: &JointMeasurement) -> f64 {
        0.0
    }

    /// A camera that is covered is something to see, and ends no loop.
    fn perception_age(&self) -> Option<f64> {
        None
    }

    fn request_stop(&mut self) {
        self.stops = true;
    }

    fn is_at_rest(&self, _measured: &JointMeasurement) -> Option<bool> {
        let velocity = &self.cell().plant().command().joint_velocity;
        Some(velocity.iter().all(|velocity| velocity.abs() < REST))
    }
}

/// The robot of a [`Law`] is within it: nothing is measured or sent outside.
#[derive(Clone, Copy, Debug, Default)]
pub struct Within;

impl RobotSide for Within {
    type Error = Infallible;

    fn receive(&mut self, _measured: &mut JointMeasurement) -> Result<Received, Infallible> {
        Ok(Received::Fresh)
    }

    fn send(&mut self, _command: &JointCommand) -> Result<(), Infallible> {
        Ok(())
    }

    fn halt(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
