//! The scheme's arithmetic on a ring.

use crate::contact::{ContactState, FrictionLaw};
use crate::integrator::Statistics;
use crate::model::ring::MODULE_DOFS;

/// Places of the tangential and the normal degree of freedom in a module.
pub(super) const TANGENT: usize = 2;
pub(super) const NORMAL: usize = 3;

/// One value a degree of freedom of a module.
pub(super) type Vector = [f64; MODULE_DOFS];

/// A module's rows of M and K.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Of the mass that rubs: along the tangent and the normal.
    pub(super) mass: [f64; 2],
    pub(super) inverse_mass: Vector,
    /// Columns of the module's own block of K.
    pub(super) own: [Vector; MODULE_DOFS],
    /// Links of x1 and x2 to the same coordinate of the module before and of the one after.
    pub(super) before: [f64; 2],
    pub(super) after: [f64; 2],
}

/// What a step needs, worked out once for all steps of a call.
#[derive(Clone, Copy)]
pub(super) struct StepConstants {
    pub(super) step: f64,
    pub(super) per_step: f64,
    /// 1 − h α.
    pub(super) retained: f64,
    pub(super) beta: f64,
}

/// What a mass rubs on: v and the law of friction of its contact.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Surface<L> {
    pub(super) velocity: f64,
    pub(super) law: L,
}

/// What the masses of all modules rub on.
pub(super) trait Surfaces {
    type Law: FrictionLaw;

    fn of(&self, module: usize) -> Surface<Self::Law>;
}

/// What changes the arithmetic of a step besides the law of friction: what is off is not compiled.
pub(super) trait Effects {
    /// Can contacts open?
    const DETACHMENT: bool;
    /// Is there Rayleigh damping?
    const DAMPING: bool;
    /// Are modules linked?
    const LINKS: bool;
}

/// The effects that there are.
pub(super) struct With<const DETACHMENT: bool, const DAMPING: bool, const LINKS: bool>;

impl<const DETACHMENT: bool, const DAMPING: bool, const LINKS: bool> Effects
    for With<DETACHMENT, DAMPING, LINKS>
{
    const DETACHMENT: bool = DETACHMENT;
    const DAMPING: bool = DAMPING;
    const LINKS: bool = LINKS;
}

/// What does not move: one item a module.
pub(super) struct Fixed<'a, S> {
    pub(super) blocks: &'a [Block],
    /// F, N.
    pub(super) load: &'a [Vector],
    pub(super) surfaces: S,
}

/// What does: one item a module.
pub(super) struct Moving<'a> {
    pub(super) x: &'a mut [Vector],
    pub(super) v: &'a mut [Vector],
    /// x + β ẋ, on which K acts for springs and dampers at once; not in use without damping.
    pub(super) strained: &'a mut [Vector],
    pub(super) contacts: &'a mut [ContactState],
    pub(super) statistics: &'a mut Statistics,
}

/// x + β ẋ of a module.
#[inline(always)]
pub(super) fn strain(x: &Vector, v: &Vector, beta: f64) -> Vector {
    [x[0] + beta * v[0], x[1] + beta * v[1], x[2] + beta * v[2], x[3] + beta * v[3]]
}

/// What links act on: x1 and x2.
#[inline(always)]
pub(super) fn linked(vector: &Vector) -> [f64; 2] {
    [vector[0], vector[1]]
}

impl Block {
    /// F − K (x + β ẋ), N: all but the mass-proportional damping and the contact. Where the mass rests on the
    /// slider, its normal column is left out, for that acts on zero.
    #[inline(always)]
    pub(super) fn force<E: Effects>(
        &self,
        load: &Vector,
        own: &Vector,
        rests: bool,
        [before, after]: [[f64; 2]; 2],
    ) -> Vector {
        let [first, second] = [self.row(0, load, own, rests), self.row(1, load, own, rests)];
        [
            if E::LINKS { first - self.link(0, before, after) } else { first },
            if E::LINKS { second - self.link(1, before, after) } else { second },
            self.row(2, load, own, rests),
            self.row(3, load, own, rests),
        ]
    }

    #[inline(always)]
    fn row(&self, r: usize, load: &Vector, own: &Vector, rests: bool) -> f64 {
        let upper = self.own[0][r] * own[0] + self.own[1][r] * own[1];
        let tangential = self.own[2][r] * own[2];
        let lower = if rests { tangential } else { tangential + self.own[3][r] * own[3] };
        load[r] - (upper + lower)
    }

    #[inline(always)]
    fn link(&self, r: usize, before: [f64; 2], after: [f64; 2]) -> f64 {
        self.before[r] * before[r] + self.after[r] * after[r]
    }
}

