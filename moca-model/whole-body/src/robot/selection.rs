//! Selection of the joints of a URDF that move, follow another one, or stay.

use super::description::Description;
use crate::error::{Error, urdf::UrdfError};
use crate::urdf::document::{Joint, Kind};
use crate::urdf::names::list;
use crate::urdf::tree::Tree;

/// The joints below the root and the role of each.
pub(super) struct Selection {
    /// The link to start from.
    pub(super) root: usize,
    /// Joints below the root, parents first, depth first.
    pub(super) order: Vec<usize>,
    /// Role of each joint.
    pub(super) roles: Vec<Role>,
    /// The joints that move by themselves, in the order of q.
    pub(super) free: Vec<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// Stays at a position \[rad or m\].
    Locked(f64),
    /// Moves as the free joint of this number.
    Free(usize),
    /// Follows the free joint of this number.
    Follows { free: usize, multiplier: f64, offset: f64 },
}

pub(super) fn select(tree: &Tree, description: &Description) -> Result<Selection, Error> {
    let root = tree.root(description.root.as_deref())?;
    let order = below(tree, root);
    let joints = &tree.document.joints;
    let mut moves = vec![description.tips.is_empty(); joints.len()];
    for tip in &description.tips {
        for joint in tree.path(root, tree.link(tip, "the tip")?)? {
            moves[joint] = true;
        }
    }
    let locked = locked(tree, description)?;
    let mut roles = vec![None; joints.len()];
    let mut free = Vec::new();
    for &index in &order {
        let joint = &joints[index];
        roles[index] = match (locked[index], &joint.kind) {
            (Some(position), _) => Some(Role::Locked(position)),
            (None, Kind::Fixed) => Some(Role::Locked(0.0)),
            (None, Kind::Other(kind)) => {
                return Err(Error::from(UrdfError::UnsupportedJoint {
                    line: joint.line,
                    joint: joint.name.clone(),
                    kind: kind.clone(),
                }));
            }
            _ if joint.mimic.is_some() => None,
            _ if moves[index] => {
                free.push(index);
                Some(Role::Free(free.len() - 1))
            }
            _ => Some(Role::Locked(0.0)),
        };
    }
    let roles = Followers { tree, roles }.resolve(&order)?;
    check_order(tree, description, &free)?;
    Ok(Selection { root, order, roles, free })
}

/// The joints below a link, parents first, depth first, in the document's order.
fn below(tree: &Tree, root: usize) -> Vec<usize> {
    let mut order = Vec::new();
    let mut to_visit: Vec<usize> = tree.joints_on(root).iter().rev().copied().collect();
    while let Some(joint) = to_visit.pop() {
        order.push(joint);
        to_visit.extend(tree.joints_on(tree.child(joint)).iter().rev());
    }
    order
}

/// The position at which the description holds each joint.
fn locked(tree: &Tree, description: &Description) -> Result<Vec<Option<f64>>, Error> {
    let mut locked = vec![None; tree.document.joints.len()];
    for (name, position) in &description.locked {
        locked[tree.joint(None, name, "the locked joint")?] = Some(*position);
    }
    for name in &description.joints {
        if locked[tree.joint(None, name, "the moving joint")?].is_some() {
            return Err(Error::LockedAndMoving { joint: name.clone() });
        }
    }
    Ok(locked)
}

/// Finds for each mimic joint the independent joint that it follows.
struct Followers<'a, 'b> {
    tree: &'a Tree<'b>,
    /// `None` for joints that are not resolved yet or not below the root.
    roles: Vec<Option<Role>>,
}

impl Followers<'_, '_> {
    fn resolve(mut self, order: &[usize]) -> Result<Vec<Role>, Error> {
        for &joint in order {
            self.resolve_one(joint)?;
        }
        Ok(self.roles.into_iter().map(|role| role.unwrap_or(Role::Locked(0.0))).collect())
    }

    /// Goes from follower to followed joint until a role is known, then back.
    fn resolve_one(&mut self, joint: usize) -> Result<(), Error> {
        let mut followers = Vec::new();
        let mut reached = joint;
        let mut role = loop {
            if let Some(role) = self.roles[reached] {
                break role;
            }
            let Joint { name, line, mimic, .. } = &self.tree.document.joints[reached];
            let Some(mimic) = mimic else {
                break Role::Locked(0.0);
            };
            if followers.len() > self.roles.len() {
                return Err(Error::from(UrdfError::MimicLoop { line: *line, joint: name.clone() }));
            }
            followers.push((reached, mimic));
            reached =
                self.tree.joint(Some(*line), &mimic.joint, "the joint that a joint mimics,")?;
        };
        for (joint, mimic) in followers.into_iter().rev() {
            role = match role {
                Role::Locked(position) => Role::Locked(mimic.multiplier * position + mimic.offset),
                Role::Free(free) => {
                    Role::Follows { free, multiplier: mimic.multiplier, offset: mimic.offset }
                }
                Role::Follows { free, multiplier, offset } => Role::Follows {
                    free,
                    multiplier: mimic.multiplier * multiplier,
                    offset: mimic.multiplier * offset + mimic.offset,
                },
            };
            self.roles[joint] = Some(role);
        }
        Ok(())
    }
}

fn check_order(tree: &Tree, description: &Description, free: &[usize]) -> Result<(), Error> {
    let wanted = free.iter().map(|&joint| tree.document.joints[joint].name.as_str());
    if description.joints.is_empty() || wanted.clone().eq(&description.joints) {
        return Ok(());
    }
    Err(Error::JointOrder {
        got: list(description.joints.iter().map(String::as_str)),
        wanted: list(wanted),
    })
}
