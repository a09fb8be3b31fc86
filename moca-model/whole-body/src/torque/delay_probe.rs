//! Measurement of the delay of a robot's response.

/// Numbers of ticks: before the push to find the noise of measurements, of a push in each direction, and of waiting for
/// the response.
const QUIET: usize = 12;
const PUSH: usize = 6;
const ANSWER: usize = 34;
const LENGTH: usize = QUIET + 2 * PUSH + ANSWER;
/// The longest delay that is searched, in ticks, and the steps of the search a tick.
const LONGEST: usize = 25;
const STEPS: usize = 4;
/// Friction rates that may slow the joint down, of which the most likely is used \[1/s\].
const FRICTION: [f64; 4] = [0.0, 10.0, 30.0, 80.0];
/// Least share of the measurements that the response must explain.
const EXPLAINED: f64 = 0.7;
/// Least response in standard deviations of the noise.
const LOUDNESS: f64 = 6.0;

/// The answer of a [`DelayProbe`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProbeAnswer {
    /// The probe has not ended.
    Pending,
    /// The time from a torque to its effect in a measurement, beyond the one period of every loop \[s\].
    Delay(f64),
    /// The joint does not respond.
    None,
}

/// Measures the delay of a robot's response to torques. It pushes one joint to and fro for 12 ticks and compares the
/// measured velocities with those of a mass under these torques.
///
/// ```
/// use whole_body::torque::{DelayProbe, ProbeAnswer};
///
/// let mut probe = DelayProbe::new(1.8, 1e3, 1e-3);
/// let (mut velocity, mut on_the_way) = (0.0, [0.0; 3]); // measured 3 ms late
/// let mut answer = ProbeAnswer::Pending;
/// while answer == ProbeAnswer::Pending {
///     on_the_way.rotate_right(1);
///     let measured = std::mem::replace(&mut on_the_way[0], velocity);
///     let torque = probe.torque();
///     answer = probe.update(Some(measured));
///     velocity += torque / 0.12 * 1e-3;
/// }
/// let ProbeAnswer::Delay(delay) = answer else { panic!("{answer:?}") };
/// assert!((delay - 3e-3).abs() < 5e-4);
/// ```
#[derive(Debug, Clone)]
pub struct DelayProbe {
    /// Torque of each tick \[Nm\].
    torque: [f64; LENGTH],
    period: f64,
    tick: usize,
    /// Velocity measured in each tick, if there was a measurement.
    measured: [Option<f64>; LENGTH],
}

impl DelayProbe {
    /// Creates a probe with the largest torque \[Nm\], its largest rate \[Nm/s\] and the control period \[s\].
    pub fn new(amplitude: f64, rate: f64, period: f64) -> Self {
        let (mut torque, mut last) = ([0.0_f64; LENGTH], 0.0_f64);
        for (tick, torque) in torque.iter_mut().enumerate() {
            last += (amplitude * direction(tick) - last).clamp(-rate * period, rate * period);
            *torque = last;
        }
        Self { torque, period, tick: 0, measured: [None; LENGTH] }
    }

    /// The torque for the joint in this tick \[Nm\].
    pub fn torque(&self) -> f64 {
        self.torque.get(self.tick).copied().unwrap_or_default()
    }

    /// Takes the joint's velocity, if it was measured since the last tick \[rad/s\], and goes on to the next tick.
    pub fn update(&mut self, velocity: Option<f64>) -> ProbeAnswer {
        if let Some(place) = self.measured.get_mut(self.tick) {
            *place = velocity;
        }
        self.tick += 1;
        if self.tick < LENGTH { ProbeAnswer::Pending } else { self.answer() }
    }

    fn answer(&self) -> ProbeAnswer {
        let quiet = || self.measured.iter().take(QUIET).flatten();
        let count = quiet().count().max(1) as f64;
        let mean = quiet().sum::<f64>() / count;
        let noise = (quiet().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
        let loudest =
            self.measured.iter().flatten().fold(0.0, |most: f64, v| most.max((v - mean).abs()));
        let mut best = (0.0, 0.0);
        for friction in FRICTION {
            let expected = self.expected(friction);
            for step in 0..=LONGEST * STEPS {
                let late = step as f64 / STEPS as f64;
                let explained = self.explained(&expected, late, mean);
                if explained > best.0 {
                    best = (explained, late * self.period);
                }
            }
        }
        let (explained, delay) = best;
        if explained > EXPLAINED && loudest > LOUDNESS * noise && loudest > 0.0 {
            ProbeAnswer::Delay(delay)
        } else {
            ProbeAnswer::None
        }
    }

    /// The velocity of a unit mass at the beginning of each tick, up to a factor.
    fn expected(&self, friction: f64) -> [f64; LENGTH] {
        let mut expected = [0.0; LENGTH];
        let mut velocity = 0.0;
        for (place, torque) in expected.iter_mut().zip(&self.torque) {
            *place = velocity;
            velocity += torque * self.period;
            velocity /= 1.0 + friction * self.period;
        }
        expected
    }

    /// The share of the measurements that the expected velocities explain with a delay of `late` ticks.
    fn explained(&self, expected: &[f64; LENGTH], late: f64, mean: f64) -> f64 {
        let (mut product, mut of_expected, mut of_measured) = (0.0, 0.0, 0.0);
        for (tick, measured) in self.measured.iter().enumerate().skip(QUIET) {
            let Some(measured) = measured else { continue };
            let at = tick as f64 - late;
            let expected = interpolated(expected, at);
            let measured = measured - mean;
            product += expected * measured;
            of_expected += expected * expected;
            of_measured += measured * measured;
        }
        let size = of_expected * of_measured;
        if size > 0.0 && product > 0.0 { product * product / size } else { 0.0 }
    }
}

/// The direction of the push in a tick: first forwards, then backwards.
fn direction(tick: usize) -> f64 {
    if (QUIET..QUIET + PUSH).contains(&tick) {
        1.0
    } else if (QUIET + PUSH..QUIET + 2 * PUSH).contains(&tick) {
        -1.0
    } else {
        0.0
    }
}

fn interpolated(values: &[f64; LENGTH], at: f64) -> f64 {
    if at < 0.0 {
        return 0.0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
    let (index, share) = (at as usize, at.fract());
    let value = |index: usize| values.get(index).copied().unwrap_or_default();
    value(index) * (1.0 - share) + value(index + 1) * share
}
