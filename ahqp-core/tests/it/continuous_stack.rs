//! Properties of a stack whose levels are inserted, removed and exchanged.

use std::collections::{BTreeMap, BTreeSet};

use ahqp_core::testing::problems::controller_sequence;
use ahqp_core::{
    ContinuousStack, Error, Hierarchy, Level, LevelId, Place, Rows, Settings, Solver, Status,
    WarmStart,
};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, RngSeed, TestRng};

const PERIOD: f64 = 1e-3;
const VARIABLES: usize = 8;
const BOUND: f64 = 1.5;

/// A task with rows and targets that oscillate.
#[derive(Debug, Clone)]
struct Task {
    rows: usize,
    one_sided: bool,
    constraint: bool,
    coefficients: [Vec<f64>; 2],
    targets: [Vec<f64>; 2],
    rate: f64,
}

impl Task {
    fn new(rows: usize, random: &mut TestRng) -> Self {
        let mut numbers = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| size * random.random_range(-1.0..1.0)).collect()
        };
        Self {
            rows,
            coefficients: [numbers(rows * VARIABLES, 1.0), numbers(rows * VARIABLES, 0.2)],
            targets: [numbers(rows, 1.0), numbers(rows, 0.2)],
            one_sided: false,
            constraint: false,
            rate: random.random_range(0.5..2.0),
        }
    }

    fn one_sided(self) -> Self {
        Self { one_sided: true, ..self }
    }

    /// Turns the task into a hard constraint that holds at zero, without an objective.
    fn constraint(mut self) -> Self {
        self.targets[0].iter_mut().for_each(|target| *target = 0.4 + 0.2 * target.abs());
        Self { constraint: true, ..self.one_sided() }
    }

    fn write(&self, rows: &mut Rows, time: f64) {
        let swing = (self.rate * time).sin();
        for i in 0..self.rows {
            for (j, entry) in rows.row_mut(i).unwrap().iter_mut().enumerate() {
                let k = i * VARIABLES + j;
                *entry = self.coefficients[0][k] + swing * self.coefficients[1][k];
            }
            let target = self.targets[0][i] + swing * self.targets[1][i];
            rows.upper_mut()[i] = target;
            rows.lower_mut()[i] = if self.one_sided { f64::NEG_INFINITY } else { target };
        }
    }

    fn level(&self, time: f64) -> Level {
        let mut rows = Rows::zeros(self.rows, VARIABLES);
        self.write(&mut rows, time);
        if self.constraint { Level::constraints_only(rows) } else { Level::least_squares(rows) }
    }
}

fn random(seed: u64) -> TestRng {
    TestRng::from_seed(RngAlgorithm::XorShift, &[seed.to_le_bytes(), [1; 8]].concat())
}

/// Uses the same cases on every run. `PROPTEST_RNG_SEED` and `AHQP_CASES` select others and more.
fn config() -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases: number("AHQP_CASES").map_or(10, |cases| u32::try_from(cases).unwrap()),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn value(row: &[f64], x: &[f64]) -> f64 {
    row.iter().zip(x).map(|(a, x)| a * x).sum()
}

/// A stack, with the expected order of its levels and plain hierarchies for comparison.
struct Run {
    stack: ContinuousStack,
    tasks: BTreeMap<LevelId, Task>,
    order: Vec<LevelId>,
    time: f64,
    random: TestRng,
    /// Largest change of each variable in a tick.
    reach: f64,
}

impl Run {
    /// Creates bounds, hard constraints, a task above all changes, and three tasks below.
    fn new(seed: u64) -> Self {
        let mut random = random(seed);
        let tasks = [
            Task::new(3, &mut random).constraint(),
            Task::new(2, &mut random),
            Task::new(1, &mut random).one_sided(),
            Task::new(1, &mut random),
            Task::new(1, &mut random),
        ];
        let stack =
            ContinuousStack::new(&hierarchy(tasks.iter(), 0.0), Settings::default()).unwrap();
        let order: Vec<_> = stack.ids().collect();
        let tasks = order.iter().copied().zip(tasks).collect();
        Self { stack, tasks, order, time: 0.0, random, reach: f64::INFINITY }
    }

