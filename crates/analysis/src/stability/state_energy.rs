//! Size of the motion at which contacts are in another state than that of uniform sliding.
//!
//! The measure is the energy ½ q̇ᵀ M q̇ + ½ qᵀ K q of the deviation q from the equilibrium. A contact that sticks, or slides
//! the other way, has its surface's velocity at that instant; one that opens has a normal force that falls to zero, and
//! one that is open at rest and closes has a gap that does. The
//! normal force is linear in q and q̇ while the other contacts slide, so that its least energy has a closed form. This ranks
//! states: a blow that lifts a mass off opens a contact with less.

use super::candidates::closed_at_rest;
use super::linearised::Linearised;
use amontons::Error;
use amontons::contact::ContactState;
use amontons::model::{Equilibrium, LinearModel, LumpedModel, SparseMatrix};
use nalgebra::{DMatrix, DVector};

/// Size of the motion whose contacts are in a state. It ranks states and is no threshold: friction may feed a smaller
/// motion until it is as large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateEnergy {
    /// The energy of the deviation from uniform sliding, J.
    pub energy: f64,
    /// The velocity, m/s, with which the heaviest degree of freedom has this energy.
    pub push: f64,
}

/// The greatest of three energies: the least kinetic one with which the contacts that stick or slide the other way have the
/// velocities of their surfaces and closed ones stay closed, the least one at which the normal force of each contact
/// that opens is zero while the others slide, and the least elastic one at which the gap of each open contact that closes
/// is zero. `None` for states that no motion can reach: contacts that would stick on
/// surfaces of velocities that their masses cannot have together, or that would slide the other way under a law that gives
/// friction the direction of the surface.
///
/// # Errors
/// Returns an error if there is no equilibrium in uniform sliding.
pub fn state_energy(
    here: &Linearised,
    states: &[ContactState],
) -> Result<Option<StateEnergy>, Error> {
    here.uniform_sliding()?;
    let model = here.model();
    // A contact that lands slides as the others do.
    let sliding = closed_at_rest(model);
    let equilibrium = here.equilibrium()?;
    let turns = |(state, usual): (&ContactState, &ContactState)| {
        state.sliding_direction().is_some() && state != usual
    };
    if model.law.has_fixed_state() && states.iter().zip(&sliding).any(turns) {
        return Ok(None);
    }
    let mass = dense(&model.mass);
    let Some(inverse) = mass.clone().try_inverse() else { return Ok(None) };
    let problem = Problem { model, inverse, damping: damping(here.linear()?) };
    let Some(mut energy) = problem.kinetic(states, &sliding) else { return Ok(None) };
    for (i, state) in states.iter().enumerate() {
        let needs = match (*state == ContactState::Detached, equilibrium.is_closed(i)) {
            (true, true) => problem.opening(i, equilibrium),
            (false, false) => problem.closing(i, equilibrium),
            _ => None,
        };
        energy = energy.max(needs.unwrap_or(0.0));
    }
    let heaviest = mass.diagonal().max();
    Ok(Some(StateEnergy { energy, push: (2.0 * energy / heaviest).sqrt() }))
}

struct Problem<'a> {
    model: &'a LumpedModel,
    /// M⁻¹.
    inverse: DMatrix<f64>,
    /// C, with what falling friction adds.
    damping: DMatrix<f64>,
}

