//! A recorded person before a robot that the recording does not know.

use moca_model::GraspedObject;
use nalgebra::Vector3;
use vision_models::Percept;

use super::on_board::{OnBoardEye, RobotView};
use super::scenario::{Delivery, Scenario};
use super::working_hand::WorkingHand;
use crate::error::Error;

/// Random stream of the on-board camera, the same in all runs.
const SEED: u64 = 1;

/// The person of a scenario as the cameras see them beside a robot. The working hand goes along with the object, and the
/// on-board camera sees the object that was handed over.
///
/// ```
/// use ergo_map::{ErgonomicsMap, MapOptions, Person};
/// use moca_simulation::people::{Walker, WalkerSettings};
/// use moca_simulation::run::{Encounter, RobotView, Scenario};
/// use nalgebra::{Isometry3, Vector3};
///
/// let person = Person::average();
/// let coarse = MapOptions { spacing: 0.1, ..MapOptions::default() };
/// let map = ErgonomicsMap::build(&person, &coarse, None)?;
/// let percepts: Vec<_> = Walker::new(WalkerSettings::default())?.take(100).collect();
/// let scenario = Scenario::new(percepts, &person, map)?;
/// let mut encounter = Encounter::new(&scenario);
/// let robot =
///     RobotView { camera: None, base: [0.0; 3], tool: Isometry3::identity(), holds: false };
/// // Nobody works on anything: the person is as recorded.
/// encounter.advance(0.001, 0.001, None);
/// assert_eq!(encounter.show(&scenario.percepts[99], &robot)?, scenario.percepts[99]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Encounter {
    pub(super) hand: WorkingHand,
    on_board: OnBoardEye,
    /// The true object, if it is handed over.
    object: Option<GraspedObject>,
}

impl Encounter {
    /// Creates the person of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let handed_over = matches!(scenario.delivery, Delivery::HandedOver { .. });
        Self {
            hand: WorkingHand::new(scenario.map.stature(), scenario.map.side()),
            on_board: OnBoardEye::new(SEED),
            object: handed_over.then(|| scenario.object.clone()),
        }
    }

    /// Advances to `now` by `period` \[s\]. The person works on an object there \[m, world\], or on none.
    pub fn advance(&mut self, now: f64, period: f64, object: Option<Vector3<f64>>) {
        self.hand.advance(now, period, object);
    }

    /// Percept of the cameras at the time of a recorded percept \[s, on the clock of `advance`\].
    ///
    /// # Errors
    /// None.
    pub fn show(&mut self, percept: &Percept, robot: &RobotView) -> Result<Percept, Error> {
        let mut shown = self.hand.show(percept);
        if let Some(object) = &self.object {
            shown.surface = self.on_board.look(robot, object)?;
        }
        Ok(shown)
    }
}
