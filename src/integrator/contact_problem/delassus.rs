//! The Delassus matrix W = G M⁻¹ Gᵀ, 1/kg, as the blocks of the contacts that share masses.

use super::factors::root_scale;
use crate::contact::LocalProblem;
use crate::model::{Contact, Direction};

/// The 2 × 2 block of W between two contacts, by rows, normal before tangent.
type ContactBlock = [f64; 4];

/// W by rows of contacts.
pub(in crate::integrator) struct Delassus {
    /// Each contact's own block.
    own: Vec<ContactBlock>,
    /// Start of the blocks of each contact with others in `others`.
    offsets: Vec<usize>,
    /// The other contacts, ascending, with their blocks.
    others: Vec<(usize, ContactBlock)>,
    /// The contacts that are coupled, directly or through others: each contact is in one group.
    groups: Vec<Vec<usize>>,
}

impl Delassus {
    /// W of contacts whose `responses` are M⁻¹ Gᵀ, one pair (normal, tangent) for each contact.
    pub(in crate::integrator) fn new(
        contacts: &[Contact],
        responses: &[[Direction; 2]],
        dofs: usize,
    ) -> Self {
        let mut moved_by = vec![Vec::new(); dofs];
        for (contact, pair) in responses.iter().enumerate() {
            for &(dof, _) in pair.iter().flat_map(|response| &response.0) {
                moved_by[dof].push(contact);
            }
        }
        let mut delassus =
            Self { own: Vec::new(), offsets: vec![0], others: Vec::new(), groups: Vec::new() };
        for (i, contact) in contacts.iter().enumerate() {
            let rows = [&contact.normal, &contact.tangent];
            let block = |j: usize| -> ContactBlock {
                let [[nn, nt], [tn, tt]] =
                    rows.map(|row| [0, 1].map(|k| dot(row, &responses[j][k])));
                [nn, nt, tn, tt]
            };
            let touched = rows.iter().flat_map(|row| &row.0).flat_map(|&(dof, _)| &moved_by[dof]);
            let mut others: Vec<usize> = touched.copied().filter(|&j| j != i).collect();
            others.sort_unstable();
            others.dedup();
            delassus.own.push(block(i));
            delassus.others.extend(others.into_iter().map(|j| (j, block(j))));
            delassus.offsets.push(delassus.others.len());
        }
        delassus.groups = delassus.coupled();
        delassus
    }

