//! Support of a person whose joints were measured.

use nalgebra::{Vector2, Vector3};

use super::{JointPositions, between, unit};

/// Shares of the body's mass: shanks, thighs, and head, arms and trunk (Dempster, in Winter's table).
const SHANKS: f64 = 2.0 * 0.0465;
const THIGHS: f64 = 2.0 * 0.100;
const UPPER_BODY: f64 = 0.678;
/// Centre of mass of the upper body, as a share from the hips towards the shoulders (the same
/// table).
const UPPER_BODY_CENTRE: f64 = 0.626;

/// Distance behind the ankles from which a centre of mass is not over the heels \[m\]. The heel is
/// about 6 cm behind the ankle, and the error of a detector's joints is 5 cm.
const BEHIND_THE_FEET: f64 = 0.15;
/// Largest slope of the thighs of a seated person: the sine of 40°.
const SEATED_SLOPE: f64 = 0.64;

/// Returns true if the person sits. The thighs are then nearly level, and the centre of mass is so
/// far behind both ankles that only a seat can support it. A person who squats balances over the
/// feet.
pub(super) fn is_sitting(joints: &JointPositions) -> bool {
    seat(joints).unwrap_or(false)
}

fn seat(joints: &JointPositions) -> Option<bool> {
    let (hips, knees) = (between(&joints.hips)?, between(&joints.knees)?);
    let (ankles, neck) = (between(&joints.ankles)?, joints.neck.or(between(&joints.shoulders))?);
    let thighs = knees - hips;
    let slope = unit(&thighs)?.z;
    let level: Vector3<f64> = Vector3::new(thighs.x, thighs.y, 0.0);
    let forward = unit(&level)?;
    let centre = (ankles + knees) * (0.5 * SHANKS)
        + (hips + knees) * (0.5 * THIGHS)
        + (hips + (neck - hips) * UPPER_BODY_CENTRE) * UPPER_BODY;
    let centre = centre / (SHANKS + THIGHS + UPPER_BODY);
    let behind = (ankles - centre).dot(&forward);
    Some(slope.abs() < SEATED_SLOPE && behind > BEHIND_THE_FEET)
}

/// Decision whether a person walks, by the distance of the pelvis from its recent mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Gait {
    /// Mean place of the pelvis over [`LATELY`] \[m\], and time of its last observation \[s\].
    mean: Option<(Vector2<f64>, f64)>,
    walks: bool,
}

/// Time constant of the mean \[s\].
const LATELY: f64 = 1.0;
/// Distance of a walking person's pelvis from its mean \[m\]. Below half of it they stand. A person
/// who bends or squats moves it by at most .15 m. A gait of .25 m/s keeps it .25 m ahead.
const AHEAD: f64 = 0.2;
/// Time without observation after which the mean restarts \[s\].
const FORGOTTEN: f64 = 1.0;

impl Gait {
    /// Takes a frame at its time \[s\]. Returns true if the person walks.
    pub(super) fn update(&mut self, time: f64, joints: &JointPositions) -> bool {
        let pelvis = joints.pelvis.or_else(|| between(&joints.hips)).map(|pelvis| pelvis.xy());
        let pelvis = pelvis.filter(|pelvis| pelvis.iter().all(|value| value.is_finite()));
        let recent = self.mean.filter(|(_, seen)| (0.0..=FORGOTTEN).contains(&(time - seen)));
        match (pelvis, recent) {
            (Some(pelvis), Some((mean, seen))) => {
                let mean = pelvis + (mean - pelvis) * (-(time - seen) / LATELY).exp();
                let ahead = (pelvis - mean).norm();
                self.walks = ahead > if self.walks { 0.5 * AHEAD } else { AHEAD };
                self.mean = Some((mean, time));
            }
            (Some(pelvis), None) => *self = Self { mean: Some((pelvis, time)), walks: false },
            (None, Some(_)) => {}
            (None, None) => *self = Self::default(),
        }
        self.walks
    }
}
