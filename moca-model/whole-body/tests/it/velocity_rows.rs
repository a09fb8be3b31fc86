//! Rows that the caller writes in every tick, some of which have no bounds.

use std::sync::LazyLock;

use ahqp_core::Rows;
use proptest::prelude::*;
use whole_body::stack::{Budget, Settings, TaskId, TaskLevel, TaskStack};
use whole_body::tasks::{VariableLayout, VelocityTask};
use whole_body::{Data, Model};

use crate::support::stacks::{PERIOD, panda};

static PANDA: LazyLock<Model> = LazyLock::new(panda);
const JOINTS: usize = 7;
const ROWS: usize = 5;

/// The content of one row: its coefficients, whether it has bounds, and its target.
type Asked = ([f64; JOINTS], bool, f64);

fn tick() -> impl Strategy<Value = Vec<Asked>> {
    let row = (prop::array::uniform7(-1.0..1.0_f64), any::<bool>(), -0.5..0.5_f64);
    prop::collection::vec(row, ROWS)
}

fn bounds(asked: &Asked) -> (f64, f64) {
    if asked.1 { (asked.2, f64::INFINITY) } else { (f64::NEG_INFINITY, f64::INFINITY) }
}

fn rows(tick: &[Asked]) -> Rows {
    let mut rows = Rows::zeros(ROWS, JOINTS);
    for (index, asked) in tick.iter().enumerate() {
        let (lower, upper) = bounds(asked);
        rows.set_row(index, &asked.0, lower, upper).unwrap();
    }
    rows
}

/// The task above another one that asks all joints for velocities.
fn stack(task: VelocityTask) -> (TaskStack, TaskId<VelocityTask>) {
    let model = &*PANDA;
    let mut first = TaskLevel::new("first");
    let id = first.push("rows", task);
    let mut rest = VelocityTask::new(JOINTS);
    for joint in 0..JOINTS {
        let mut row = [0.0; JOINTS];
        row[joint] = 1.0;
        let target = 0.1 * f64::from(u8::try_from(joint).unwrap()) - 0.3;
        rest.set_row(joint, &row, target, target).unwrap();
    }
    let mut second = TaskLevel::new("second");
    second.push("rest", rest);
    let layout = VariableLayout::new(model);
    let stack = TaskStack::new(model, &layout, vec![first, second], Settings::default());
    (stack.unwrap(), id)
}

fn solve(stack: &mut TaskStack) -> Vec<f64> {
    let model = &*PANDA;
    let mut data = Data::new(model);
    stack.write(&mut data.pose(model, &model.neutral()).unwrap(), &[0.0; JOINTS], PERIOD).unwrap();
    stack.solve(Budget::default()).unwrap().best().to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Rows copied over those of earlier ticks equal rows written one by one in a new stack.
    #[test]
    fn what_ticks_before_left_does_not_matter(ticks in prop::collection::vec(tick(), 1..6)) {
        let (mut reused, id) = stack(VelocityTask::from_rows(&rows(&ticks[0])));
        for tick in &ticks {
            reused.task_mut(id).unwrap().copy_from(&rows(tick)).unwrap();
            let mut own = VelocityTask::new(ROWS);
            for (index, asked) in tick.iter().enumerate() {
                let (lower, upper) = bounds(asked);
                own.set_row(index, &asked.0, lower, upper).unwrap();
            }
            let (found, expected) = (solve(&mut reused), solve(&mut stack(own).0));
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    /// A row behind the last one with bounds is zero, whatever was there before.
    #[test]
    fn newly_bounded_row_starts_from_zero(
        before in tick(), after in tick(), were_longer in any::<bool>(),
    ) {
        let mut task = VelocityTask::from_rows(&rows(&before));
        if were_longer {
            // Move the rows to other places in memory.
            task = VelocityTask::new(ROWS);
            for (index, asked) in before.iter().enumerate().take(ROWS - 1) {
                let longer: Vec<f64> = asked.0.iter().chain(&asked.0).copied().collect();
                task.set_row(index, &longer, 0.0, 0.0).unwrap();
            }
        }
        let mut after = after;
        after[ROWS - 1].1 = false;
        task.copy_from(&rows(&after)).unwrap();
        task.set_range(ROWS - 1, 0.0, 0.0).unwrap();
        let mut own = VelocityTask::new(ROWS);
        for (index, asked) in after.iter().enumerate() {
            let (lower, upper) = bounds(asked);
            own.set_row(index, &asked.0, lower, upper).unwrap();
        }
        own.set_row(ROWS - 1, &[0.0; JOINTS], 0.0, 0.0).unwrap();
        let (found, expected) = (solve(&mut stack(task).0), solve(&mut stack(own).0));
        for (found, expected) in found.iter().zip(expected) {
            prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
