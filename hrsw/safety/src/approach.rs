//! Constraint rows that bound the speed at which bodies of the robot approach other bodies.

mod bodies;
mod body_motion;
mod candidate;
mod joint_changes;
mod joint_motion;
mod nearest;
mod own_motion;
mod own_pairs;
mod part_speeds;
mod person_pairs;
mod places;
mod ranking;
mod reach;
mod separation_violations;

use ahqp_core::{AugmentedState, Rows, VelocityInterval};

use crate::contact::Mobility;
use crate::distance::proximity;
use crate::distance_bounds::DistanceBounds;
use crate::error::{Error, check_capsule, check_size};
use crate::separation::SeparationSettings;
pub use bodies::{PersonBody, RobotBody};
use body_motion::BodyMotion;
use candidate::Candidate;
use hrsw::Capsule;
use joint_changes::JointChanges;
pub use joint_motion::JointMotion;
pub use nearest::Nearest;
use part_speeds::PartSpeeds;
use person_pairs::Pair;
use places::Places;
use ranking::Ranking;
use reach::Reach;
use separation_violations::SeparationViolations;

/// Writes a block of rows, −∂d/∂q q̇ ≤ v_max(d), that bound the speed of approach of pairs of
/// bodies.
///
/// The block holds `capacity` rows. They go to the pairs with the least headroom between the
/// largest allowed speed of approach and the speed at the last commanded velocity. Rows that are
/// not needed bound nothing.
///
/// Rest and retreat are always admitted. Acceleration limits may admit neither, for instance when a
/// person steps in front of a moving robot. Two ways keep the problem feasible then:
/// - As the first level of the hierarchy, `Level::least_squares(rows)`, the rows are violated as
///   little as possible. They hold wherever they can hold, but cost a level.
/// - As hard constraints the rows are relaxed to admit [`JointMotion::braking`]. This costs no
///   level.
///
/// ```
/// use ahqp_core::AugmentedState;
/// use hrsw_safety::{
///     ApproachRows, Capsule, JointMotion, MeasuredVelocity, PersonBody, RobotBody, SeparationSettings,
/// };
/// use nalgebra::{Matrix6xX, Vector3};
///
/// // One joint slides the robot along x, towards a person.
/// let state = AugmentedState { joints: 1, task: 6, slack: 6 };
/// let mut separation = ApproachRows::new(state, SeparationSettings::default(), 4)?;
/// let mut rows = separation.rows();
/// let mut jacobian = Matrix6xX::zeros(1);
/// jacobian[(0, 0)] = 1.0;
/// let motion = JointMotion {
///     jacobian: &jacobian,
///     origin: Vector3::zeros(),
///     velocity: &[0.0],
///     braking: Some(&[0.0]),
///     change: None,
///     inverse_inertia: None,
/// };
/// let robot = [RobotBody { capsule: Capsule::sphere(Vector3::zeros(), 0.1)?, joints: 1 }];
/// let head = Capsule::sphere(Vector3::new(1.5, 0.0, 0.0), 0.1)?;
/// let velocity = Some(MeasuredVelocity::exact(Vector3::zeros()));
/// let person = [PersonBody {
///     capsule: head,
///     velocity,
///     assumed_speed: 1.6,
///     age: 0.0,
///     uncertainty: 0.0,
///     contact: None,
/// }];
/// let nearest = separation.write(&motion, &robot, &person, &mut rows)?;
/// assert!((nearest.map_or(0.0, |pair| pair.distance) - 1.3).abs() < 1e-12);
/// let limit = SeparationSettings::default().approach_limit(1.3, 0.0);
/// assert!((rows.upper()[0] - limit).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ApproachRows {
    state: AugmentedState,
    settings: SeparationSettings,
    capacity: usize,
    candidates: Ranking,
    places: Places,
    /// Speeds of the person's parts whose distances are remembered.
    speeds: Vec<PartSpeeds>,
    changes: JointChanges,
    nearest: Option<Nearest>,
    mobility: Mobility,
    /// Pairs with less room than this are searched for \[m\].
    watched_room: f64,
    bounds: DistanceBounds,
    /// The nearest pair. Its distance \[m\] is `least_distance`.
    closest: Option<(usize, usize)>,
    least_distance: f64,
    /// True if the robot's mass decided the speed that a contact allows.
    needs_inertia: bool,
    /// True if a pair that needs a row got none.
    crowded: bool,
    violations: SeparationViolations,
    /// Velocities of a stop that recedes, n.
    receding: Vec<f64>,
}

/// Rounding error of a speed of approach \[m/s\].
const ROUNDING: f64 = 1e-7;
/// A pair counts as at its limit if its speed of approach is within this of the limit \[m/s\].
const AT_LIMIT: f64 = 0.05;