impl Problem<'_> {
    /// The least kinetic energy with which contacts that are not to slide as before have their surface's velocity, and
    /// closed ones stay closed. `None` where they cannot stick together.
    fn kinetic(&self, states: &[ContactState], sliding: &[ContactState]) -> Option<f64> {
        let (mut rows, mut speeds) = (Vec::new(), Vec::new());
        for ((contact, state), usual) in self.model.contacts.iter().zip(states).zip(sliding) {
            if *state != ContactState::Detached {
                rows.push(self.row(&contact.normal.0));
                speeds.push(0.0);
            }
            if *state == ContactState::Stick
                || *state != *usual && state.sliding_direction().is_some()
            {
                rows.push(self.row(&contact.tangent.0));
                speeds.push(contact.surface_velocity);
            }
        }
        if rows.is_empty() {
            return Some(0.0);
        }
        let rows = DMatrix::from_columns(&rows).transpose();
        let speeds = DVector::from_vec(speeds);
        let compliance = &rows * &self.inverse * rows.transpose();
        let eigen = compliance.clone().symmetric_eigen();
        let floor = 1e-12 * eigen.eigenvalues.amax();
        let mut impulse = DVector::zeros(speeds.len());
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > floor {
                impulse += vector * (vector.dot(&speeds) / value);
            }
        }
        let missed = (&compliance * &impulse - &speeds).amax();
        (missed <= 1e-9 * speeds.amax()).then(|| 0.5 * speeds.dot(&impulse))
    }

    /// The least elastic energy at which the gap of a contact is zero while those that are closed in the equilibrium stay
    /// closed. `None` where the deviation is not determined.
    fn closing(&self, contact: usize, equilibrium: &Equilibrium) -> Option<f64> {
        let n = self.model.dofs();
        let held: Vec<usize> = (0..equilibrium.gap.len())
            .filter(|other| equilibrium.is_closed(*other))
            .chain([contact])
            .collect();
        let mut system = DMatrix::zeros(n + held.len(), n + held.len());
        for (row, column, value) in self.model.stiffness.entries() {
            // The energy has the symmetric part alone.
            system[(row, column)] += 0.5 * value;
            system[(column, row)] += 0.5 * value;
        }
        for (place, other) in held.iter().enumerate() {
            for &(dof, part) in &self.model.contacts[*other].normal.0 {
                system[(n + place, dof)] += part;
                system[(dof, n + place)] += part;
            }
        }
        let mut wanted = DVector::zeros(n + held.len());
        wanted[n + held.len() - 1] = -equilibrium.gap[contact];
        let found = system.lu().solve(&wanted)?;
        // ½ q·K q = −½ (force along the gap) · (its change).
        let energy = 0.5 * found[n + held.len() - 1] * equilibrium.gap[contact];
        energy.is_finite().then_some(energy.max(0.0))
    }

    /// The least energy at which the normal force of a contact is zero while all contacts that are closed in the
    /// equilibrium slide. `None` where no deviation changes it, or contacts are redundant.
    fn opening(&self, contact: usize, equilibrium: &Equilibrium) -> Option<f64> {
        let usual = equilibrium.normal_force[contact];
        let ratios: Vec<f64> = self.model.sliding_ratios().collect();
        let contacts = &self.model.contacts;
        let closed: Vec<usize> =
            (0..contacts.len()).filter(|other| equilibrium.is_closed(*other)).collect();
        let rows: Vec<DVector<f64>> =
            closed.iter().map(|other| self.row(&contacts[*other].normal.0)).collect();
        let forces: Vec<DVector<f64>> = closed
            .iter()
            .zip(&rows)
            .map(|(other, normal)| normal + self.row(&contacts[*other].tangent.0) * ratios[*other])
            .collect();
        let mut wanted = DVector::zeros(closed.len());
        wanted[closed.iter().position(|other| *other == contact)?] = 1.0;
        let (rows, forces) =
            (DMatrix::from_columns(&rows).transpose(), DMatrix::from_columns(&forces));
        // (G M⁻¹ F) dN = G M⁻¹ (K q + C q̇), because closed contacts are not accelerated along G.
        let system = &rows * &self.inverse * forces;
        let shares = system.transpose().lu().solve(&wanted)?;
        let shape = &self.inverse * rows.transpose() * shares;
        let stiffness = dense(&self.model.stiffness);
        let damped = &self.damping * &shape;
        let answer = shape.dot(&(stiffness * &shape)) + damped.dot(&(&self.inverse * &damped));
        let energy = 0.5 * usual * usual / answer;
        (answer > 0.0 && energy.is_finite()).then_some(energy)
    }

    fn row(&self, direction: &[(usize, f64)]) -> DVector<f64> {
        let mut row = DVector::zeros(self.model.dofs());
        direction.iter().for_each(|&(dof, value)| row[dof] += value);
        row
    }
}

/// C = α M + β K + D, and what the friction of contacts that slide adds.
fn damping(linear: LinearModel<'_>) -> DMatrix<f64> {
    let model = linear.model();
    let mut found =
        dense(&model.mass) * model.damping.alpha + dense(&model.stiffness) * model.damping.beta;
    if !model.dampers.is_empty() {
        found += dense(&model.dampers);
    }
    for (_, direction, coefficient) in linear.friction_damping() {
        for &(i, a) in &direction.0 {
            for &(j, b) in &direction.0 {
                found[(i, j)] += coefficient * a * b;
            }
        }
    }
    found
}

