//! A workcell that goes on, and what is seen of it.

use std::collections::VecDeque;

use moca_replay::recorded::Sampler;
use moca_simulation::Error;
use moca_simulation::moca_model::Goal;
use moca_simulation::people::{Lead, Way};
use moca_simulation::workcell::{Who, Workcell};
use nalgebra::Vector3;

use crate::request::Request;

/// Time between two pictures \[s\].
pub(crate) const INTERVAL: f64 = 0.03;
/// Speeds of the tool are averaged over so many pictures.
const CALM_PICTURES: usize = 33;

/// A workcell with what makes its pictures.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) cell: Workcell,
    pub(crate) sampler: Sampler,
    /// Places of the tool at the last pictures \[m\].
    tool: VecDeque<Vector3<f64>>,
}

impl Run {
    pub(crate) fn new(cell: Workcell, sampler: Sampler) -> Self {
        Self { cell, sampler, tool: VecDeque::with_capacity(CALM_PICTURES + 1) }
    }

    /// The same with the other choice of ergonomics.
    pub(crate) fn other(&self) -> Self {
        let mut other = self.clone();
        other.cell.set_goal(if asks_for_ergonomics(&self.cell) {
            Goal::LeastMotion
        } else {
            Goal::Ergonomics
        });
        other
    }

    /// Goes on by a period.
    pub(crate) fn advance(&mut self) -> Result<(), Error> {
        self.cell.advance()?;
        let plant = self.cell.plant();
        self.sampler.watch(plant.controller(), plant.configuration());
        Ok(())
    }

    /// Does what a page asks of a workcell; what it asks of the program is none of its business.
    pub(crate) fn obey(&mut self, request: &Request) -> Result<(), Error> {
        let cell = &mut self.cell;
        match *request {
            // The second person may have left since.
            Request::Lead(Who::Bystander, _) | Request::Move(Who::Bystander, _)
                if cell.person(Who::Bystander).is_none() => {}
            Request::Lead(who, lead) => cell.lead(who, lead)?,
            Request::Move(who, movement) => cell.begin(who, movement)?,
            Request::Faults(faults) => cell.set_faults(faults)?,
            Request::Ergonomics(on) => {
                cell.set_goal(if on { Goal::Ergonomics } else { Goal::LeastMotion });
            }
            Request::Bystander(on) => cell.set_bystander(on)?,
            Request::Acknowledge => cell.acknowledge(),
            Request::Stop => cell.request_stop(),
            Request::Beside(_) | Request::Restart(_) | Request::Drawn(_) => {}
        }
        Ok(())
    }

    /// Nobody leads the people: they stand where they are.
    pub(crate) fn stand(&mut self) -> Result<(), Error> {
        for who in [Who::Worker, Who::Bystander] {
            if let Some(person) = self.cell.person(who) {
                let lead = Lead { way: Way::Stand, ..*person.told() };
                self.cell.lead(who, lead)?;
            }
        }
        Ok(())
    }

    /// Mean speed of the tool in the last second \[m/s\], up to a picture that is taken now.
    pub(crate) fn calm(&mut self) -> f64 {
        self.tool.push_back(Vector3::from(self.cell.row().actual));
        if self.tool.len() > CALM_PICTURES {
            self.tool.pop_front();
        }
        let way: f64 =
            self.tool.iter().zip(self.tool.iter().skip(1)).map(|(a, b)| (b - a).norm()).sum();
        way / (INTERVAL * (self.tool.len().max(2) - 1) as f64)
    }
}

/// True if the controller of a workcell asks for ergonomics.
pub(crate) fn asks_for_ergonomics(cell: &Workcell) -> bool {
    cell.setup().robot.controller.goal == Goal::Ergonomics
}
