//! Frames that follow a person who walks, and are held in the world while the person stands.

use nalgebra::{SVector, Vector1, Vector2};

/// Time constant of the mean place of a person who stands, several periods of body sway \[s\].
const MEAN: f64 = 1.0;
/// A person who is slower stands still \[m/s\].
const SLOW: f64 = 0.12;
/// A person who turns more slowly does not turn \[rad/s\].
const SLOW_TURN: f64 = 0.15;
/// Time constant of the mean place of a person who is followed \[s\]. A person near that mean is
/// slow, however noisy the frames are.
const FOLLOWED: f64 = 0.3;
/// Time for which a person must be slow before the frame is held \[s\]: two frames of a camera.
const SETTLING: f64 = 0.1;
/// A frame is held if it would stop within this distance of the person \[zones\].
const NEAR: f64 = 0.7;
/// Prediction times of place and heading \[s\]. A person leaves if the prediction is more than
/// so many zones away.
const AHEAD: f64 = 0.2;
const AHEAD_TURN: f64 = 0.2;
const LEAVES: f64 = 1.6;
const LEAVES_TURNING: f64 = 2.3;
/// A person who is farther from the held place is not swaying \[zones\].
const ELSEWHERE: f64 = 3.0;
/// Time constant of each of the three lags with which a held frame moves to a new place \[s\]. After a step of one zone
/// its speed is at most 0.27 / 0.4 s = 0.7 zones/s, and its jerk 1 / (0.4 s)³ = 16 zones/s³.
const PLACING: f64 = 0.4;

/// Place and heading of a person on the floor, or their rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorMotion {
    /// Place on the floor \[m\] or its rate \[m/s\].
    pub position: Vector2<f64>,
    /// Angle about the vertical \[rad\] or its rate \[rad/s\].
    pub heading: f64,
}

/// Frame of a person for the work of a robot. It is held in the world while they stand, and follows
/// them while they walk.
///
/// Place and heading are held independently. A person who sways or leans does not move the frame.
/// It moves slowly to a new place when the person's mean place has left the zone around it. It
/// follows again when the person leaves the zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldFrame {
    position: Hold<2>,
    heading: Hold<1>,
}

impl HeldFrame {
    /// Largest distance on the floor between the held frame and the mean frame of a person who
    /// stands \[m\]. Body sway and leaning stay within it, and the tool can reach that far.
    pub const POSITION: f64 = 0.07;
    /// Largest difference in heading between the held frame and that mean frame \[rad\].
    pub const HEADING: f64 = 0.13;

    /// Creates a frame that follows until the person stands still.
    #[must_use]
    pub const fn following() -> Self {
        Self { position: Hold::FOLLOWING, heading: Hold::FOLLOWING }
    }

    /// Returns true if both place and heading are held.
    pub fn is_held(&self) -> bool {
        self.position.place.is_some() && self.heading.place.is_some()
    }

    /// Moves a held frame slowly to the mean place and heading of the person. It is for times in which the robot moves
    /// anyway.
    pub fn recentre(&mut self) {
        self.position.recentre();
        self.heading.recentre();
    }

