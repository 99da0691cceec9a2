//! Bounds of M̃⁻¹ K̃ and M̃⁻¹ D̃ over all contact states, for models whose states are too many or too large to examine
//! one by one.

use super::alike_states::{self, AlikeStates};
use super::complex::{from_polar, modulus};
use super::oblique_projection::{ContactGroup, groups};
use crate::model::{LinearModel, LumpedModel, SparseMatrix};
use crate::numerics::range;
use nalgebra::Complex;

/// Bounds of the modes of all contact states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sizes {
    /// Bound of the stiffness, 1/s²: of |s| for the eigenvalues s of M̃⁻¹ K̃ or, with discrete dampers, of |uᴴ K u| for
    /// the shapes u of the modes, masses scaled to one.
    pub(super) square: f64,
    /// Bound of the discrete dampers, 1/s: of |uᴴ D u|.
    pub(super) dampers: f64,
    /// The ellipse that contains the eigenvalues s, without discrete dampers.
    pub(super) ellipse: Option<Ellipse>,
}

/// An ellipse of the complex plane about two foci on the real axis, 1/s², with all that it encloses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ellipse {
    foci: [f64; 2],
    /// Ratio of the longer axis to the distance of the foci.
    stretch: f64,
}

impl Ellipse {
    /// The largest |s| of the ellipse.
    fn reach(self) -> f64 {
        let [from, to] = self.foci;
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        middle.abs() + self.stretch * half
    }

    /// The narrowest ellipse about the real parts of these numbers that encloses all of them; `None` where they have one real part.
    pub(super) fn around(numbers: &[Complex<f64>]) -> Option<Self> {
        let foci = range(numbers.iter().map(|s| s.re));
        let apart = foci[1] - foci[0];
        let sum = |s: &Complex<f64>| modulus(s - foci[0]) + modulus(s - foci[1]);
        let longest = numbers.iter().map(sum).fold(apart, f64::max);
        (apart > 0.0).then_some(Self { foci, stretch: longest / apart })
    }

    /// `true` if the ellipse encloses this number, but for rounding.
    #[cfg(test)]
    pub(super) fn encloses(self, s: Complex<f64>) -> bool {
        let [from, to] = self.foci;
        let sum = modulus(s - from) + modulus(s - to);
        sum <= self.stretch * (to - from) + 1e-6 * to
    }

    /// A point of the concentric ellipse scaled by `part`, at this angle of its parameter, rad.
    pub(super) fn point(self, part: f64, angle: f64) -> Complex<f64> {
        let [from, to] = self.foci;
        let half = 0.5 * (to - from) * part;
        let unit = from_polar(half, angle);
        let lean = (self.stretch * self.stretch - 1.0).max(0.0).sqrt();
        Complex::new(0.5 * (from + to) + self.stretch * unit.re, lean * unit.im)
    }
}

/// Bounds over all contact states, cheap to evaluate again as µ changes.
///
/// *Contacts that share no mass, along degrees of freedom, and no discrete dampers*: in every contact
/// state the entries of M̃⁻¹ K̃ are in size at most those of the non-negative matrix B: the rows of
/// M⁻¹ |K|, the tangential rows with µ times the normal row added. Its spectral radius is at most
/// maxᵢ (B d)ᵢ / dᵢ for any positive d (Collatz and Wielandt); a few powers of B make a good d.
///
/// *Always*: with masses scaled to one, K̃ acts as P K, where P projects obliquely, along the
/// contact forces, onto the motions that a state allows; so |s| ≤ ‖P‖ ‖K‖, and likewise for D.
/// ‖K‖ ≤ maxᵢ (B d)ᵢ / dᵢ for B = M⁻¹ |K|.
///
/// *Without discrete dampers* s lies in an ellipse. Let κ₀ and κ₁ be bounds of the eigenvalues of K. On the motions that
/// P allows P K = κ₀ + P (K − κ₀), and P (K − κ₀) has the eigenvalues of R P R, R = (K − κ₀)^½, beside zero. These are
/// values of (R v)ᴴ P (R v) with |v| = 1, |R v|² ≤ κ₁ − κ₀. The values of wᴴ P w, |w| = 1, fill the ellipse with the
/// foci 0 and 1 and the longer axis ‖P‖ (P is a projection). So s lies in the ellipse with the foci κ₀ and κ₁
/// and the longer axis ‖P‖ (κ₁ − κ₀), and friction alone takes it off the real axis.
#[derive(Clone, Debug)]
pub(super) struct FrequencyBound {
    /// Terms of (B d)ᵢ / dᵢ: the part without µ, the factor of µ, and the contact whose µ applies.
    rows: Vec<(f64, f64, usize)>,
    /// Bound of ‖D‖, 1/s.
    dampers: f64,
    /// κ₀ and κ₁, 1/s²; `None` with discrete dampers.
    foci: Option<[f64; 2]>,
    /// `true` if `rows` include µ. Otherwise ‖P‖ scales them.
    has_friction: bool,
    /// The groups of contacts that share masses.
    groups: Vec<ContactGroup>,
    /// What takes the place of all this where the mass matrix is full.
    alike: Option<AlikeStates>,
}

