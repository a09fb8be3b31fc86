//! What the robot carries for a while.

use nalgebra::{Matrix3, Point3};

use super::data::Data;
use crate::error::{Error, check_finite};
use crate::inertia::body::BodyInertia;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// How many payloads there can be at a time.
const ROOM: usize = 8;

/// A rigid body that moves with a frame: what a hand holds, a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payload {
    /// The frame that carries it.
    pub frame: FrameId,
    /// \[kg\]
    pub mass: f64,
    /// Centre of mass in that frame \[m\].
    pub centre: Point3<f64>,
    /// About the centre of mass, in the frame's axes \[kg m²\].
    pub inertia: Matrix3<f64>,
}

/// A payload that is attached; see [`Data::attach`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PayloadId {
    model: u64,
    number: u64,
}

/// The payloads of one thread's data.
#[derive(Debug, Clone, Default)]
pub(crate) struct Payloads {
    attached: [Option<Attached>; ROOM],
    /// How many there have been.
    count: u64,
}

#[derive(Debug, Clone, Copy)]
struct Attached {
    number: u64,
    body: usize,
    inertia: BodyInertia,
}

impl Data {
    /// Adds a payload to what all dynamics see, until [`detach`](Self::detach) takes it away.
    ///
    /// The model stays as it is and can be shared by threads whose robots carry different things.
    /// Picking something up allocates nothing.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] for a frame of another model;
    /// [`Error::NegativeMass`]; [`Error::NotFinite`]; [`Error::TooManyPayloads`] above eight.
    pub fn attach(&mut self, model: &Model, payload: &Payload) -> Result<PayloadId, Error> {
        self.check(model)?;
        let frame = model.frame(payload.frame)?;
        let numbers = payload.centre.iter().chain(&payload.inertia).chain([&payload.mass]);
        for value in numbers {
            check_finite(*value, || "a number of the payload".to_owned())?;
        }
        if payload.mass < 0.0 {
            let what = "the mass of the payload".to_owned();
            return Err(Error::NegativeMass { what, mass: payload.mass });
        }
        let symmetric = (payload.inertia + payload.inertia.transpose()) * 0.5;
        let own =
            BodyInertia { mass: payload.mass, centre: payload.centre.coords, inertia: symmetric };
        let free = self.payloads.attached.iter_mut().find(|place| place.is_none());
        let place = free.ok_or(Error::TooManyPayloads { limit: ROOM })?;
        let number = self.payloads.count;
        let inertia = own.placed(&frame.pose);
        *place = Some(Attached { number, body: frame.body, inertia });
        self.payloads.count += 1;
        self.weigh(model, frame.body);
        Ok(PayloadId { model: model.tag, number })
    }

    /// Takes a payload away.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::ForeignId`] if it is not attached.
    pub fn detach(&mut self, model: &Model, payload: PayloadId) -> Result<(), Error> {
        self.check(model)?;
        let own = |place: &&mut Option<Attached>| {
            place.is_some_and(|attached| attached.number == payload.number)
        };
        let place = self.payloads.attached.iter_mut().find(own);
        let attached = place.filter(|_| payload.model == model.tag).and_then(Option::take);
        let attached = attached.ok_or_else(|| model.foreign("payload"))?;
        self.weigh(model, attached.body);
        Ok(())
    }

    /// Sums up a body and what is attached to it; nothing is ever subtracted.
    fn weigh(&mut self, model: &Model, body: usize) {
        // What is attached to the world has no part in motion.
        let moves = body > 0 || model.base == crate::robot::description::Base::Floating;
        let (Some(total), Some(own)) = (self.inertias.get_mut(body), model.inertias.get(body))
        else {
            return;
        };
        *total = *own;
        let attached = self.payloads.attached.iter().flatten();
        for payload in attached.filter(|payload| payload.body == body && moves) {
            *total = total.joined(&payload.inertia);
        }
    }
}