/// Numbers of bodies of the robot and of parts of people whose distances are remembered.
const BODIES: usize = 32;
const PARTS: usize = 48;

impl ApproachRows {
    /// Creates rows for the layout of χ, with room for `capacity` pairs.
    ///
    /// # Errors
    /// [`Error::Value`] if a setting is out of range.
    pub fn new(
        state: AugmentedState,
        settings: SeparationSettings,
        capacity: usize,
    ) -> Result<Self, Error> {
        settings.validate()?;
        let candidates = Ranking::new(capacity);
        let mobility = Mobility::new(state.joints);
        Ok(Self {
            state,
            settings,
            capacity,
            candidates,
            places: Places::new(capacity),
            speeds: Vec::with_capacity(PARTS),
            changes: JointChanges::new(state.joints),
            nearest: None,
            mobility,
            watched_room: 0.0,
            bounds: DistanceBounds::new(BODIES, PARTS),
            closest: None,
            least_distance: f64::INFINITY,
            needs_inertia: false,
            crowded: false,
            violations: SeparationViolations::new(state.joints),
            receding: Vec::with_capacity(state.joints),
        })
    }

    /// Watches pairs with less room than `room` \[m\], even where [`JointMotion::change`] shows
    /// that they need no row. [`write`](Self::write) then returns the pair with the least room if
    /// that is below `room`. Default 0.
    #[must_use]
    pub fn watching(self, room: f64) -> Self {
        Self { watched_room: room, ..self }
    }

    /// Returns the block of rows, which bounds nothing yet.
    pub fn rows(&self) -> Rows {
        let mut rows = Rows::zeros(self.capacity, self.state.len());
        rows.lower_mut().fill(f64::NEG_INFINITY);
        rows.upper_mut().fill(f64::INFINITY);
        rows
    }

    /// Returns the settings.
    pub fn settings(&self) -> &SeparationSettings {
        &self.settings
    }

    /// [Measures](Self::measure) the pairs of robot and person, and [writes](Self::write_rows) their
    /// rows.
    ///
    /// # Errors
    /// Those of both. The block is unchanged after an error.
    pub fn write(
        &mut self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        person: &[PersonBody],
        rows: &mut Rows,
    ) -> Result<Option<Nearest>, Error> {
        self.check_rows(rows)?;
        let nearest = self.measure(motion, robot, person)?;
        self.write_rows(motion, rows)?;
        Ok(nearest)
    }

    /// Measures the pairs of robot and person, and decides which of them get a row. Returns the
    /// pair with the least room among those that may not touch. Ignores
    /// [`JointMotion::braking`]. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the Jacobian or the velocities do not fit. [`Error::Value`] if a number is
    /// not finite or out of range.
    pub fn measure(
        &mut self,
        motion: &JointMotion<'_>,
        robot: &[RobotBody],
        person: &[PersonBody],
    ) -> Result<Option<Nearest>, Error> {
        self.check(motion, robot)?;
        person.iter().try_for_each(PersonBody::check)?;
        self.clear();
        self.needs_inertia = false;
        self.mobility.clear();
        self.bounds.advance(capsules(robot), person.iter().map(|part| &part.capsule));
        self.find_closest(robot, person);
        let base_joints = self.settings.base.map_or(0, |base| base.joints);
        self.changes.update(motion);
        self.speeds.clear();
        let watched = self.watched_room;
        let speeds_of = |part: &PersonBody| PartSpeeds::of(part, watched);
        self.speeds.extend(person.iter().take(PARTS).map(speeds_of));
        let most = PartSpeeds::most(&self.speeds);
        let mut before: Option<BodyMotion> = None;
        for (i, body) in robot.iter().enumerate() {
            let known = before.as_ref();
            let mut moves = BodyMotion::new(motion, body, base_joints, &self.changes, known);
            let (mut next, mut reach) = (0, self.reach(moves.fastest, moves.change));
            while let Some((j, part, speeds)) =
                self.find_in_sight((i, &moves), (reach, &most), person, next)
            {
                next = j + 1;
                let sight = speeds.sight(&moves, reach);
                let near = proximity(&body.capsule, &part.capsule);
                self.bounds.set(i, j, near.distance);
                self.keep_closest((i, j), near.distance);
                if near.distance <= sight + speeds.watched_room {
                    let pair = Pair { robot: (i, body), other: (j, part), near, sight };
                    self.evaluate(motion, &mut moves, &pair);
                    reach = self.reach(moves.fastest, moves.change);
                }
            }
            before = Some(moves);
        }
        self.places.assign(&self.candidates);
        Ok(self.nearest)
    }