    fn plain(&self, levels: &[LevelId], time: f64) -> Vec<f64> {
        let hierarchy = hierarchy(levels.iter().map(|id| &self.tasks[id]), time);
        let settings = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
        let mut solver = Solver::new(&hierarchy, settings).unwrap();
        let solution = solver.solve(&hierarchy).unwrap();
        assert_eq!(solution.status(), Status::Solved);
        solution.optimum().unwrap().to_vec()
    }

    /// Returns the mean over all thresholds, computed from the activations and the expected order.
    fn expected(&self) -> Vec<f64> {
        let activation = |id: &LevelId| self.stack.activation(*id).unwrap();
        let mut thresholds: Vec<_> = self.order.iter().map(activation).chain([0.0, 1.0]).collect();
        thresholds.sort_by(f64::total_cmp);
        let mut mean = vec![0.0; VARIABLES];
        for pair in thresholds.windows(2).filter(|pair| pair[0] < pair[1]) {
            let present: Vec<_> =
                self.order.iter().copied().filter(|id| activation(id) >= pair[1]).collect();
            for (to, x) in mean.iter_mut().zip(self.plain(&present, self.time)) {
                *to += (pair[1] - pair[0]) * x;
            }
        }
        mean
    }

    /// Returns the levels that are to become fully active, in order.
    fn aim(&self, activations: &BTreeMap<LevelId, f64>) -> Vec<LevelId> {
        self.order.iter().copied().filter(|id| activations.get(id) != Some(&0.0)).collect()
    }

    /// Starts a random change of the levels below the first two, unless too many are in progress.
    fn change(&mut self, aims: &mut BTreeMap<LevelId, f64>) {
        let free = self.order[2..].to_vec();
        let pick = |random: &mut TestRng| free[random.random_range(0..free.len())];
        let duration = self.random.random_range(0.05..0.2);
        let result = match self.random.random_range(0..4) {
            0 if free.len() < 6 => {
                let task = Task::new(1, &mut self.random);
                let neighbour = pick(&mut self.random);
                let above = self.random.random::<bool>();
                let place = if above { Place::Above(neighbour) } else { Place::Below(neighbour) };
                self.stack.insert(task.level(self.time), place, duration).map(|id| {
                    let at = self.order.iter().position(|other| *other == neighbour).unwrap();
                    self.order.insert(at + usize::from(!above), id);
                    self.tasks.insert(id, task);
                })
            }
            1 if free.len() > 2 => {
                let id = pick(&mut self.random);
                self.stack.remove(id, duration).map(|()| {
                    self.order.retain(|other| *other != id);
                })
            }
            2 => {
                let (a, b) = (pick(&mut self.random), pick(&mut self.random));
                self.stack.swap(a, b, duration).map(|()| {
                    let place = |id| self.order.iter().position(|other| *other == id).unwrap();
                    let (i, j) = (place(a), place(b));
                    self.order.swap(i, j);
                })
            }
            _ => {
                let id = pick(&mut self.random);
                let aim = [0.0, 0.4, 1.0][self.random.random_range(0..3)];
                self.stack.activate(id, aim, duration).map(|()| {
                    aims.insert(id, aim);
                })
            }
        };
        assert!(
            matches!(
                result,
                Ok(()) | Err(Error::Value { what: "the number of changes under way", .. })
            ),
            "{result:?}"
        );
    }

    fn tick(&mut self) -> Vec<f64> {
        self.time += PERIOD;
        for (id, task) in &self.tasks {
            // A removed level needs no data.
            if let Ok(level) = self.stack.level_mut(*id) {
                let rows = if task.constraint {
                    level.constraints_mut()
                } else {
                    level.rows_mut().unwrap()
                };
                task.write(rows, self.time);
            }
        }
        let last = self.stack.solution().map_or(vec![0.0; VARIABLES], |last| last.best().to_vec());
        let (lower, upper) = self.stack.output_bounds_mut();
        for (i, x) in last.iter().enumerate() {
            (lower[i], upper[i]) = (x - self.reach, x + self.reach);
        }
        self.stack.solve(PERIOD).unwrap().best().to_vec()
    }

    /// Expects what no change may affect: the bounds, the hard constraints, and the first task.
    fn expect_untouched(&self, x: &[f64], first_task: bool) {
        assert!(x.iter().all(|x| (-BOUND..=BOUND).contains(x)));
        let above = [&self.tasks[&self.order[0]], &self.tasks[&self.order[1]]];
        for (row, _, upper) in above[0].level(self.time).constraints().iter() {
            assert!(value(row, x) <= upper + 1e-9);
        }
        if !first_task {
            return;
        }
        let alone = hierarchy(above.into_iter(), self.time);
        let mut solver = Solver::new(&alone, Settings::default()).unwrap();
        let x_alone = solver.solve(&alone).unwrap().optimum().unwrap();
        let least = alone.levels()[1].violation(x_alone).unwrap();
        let level = above[1].level(self.time);
        assert!((level.violation(x).unwrap() - least).abs() < 1e-8);
    }
}