impl FrequencyBound {
    /// The bounds for a model, sharpest near its present µ; for a full mass matrix the sizes in [`AlikeStates`], and `None` where
    /// these are not found.
    pub(super) fn new(linear: LinearModel<'_>) -> Option<Self> {
        let model = linear.model();
        let Some(mass) = model.mass.as_diagonal() else {
            return AlikeStates::of(linear).map(Self::of_alike);
        };
        let alike = None;
        let alone = vec![None; mass.len()];
        let groups = groups(&model.contacts, &mass);
        let rows = collatz_wielandt(&model.stiffness, &mass, &alone, &[]);
        if !model.dampers.is_empty() {
            let dampers = largest(&collatz_wielandt(&model.dampers, &mass, &alone, &[]));
            return Some(Self { rows, dampers, foci: None, has_friction: false, groups, alike });
        }
        let most = largest(&rows);
        let is_symmetric = model.stiffness.is_symmetric();
        let foci = is_symmetric.then(|| [least(&model.stiffness, &mass, most), most]);
        if let Some(dragged_by) = uncoupled(model) {
            let friction: Vec<f64> =
                linear.friction().map(|friction| friction.coefficient).collect();
            let rows = collatz_wielandt(&model.stiffness, &mass, &dragged_by, &friction);
            return Some(Self { rows, dampers: 0.0, foci, has_friction: true, groups, alike });
        }
        Some(Self { rows, dampers: 0.0, foci, has_friction: false, groups, alike })
    }

    /// The bounds for a model whose µ changes during a run. Those of a full mass matrix hold for somewhat more friction too, since
    /// they are found anew beyond it, by the eigenvalues of the whole model.
    pub(super) fn for_changes(model: &LumpedModel) -> Option<Self> {
        if model.mass.as_diagonal().is_some() {
            return Self::new(model.with_greatest_friction());
        }
        AlikeStates::with_room(model).map(Self::of_alike)
    }

    fn of_alike(alike: AlikeStates) -> Self {
        let (rows, groups) = (Vec::new(), Vec::new());
        let alike = Some(alike);
        Self { rows, dampers: 0.0, foci: None, has_friction: false, groups, alike }
    }

    /// `true` if the bounds with the friction of this model are known without eigenvalues.
    pub(super) fn covers(&self, linear: LinearModel<'_>) -> bool {
        self.alike.as_ref().is_none_or(|alike| alike.cover(linear))
    }

    /// Ratio of the bound of the discrete dampers to that of the stiffness, s: the same at every µ.
    pub(super) fn dampers_against_stiffness(&self) -> f64 {
        if let Some(alike) = &self.alike {
            return alike.dampers_against_stiffness();
        }
        if self.dampers == 0.0 {
            return 0.0;
        }
        // With discrete dampers µ is in the groups alone, which scale both.
        self.dampers / largest(&self.rows)
    }

    /// The bounds with the model's present µ; `model` is the one they were made for, but for its friction. Infinite
    /// where no bound is known.
    pub(super) fn at(&self, model: LinearModel<'_>) -> Sizes {
        if let Some(alike) = &self.alike {
            return alike.at(model);
        }
        let mu = |contact: usize| model.friction_of(contact).coefficient;
        let square = self.rows.iter().fold(0.0, |largest, &(own, drag, contact)| {
            f64::max(largest, if drag == 0.0 { own } else { own + mu(contact) * drag })
        });
        let groups = self.groups.iter();
        let stretch = groups.fold(1.0, |stretch, group| f64::max(stretch, group.stretch(&mu)));
        let ellipse = self.foci.filter(|_| stretch.is_finite());
        let ellipse = ellipse.map(|foci| Ellipse { foci, stretch });
        Sizes {
            square: if self.has_friction { square } else { stretch * square },
            dampers: stretch * self.dampers,
            ellipse,
        }
    }
}