impl StepConstants {
    /// Takes `count` steps of all modules.
    #[inline(always)]
    pub(super) fn steps<E: Effects, S: Surfaces>(
        &self,
        fixed: &Fixed<'_, S>,
        moving: &mut Moving<'_>,
        count: u64,
    ) {
        // In slices of one length no index needs a check.
        let modules = fixed.blocks.len();
        let (blocks, load) = (fixed.blocks, &fixed.load[..modules]);
        let (x, v) = (&mut moving.x[..modules], &mut moving.v[..modules]);
        let contacts = &mut moving.contacts[..modules];
        let w = &mut moving.strained[..if E::DAMPING { modules } else { 0 }];
        for _ in 0..count {
            // Neighbours act with what they had before the step; these two are overwritten too early.
            let strained = if E::DAMPING { &*w } else { &*x };
            let first = linked(&strained[0]);
            let mut before = linked(&strained[modules - 1]);
            for i in 0..modules {
                let strained = if E::DAMPING { &*w } else { &*x };
                let own = strained[i];
                let after = if i + 1 < modules { linked(&strained[i + 1]) } else { first };
                let was = contacts[i];
                let old = (x[i], v[i], was);
                let links = [before, after];
                let surface = fixed.surfaces.of(i);
                let (moved, moving_on, state, broken) =
                    self.step_module::<E, _>(&blocks[i], &load[i], &own, links, &surface, old);
                x[i] = moved;
                v[i] = moving_on;
                if E::DAMPING {
                    w[i] = strain(&moved, &moving_on, self.beta);
                }
                before = linked(&own);
                if was != state {
                    moving.statistics.count_change(state);
                    moving.statistics.touch_downs += u64::from(was == ContactState::Detached);
                    contacts[i] = state;
                }
                if !S::Law::STICKS || !E::DETACHMENT {
                    broken.count(moving.statistics);
                }
            }
        }
        moving.statistics.steps += count;
        // The Delassus matrix is diagonal: the first sweep over the contacts solves them.
        moving.statistics.sweeps += count;
        moving.statistics.most_sweeps = moving.statistics.most_sweeps.max(count.min(1));
    }