fn hierarchy<'a>(tasks: impl Iterator<Item = &'a Task>, time: f64) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(VARIABLES).unwrap();
    let (lower, upper) = hierarchy.bounds_mut();
    lower.fill(-BOUND);
    upper.fill(BOUND);
    for task in tasks {
        hierarchy.push(task.level(time)).unwrap();
    }
    hierarchy
}

/// Measurements of a run of 600 ticks with occasional changes.
#[derive(Debug, Default)]
struct Record {
    /// Largest ‖χ(t + Δt) − χ(t)‖.
    step: f64,
    /// L, the largest rate of a plain hierarchy.
    plain_rate: f64,
    /// D, the largest distance between two plain hierarchies.
    spread: f64,
    /// Largest rate of the activations.
    rate: f64,
    /// Largest step of the same changes without a transition.
    jump: f64,
}

impl Record {
    /// Returns the largest step that the documentation allows.
    fn bound(&self) -> f64 {
        (self.plain_rate + self.spread * self.rate) * PERIOD
    }
}

fn record(seed: u64) -> Record {
    let mut run = Run::new(seed);
    let mut record = Record::default();
    let mut aims = BTreeMap::new();
    let mut before = run.tick();
    let mut plans_before: BTreeSet<Vec<LevelId>> =
        run.stack.parts().map(|part| part.ids().collect()).collect();
    for tick in 1..600 {
        if tick < 400 && run.random.random_range(0..40) == 0 {
            let old = run.plain(&run.aim(&aims), run.time);
            run.change(&mut aims);
            let new = run.plain(&run.aim(&aims), run.time);
            record.jump = record.jump.max(distance(&old, &new));
        }
        record.rate = record.rate.max(run.stack.rate());
        let x = run.tick();

        // The solution is the mean of the parts, whose weights sum to one.
        let mut mean = vec![0.0; VARIABLES];
        let mut weights = 0.0;
        for part in run.stack.parts() {
            assert_eq!(part.solution().status(), Status::Solved);
            let levels: Vec<_> = part.ids().collect();
            let plain = run.plain(&levels, run.time);
            assert!(distance(part.solution().optimum().unwrap(), &plain) < 1e-7);
            mean.iter_mut().zip(&plain).for_each(|(to, x)| *to += part.weight() * x);
            weights += part.weight();
        }
        assert!((weights - 1.0).abs() < 1e-12 && distance(&mean, &x) < 1e-7);
        if !run.stack.is_changing() {
            assert_eq!(run.stack.ids().collect::<Vec<_>>(), run.order);
            assert!(distance(&run.expected(), &x) < 1e-7);
        }

        run.expect_untouched(&x, true);
        if tick % 50 == 0 {
            for part in run.stack.certified_parts().unwrap() {
                let residuals = part.certificate.residuals(&part.hierarchy, &part.x).unwrap();
                assert!(residuals.worst() < 1e-8, "{residuals:?}");
            }
        }

        // Rates and distances of the plain hierarchies of this tick and the last one.
        let plans: BTreeSet<Vec<LevelId>> =
            run.stack.parts().map(|part| part.ids().collect()).collect();
        let all: Vec<_> = plans.union(&plans_before).collect();
        let now: Vec<_> = all.iter().map(|levels| run.plain(levels, run.time)).collect();
        for (levels, x) in all.iter().zip(&now) {
            let then = run.plain(levels, run.time - PERIOD);
            record.plain_rate = record.plain_rate.max(distance(x, &then) / PERIOD);
            for other in &now {
                record.spread = record.spread.max(distance(x, other));
            }
        }
        record.step = record.step.max(distance(&x, &before));
        (before, plans_before) = (x, plans);
    }
    assert!(!run.stack.is_changing());
    record
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn the_solution_moves_no_faster_than_stated(seed in any::<u64>()) {
        let record = record(seed);
        prop_assert!(record.step <= record.bound() * (1.0 + 1e-6) + 1e-7, "{record:?}");
    }

    #[test]
    fn bounds_of_the_output_always_hold(seed in any::<u64>()) {
        const REACH: f64 = 0.01;
        let mut run = Run::new(seed);
        let mut aims = BTreeMap::new();
        let mut before = run.tick();
        run.reach = REACH;
        for tick in 1..1200 {
            if tick < 400 && run.random.random_range(0..30) == 0 {
                run.change(&mut aims);
            }
            let x = run.tick();
            for (x, before) in x.iter().zip(&before) {
                prop_assert!((x - before).abs() <= REACH + 1e-12);
            }
            run.expect_untouched(&x, false);
            before = x;
        }
        // The solution has arrived, unless it is still moving after a jump of the hierarchy.
        let (now, then) = (run.expected(), run.time);
        run.time -= 0.5;
        let settled = distance(&now, &run.expected()) < 0.5;
        run.time = then;
        prop_assert!(!settled || distance(&now, &before) < 1e-6);
    }
}

