//! Nothing is allocated after construction.

use std::ffi::CString;
use std::ptr::{null, null_mut};

use ahqp::AhqpStatus::Ok as Done;
use ahqp::hierarchy::{
    ahqp_hierarchy_free, ahqp_hierarchy_new, ahqp_hierarchy_push, ahqp_hierarchy_update,
};
use ahqp::ik::{
    ahqp_ik_brake, ahqp_ik_build, ahqp_ik_free, ahqp_ik_new, ahqp_ik_push_position,
    ahqp_ik_push_posture, ahqp_ik_set_position, ahqp_ik_step,
};
use ahqp::model::{ahqp_model_free, ahqp_model_from_urdf};
use ahqp::solver::{ahqp_solver_free, ahqp_solver_new, ahqp_solver_solve};
use ahqp::views::{AhqpMatrix, AhqpVector};

fn vector(data: &[f64]) -> AhqpVector {
    AhqpVector { data: data.as_ptr(), size: data.len() }
}

const NOTHING: AhqpVector = AhqpVector { data: null(), size: 0 };

#[test]
fn solving_and_rewriting_allocate_nothing() {
    let (mut hierarchy, mut solver, mut x) = (null_mut(), null_mut(), [0.0; 3]);
    let a = [1.0, 2.0, 0.5, 0.3, -1.0, 2.0];
    let matrix =
        AhqpMatrix { data: a.as_ptr(), rows: 2, columns: 3, row_stride: 3, column_stride: 1 };
    // SAFETY: pointers to numbers that live as long as the calls; handles are freed once.
    unsafe {
        assert_eq!(ahqp_hierarchy_new(3, &raw mut hierarchy), Done);
        let bound = vector(&[1.0, 2.0]);
        let none = null_mut();
        for hard in [true, false, false] {
            let end = ahqp_hierarchy_push(hierarchy, matrix, bound, bound, hard, null(), none);
            assert_eq!(end, Done);
        }
        assert_eq!(ahqp_solver_new(hierarchy, null(), &raw mut solver), Done);
        let run = allocation_counter::measure(|| {
            for step in 0..20 {
                let bound = [f64::from(step), 2.0];
                let bound = vector(&bound);
                for level in 0..3 {
                    let end =
                        ahqp_hierarchy_update(hierarchy, level, matrix, bound, bound, NOTHING);
                    assert_eq!(end, Done);
                }
                assert_eq!(ahqp_solver_solve(solver, hierarchy, 0, 0.0, x.as_mut_ptr(), 3), Done);
                assert!((a[0] * x[0] + a[1] * x[1] + a[2] * x[2] - f64::from(step)).abs() < 1e-9);
            }
        });
        assert_eq!(run.count_total, 0);
        ahqp_solver_free(solver);
        ahqp_hierarchy_free(hierarchy);
    }
}

#[test]
fn steps_allocate_nothing() {
    let urdf = r#"<robot name="arm">
      <link name="base"/> <link name="upper"/> <link name="lower"/> <link name="tool"/>
      <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
        <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="2" effort="9"/></joint>
      <joint name="elbow" type="revolute"><origin xyz="0.5 0 0"/><parent link="upper"/>
        <child link="lower"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" velocity="2" effort="9"/></joint>
      <joint name="wrist" type="fixed"><origin xyz="0.5 0 0"/><parent link="lower"/>
        <child link="tool"/></joint>
    </robot>"#;
    let [urdf, tool, posture] = [urdf, "tool", "posture"].map(|text| CString::new(text).unwrap());
    let (mut model, mut ik, mut task) = (null_mut(), null_mut(), 7);
    let (mut q, mut velocity) = ([0.3, 0.6], [0.0; 2]);
    // SAFETY: pointers to numbers and texts that live as long as the calls; handles are freed once.
    unsafe {
        assert_eq!(ahqp_model_from_urdf(urdf.as_ptr(), 0, &raw mut model), Done);
        assert_eq!(ahqp_ik_new(model, &raw mut ik), Done);
        ahqp_model_free(model);
        let (name, frame) = (tool.as_ptr(), tool.as_ptr());
        assert_eq!(ahqp_ik_push_position(ik, name, frame, &raw mut task), Done);
        assert_eq!(ahqp_ik_push_posture(ik, posture.as_ptr(), null_mut()), Done);
        assert_eq!(ahqp_ik_build(ik, vector(&q)), Done);
        let run = allocation_counter::measure(|| {
            for _ in 0..50 {
                let target = [0.6, 0.6, 0.0];
                assert_eq!(ahqp_ik_set_position(ik, task, vector(&target), NOTHING), Done);
                let now = AhqpVector { data: q.as_ptr(), size: 2 };
                let (out, next) = (velocity.as_mut_ptr(), q.as_mut_ptr());
                assert_eq!(ahqp_ik_step(ik, now, 1e-3, out, 2, next, 2), Done);
            }
            assert_eq!(ahqp_ik_brake(ik, 1e-3, velocity.as_mut_ptr(), 2), Done);
        });
        assert_eq!(run.count_total, 0);
        assert!(q != [0.3, 0.6]);
        ahqp_ik_free(ik);
    }
}
