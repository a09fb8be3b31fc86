//! What a task asks for and does not get.

use nalgebra::Vector3;

/// What a task has been missing for half a second, and how much of that it still asks for.
///
/// Where less than a fifth of a velocity is got for long, there is an error that cannot be taken away,
/// as of a target out of reach. Its Jacobian alone then says nothing about what the joints should do:
/// the task adds its curvature, and the part that is missing is asked for less and less, so that the
/// robot comes to rest. All else is asked for as before. As soon as what is still asked for is got,
/// the rest comes back, within a third of a second.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shortfall {
    /// Of what is wanted, a mean over the [`MEMORY`].
    missing: Vector3<f64>,
    wanted: f64,
    /// Of what is asked for, a mean over [`QUICK`].
    missing_now: Vector3<f64>,
    asked_now: f64,
    /// Of what is missing, the part that is asked for.
    share: f64,
}

/// What to ask for, and what is missing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ask {
    pub(crate) velocity: Vector3<f64>,
    /// Zero unless it has been missing for long.
    pub(crate) missing: Vector3<f64>,
}

/// \[s\]
const MEMORY: f64 = 0.5;
/// \[s\]
const QUICK: f64 = 0.05;
/// Parts that are missing, of all that is wanted: below the first nothing is given up, above the
/// second all of it.
const FEW: f64 = 0.5;
const MOST: f64 = 0.8;
/// Speeds below this are never given up \[m/s, rad/s\].
const SMALL: f64 = 0.02;
/// Time in which what is missing is asked for less by the factor e \[s\].
const FADING: f64 = 0.5;
/// The same for its return \[s\].
const RETURN: f64 = 0.02;
/// The least part that is asked for.
const LEAST: f64 = 1e-6;

impl Default for Shortfall {
    fn default() -> Self {
        let none = Vector3::zeros();
        Self { missing: none, wanted: 0.0, missing_now: none, asked_now: 0.0, share: 1.0 }
    }
}

impl Shortfall {
    /// What to ask for, where `wanted` is wanted and the last step gave `got` \[m/s, rad/s\].
    pub(crate) fn ask(&mut self, wanted: &Vector3<f64>, got: &Vector3<f64>, period: f64) -> Ask {
        let new = period / (period + MEMORY);
        self.missing += (wanted - got - self.missing) * new;
        self.wanted += (wanted.norm() - self.wanted) * new;
        let size = self.missing.norm();
        if self.share == 1.0 && size <= FEW * self.wanted {
            // Nothing is given up, and this is where most steps end.
            (self.missing_now, self.asked_now) = (self.missing, self.wanted);
            return Ask { velocity: *wanted, missing: Vector3::zeros() };
        }
        let way = if size > 0.0 { self.missing / size } else { Vector3::zeros() };
        let velocity = wanted - way * (way.dot(wanted) * (1.0 - self.share));
        let new = period / (period + QUICK);
        self.missing_now += (velocity - got - self.missing_now) * new;
        self.asked_now += (velocity.norm() - self.asked_now) * new;
        if self.wanted < SMALL || self.missing_now.norm() < FEW * self.asked_now {
            self.share = (self.share * (1.0 + period / RETURN)).min(1.0);
        } else if size > MOST * self.wanted {
            self.share = (self.share * (1.0 - period / FADING)).max(LEAST);
        }
        let lasting = (size / self.wanted - FEW) / (MOST - FEW);
        let counts = (self.wanted - SMALL) / SMALL;
        let part = lasting.clamp(0.0, 1.0) * counts.clamp(0.0, 1.0);
        Ask { velocity, missing: self.missing * part }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: f64 = 1e-3;

    const WANTED: Vector3<f64> = Vector3::new(1.0, 0.2, 0.0);

    fn after(shortfall: &mut Shortfall, ticks: u32, got: fn(Vector3<f64>) -> Vector3<f64>) -> Ask {
        let mut ask = shortfall.ask(&WANTED, &Vector3::zeros(), PERIOD);
        for _ in 0..ticks {
            ask = shortfall.ask(&WANTED, &got(ask.velocity), PERIOD);
        }
        ask
    }

    #[test]
    fn what_is_got_is_asked_for_in_full() {
        let ask = after(&mut Shortfall::default(), 5000, |asked| asked);
        assert_eq!((ask.velocity, ask.missing), (WANTED, Vector3::zeros()));
    }

    #[test]
    fn what_is_missing_for_long_is_given_up_and_comes_back() {
        let mut shortfall = Shortfall::default();
        let ask = after(&mut shortfall, 8000, |_| Vector3::zeros());
        assert!((ask.missing - WANTED).norm() < 1e-6 && ask.velocity.norm() < 1e-5, "{ask:?}");
        assert_eq!(after(&mut shortfall, 600, |asked| asked).velocity, WANTED);
    }

    #[test]
    fn what_can_be_had_beside_it_is_asked_for() {
        let sideways = |asked: Vector3<f64>| Vector3::new(0.0, asked.y, 0.0);
        let ask = after(&mut Shortfall::default(), 8000, sideways);
        assert!((ask.velocity.y - 0.2).abs() < 1e-3 && ask.velocity.x < 0.2, "{ask:?}");
    }
}
