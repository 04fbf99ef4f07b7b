//! Groups of elements: element sets and blocks by name.

use std::collections::BTreeMap;

use super::{ElementMesh, MeshError};
use crate::error::GeometryError;

impl<const D: usize> ElementMesh<D> {
    /// Number of elements of every group by name. Groups are all element sets, and blocks whose name no element set has.
    #[must_use]
    pub fn groups(&self) -> BTreeMap<&str, usize> {
        let sets = self.element_sets.iter();
        let mut groups: BTreeMap<&str, usize> = sets.map(|(name, set)| (name.as_str(), set.len())).collect();
        for block in self.blocks.iter().filter(|b| !b.name.is_empty()) {
            if !self.element_sets.contains_key(&block.name) {
                *groups.entry(&block.name).or_default() += block.len();
            }
        }
        groups
    }

    /// Extract the elements of these [`groups`](Self::groups), each once, with their nodes: physical groups of a Gmsh file, element sets of
    /// an Abaqus file. An exact match of a name precedes a match without regard to case. Empty blocks and sets are dropped.
    ///
    /// ```
    /// use impactite_geometry::structured::box_mesh;
    /// use impactite_geometry::{Cuboid, Metric};
    /// // Three squares in a row; the one in the middle is in both groups.
    /// let row = box_mesh(&Cuboid::new([0.0; 2], [3.0, 1.0])?, [3, 1])?;
    /// let row = row.with_element_set("STEEL", vec![0, 1])?.with_element_set("HOT", vec![1, 2])?;
    /// let steel = row.only_groups(&["steel"])?;
    /// assert_eq!((steel.nodes.len(), steel.measure(Metric::Cartesian)?), (6, 2.0));
    /// assert_eq!(steel.element_sets["HOT"], [1]);
    /// assert_eq!(
    ///     row.only_groups(&["wood"]).unwrap_err().to_string(),
    ///     "mesh: no group of elements has the name `wood`; there are HOT, STEEL"
    /// );
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NoGroup`] with the available names; [`MeshError::Empty`] if no element is in these groups; [`MeshError`] for indices of
    /// nodes or elements that do not exist.
    pub fn only_groups(&self, names: &[impl AsRef<str>]) -> Result<Self, GeometryError> {
        self.check_numbers()?;
        let groups = self.groups();
        let mut kept = vec![false; self.elements()];
        let first: Vec<usize> = self
            .blocks
            .iter()
            .scan(0, |next, block| {
                *next += block.len();
                Some(*next - block.len())
            })
            .collect();
        for name in names.iter().map(AsRef::as_ref) {
            let alike = || groups.keys().copied().find(|group| group.eq_ignore_ascii_case(name));
            let group = groups.get_key_value(name).map(|(group, _)| *group).or_else(alike);
            let Some(group) = group else {
                let groups = groups.keys().map(ToString::to_string).collect();
                return Err(MeshError::NoGroup { name: name.into(), groups }.into());
            };
            match self.element_sets.get(group) {
                Some(set) => set.iter().for_each(|&element| kept[element as usize] = true),
                None => {
                    let named = self.blocks.iter().zip(&first).filter(|(block, _)| block.name == group);
                    named.for_each(|(block, &first)| kept[first..first + block.len()].fill(true));
                }
            }
        }
        let mut part = self.part(&|block, element| kept[first[block] + element])?;
        if part.elements() == 0 {
            return Err(MeshError::Empty { what: "a choice of groups" }.into());
        }
        part.blocks.retain(|block| !block.is_empty());
        part.node_sets.retain(|_, nodes| !nodes.is_empty());
        part.element_sets.retain(|_, elements| !elements.is_empty());
        Ok(part)
    }

    /// Add an element set, or replace the one of this name. Elements are numbered through all blocks.
    ///
    /// # Errors
    /// [`MeshError`] unless the elements exist and ascend.
    pub fn with_element_set(mut self, name: &str, elements: Vec<u32>) -> Result<Self, GeometryError> {
        self.element_sets.insert(name.into(), elements);
        self.check_numbers()?;
        Ok(self)
    }
}