fn dense(matrix: &SparseMatrix) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.rows(), matrix.rows());
    for (row, column, value) in matrix.entries() {
        dense[(row, column)] = value;
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;
    use amontons::scene::parse;

    /// One mass m on a belt, held along it by k, pressed on by a spring k_n across with N.
    const BLOCK: &str = r#"
description = "a block"
[slider]
velocity = -0.3
angle = 0.0
[friction]
coefficient = 0.4
[[mass]]
name = "block"
mass = 2.0
force = [0.0, -10.0]
[[spring]]
name = "hold"
between = ["block", "ground"]
direction = "x"
stiffness = 5000.0
[[spring]]
name = "press"
between = ["block", "ground"]
direction = 1.1
stiffness = 300.0
[[contact]]
name = "belt"
mass = "block"
[integrator]
step = 1.0e-5
[experiment]
stop_time = 1.0
output_interval = 1.0e-3
"#;

    /// Friction that cannot stick keeps the direction of the surface, whatever the slip does; a contact may still open.
    #[test]
    fn without_sticking_no_contact_turns() {
        let text = format!("{BLOCK}[effects]\nsticking = false\n");
        let here = Linearised::of(&parse("block", &text).unwrap());
        assert_eq!(here.uniform_sliding().unwrap(), [ContactState::ReverseSlide]);
        let is_reached = |state| state_energy(&here, &[state]).unwrap().is_some();
        assert!(is_reached(ContactState::Detached) && !is_reached(ContactState::Slide));
        let whole = Linearised::of(&parse("block", BLOCK).unwrap());
        assert!(state_energy(&whole, &[ContactState::Slide]).unwrap().is_some());
    }

    #[test]
    fn one_block_has_the_energies_that_can_be_written_down() {
        let here = Linearised::of(&parse("block", BLOCK).unwrap());
        let needs = |state| state_energy(&here, &[state]).unwrap().unwrap();
        // To stick: the belt's speed.
        let stick = needs(ContactState::Stick);
        assert!((stick.energy - 0.5 * 2.0 * 0.3 * 0.3).abs() < 1e-12);
        assert!((stick.push - 0.3).abs() < 1e-12);
        // To open: with c = cos 1.1, s = sin 1.1, k = 300 the spring presses with k (c s x + s² y) more. Of all (x, y)
        // the least energy ½ (x, y) K (x, y)ᵀ with k c s x + k s² y = −N is N² / (2 a K⁻¹ aᵀ) with a the row of K for y,
        // and a K⁻¹ aᵀ is K_yy.
        let normal = here.equilibrium().unwrap().normal_force[0];
        let k_yy = 300.0 * f64::sin(1.1).powi(2);
        assert!(
            (needs(ContactState::Detached).energy / (0.5 * normal * normal / k_yy) - 1.0).abs()
                < 1e-9
        );
        // To slide the other way it has the belt's speed first, and a blow takes it there with no more.
        assert_eq!(needs(ContactState::Slide).energy, stick.energy);
        assert_eq!(needs(ContactState::ReverseSlide).energy, 0.0);
    }

    #[test]
    fn contacts_of_one_mass_cannot_stick_on_surfaces_that_move_apart() {
        let two = BLOCK.replace(
            "[integrator]",
            "[[contact]]\nname = \"other\"\nmass = \"block\"\nvelocity = -0.1\n[integrator]",
        );
        let Ok(scene) = parse("two", &two) else { panic!() };
        let here = Linearised::of(&scene);
        // Both press along one line, so there is no one equilibrium; the kinematics alone decide.
        let problem = Problem {
            model: here.model(),
            inverse: dense(&here.model().mass).try_inverse().unwrap(),
            damping: damping(here.linear().unwrap()),
        };
        let sliding = here.uniform_sliding().unwrap();
        assert_eq!(problem.kinetic(&[ContactState::Stick; 2], &sliding), None);
        let one = [ContactState::Stick, sliding[1]];
        assert!((problem.kinetic(&one, &sliding).unwrap() - 0.09).abs() < 1e-12);
    }

    /// The block hangs g above the belt: to land, its springs take ½ k g² with the stiffness k along the normal.
    #[test]
    fn a_contact_that_is_open_at_rest_needs_the_energy_that_closes_its_gap() {
        let text = BLOCK.replace("force = [0.0, -10.0]", "force = [0.0, 3.0]");
        let here = Linearised::of(&parse("block", &text).unwrap());
        let gap = here.equilibrium().unwrap().gap[0];
        let inverse = [[5000.0, 0.0], [0.0, 0.0]];
        let (c, s) = (f64::cos(1.1), f64::sin(1.1));
        let k = [[inverse[0][0] + 300.0 * c * c, 300.0 * c * s], [300.0 * c * s, 300.0 * s * s]];
        // Along y with x free: k_yy − k_xy²/k_xx.
        let along = k[1][1] - k[0][1] * k[0][1] / k[0][0];
        assert!((gap - 3.0 / along).abs() < 1e-12);
        let needs = |state| state_energy(&here, &[state]).unwrap().unwrap().energy;
        let closes = 0.5 * along * gap * gap;
        assert!((needs(ContactState::ReverseSlide) - closes).abs() < 1e-12 * closes);
        assert_eq!(needs(ContactState::Detached), 0.0);
        // A circulatory part has no energy.
        let mut model = here.model().clone();
        let circulatory = [(0, 1, 150.0), (1, 0, -150.0)];
        let entries = model.stiffness.entries().chain(circulatory).collect();
        model.stiffness = SparseMatrix::from_entries(2, entries);
        let (inverse, damping) = (DMatrix::identity(2, 2), DMatrix::zeros(2, 2));
        let problem = Problem { model: &model, inverse, damping };
        let found = problem.closing(0, here.equilibrium().unwrap()).unwrap();
        assert!((found - closes).abs() < 1e-12 * closes, "{found} {closes}");
        // To stick it needs the velocity of the belt, too: ½ 2 kg (0.3 m/s)².
        assert!((needs(ContactState::Stick) - closes.max(0.09)).abs() < 1e-12);
    }
}
