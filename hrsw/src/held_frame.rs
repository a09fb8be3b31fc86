//! When a frame follows a person, and when it is held in the world.

use nalgebra::{SVector, Vector1, Vector2};

use crate::error::{Error, positive};

/// When the frame of a person who stands is held, and when it is placed anew.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct HoldSettings {
    /// How far the mean place of somebody who stands may be from the held one \[m\]. Default 0.07.
    pub position: f64,
    /// The same for their heading \[rad\]. Default 0.13.
    pub heading: f64,
    /// Over how long that mean goes \[s\]. Default 1.0.
    pub mean: f64,
    /// Slower than this a person stands \[m/s\]. Default 0.12.
    pub speed: f64,
    /// Slower than this they do not turn \[rad/s\]. Default 0.15.
    pub turn: f64,
    /// For so long \[s\]. Default 0.2.
    pub settling: f64,
    /// The person leaves if by their velocity they are out of the zone so much later \[s\]. Default 0.3.
    pub ahead: f64,
    /// How fast a held frame goes to a new place \[m/s\]. Default 0.05.
    pub placing: f64,
}

impl Default for HoldSettings {
    fn default() -> Self {
        Self {
            position: 0.07,
            heading: 0.13,
            mean: 1.0,
            speed: 0.12,
            turn: 0.15,
            settling: 0.2,
            ahead: 0.3,
            placing: 0.05,
        }
    }
}

impl HoldSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is not positive and finite.
    pub fn validate(&self) -> Result<(), Error> {
        positive("the zone of positions of a held frame", self.position)?;
        positive("the zone of headings of a held frame", self.heading)?;
        positive("the time of the mean of a held frame", self.mean)?;
        positive("the speed of somebody who stands", self.speed)?;
        positive("the turning of somebody who stands", self.turn)?;
        positive("the settling time of a held frame", self.settling)?;
        positive("the time ahead of a held frame", self.ahead)?;
        positive("the placing speed of a held frame", self.placing)?;
        Ok(())
    }
}

/// Where somebody is on the floor and where they look, or how fast these change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorMotion {
    /// On the floor \[m\] or \[m/s\].
    pub position: Vector2<f64>,
    /// About the vertical \[rad\] or \[rad/s\].
    pub heading: f64,
}

/// The frame of a person that a robot works by: held in the world while they stand, along with them while they walk.
///
/// Place and heading are held each for themselves. Who sways, or leans, does not move it. It is placed anew, slowly,
/// when their mean place has left the zone around it, and follows again when they leave the zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldFrame {
    settings: HoldSettings,
    position: Hold<2>,
    heading: Hold<1>,
}

impl HeldFrame {
    /// A frame that follows.
    ///
    /// # Errors
    /// [`Error::Value`] for settings out of range.
    pub fn new(settings: HoldSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self { settings, position: Hold::FOLLOWING, heading: Hold::FOLLOWING })
    }

    /// Follows from now on, until the person stands.
    pub fn follow(&mut self) {
        (self.position, self.heading) = (Hold::FOLLOWING, Hold::FOLLOWING);
    }

    /// Whether both place and heading are held.
    pub fn is_held(&self) -> bool {
        self.position.place.is_some() && self.heading.place.is_some()
    }

    /// Goes on by `period` \[s\] with the person as `seen`, moving at `rate`, and returns the target of what follows
    /// and how fast that moves. A frame that begins to be held stays where what follows `stops`. Who `walks` is
    /// followed. Headings are continuous, in any branch.
    pub fn advance(
        &mut self,
        seen: FloorMotion,
        rate: FloorMotion,
        stops: FloorMotion,
        walks: bool,
        period: f64,
    ) -> (FloorMotion, FloorMotion) {
        let s = &self.settings;
        let zone = Zone { width: s.position, slow: s.speed, placing: s.placing };
        let (position, velocity) =
            self.position.advance(seen.position, rate.position, stops.position, walks, &zone, s, period);
        // The same in the branch of the heading that is seen.
        let near = |angle: f64| seen.heading + wrapped(angle - seen.heading);
        self.heading.map(near);
        let zone = Zone { width: s.heading, slow: s.turn, placing: s.placing * s.heading / s.position };
        let (heading, turn) = self.heading.advance(
            Vector1::new(seen.heading),
            Vector1::new(rate.heading),
            Vector1::new(near(stops.heading)),
            walks,
            &zone,
            s,
            period,
        );
        (
            FloorMotion { position, heading: heading.x },
            FloorMotion { position: velocity, heading: turn.x },
        )
    }
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

struct Zone {
    width: f64,
    slow: f64,
    placing: f64,
}

/// One of both.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hold<const N: usize> {
    /// Where it is held; none while it follows.
    place: Option<SVector<f64, N>>,
    /// The target on the way to a new place.
    target: SVector<f64, N>,
    /// Of where the person is.
    mean: SVector<f64, N>,
    /// For how long they have been slow \[s\].
    slow: f64,
}

impl<const N: usize> Hold<N> {
    const FOLLOWING: Self = Self {
        place: None,
        target: SVector::<f64, N>::from_array_storage(nalgebra::ArrayStorage([[0.0; N]; 1])),
        mean: SVector::<f64, N>::from_array_storage(nalgebra::ArrayStorage([[0.0; N]; 1])),
        slow: 0.0,
    };

    fn map(&mut self, by: impl Fn(f64) -> f64) {
        self.mean = self.mean.map(&by);
        self.target = self.target.map(&by);
        self.place = self.place.map(|place| place.map(&by));
    }

    #[expect(clippy::too_many_arguments, reason = "one caller")]
    fn advance(
        &mut self,
        seen: SVector<f64, N>,
        rate: SVector<f64, N>,
        stops: SVector<f64, N>,
        walks: bool,
        zone: &Zone,
        settings: &HoldSettings,
        period: f64,
    ) -> (SVector<f64, N>, SVector<f64, N>) {
        let speed = rate.norm();
        if let Some(place) = self.place {
            let passed = -(-period / settings.mean).exp_m1();
            self.mean += (seen - self.mean) * passed;
            let ahead = seen + rate * settings.ahead - place;
            let leaves = ahead.norm() > 1.6 * zone.width && speed > zone.slow;
            if leaves || (walks && speed > zone.slow) {
                self.place = None;
            } else if (self.mean - place).norm() > zone.width {
                self.place = Some(self.mean);
            }
        } else {
            self.slow = if speed < zone.slow && !walks { self.slow + period } else { 0.0 };
            if self.slow >= settings.settling {
                self.place = Some(stops);
                (self.target, self.mean) = (stops, seen);
            }
        }
        if let Some(place) = self.place {
            let way = place - self.target;
            let most = zone.placing * period;
            let step = if way.norm() > most { way * (most / way.norm()) } else { way };
            self.target += step;
            (self.target, step / period)
        } else {
            // What is slow is mostly noise, and is left to the follower.
            let certain = (speed / zone.slow - 1.0).clamp(0.0, 1.0);
            (seen, rate * certain)
        }
    }
}
