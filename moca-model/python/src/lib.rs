//! Native half of the Python package `ahqp`: classes and functions over `ahqp-core`, `whole-body`, `ergo-map`,
//! `moca-model`, `simulated-people` and `vision-models`. The modules `ahqp`, `ahqp.whole_body`, `ahqp.ergo`,
//! `ahqp.collaboration`, `ahqp.simulation` and `ahqp.vision` re-export its contents.

mod arrays;
mod collaboration;
mod ergo;
mod failure;
mod shared;
mod simulation;
mod solver;
mod vision;
mod whole_body;

/// Everything that the package's modules re-export.
#[pyo3::pymodule]
mod _ahqp {
    #[pymodule_export]
    const MOCA_URDF: &str = moca_model::MOCA_URDF;

    #[pymodule_export]
    use crate::collaboration::body::Body;
    #[pymodule_export]
    use crate::collaboration::command::Command;
    #[pymodule_export]
    use crate::collaboration::controller::Controller;
    #[pymodule_export]
    use crate::collaboration::object::GraspedObject;
    #[pymodule_export]
    use crate::collaboration::recording::Recording;
    #[pymodule_export]
    use crate::collaboration::scene::Scene;
    #[pymodule_export]
    use crate::ergo::map::{ErgonomicsMap, FitReport, Quadratic};
    #[pymodule_export]
    use crate::ergo::person::Person;
    #[pymodule_export]
    use crate::ergo::posture::{Posture, ergonomics_score};
    #[pymodule_export]
    use crate::ergo::reba::{Reba, Worksheet};
    #[pymodule_export]
    use crate::ergo::rula::{Rula, RulaWorksheet};
    #[pymodule_export]
    use crate::failure::{Error, FrameError, InfeasibleError, UnfinishedError};
    #[pymodule_export]
    use crate::simulation::person::SimulatedPerson;
    #[pymodule_export]
    use crate::solver::certificate::{Certificate, Residuals};
    #[pymodule_export]
    use crate::solver::hierarchy::Hierarchy;
    #[pymodule_export]
    use crate::solver::limits::Limits;
    #[pymodule_export]
    use crate::solver::row::Row;
    #[pymodule_export]
    use crate::solver::solution::Solution;
    #[pymodule_export]
    use crate::solver::{Solver, solve};
    #[pymodule_export]
    use crate::vision::body::ImageBody;
    #[pymodule_export]
    use crate::vision::camera::{Camera, CameraPlacement};
    #[pymodule_export]
    use crate::vision::files::{read_depth, read_image, read_weights};
    #[pymodule_export]
    use crate::vision::lifting::{Lifter, MonocularLifter};
    #[pymodule_export]
    use crate::vision::networks::{ResNet, Scores, SlowOnly, SlowOnlyStream};
    #[pymodule_export]
    use crate::vision::people::{FollowedPerson, People};
    #[pymodule_export]
    use crate::vision::pose::{BlazePose, Landmarks, OpenPose, SimpleBaseline, nearest_person};
    #[pymodule_export]
    use crate::vision::preprocessing::Preprocessing;
    #[pymodule_export]
    use crate::vision::svm::{LinearSvm, Training};
    #[pymodule_export]
    use crate::vision::tensorflow_lite::TensorFlowLite;
    #[pymodule_export]
    use crate::vision::views::Triangulator;
    #[pymodule_export]
    use crate::whole_body::data::Data;
    #[pymodule_export]
    use crate::whole_body::ik::{Ik, Step};
    #[pymodule_export]
    use crate::whole_body::limits::{FrameVelocityLimit, SelfCollisionLimit, WheelLimit};
    #[pymodule_export]
    use crate::whole_body::model::Model;
    #[pymodule_export]
    use crate::whole_body::tasks::{
        AxisTask, CentreOfMassTask, DampingTask, FrameTask, JointCouplingTask, OrientationTask,
        PositionTask, PostureTask, RelativeFrameTask, VelocityTask,
    };
}
