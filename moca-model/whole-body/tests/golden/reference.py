"""Values that Pinocchio computes of a robot, in the conventions of whole-body.

Both differ in four things. Pinocchio orders joints by name; values go by name here. It writes a
continuous joint as cosine and sine. Its floating base has velocities in the base's own axes, and
accelerations there that are spatial: whole-body has both in the world's, as the derivatives of the
position and of the orientation. Its planar joint is replaced by three joints x, y and yaw.
"""

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

GRAVITY = np.array([0.0, 0.0, -9.81])
DIRECTION = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0)
BASES = {
    "fixed": (0, 0),
    "planar": (3, 3),
    "floating": (7, 6),
}


def inverse_of(matrix):
    """NaN where there is none."""
    try:
        return np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return np.full_like(matrix, np.nan)


class Robot:
    """A URDF on a base. Pinocchio sees its mimic joints as free ones, and all goes through the
    matrix that makes their velocities from those of the joints that move by themselves."""

    def __init__(self, urdf, base):
        self.urdf, self.base = str(urdf), base
        if base == "floating":
            self.model = pin.buildModelFromUrdf(self.urdf, pin.JointModelFreeFlyer())
        elif base == "planar":
            root = pin.JointModelComposite(3)
            for joint in (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelRZ()):
                root.addJoint(joint)
            self.model = pin.buildModelFromUrdf(self.urdf, root)
        else:
            self.model = pin.buildModelFromUrdf(self.urdf)
        self.model.gravity.linear = GRAVITY
        self.data = self.model.createData()
        self.mimics = {}
        names = list(self.model.names)
        for joint in ElementTree.parse(self.urdf).getroot().findall("joint"):
            mimic = joint.find("mimic")
            if mimic is not None and joint.get("name") in names:
                ratio = float(mimic.get("multiplier", 1.0))
                offset = float(mimic.get("offset", 0.0))
                self.mimics[joint.get("name")] = (mimic.get("joint"), ratio, offset)
        first = 1 if base == "fixed" else 2
        self.joints = [name for name in names[first:] if name not in self.mimics]
        self.links = [
            frame.name for frame in self.model.frames if frame.type == pin.FrameType.BODY
        ]

    def leader(self, name):
        """The joint that a joint follows in the end, with multiplier and offset."""
        ratio, offset = 1.0, 0.0
        while name in self.mimics:
            name, own_ratio, own_offset = self.mimics[name]
            offset += ratio * own_offset
            ratio *= own_ratio
        return name, ratio, offset

    def random_state(self, source):
        """Uniform within the limits, without them within half a turn; base anywhere."""
        state = {"position": {}, "velocity": {}, "acceleration": {}}
        for name in self.joints:
            joint = self.model.joints[self.model.getJointId(name)]
            low, high = -3.0, 3.0
            if joint.nq == 1:
                low = max(low, self.model.lowerPositionLimit[joint.idx_q])
                high = min(high, self.model.upperPositionLimit[joint.idx_q])
                if not low < high:
                    low, high = -3.0, 3.0
            state["position"][name] = source.uniform(low, high)
            state["velocity"][name] = source.uniform(-2.0, 2.0)
            state["acceleration"][name] = source.uniform(-3.0, 3.0)
        if self.base != "fixed":
            size = BASES[self.base][1]
            state["base_position"] = source.uniform(-2.0, 2.0, 3).tolist()
            if self.base == "floating":
                quaternion = source.normal(size=4)
                state["base_position"] += (quaternion / np.linalg.norm(quaternion)).tolist()
            state["base_velocity"] = source.uniform(-2.0, 2.0, size).tolist()
            state["base_acceleration"] = source.uniform(-3.0, 3.0, size).tolist()
        return state

    def _joint(self, name):
        return self.model.joints[self.model.getJointId(name)]

    def _configuration(self, state):
        q = pin.neutral(self.model)
        size = BASES[self.base][0]
        q[:size] = state.get("base_position", [])
        for name in self.joints + list(self.mimics):
            leader, ratio, offset = self.leader(name)
            value = ratio * state["position"][leader] + offset
            joint = self._joint(name)
            at = joint.idx_q
            if joint.nq == 2:
                q[at : at + 2] = np.cos(value), np.sin(value)
            else:
                q[at] = value
        return q

    def _expansion(self, joints):
        """Matrix that makes Pinocchio's joint velocities from the base's and those of `joints`."""
        size = BASES[self.base][1]
        expansion = np.zeros((self.model.nv, size + len(joints)))
        expansion[:size, :size] = np.eye(size)
        for name in self.joints + list(self.mimics):
            leader, ratio, _ = self.leader(name)
            expansion[self._joint(name).idx_v, size + joints.index(leader)] = ratio
        return expansion

    def _vector(self, state, of, joints):
        return np.array(state.get("base_" + of, []) + [state[of][name] for name in joints])

    def values(self, state, frames, joints):
        """Values of a state; joint-wise ones in the order of `joints`, behind the base's."""
        model, data = self.model, self.data
        q = self._configuration(state)
        # What takes whole-body's q̇ to Pinocchio's.
        turn = np.eye(model.nv)
        if self.base == "floating":
            rotation = pin.Quaternion(np.array(state["base_position"][3:])).matrix()
            turn[:3, :3] = turn[3:6, 3:6] = rotation.T
        to_own = turn @ self._expansion(joints)
        velocity = self._vector(state, "velocity", joints)
        acceleration = self._vector(state, "acceleration", joints)
        v = to_own @ velocity

        def own_acceleration(world):
            own = to_own @ world
            if self.base == "floating":
                own[:3] -= np.cross(v[3:6], v[:3])
            return own

        out = {}
        forces = pin.rnea(model, data, q, v, own_acceleration(acceleration))
        out["inverse_dynamics"] = to_own.T @ forces
        out["gravity"] = to_own.T @ pin.computeGeneralizedGravity(model, data, q)
        mass = pin.crba(model, data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        world_mass = to_own.T @ mass @ to_own
        out["mass_matrix"] = world_mass
        # The accelerations serve as torques too.
        out["torque"] = acceleration
        bias = to_own.T @ pin.rnea(model, data, q, v, own_acceleration(0.0 * velocity))
        out["bias"] = bias
        if self.mimics:
            out["forward_dynamics"] = inverse_of(world_mass) @ (acceleration - bias)
        else:
            solved = pin.aba(model, data, q, v, turn @ self._expansion(joints) @ acceleration)
            if self.base == "floating":
                solved[:3] += np.cross(v[3:6], v[:3])
            out["forward_dynamics"] = to_own.T @ solved

        pin.computeJointJacobians(model, data, q)
        pin.forwardKinematics(model, data, q, v, own_acceleration(0.0 * velocity))
        pin.updateFramePlacements(model, data)
        out["frames"] = []
        inverse = inverse_of(world_mass)
        for name in frames:
            frame = model.getFrameId(name, pin.FrameType.BODY)
            aligned, local = pin.LOCAL_WORLD_ALIGNED, pin.LOCAL
            jacobian = pin.getFrameJacobian(model, data, frame, aligned) @ to_own
            jacobian_local = pin.getFrameJacobian(model, data, frame, local) @ to_own
            rate = pin.getFrameClassicalAcceleration(model, data, frame, aligned)
            rate_local = pin.getFrameAcceleration(model, data, frame, local)
            row = DIRECTION @ jacobian[:3]
            out["frames"].append(
                {
                    "position": data.oMf[frame].translation.copy(),
                    "rotation": data.oMf[frame].rotation.copy(),
                    "jacobian": jacobian,
                    "jacobian_local": jacobian_local,
                    "rate": rate.vector.copy(),
                    "rate_local": rate_local.vector.copy(),
                    "effective_mobility": row @ inverse @ row,
                }
            )
        out["centre_of_mass"] = pin.centerOfMass(model, data, q).copy()
        centre = pin.jacobianCenterOfMass(model, data, q) @ to_own
        out["centre_of_mass_jacobian"] = centre
        out["kinetic_energy"] = pin.computeKineticEnergy(model, data, q, v)
        out["potential_energy"] = pin.computePotentialEnergy(model, data, q)
        out["momentum"] = pin.computeCentroidalMomentum(model, data, q, v).vector.copy()
        return out