#[test]
fn without_a_transition_the_same_changes_jump() {
    let records = (0..12).map(record);
    // If a plain hierarchy jumps by itself, the comparison shows nothing.
    let smooth = records.filter(|record| record.plain_rate * PERIOD < 0.02);
    let (farther, total) = smooth.fold((0, 0), |(farther, total), record| {
        (farther + usize::from(record.jump > 3.0 * record.bound()), total + 1)
    });
    assert!(total >= 6 && 10 * farther >= 8 * total, "{farther} of {total}");
}

#[test]
fn a_mobile_manipulators_stack_keeps_constraints_and_bounds() {
    // The solutions jump by up to 2 between two ticks, since nothing limits the acceleration.
    const REACH: f64 = 0.02;
    let problems = controller_sequence(1, 600).unwrap();
    let mut stack = ContinuousStack::new(&problems[0], Settings::default()).unwrap();
    let levels: Vec<_> = stack.ids().collect();
    let mut before = stack.solve(PERIOD).unwrap().optimum().unwrap().to_vec();
    for (tick, problem) in problems.iter().enumerate().skip(1) {
        match tick {
            50 => stack.remove(levels[3], 0.2).unwrap(),
            150 => stack.activate(levels[2], 0.3, 0.2).unwrap(),
            200 => stack.swap(levels[0], levels[2], 0.1).unwrap(),
            400 => stack.activate(levels[2], 1.0, 0.15).unwrap(),
            _ => {}
        }
        for (id, level) in levels.iter().zip(problem.levels()) {
            if let Ok(to) = stack.level_mut(*id) {
                to.clone_from(level);
            }
        }
        let (lower, upper) = stack.bounds_mut();
        lower.copy_from_slice(problem.lower());
        upper.copy_from_slice(problem.upper());
        let (lower, upper) = stack.output_bounds_mut();
        for (i, x) in before.iter().enumerate() {
            (lower[i], upper[i]) = (x - REACH, x + REACH);
        }
        let x = stack.solve(PERIOD).unwrap().optimum().unwrap().to_vec();
        for (i, x) in x.iter().enumerate() {
            assert!((problem.lower()[i]..=problem.upper()[i]).contains(x));
            assert!((x - before[i]).abs() <= REACH + 1e-12);
        }
        let whole = levels.iter().zip(problem.levels());
        for (_, level) in whole.filter(|(id, _)| stack.activation(**id) == Ok(1.0)) {
            for (row, lower, upper) in level.constraints().iter() {
                assert!((lower - 1e-9..=upper + 1e-9).contains(&value(row, &x)), "{tick}");
            }
        }
        before = x;
    }
    assert!(!stack.is_changing());
}

#[test]
fn running_out_of_iterations_shows() {
    let hierarchy = Run::new(1);
    let settings = Settings { max_iterations: 1, ..Settings::default() };
    let tasks = hierarchy.order.iter().map(|id| &hierarchy.tasks[id]);
    let mut stack = ContinuousStack::new(&self::hierarchy(tasks, 0.0), settings).unwrap();
    let solution = stack.solve(PERIOD).unwrap();
    assert!(matches!(solution.status(), Status::IterationLimit { .. }));
    assert!(matches!(solution.optimum(), Err(Error::Unfinished { .. })));
    let mut run = Run::new(1);
    run.tick();
    assert!(run.stack.solution().unwrap().optimum().is_ok());
}