impl Sizes {
    /// The largest |s| of any mode, 1/s².
    pub(super) fn largest_square(self) -> f64 {
        self.ellipse.map_or(self.square, |ellipse| self.square.min(ellipse.reach()))
    }
}

/// The largest (B d)ᵢ / dᵢ, without the terms of µ.
fn largest(rows: &[(f64, f64, usize)]) -> f64 {
    rows.iter().fold(0.0, |largest, row| f64::max(largest, row.0))
}

/// A lower bound of the eigenvalues of M⁻¹ K, of which none is above `most`, 1/s²: the eigenvalues of `most` − M⁻¹ K,
/// none of which is negative, are bounded as above.
fn least(stiffness: &SparseMatrix, mass: &[f64], most: f64) -> f64 {
    let entries = stiffness.entries().map(|(i, j, k)| (i, j, -k));
    let diagonal = mass.iter().enumerate().map(|(i, m)| (i, i, most * m));
    let below = SparseMatrix::from_entries(mass.len(), entries.chain(diagonal).collect());
    most - largest(&collatz_wielandt(&below, mass, &vec![None; mass.len()], &[]))
}

/// An upper bound of the frequencies of modes without friction, rad/s, in any contact state: constraints of contacts
/// only lower them. `None` where none is found. The operations are plain and in a fixed order, so the result is the
/// same double on each machine.
pub(super) fn frictionless(model: &LumpedModel) -> Option<f64> {
    let Some(mass) = model.mass.as_diagonal() else { return alike_states::frictionless(model) };
    let rows = collatz_wielandt(&model.stiffness, &mass, &vec![None; mass.len()], &[]);
    Some(largest(&rows).sqrt())
}

/// The normal degree of freedom and the contact of each degree of freedom that is a tangent; `None` unless all contacts
/// lie along degrees of freedom of their own.
fn uncoupled(model: &LumpedModel) -> Option<Vec<Option<(usize, usize)>>> {
    let mut dragged_by = vec![None; model.dofs()];
    let mut used = vec![false; model.dofs()];
    for (i, contact) in model.contacts.iter().enumerate() {
        let (tangent, normal) = (contact.tangent.as_unit()?, contact.normal.as_unit()?);
        for dof in [tangent, normal] {
            if std::mem::replace(&mut used[dof], true) {
                return None;
            }
        }
        dragged_by[tangent] = Some((normal, i));
    }
    Some(dragged_by)
}

/// (B d)ᵢ / dᵢ of B = M⁻¹ |matrix| with the dragged rows added; see [`FrequencyBound`].
fn collatz_wielandt(
    matrix: &SparseMatrix,
    mass: &[f64],
    dragged_by: &[Option<(usize, usize)>],
    friction: &[f64],
) -> Vec<(f64, f64, usize)> {
    // Of an unsymmetric matrix the larger one of two entries bounds both.
    let larger = (!matrix.is_symmetric()).then(|| matrix.symmetric(f64::max));
    let matrix = larger.as_ref().unwrap_or(matrix);
    let row = |dof: usize, d: &[f64]| {
        matrix.row(dof).fold(0.0, |sum, (column, value)| sum + value.abs() * d[column])
    };
    let apply = |d: &[f64]| -> Vec<(f64, f64, usize)> {
        let parts = (0..mass.len()).zip(mass).zip(dragged_by);
        let parts = parts.map(|((dof, mass), dragged)| {
            let (drag, contact) = dragged.map_or((0.0, 0), |(normal, i)| (row(normal, d), i));
            (row(dof, d) / mass, drag / mass, contact)
        });
        parts.collect()
    };
    let mut d = vec![1.0; mass.len()];
    for _ in 0..30 {
        let total = |&(own, drag, i): &(f64, f64, usize)| {
            if drag == 0.0 { own } else { own + friction[i] * drag }
        };
        let next: Vec<f64> = apply(&d).iter().map(total).collect();
        let largest = next.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        // The floor keeps d positive, as the theorem wants it, where a row is zero.
        d = next.into_iter().map(|value| (value / largest).max(1e-6)).collect();
    }
    let rows = apply(&d).into_iter().zip(&d);
    rows.map(|((own, drag, contact), d)| (own / d, drag / d, contact)).collect()
}
