//! Null pointers, wrong sizes, texts.

use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

use ahqp::AhqpStatus;
use ahqp::failure::ahqp_last_error;
use ahqp::hierarchy::{
    ahqp_hierarchy_free, ahqp_hierarchy_new, ahqp_hierarchy_push, ahqp_hierarchy_set_bounds,
    ahqp_hierarchy_violation,
};
use ahqp::model::{ahqp_model_from_file, ahqp_model_from_urdf};
use ahqp::solver::{
    ahqp_solver_conflict_count, ahqp_solver_conflict_row, ahqp_solver_free, ahqp_solver_new,
    ahqp_solver_solve,
};
use ahqp::views::{AhqpMatrix, AhqpVector};

fn last() -> String {
    // SAFETY: never null, and ends with a zero byte.
    unsafe { CStr::from_ptr(ahqp_last_error()) }.to_str().unwrap().to_owned()
}

#[track_caller]
fn expect(found: AhqpStatus, status: AhqpStatus, words: &str) {
    assert_eq!(found, status, "{}", last());
    assert!(last().contains(words), "{}", last());
}

const ONE: [f64; 1] = [1.0];

fn one() -> AhqpVector {
    AhqpVector { data: ONE.as_ptr(), size: 1 }
}

#[test]
fn null_pointers_and_sizes_are_errors() {
    use AhqpStatus::{BadArgument, NullPointer, Ok};
    let mut hierarchy = null_mut();
    let nothing = AhqpVector { data: null(), size: 0 };
    let matrix =
        AhqpMatrix { data: ONE.as_ptr(), rows: 1, columns: 1, row_stride: 1, column_stride: 1 };
    // SAFETY: every pointer is null or to numbers that live as long as the calls.
    unsafe {
        expect(ahqp_hierarchy_new(1, null_mut()), NullPointer, "handle");
        expect(ahqp_hierarchy_new(usize::MAX, &raw mut hierarchy), BadArgument, "at most");
        assert!(hierarchy.is_null());
        assert_eq!(ahqp_hierarchy_new(1, &raw mut hierarchy), Ok);
        let push = |matrix, lower| {
            ahqp_hierarchy_push(hierarchy, matrix, lower, nothing, false, null(), null_mut())
        };
        expect(push(AhqpMatrix { data: null(), ..matrix }, one()), NullPointer, "A is null");
        let huge = AhqpMatrix { rows: usize::MAX, ..matrix };
        expect(push(huge, one()), BadArgument, "more than");
        let odd = ONE.as_ptr().wrapping_byte_add(1);
        expect(push(AhqpMatrix { data: odd, ..matrix }, one()), BadArgument, "aligned");
        let two = AhqpVector { size: 2, ..one() };
        expect(push(matrix, two), BadArgument, "the lower bound has size 2; it must have 1");
        let broken: [c_char; 2] = [-1, 0];
        let end = ahqp_hierarchy_push(
            hierarchy,
            matrix,
            one(),
            one(),
            false,
            broken.as_ptr(),
            null_mut(),
        );
        expect(end, BadArgument, "UTF-8");
        expect(ahqp_hierarchy_set_bounds(null_mut(), one(), one()), NullPointer, "hierarchy");
        let end = ahqp_hierarchy_violation(hierarchy, 0, one(), null_mut());
        expect(end, NullPointer, "where to put");
        expect(ahqp_solver_new(null(), null(), null_mut()), NullPointer, "hierarchy");
        expect(ahqp_model_from_urdf(null(), 0, null_mut()), NullPointer, "URDF");
        let mut model = null_mut();
        expect(ahqp_model_from_file(c"x".as_ptr(), -1, &raw mut model), BadArgument, "0 to 2");
        ahqp_hierarchy_free(hierarchy);
        ahqp_hierarchy_free(null_mut());
    }
}

#[test]
fn conflicts_are_put_into_words_that_fit() {
    let (mut hierarchy, mut solver, mut x) = (null_mut(), null_mut(), [0.0]);
    let two = [2.0];
    let two = AhqpVector { data: two.as_ptr(), size: 1 };
    let matrix =
        AhqpMatrix { data: ONE.as_ptr(), rows: 1, columns: 1, row_stride: 1, column_stride: 1 };
    // SAFETY: pointers to numbers and texts that live as long as the calls; handles are freed once.
    unsafe {
        assert_eq!(ahqp_hierarchy_new(1, &raw mut hierarchy), AhqpStatus::Ok);
        assert_eq!(ahqp_hierarchy_set_bounds(hierarchy, one(), one()), AhqpStatus::Ok);
        let name = c"höher".as_ptr();
        let end = ahqp_hierarchy_push(hierarchy, matrix, two, two, true, name, null_mut());
        assert_eq!(end, AhqpStatus::Ok);
        assert_eq!(ahqp_solver_new(hierarchy, null(), &raw mut solver), AhqpStatus::Ok);
        let end = ahqp_solver_solve(solver, hierarchy, 0, 0.0, x.as_mut_ptr(), 1);
        expect(end, AhqpStatus::Infeasible, "höher");
        assert_eq!(ahqp_solver_conflict_count(solver), 2);
        let whole = "constraint row 0 of level 0 \"höher\"";
        for size in 1..=whole.len() + 1 {
            let mut text = vec![b'#'; size + 1];
            let buffer = text.as_mut_ptr().cast();
            let end = ahqp_solver_conflict_row(solver, hierarchy, 0, buffer, size);
            assert_eq!(end, AhqpStatus::Ok);
            let row = CStr::from_bytes_until_nul(&text).unwrap().to_str().unwrap();
            assert!(whole.starts_with(row) && row.len() + 2 >= size.min(whole.len()));
            assert_eq!(text[size], b'#', "beyond the buffer");
        }
        let end = ahqp_solver_conflict_row(solver, hierarchy, 2, null_mut(), 0);
        expect(end, AhqpStatus::NullPointer, "buffer");
        ahqp_solver_free(solver);
        ahqp_hierarchy_free(hierarchy);
    }
}
