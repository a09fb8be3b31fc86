//! Rows that the caller writes in every tick, some of which have no bounds.

use std::sync::LazyLock;

use proptest::prelude::*;
use whole_body::stack::{Budget, Settings, TaskId, TaskLevel, TaskStack};
use whole_body::tasks::{RowBlock, VariableLayout, VelocityTask};
use whole_body::{Data, Error, Model, Task};

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

/// The task above another one that asks all joints for velocities.
fn stack<T: Task>(task: T) -> (TaskStack, TaskId<T>) {
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

    /// Rows written in place over those of earlier ticks equal rows written one by one in a new stack.
    #[test]
    fn what_ticks_before_left_does_not_matter(ticks in prop::collection::vec(tick(), 1..6)) {
        let (mut reused, id) = stack(RowBlock::new(ROWS));
        for tick in &ticks {
            let block = reused.block_mut(id).unwrap();
            let mut own = VelocityTask::new(ROWS);
            for (index, asked) in tick.iter().enumerate() {
                let (lower, upper) = bounds(asked);
                block.set_row(index, &asked.0, lower, upper).unwrap();
                own.set_row(index, &asked.0, lower, upper).unwrap();
            }
            let (found, expected) = (solve(&mut reused), solve(&mut stack(own).0));
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }
}

#[test]
fn unwritten_block_bounds_nothing() {
    let (mut whole, id) = stack(RowBlock::new(ROWS));
    assert!(whole.block(id).unwrap().upper().iter().all(|upper| *upper == f64::INFINITY));
    let rest: Vec<f64> = (0..JOINTS).map(|joint| 0.1 * joint as f64 - 0.3).collect();
    for (found, expected) in solve(&mut whole).iter().zip(rest) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn only_a_lone_block_is_written_in_place() {
    let mut level = TaskLevel::new("shared");
    let block = level.push("block", RowBlock::new(1));
    level.push("other", RowBlock::new(2));
    let hard = level.constrain("hard", RowBlock::new(3));
    let layout = VariableLayout::new(&PANDA);
    let mut whole = TaskStack::new(&PANDA, &layout, vec![level], Settings::default()).unwrap();
    assert_eq!(whole.block_mut(hard).unwrap().len(), 3);
    assert!(matches!(whole.block_mut(block), Err(Error::UnknownTask)));
    assert!(matches!(whole.block(stack(RowBlock::new(1)).1), Err(Error::UnknownTask)));
}
