//! Public arms with their published dimensions.

use std::fmt::Write as _;

use whole_body::{Description, Model};

use super::stacks::panda;

/// An arm by Denavit-Hartenberg parameters in the convention of Siciliano et al. 2009, Sec. 2.8.2.
struct Arm {
    name: &'static str,
    /// Length a \[m\], twist α in quarter turns, offset d \[m\], and the angle at zero in quarter turns.
    links: &'static [[f64; 4]],
    /// Range to each side and speed of the joints \[°, °/s\].
    joints: &'static [[f64; 2]],
}

const ELBOW: f64 = -1.0;

/// Values are from the manufacturers' data sheets: Universal Robots UR3e, UR5, UR10e; ABB IRB 1600-6/1.45, IRB 120;
/// KUKA KR 6 R900, LBR iiwa 7 and 14; Fanuc LR Mate 200iD; Yaskawa GP7; Stäubli TX2-60. Ranges are cut to be symmetric.
const ARMS: [Arm; 11] = [
    Arm {
        name: "ur3e",
        links: &[
            [0.0, 1.0, 0.15185, 0.0],
            [-0.24355, 0.0, 0.0, 0.0],
            [-0.2132, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.13105, 0.0],
            [0.0, -1.0, 0.08535, 0.0],
            [0.0, 0.0, 0.0921, 0.0],
        ],
        joints: &[
            [180.0, 180.0],
            [180.0, 180.0],
            [180.0, 180.0],
            [180.0, 360.0],
            [180.0, 360.0],
            [180.0, 360.0],
        ],
    },
    Arm {
        name: "ur5",
        links: &[
            [0.0, 1.0, 0.089159, 0.0],
            [-0.425, 0.0, 0.0, 0.0],
            [-0.39225, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.10915, 0.0],
            [0.0, -1.0, 0.09465, 0.0],
            [0.0, 0.0, 0.0823, 0.0],
        ],
        joints: &[[180.0, 180.0]; 6],
    },
    Arm {
        name: "ur10e",
        links: &[
            [0.0, 1.0, 0.1807, 0.0],
            [-0.6127, 0.0, 0.0, 0.0],
            [-0.57155, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.17415, 0.0],
            [0.0, -1.0, 0.11985, 0.0],
            [0.0, 0.0, 0.11655, 0.0],
        ],
        joints: &[
            [180.0, 120.0],
            [180.0, 120.0],
            [180.0, 180.0],
            [180.0, 180.0],
            [180.0, 180.0],
            [180.0, 180.0],
        ],
    },
    Arm {
        name: "irb1600",
        links: &[
            [0.15, -1.0, 0.4865, 0.0],
            [0.7, 0.0, 0.0, ELBOW],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.6, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.065, 0.0],
        ],
        joints: &[
            [180.0, 150.0],
            [90.0, 160.0],
            [65.0, 170.0],
            [200.0, 320.0],
            [115.0, 400.0],
            [180.0, 460.0],
        ],
    },
    Arm {
        name: "irb120",
        links: &[
            [0.0, -1.0, 0.29, 0.0],
            [0.27, 0.0, 0.0, ELBOW],
            [0.07, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.302, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.072, 0.0],
        ],
        joints: &[
            [165.0, 250.0],
            [110.0, 250.0],
            [70.0, 250.0],
            [160.0, 320.0],
            [120.0, 320.0],
            [180.0, 420.0],
        ],
    },
    Arm {
        name: "kr6_r900",
        links: &[
            [0.025, -1.0, 0.4, 0.0],
            [0.455, 0.0, 0.0, ELBOW],
            [0.035, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.42, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.08, 0.0],
        ],
        joints: &[
            [170.0, 360.0],
            [100.0, 300.0],
            [120.0, 360.0],
            [185.0, 381.0],
            [120.0, 388.0],
            [180.0, 615.0],
        ],
    },
    Arm {
        name: "lr_mate_200id",
        links: &[
            [0.05, -1.0, 0.33, 0.0],
            [0.33, 0.0, 0.0, ELBOW],
            [0.035, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.335, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.08, 0.0],
        ],
        joints: &[
            [170.0, 450.0],
            [100.0, 380.0],
            [140.0, 520.0],
            [190.0, 550.0],
            [125.0, 545.0],
            [180.0, 1000.0],
        ],
    },
    Arm {
        name: "gp7",
        links: &[
            [0.04, -1.0, 0.33, 0.0],
            [0.445, 0.0, 0.0, ELBOW],
            [0.04, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.44, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.08, 0.0],
        ],
        joints: &[
            [170.0, 375.0],
            [65.0, 315.0],
            [115.0, 410.0],
            [190.0, 550.0],
            [135.0, 550.0],
            [180.0, 1000.0],
        ],
    },
    Arm {
        name: "tx2_60",
        links: &[
            [0.0, -1.0, 0.375, 0.0],
            [0.29, 0.0, 0.0, ELBOW],
            [0.0, 1.0, 0.02, 1.0],
            [0.0, -1.0, 0.31, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.07, 0.0],
        ],
        joints: &[
            [180.0, 435.0],
            [127.0, 385.0],
            [142.0, 500.0],
            [180.0, 995.0],
            [121.0, 1065.0],
            [180.0, 1445.0],
        ],
    },
    Arm {
        name: "iiwa7",
        links: &[
            [0.0, -1.0, 0.34, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 0.4, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, -1.0, 0.4, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.126, 0.0],
        ],
        joints: &[
            [170.0, 98.0],
            [120.0, 98.0],
            [170.0, 100.0],
            [120.0, 130.0],
            [170.0, 140.0],
            [120.0, 180.0],
            [175.0, 180.0],
        ],
    },
    Arm {
        name: "iiwa14",
        links: &[
            [0.0, -1.0, 0.36, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 0.42, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, -1.0, 0.4, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.126, 0.0],
        ],
        joints: &[
            [170.0, 85.0],
            [120.0, 85.0],
            [170.0, 100.0],
            [120.0, 75.0],
            [170.0, 130.0],
            [120.0, 135.0],
            [175.0, 135.0],
        ],
    },
];

