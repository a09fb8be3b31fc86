//! A URDF with unique names whose joints form a tree.

use std::collections::HashMap;

use super::document::{Document, Joint};
use super::names::nearest;
use crate::error::{Error, urdf::UrdfError};

/// Links and joints by their indices in the document.
pub(crate) struct Tree<'a> {
    pub(crate) document: &'a Document,
    links: HashMap<&'a str, usize>,
    joints: HashMap<&'a str, usize>,
    /// Joint that carries each link.
    carrier: Vec<Option<usize>>,
    /// Joints on each link, in the document's order.
    hanging: Vec<Vec<usize>>,
    /// Parent and child link of each joint.
    ends: Vec<(usize, usize)>,
}

impl<'a> Tree<'a> {
    pub(crate) fn new(document: &'a Document) -> Result<Self, Error> {
        let named = document.links.iter().map(|link| (link.name.as_str(), link.line));
        let links = unique("link", named)?;
        let named = document.joints.iter().map(|joint| (joint.name.as_str(), joint.line));
        let joints = unique("joint", named)?;
        let mut tree = Self {
            document,
            links,
            joints,
            carrier: vec![None; document.links.len()],
            hanging: vec![Vec::new(); document.links.len()],
            ends: Vec::with_capacity(document.joints.len()),
        };
        for (index, joint) in document.joints.iter().enumerate() {
            tree.hang(index, joint)?;
        }
        tree.check_loops()?;
        Ok(tree)
    }

    fn hang(&mut self, index: usize, joint: &Joint) -> Result<(), Error> {
        let parent = self.link_of(joint, &joint.parent, "the parent that a joint names,")?;
        let child = self.link_of(joint, &joint.child, "the child that a joint names,")?;
        if let Some(other) = self.carrier[child].replace(index) {
            return Err(Error::from(UrdfError::TwoParents {
                line: joint.line,
                link: joint.child.clone(),
                first: self.document.joints[other].name.clone(),
                second: joint.name.clone(),
            }));
        }
        self.hanging[parent].push(index);
        self.ends.push((parent, child));
        Ok(())
    }

    /// Returns an error unless every link is reached from the links without a parent.
    fn check_loops(&self) -> Result<(), Error> {
        let mut reached = vec![false; self.carrier.len()];
        let mut to_visit: Vec<usize> = self.tops().collect();
        while let Some(link) = to_visit.pop() {
            reached[link] = true;
            to_visit.extend(self.hanging[link].iter().map(|&joint| self.ends[joint].1));
        }
        let Some(link) = reached.iter().position(|reached| !reached) else {
            return Ok(());
        };
        // As many steps upwards as there are links end in the loop itself.
        let up = |link: usize| self.carrier[link].map_or(link, |joint| self.ends[joint].0);
        let link = (0..self.carrier.len()).fold(link, |link, _| up(link));
        let joint = self.carrier[link].map(|joint| &self.document.joints[joint]);
        Err(Error::from(UrdfError::Loop {
            line: joint.map_or(0, |joint| joint.line),
            link: self.document.links[link].name.clone(),
            joint: joint.map_or_else(String::new, |joint| joint.name.clone()),
        }))
    }

    /// Links without a parent joint.
    fn tops(&self) -> impl Iterator<Item = usize> {
        (0..self.carrier.len()).filter(|&link| self.carrier[link].is_none())
    }

    /// The link named `root`, or the only one without a parent joint.
    pub(crate) fn root(&self, root: Option<&str>) -> Result<usize, Error> {
        if let Some(name) = root {
            return self.link(name, "the root");
        }
        let mut tops = self.tops();
        let first = tops
            .next()
            .ok_or_else(|| Error::from(UrdfError::NoLinks { robot: self.document.name.clone() }))?;
        if let Some(second) = tops.next() {
            let [one, other] = [first, second].map(|link| &self.document.links[link]);
            return Err(Error::from(UrdfError::TwoRoots {
                first: one.name.clone(),
                first_line: one.line,
                second: other.name.clone(),
                second_line: other.line,
            }));
        }
        Ok(first)
    }

    pub(crate) fn link(&self, name: &str, role: &'static str) -> Result<usize, Error> {
        self.link_at(None, name, role)
    }

    fn link_of(&self, joint: &Joint, name: &str, role: &'static str) -> Result<usize, Error> {
        self.link_at(Some(joint.line), name, role)
    }

    fn link_at(&self, line: Option<usize>, name: &str, role: &'static str) -> Result<usize, Error> {
        let known = self.document.links.iter().map(|link| link.name.as_str());
        self.links.get(name).copied().ok_or_else(|| Error::UnknownName {
            line,
            element: "link",
            name: name.to_owned(),
            role,
            robot: self.document.name.clone(),
            known: nearest(name, known),
        })
    }

    /// The joint `name`, which a joint of the URDF on `line` or the description names.
    pub(crate) fn joint(
        &self,
        line: Option<usize>,
        name: &str,
        role: &'static str,
    ) -> Result<usize, Error> {
        let known = self.document.joints.iter().map(|joint| joint.name.as_str());
        self.joints.get(name).copied().ok_or_else(|| Error::UnknownName {
            line,
            element: "joint",
            name: name.to_owned(),
            role,
            robot: self.document.name.clone(),
            known: nearest(name, known),
        })
    }

    /// The joints on a link, in the document's order.
    pub(crate) fn joints_on(&self, link: usize) -> &[usize] {
        &self.hanging[link]
    }

    /// The parent link of a joint.
    pub(crate) fn parent(&self, joint: usize) -> usize {
        self.ends[joint].0
    }

    /// The link that a joint carries.
    pub(crate) fn child(&self, joint: usize) -> usize {
        self.ends[joint].1
    }

    /// The joints from `root` down to `tip`.
    pub(crate) fn path(&self, root: usize, tip: usize) -> Result<Vec<usize>, Error> {
        let mut joints = Vec::new();
        let mut reached = tip;
        while reached != root {
            let Some(joint) = self.carrier[reached] else {
                let name = |link: usize| self.document.links[link].name.clone();
                let (root, tip, reached) = (name(root), name(tip), name(reached));
                return Err(Error::NoPath { root, tip, reached });
            };
            joints.push(joint);
            reached = self.ends[joint].0;
        }
        joints.reverse();
        Ok(joints)
    }
}

fn unique<'a>(
    element: &'static str,
    named: impl Iterator<Item = (&'a str, usize)>,
) -> Result<HashMap<&'a str, usize>, Error> {
    let mut places = HashMap::new();
    for (place, (name, line)) in named.enumerate() {
        if places.insert(name, place).is_some() {
            return Err(Error::DuplicateName { line: Some(line), element, name: name.to_owned() });
        }
    }
    Ok(places)
}