    /// Writes the rows of the pairs that were measured last, with the robot where it was then. The
    /// block is that of [`rows`](Self::rows) or one like it. Rows that bound nothing and need not
    /// are left as they are. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the block, the Jacobian or the velocities do not fit. [`Error::Value`] if
    /// a number is not finite.
    pub fn write_rows(&self, motion: &JointMotion<'_>, rows: &mut Rows) -> Result<(), Error> {
        self.check_rows(rows)?;
        motion.check(self.state.joints)?;
        for (index, candidate) in self.places.candidates().enumerate() {
            let candidate = candidate.and_then(|candidate| self.candidates.get(candidate));
            if candidate.is_none() && rows.upper().get(index) == Some(&f64::INFINITY) {
                continue;
            }
            let row = rows.row_mut(index)?;
            row.fill(0.0);
            let mut upper = f64::INFINITY;
            if let Some(candidate) = candidate {
                candidate.write(motion, row);
                let along = |velocity: &[f64]| -> f64 {
                    row.iter().zip(velocity).map(|(a, b)| a * b).sum()
                };
                upper = candidate.limit.max(motion.braking.map_or(0.0, along));
            }
            rows.upper_mut()[index] = upper;
        }
        Ok(())
    }

    /// Finds the next part of the person, from index `from` on, that may be near enough to a body
    /// of the robot. Returns its index, the part, and its speeds. `most` bounds the speeds of all
    /// parts.
    fn find_in_sight<'a>(
        &self,
        (robot, moves): (usize, &BodyMotion),
        (reach, most): (Reach, &PartSpeeds),
        person: &'a [PersonBody],
        from: usize,
    ) -> Option<(usize, &'a PersonBody, PartSpeeds)> {
        let bounds = self.bounds.of(robot);
        let mut remembered = bounds.iter().zip(&self.speeds).enumerate().skip(from);
        let farthest = |speeds: &PartSpeeds| {
            (speeds.sight(moves, reach) + speeds.watched_room).max(self.least_distance)
        };
        // Most parts are farther away than any part may matter.
        let farthest_of_all = farthest(most);
        let in_sight = remembered
            .find(|(_, (bound, speeds))| **bound <= farthest_of_all && **bound <= farthest(speeds));
        if let Some((other, (_, speeds))) = in_sight {
            return Some((other, person.get(other)?, *speeds));
        }
        let other = from.max(bounds.len());
        let part = person.get(other)?;
        Some((other, part, PartSpeeds::of(part, self.watched_room)))
    }

    /// Keeps the pair with the least room.
    fn see(&mut self, pair: Nearest) {
        if self.nearest.is_none_or(|other| pair.room() < other.room()) {
            self.nearest = Some(pair);
        }
    }

    /// Returns true if a pair of the rows written last approaches at nearly its largest speed.
    /// `velocity` holds the velocities of the joints, n \[m/s or rad/s\].
    pub fn is_at_limit(&self, rows: &Rows, velocity: &[f64]) -> bool {
        let mut written = self.places.candidates().zip(rows.iter());
        written.any(|(candidate, (row, _, upper))| {
            let approach: f64 = row.iter().zip(velocity).map(|(a, b)| a * b).sum();
            candidate.is_some() && approach > upper - AT_LIMIT
        })
    }

    /// Returns the smallest share of the way from `velocity` to `braking`, each n, that satisfies
    /// the rows written last \[-\]. After it every pair approaches no faster than its row allows,
    /// or than it does with `braking`. Rows that contradict each other, for instance between two
    /// people, are not weighed against each other.
    ///
    /// If a person is inside the protective distance, the robot must not approach any of their
    /// possible positions. The person has moved since they were seen, and perhaps not as measured.
    /// If `velocity` would approach one of these positions, the share is 1.
    pub fn braking_share(
        &self,
        motion: &JointMotion<'_>,
        rows: &Rows,
        velocity: &[f64],
        braking: &[f64],
    ) -> f64 {
        let mut share = 0.0_f64;
        for (candidate, (row, _, upper)) in self.places.candidates().zip(rows.iter()) {
            if candidate.is_none() {
                continue;
            }
            let along =
                |velocity: &[f64]| -> f64 { row.iter().zip(velocity).map(|(a, b)| a * b).sum() };
            let (approach, least) = (along(velocity) - ROUNDING, along(braking));
            if approach > upper.max(least) {
                share = share.max((approach - upper.max(least)) / (approach - least));
            }
        }
        let is_left = self.violations.is_left_by(motion, velocity, ROUNDING);
        if is_left && (share == 0.0 || self.violations.is_empty()) { share.min(1.0) } else { 1.0 }
    }

    /// Changes the velocities of a `stop` within the `intervals`, so that it approaches people inside
    /// the protective distance no faster than the stop `least` does; n each. Joints that may not
    /// brake as much as in `least` are made up for by others. The stop stays as it is if that cannot
    /// be, or if a row written last would forbid the change.
    pub fn recede(
        &mut self,
        motion: &JointMotion<'_>,
        rows: &Rows,
        (least, intervals): (&[f64], &[VelocityInterval]),
        stop: &mut [f64],
    ) {
        let mut receding = std::mem::take(&mut self.receding);
        receding.clear();
        receding.extend_from_slice(stop);
        if self.violations.recede(motion, (least, intervals), &mut receding, ROUNDING) {
            let mut written = self.places.candidates().zip(rows.iter());
            let is_allowed = written.all(|(candidate, (row, _, upper))| {
                let along = |velocity: &[f64]| -> f64 {
                    row.iter().zip(velocity).map(|(a, b)| a * b).sum()
                };
                candidate.is_none() || along(&receding) - ROUNDING <= upper.max(along(stop))
            });
            if is_allowed {
                stop.copy_from_slice(&receding);
            }
        }
        self.receding = receding;
    }

    /// Returns true if a pair that may not touch is closer than the uncertainty of both positions.
    /// No direction surely leads away then, so the robot must stand still.
    pub fn is_too_near_to_tell(&self) -> bool {
        self.violations.is_too_near()
    }

    /// Returns true if [`JointMotion::inverse_inertia`] decided, or would have decided, the speed
    /// limit of a pair written last. All other pairs allow full speed even to a robot of infinite
    /// mass.
    pub fn needs_inertia(&self) -> bool {
        self.needs_inertia
    }

    /// Returns true if more pairs are at their limits than there are rows. The robot must then
    /// brake, which satisfies the limits of all pairs.
    pub fn is_crowded(&self) -> bool {
        self.crowded || self.violations.overflows()
    }

    /// Returns the smallest distance of the pairs written last \[m\], infinite if there are none.
    pub fn least_distance(&self) -> f64 {
        self.least_distance
    }

    fn clear(&mut self) {
        self.candidates.clear();
        self.nearest = None;
        self.least_distance = f64::INFINITY;
        self.crowded = false;
        self.violations.clear();
    }

    /// Measures the pair that was nearest last. Its distance bounds the smallest distance from
    /// above.
    fn find_closest(&mut self, robot: &[RobotBody], person: &[PersonBody]) {
        let Some((i, j)) = self.closest.take() else { return };
        if let (Some(body), Some(part)) = (robot.get(i), person.get(j)) {
            let distance = proximity(&body.capsule, &part.capsule).distance;
            self.keep_closest((i, j), distance);
        }
    }

    fn keep_closest(&mut self, pair: (usize, usize), distance: f64) {
        if distance <= self.least_distance {
            (self.closest, self.least_distance) = (Some(pair), distance);
        }
    }

    fn check(&self, motion: &JointMotion<'_>, robot: &[RobotBody]) -> Result<(), Error> {
        robot.iter().try_for_each(|body| check_capsule("a capsule of the robot", &body.capsule))?;
        motion.check(self.state.joints)
    }

    fn check_rows(&self, rows: &Rows) -> Result<(), Error> {
        check_size("the block of rows", rows.len(), self.capacity)?;
        Ok(check_size("a row of the block", rows.columns(), self.state.len())?)
    }

    /// Returns how far to search for pairs, for a body that approaches at `speed` or less. Within
    /// this tick it gets faster by `change` at most.
    fn reach(&self, speed: f64, change: f64) -> Reach {
        let headroom = match self.candidates.worst() {
            _ if self.capacity == 0 => 0.0,
            Some(worst) => change.min(worst),
            None => change,
        };
        if headroom == f64::INFINITY {
            return Reach { standing: f64::INFINITY, time: 0.0 };
        }
        let (settings, speed) = (self.settings.braking_worst(), speed + headroom.max(0.0));
        let standing = settings.protective_distance(0.0, speed);
        Reach { standing, time: settings.reaction_time + speed / settings.deceleration }
    }

    /// Keeps the pairs with the least headroom.
    fn consider(&mut self, candidate: Candidate, change: f64) {
        if candidate.headroom > change {
            return;
        }
        if let Some(left_out) = self.candidates.insert(candidate) {
            // Within this tick the pair could reach its limit.
            self.crowded |= !left_out.contact || left_out.headroom < 0.0;
        }
    }
}

fn capsules(robot: &[RobotBody]) -> impl Iterator<Item = &Capsule> + Clone {
    robot.iter().map(|body| &body.capsule)
}