    /// One step of one module: its new position and velocity, and the state of its contact.
    #[inline(always)]
    fn step_module<E: Effects, L: FrictionLaw>(
        &self,
        block: &Block,
        load: &Vector,
        own: &Vector,
        links: [[f64; 2]; 2],
        surface: &Surface<L>,
        (x, v, before): (Vector, Vector, ContactState),
    ) -> (Vector, Vector, ContactState, Broken) {
        let h = self.step;
        let surface = &surface.at(&v, before);
        if !E::DETACHMENT {
            return self.step_held::<E, _>(block, load, own, links, surface, (x, v, before));
        }
        let resting = x[NORMAL] == 0.0 && v[NORMAL] == 0.0;
        // Two copies of one expression, the first of which is shorter.
        let force = if resting {
            block.force::<E>(load, own, true, links)
        } else {
            block.force::<E>(load, own, false, links)
        };
        let (tangential, normal);
        let (gap, state, is_closed);
        if resting && force[NORMAL] <= 0.0 {
            // At rest on the slider and pressed on it, which is the rule.
            let contact = self.contact::<E, L>(block, &force, -force[NORMAL], &v, surface, before);
            tangential = self.dragged::<E, L>(block, &force, &v, surface, &contact);
            (gap, normal, state, is_closed) = (0.0, 0.0, contact.state, true);
        } else {
            let free = self.predicted::<E>(block, NORMAL, &v, force[NORMAL]);
            let reached = x[NORMAL] + h * free;
            is_closed = !resting && reached <= 0.0;
            if is_closed {
                // N as seen from the beginning of the step.
                let impact = self.kept::<E>(v[NORMAL]) + x[NORMAL] * self.per_step;
                let lands = -(force[NORMAL] + block.mass[1] * impact * self.per_step);
                let pressing = if 0.0 < lands { lands } else { 0.0 };
                let contact = self.contact::<E, L>(block, &force, pressing, &v, surface, before);
                tangential = self.dragged::<E, L>(block, &force, &v, surface, &contact);
                normal = (0.0 - x[NORMAL]) * self.per_step;
                (gap, state) = (0.0, contact.state);
            } else {
                tangential = self.predicted::<E>(block, TANGENT, &v, force[TANGENT]);
                (gap, normal, state) = (reached, free, ContactState::Detached);
            }
        }
        let new = [
            self.predicted::<E>(block, 0, &v, force[0]),
            self.predicted::<E>(block, 1, &v, force[1]),
            tangential,
            normal,
        ];
        let broken = Broken { slip: surface.reversed(tangential) && is_closed, pull: false };
        // Corrector, eq. (18).
        ([x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], gap], new, state, broken)
    }

    /// The same of a module whose contact holds in both directions, and never moves along its normal.
    #[inline(always)]
    fn step_held<E: Effects, L: FrictionLaw>(
        &self,
        block: &Block,
        load: &Vector,
        own: &Vector,
        links: [[f64; 2]; 2],
        surface: &Surface<L>,
        (x, v, before): (Vector, Vector, ContactState),
    ) -> (Vector, Vector, ContactState, Broken) {
        let h = self.step;
        let force = block.force::<E>(load, own, true, links);
        let pressing = -force[NORMAL];
        // What can stick follows |N|, so that it never drives; what is frozen follows N, so that it is linear.
        let size = if L::STICKS { pressing.abs() } else { pressing };
        let contact = self.contact::<E, L>(block, &force, size, &v, surface, before);
        let tangential = self.dragged::<E, L>(block, &force, &v, surface, &contact);
        let new = [
            self.predicted::<E>(block, 0, &v, force[0]),
            self.predicted::<E>(block, 1, &v, force[1]),
            tangential,
            0.0,
        ];
        let broken = Broken { slip: surface.reversed(tangential), pull: pressing < 0.0 };
        let moved = [x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], 0.0];
        (moved, new, contact.state, broken)
    }

    /// The tangential velocity under friction.
    #[inline(always)]
    fn dragged<E: Effects, L: FrictionLaw>(
        &self,
        block: &Block,
        force: &Vector,
        v: &Vector,
        surface: &Surface<L>,
        contact: &Closed,
    ) -> f64 {
        if contact.sticks {
            return surface.velocity;
        }
        self.predicted::<E>(block, TANGENT, v, force[TANGENT] + contact.slipping)
    }

    /// What mass-proportional damping leaves of a velocity over a step.
    #[inline(always)]
    fn kept<E: Effects>(&self, v: f64) -> f64 {
        if E::DAMPING { v * self.retained } else { v }
    }

    /// Predictor, eq. (13), in velocities.
    #[inline(always)]
    fn predicted<E: Effects>(&self, block: &Block, dof: usize, v: &Vector, force: f64) -> f64 {
        self.kept::<E>(v[dof]) + self.step * (force * block.inverse_mass[dof])
    }

    /// The tangential multiplier, eq. (16), of contacts that are closed and press with `normal` (N).
    #[inline(always)]
    fn contact<E: Effects, L: FrictionLaw>(
        &self,
        block: &Block,
        force: &Vector,
        normal: f64,
        v: &Vector,
        surface: &Surface<L>,
        before: ContactState,
    ) -> Closed {
        let lag = surface.velocity - self.kept::<E>(v[TANGENT]);
        let holding = block.mass[0] * lag * self.per_step - force[TANGENT];
        let (slipping, slips) = surface.law.slip(holding, normal);
        if !L::STICKS {
            return Closed { sticks: false, slipping, state: slips };
        }
        let sticks = surface.law.holds(holding, normal, before);
        let state = if sticks { ContactState::Stick } else { slips };
        Closed { sticks, slipping, state }
    }
}

impl<L: FrictionLaw> Surface<L> {
    /// The surface as a module meets it that moves with these velocities.
    #[inline(always)]
    fn at(&self, v: &Vector, before: ContactState) -> Self {
        Self { law: self.law.at(self.velocity - v[TANGENT], before), ..*self }
    }

    /// Does a mass with this tangential velocity slip against a direction that is frozen?
    #[inline(always)]
    fn reversed(&self, tangential: f64) -> bool {
        if L::STICKS || !L::HAS_DIRECTION {
            return false;
        }
        let slip = self.velocity - tangential;
        slip * self.velocity < 0.0
    }
}

/// Where what a scene leaves out would have been needed.
#[derive(Clone, Copy)]
struct Broken {
    /// Slip against the frozen direction.
    slip: bool,
    /// A normal force that pulls.
    pull: bool,
}

impl Broken {
    #[inline(always)]
    fn count(self, statistics: &mut Statistics) {
        statistics.reversed_slips += u64::from(self.slip);
        statistics.pulled_contacts += u64::from(self.pull);
    }
}

/// What friction does on contacts that are closed.
struct Closed {
    sticks: bool,
    /// T where it does not stick, N.
    slipping: f64,
    state: ContactState,
}