/// The models of the arms. Their tools are the last frames.
pub(crate) fn arms() -> Vec<Model> {
    let mut arms: Vec<_> = ARMS.iter().map(Arm::model).collect();
    arms.push(panda());
    arms
}

pub(crate) fn arm(name: &str) -> Model {
    ARMS.iter().find(|arm| arm.name == name).unwrap().model()
}

impl Arm {
    fn model(&self) -> Model {
        let mut text = format!("<robot name=\"{}\"><link name=\"link0\"/>", self.name);
        let quarter = std::f64::consts::FRAC_PI_2;
        // Position and roll of the previous link behind its joint.
        let (mut xyz, mut roll) = ([0.0, 0.0], 0.0);
        for (index, (link, joint)) in self.links.iter().zip(self.joints).enumerate() {
            let [length, twist, offset, angle] = *link;
            let [range, speed] = joint.map(f64::to_radians);
            let next = index + 1;
            // The rotation is Rx(α) of the link before, then Rz(angle), as roll, pitch and yaw.
            let turn = nalgebra::UnitQuaternion::from_euler_angles(roll, 0.0, 0.0)
                * nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, angle * quarter);
            let (r, p, y) = turn.euler_angles();
            let [a, d] = xyz;
            write!(
                text,
                "<link name=\"link{next}\"/><joint name=\"joint{next}\" type=\"revolute\">\
                 <origin xyz=\"{a} 0 {d}\" rpy=\"{r} {p} {y}\"/><parent link=\"link{index}\"/>\
                 <child link=\"link{next}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-{range}\" \
                 upper=\"{range}\" velocity=\"{speed}\" effort=\"0\"/></joint>"
            )
            .unwrap();
            (xyz, roll) = ([length, offset], twist * quarter);
        }
        let (last, [a, d]) = (self.links.len(), xyz);
        write!(
            text,
            "<link name=\"tool0\"/><joint name=\"flange\" type=\"fixed\"><origin xyz=\"{a} 0 {d}\" \
             rpy=\"{roll} 0 0\"/><parent link=\"link{last}\"/><child link=\"tool0\"/></joint></robot>"
        )
        .unwrap();
        Model::from_urdf(&text, &Description::default()).unwrap()
    }
}