    /// The groups of contacts that are coupled, directly or through others; contacts ascending in each.
    fn coupled(&self) -> Vec<Vec<usize>> {
        let mut is_known = vec![false; self.contacts()];
        let mut groups = Vec::new();
        for start in 0..self.contacts() {
            if std::mem::replace(&mut is_known[start], true) {
                continue;
            }
            let (mut group, mut next) = (vec![start], 0);
            while let Some(&contact) = group.get(next) {
                for &(other, _) in self.others(contact) {
                    if !std::mem::replace(&mut is_known[other], true) {
                        group.push(other);
                    }
                }
                next += 1;
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }

    /// The contacts that share masses, directly or through others, group by group; a contact that shares none is
    /// a group of its own.
    pub(in crate::integrator) fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// The group of a contact.
    pub(in crate::integrator) fn group_of(&self, contact: usize) -> &[usize] {
        self.groups.iter().find(|group| group.contains(&contact)).map_or(&[], Vec::as_slice)
    }

    /// The number of contacts in the largest group.
    pub(in crate::integrator) fn largest_group(&self) -> usize {
        self.groups.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Number of contacts.
    pub(super) fn contacts(&self) -> usize {
        self.own.len()
    }

    /// A contact's own block.
    pub(in crate::integrator) fn own(&self, contact: usize) -> ContactBlock {
        self.own[contact]
    }

    /// A contact's own block, as the problem of a single contact.
    pub(in crate::integrator) fn local(&self, contact: usize) -> LocalProblem {
        let [nn, nt, _, tt] = self.own(contact);
        LocalProblem { nn, nt, tt }
    }

    /// The acceleration that these forces (N) of all contacts add along the normal (0) or the tangent (1) of one, m/s²,
    /// and the sum of the magnitudes of the terms.
    pub(in crate::integrator) fn along(
        &self,
        contact: usize,
        row: usize,
        forces: impl Fn(usize) -> [f64; 2],
    ) -> [f64; 2] {
        let own = (contact, self.own(contact));
        let all = self.others(contact).iter().copied().chain([own]);
        all.fold([0.0; 2], |[sum, size], (other, w)| {
            let [normal, tangential] = forces(other);
            let terms = [w[2 * row] * normal, w[2 * row + 1] * tangential];
            [sum + terms[0] + terms[1], size + terms[0].abs() + terms[1].abs()]
        })
    }

    /// Powers of two, √kg, for a contact's normal and tangent: forces in these units cause accelerations of order one.
    pub(super) fn scales(&self, contact: usize) -> [f64; 2] {
        let own = self.own(contact);
        [own[0], own[3]].map(root_scale)
    }

    /// The block between two contacts; zero where they share no mass.
    pub(super) fn block(&self, contact: usize, other: usize) -> ContactBlock {
        if contact == other {
            return self.own(contact);
        }
        let others = self.others(contact);
        // Where all contacts share masses, the place is known.
        match others.get(other - usize::from(other > contact)) {
            Some(&(known, block)) if known == other => block,
            _ => others
                .binary_search_by_key(&other, |&(known, _)| known)
                .map_or([0.0; 4], |place| others[place].1),
        }
    }

    /// The contacts that share masses with one, ascending, with their blocks.
    pub(super) fn others(&self, contact: usize) -> &[(usize, ContactBlock)] {
        &self.others[self.offsets[contact]..self.offsets[contact + 1]]
    }

    /// W from the full matrix, by rows.
    #[cfg(test)]
    pub(super) fn from_rows(contacts: usize, rows: &[f64]) -> Self {
        let at = |row: usize, column: usize| rows[row * 2 * contacts + column];
        let block = |i: usize, j: usize| {
            let (i, j) = (2 * i, 2 * j);
            [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]
        };
        let others =
            |i: usize| (0..contacts).filter(move |&j| j != i).map(move |j| (j, block(i, j)));
        let mut delassus = Self {
            own: (0..contacts).map(|i| block(i, i)).collect(),
            offsets: (0..=contacts).map(|i| i * (contacts - 1)).collect(),
            others: (0..contacts).flat_map(others).collect(),
            groups: Vec::new(),
        };
        delassus.groups = delassus.coupled();
        delassus
    }
}

/// The product of two sparse vectors.
fn dot(a: &Direction, b: &Direction) -> f64 {
    let part = |&(dof, value): &(usize, f64)| {
        let matching = b.0.iter().filter(move |other| other.0 == dof);
        matching.fold(0.0, |sum, other| sum + value * other.1)
    };
    a.0.iter().map(part).fold(0.0, |sum, part| sum + part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_are_coupled_through_the_masses_that_they_share_alone() {
        // Contact 1 rubs on the mass of contact 0; contact 2 is elsewhere. All masses are 2 kg.
        let difference = |a, b| Direction(vec![(a, 1.0), (b, -1.0)]);
        let contacts = [
            Contact::new(Direction::unit(0), Direction::unit(1)),
            Contact::new(difference(2, 0), difference(3, 1)),
            Contact::new(Direction::unit(4), Direction::unit(5)),
        ];
        let half = |d: &Direction| Direction(d.0.iter().map(|&(i, v)| (i, 0.5 * v)).collect());
        let responses = contacts.each_ref().map(|c| [half(&c.normal), half(&c.tangent)]);
        let delassus = Delassus::new(&contacts, &responses, 6);
        assert_eq!(delassus.own(0), [0.5, 0.0, 0.0, 0.5]);
        assert_eq!(delassus.own(1), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(delassus.others(0), [(1, [-0.5, 0.0, 0.0, -0.5])]);
        assert_eq!(delassus.others(1), [(0, [-0.5, 0.0, 0.0, -0.5])]);
        assert!(delassus.others(2).is_empty());
        assert_eq!(delassus.groups(), [vec![0, 1], vec![2]]);
    }
}
