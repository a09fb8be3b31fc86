//! Payloads: rigid bodies that the robot carries for some time.

use nalgebra::{Matrix3, Point3};

use crate::error::{Error, check_finite};
use crate::inertia::body::BodyInertia;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// The largest number of payloads.
const ROOM: usize = 8;

/// A rigid body that moves with a frame, such as a grasped object or a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payload {
    /// The frame that carries it.
    pub frame: FrameId,
    /// \[kg\]
    pub mass: f64,
    /// Centre of mass in that frame \[m\].
    pub centre: Point3<f64>,
    /// Inertia about the centre of mass, in the frame's axes \[kg m²\].
    pub inertia: Matrix3<f64>,
}

/// A payload that is attached; see [`Data::attach`](crate::Data::attach).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PayloadId {
    model: u64,
    number: u64,
}

/// The payloads of one thread's data.
#[derive(Debug, Clone, Default)]
pub(crate) struct Payloads {
    attached: [Option<Attached>; ROOM],
    /// Number of payloads that were ever attached.
    count: u64,
}

#[derive(Debug, Clone, Copy)]
struct Attached {
    number: u64,
    body: usize,
    inertia: BodyInertia,
}

impl Payloads {
    /// Adds a payload and returns the index of its body.
    pub(super) fn add(
        &mut self,
        model: &Model,
        payload: &Payload,
    ) -> Result<(PayloadId, usize), Error> {
        let frame = model.frame(payload.frame)?;
        let numbers = payload.centre.iter().chain(&payload.inertia).chain([&payload.mass]);
        for value in numbers {
            check_finite(*value, || "a number of the payload".to_owned())?;
        }
        if payload.mass < 0.0 {
            let what = "the mass of the payload".to_owned();
            return Err(Error::value(what, payload.mass, "zero or positive [kg]"));
        }
        let free = self.attached.iter_mut().find(|place| place.is_none());
        let place = free.ok_or(Error::TooManyPayloads { limit: ROOM })?;
        let own = BodyInertia {
            mass: payload.mass,
            centre: payload.centre.coords,
            inertia: (payload.inertia + payload.inertia.transpose()) * 0.5,
        };
        let number = self.count;
        *place = Some(Attached { number, body: frame.body, inertia: own.placed(&frame.pose) });
        self.count += 1;
        Ok((PayloadId { model: model.tag, number }, frame.body))
    }

    /// Removes a payload and returns the index of its body.
    pub(super) fn remove(&mut self, model: &Model, payload: PayloadId) -> Result<usize, Error> {
        let own = |place: &&mut Option<Attached>| {
            payload.model == model.tag
                && place.is_some_and(|attached| attached.number == payload.number)
        };
        let place = self.attached.iter_mut().find(own);
        let attached = place.and_then(Option::take).ok_or_else(|| model.foreign("payload"))?;
        Ok(attached.body)
    }

    /// The inertia of a body with its payloads.
    pub(super) fn on(&self, body: usize, own: &BodyInertia) -> BodyInertia {
        let attached = self.attached.iter().flatten().filter(|payload| payload.body == body);
        attached.fold(*own, |sum, payload| sum.joined(&payload.inertia))
    }
}