    /// Advances by `period` \[s\]. Returns the target of the follower and its velocity.
    ///
    /// `seen` is the person's place, and `rate` its rate. A frame that begins to be held stays
    /// where the follower `stops`. Headings are continuous, in any branch.
    pub fn advance(
        &mut self,
        seen: FloorMotion,
        rate: FloorMotion,
        stops: FloorMotion,
        period: f64,
    ) -> (FloorMotion, FloorMotion) {
        let zone = Zone { width: Self::POSITION, slow: SLOW, ahead: AHEAD, leaves: LEAVES };
        let seen_at = Seen { place: seen.position, rate: rate.position };
        let (position, velocity) = self.position.advance(&seen_at, stops.position, &zone, period);
        // Angles are in the branch of the heading that is seen.
        let near = |angle: f64| seen.heading + wrapped(angle - seen.heading);
        self.heading.map(near);
        let zone = Zone {
            width: Self::HEADING,
            slow: SLOW_TURN,
            ahead: AHEAD_TURN,
            leaves: LEAVES_TURNING,
        };
        let vector = |value: f64| Vector1::new(value);
        let seen_at = Seen { place: vector(seen.heading), rate: vector(rate.heading) };
        let stops = vector(near(stops.heading));
        let (heading, turn) = self.heading.advance(&seen_at, stops, &zone, period);
        (
            FloorMotion { position, heading: heading.x },
            FloorMotion { position: velocity, heading: turn.x },
        )
    }
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Zone within which a place or a heading is held.
struct Zone {
    width: f64,
    slow: f64,
    ahead: f64,
    leaves: f64,
}

/// Place or heading of a person, and its rate.
struct Seen<const N: usize> {
    place: SVector<f64, N>,
    rate: SVector<f64, N>,
}

/// State of a held place or heading.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hold<const N: usize> {
    /// The held value. None while it follows.
    place: Option<SVector<f64, N>>,
    /// The held value behind one, two and three lags. The last is the target.
    lags: [SVector<f64, N>; 3],
    /// Mean value of the person, once they were seen.
    mean: Option<SVector<f64, N>>,
    /// Time for which the person has been slow \[s\].
    slow: f64,
}

impl<const N: usize> Hold<N> {
    const FOLLOWING: Self = Self {
        place: None,
        lags: [SVector::<f64, N>::from_array_storage(nalgebra::ArrayStorage([[0.0; N]; 1])); 3],
        mean: None,
        slow: 0.0,
    };

    fn map(&mut self, by: impl Fn(f64) -> f64) {
        self.mean = self.mean.map(|mean| mean.map(&by));
        self.lags = self.lags.map(|lag| lag.map(&by));
        self.place = self.place.map(|place| place.map(&by));
    }

    fn recentre(&mut self) {
        self.place = self.place.and(self.mean);
    }

    /// Advances by `period` \[s\]. Returns the target and its rate.
    fn advance(
        &mut self,
        seen: &Seen<N>,
        stops: SVector<f64, N>,
        zone: &Zone,
        period: f64,
    ) -> (SVector<f64, N>, SVector<f64, N>) {
        let Seen { place: seen, rate } = *seen;
        let over = if self.place.is_some() { MEAN } else { FOLLOWED };
        let mean = self.mean.get_or_insert(seen);
        *mean += (seen - *mean) * -(-period / over).exp_m1();
        let mean = *mean;
        if let Some(place) = self.place {
            let ahead = seen + rate * zone.ahead - place;
            let leaves = ahead.norm() > zone.leaves * zone.width && rate.norm() > zone.slow;
            if leaves || (seen - place).norm() > ELSEWHERE * zone.width {
                (self.place, self.mean, self.slow) = (None, Some(place), 0.0);
            } else if (mean - place).norm() > zone.width {
                self.place = Some(mean);
            }
        }
        let speed = (seen - self.mean.unwrap_or(seen)).norm() / FOLLOWED;
        if self.place.is_none() {
            self.slow = if speed < zone.slow { self.slow + period } else { 0.0 };
            if self.slow >= SETTLING && (stops - seen).norm() <= NEAR * zone.width {
                self.place = Some(stops);
                (self.lags, self.mean) = ([stops; 3], Some(seen));
            }
        }
        let Some(place) = self.place else {
            // A slow motion is mostly noise, and is left to the follower.
            return (seen, rate * (speed / zone.slow - 1.0).clamp(0.0, 1.0));
        };
        let drawn = -(-period / PLACING).exp_m1();
        let [.., before] = self.lags;
        let mut towards = place;
        for lag in &mut self.lags {
            *lag += (towards - *lag) * drawn;
            towards = *lag;
        }
        (towards, (towards - before) / period)
    }
}
