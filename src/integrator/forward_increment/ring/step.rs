//! The scheme's arithmetic on a ring: for one simulation, or for several at once, one in each lane
//! ([`Lanes`]).
//!
//! All of it is inlined, so that it becomes part of a function compiled for wide vectors. That is why there are
//! no closures in here: they could not be forced to.

use crate::contact::{ContactState, FrictionLaw, Lanes};
use crate::integrator::Statistics;
use crate::model::ring::MODULE_DOFS;
use std::borrow::{Borrow, BorrowMut};

/// Places of the tangential and the normal degree of freedom in a module.
pub(super) const TANGENT: usize = 2;
pub(super) const NORMAL: usize = 3;

/// One value a degree of freedom of a module.
pub(super) type Vector<V> = [V; MODULE_DOFS];

/// A module's rows of M and K.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<V> {
    /// Of the mass that rubs: along the tangent and the normal.
    pub(super) mass: [V; 2],
    pub(super) inverse_mass: Vector<V>,
    /// Columns of the module's own block of K.
    pub(super) own: [Vector<V>; MODULE_DOFS],
    /// Links of x1 and x2 to the same coordinate of the module before and of the one after.
    pub(super) before: [V; 2],
    pub(super) after: [V; 2],
}

/// What a step needs, worked out once for all steps of a call.
#[derive(Clone, Copy)]
pub(super) struct StepConstants<V> {
    pub(super) step: V,
    pub(super) per_step: V,
    /// 1 − h α.
    pub(super) retained: V,
    pub(super) beta: V,
}

/// What a mass rubs on: v and the law of friction of its contact.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Surface<V, L> {
    pub(super) velocity: V,
    pub(super) law: L,
}

/// What the masses of all modules rub on.
pub(super) trait Surfaces<V: Lanes> {
    type Law: FrictionLaw<V>;

    fn of(&self, module: usize) -> Surface<V, Self::Law>;
}

/// The same surface for all, which stays in registers.
pub(super) struct Common<S>(pub(super) S);

impl<V: Lanes, L: FrictionLaw<V>> Surfaces<V> for Common<Surface<V, L>> {
    type Law = L;

    #[inline(always)]
    fn of(&self, _: usize) -> Surface<V, L> {
        self.0
    }
}

/// What does not move: one item a module.
pub(super) struct Fixed<'a, B, X, S> {
    pub(super) blocks: &'a [B],
    /// F, N.
    pub(super) load: &'a [X],
    pub(super) surfaces: S,
}

/// What does: one item a module.
pub(super) struct Moving<'a, X, C> {
    pub(super) x: &'a mut [X],
    pub(super) v: &'a mut [X],
    /// x + β ẋ, on which K acts for springs and dampers at once.
    pub(super) strained: &'a mut [X],
    pub(super) contacts: &'a mut [C],
    /// One a lane; state changes and touch-downs are counted here.
    pub(super) statistics: &'a mut [Statistics],
}

/// x + β ẋ of a module.
#[inline(always)]
pub(super) fn strain<V: Lanes>(x: &Vector<V>, v: &Vector<V>, beta: V) -> Vector<V> {
    [x[0] + beta * v[0], x[1] + beta * v[1], x[2] + beta * v[2], x[3] + beta * v[3]]
}

/// What links act on: x1 and x2.
#[inline(always)]
pub(super) fn linked<V: Lanes>(vector: &Vector<V>) -> [V; 2] {
    [vector[0], vector[1]]
}

impl<V: Lanes> Block<V> {
    /// F − K (x + β ẋ), N: all but the mass-proportional damping and the contact. Where the mass rests on the
    /// slider, its normal column is left out, for that acts on zero.
    #[inline(always)]
    pub(super) fn force(
        &self,
        load: &Vector<V>,
        own: &Vector<V>,
        rests: bool,
        [before, after]: [[V; 2]; 2],
    ) -> Vector<V> {
        [
            self.row(0, load, own, rests) - self.link(0, before, after),
            self.row(1, load, own, rests) - self.link(1, before, after),
            self.row(2, load, own, rests),
            self.row(3, load, own, rests),
        ]
    }

    #[inline(always)]
    fn row(&self, r: usize, load: &Vector<V>, own: &Vector<V>, rests: bool) -> V {
        let upper = self.own[0][r] * own[0] + self.own[1][r] * own[1];
        let tangential = self.own[2][r] * own[2];
        let lower = if rests { tangential } else { tangential + self.own[3][r] * own[3] };
        load[r] - (upper + lower)
    }

    #[inline(always)]
    fn link(&self, r: usize, before: [V; 2], after: [V; 2]) -> V {
        self.before[r] * before[r] + self.after[r] * after[r]
    }
}

impl<V: Lanes> StepConstants<V> {
    /// Takes `count` steps of all modules.
    #[inline(always)]
    pub(super) fn steps<
        B: Borrow<Block<V>>,
        S: Surfaces<V>,
        X: BorrowMut<Vector<V>>,
        C: BorrowMut<V::States>,
    >(
        &self,
        fixed: &Fixed<'_, B, X, S>,
        moving: &mut Moving<'_, X, C>,
        count: u64,
    ) {
        // In slices of one length no index needs a check.
        let modules = fixed.blocks.len();
        let (blocks, load) = (fixed.blocks, &fixed.load[..modules]);
        let (x, v) = (&mut moving.x[..modules], &mut moving.v[..modules]);
        let (w, contacts) = (&mut moving.strained[..modules], &mut moving.contacts[..modules]);
        for _ in 0..count {
            // Neighbours act with what they had before the step; these two are overwritten too early.
            let first = linked(w[0].borrow());
            let mut before = linked(w[modules - 1].borrow());
            for i in 0..modules {
                let own = *w[i].borrow();
                let after = if i + 1 < modules { linked(w[i + 1].borrow()) } else { first };
                let (block, load): (&Block<V>, &Vector<V>) = (blocks[i].borrow(), load[i].borrow());
                let was: V::States = *contacts[i].borrow();
                let old = (*x[i].borrow(), *v[i].borrow(), was);
                let links = [before, after];
                let (moved, moving_on, state) =
                    self.step_module(block, load, &own, links, &fixed.surfaces.of(i), old);
                *x[i].borrow_mut() = moved;
                *v[i].borrow_mut() = moving_on;
                *w[i].borrow_mut() = strain(&moved, &moving_on, self.beta);
                before = linked(&own);
                let changed = V::changed(was, state);
                if V::any(changed) {
                    for (lane, statistics) in moving.statistics.iter_mut().enumerate() {
                        if V::lane(changed, lane) {
                            let landed = V::state(was, lane) == ContactState::Detached;
                            statistics.state_changes += 1;
                            statistics.touch_downs += u64::from(landed);
                        }
                    }
                    *contacts[i].borrow_mut() = state;
                }
            }
        }
        for statistics in moving.statistics.iter_mut() {
            statistics.steps += count;
            // The Delassus matrix is diagonal: the first sweep over the contacts solves them.
            statistics.sweeps += count;
            statistics.most_sweeps = statistics.most_sweeps.max(count.min(1));
        }
    }

    /// One step of one module: its new position and velocity, and the state of its contact.
    #[inline(always)]
    fn step_module<L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        load: &Vector<V>,
        own: &Vector<V>,
        links: [[V; 2]; 2],
        surface: &Surface<V, L>,
        (x, v, before): (Vector<V>, Vector<V>, V::States),
    ) -> (Vector<V>, Vector<V>, V::States) {
        let h = self.step;
        let zero = h.splat(0.0);
        let resting = x[NORMAL].is(zero) & v[NORMAL].is(zero);
        let all_rest = V::all(resting);
        // Two copies of one expression, the first of which is shorter.
        let force = if all_rest {
            block.force(load, own, true, links)
        } else {
            block.force(load, own, false, links)
        };
        let (tangential, normal);
        let (gap, state);
        if all_rest && V::all(force[NORMAL].is_at_most(zero)) {
            // At rest on the slider and pressed on it, which is the rule.
            let contact = self.contact(block, &force, -force[NORMAL], &v, surface, before);
            tangential = if V::all(contact.sticks) {
                surface.velocity
            } else {
                let slips = self.predicted(block, TANGENT, &v, force[TANGENT] + contact.slipping);
                V::select(contact.sticks, surface.velocity, slips)
            };
            (gap, normal, state) = (zero, zero, contact.state);
        } else {
            let free = self.predicted(block, NORMAL, &v, force[NORMAL]);
            let reached = x[NORMAL] + h * free;
            let closed = V::select(resting, force[NORMAL], reached).is_at_most(zero);
            let detached = zero.in_state(ContactState::Detached);
            if V::any(closed) {
                // N as seen from the beginning of the step.
                let (mut pressing, mut landing) = (-force[NORMAL], zero);
                if V::any(closed & !resting) {
                    landing = (zero - x[NORMAL]) * self.per_step;
                    let impact = v[NORMAL] * self.retained + x[NORMAL] * self.per_step;
                    let lands = -(force[NORMAL] + block.mass[1] * impact * self.per_step);
                    let lands = V::select(zero.is_below(lands), lands, zero);
                    pressing = V::select(resting, pressing, lands);
                }
                let contact = self.contact(block, &force, pressing, &v, surface, before);
                let dragged = force[TANGENT] + contact.slipping;
                let pull = V::select(closed, dragged, force[TANGENT]);
                let slips = self.predicted(block, TANGENT, &v, pull);
                tangential = V::select(contact.sticks & closed, surface.velocity, slips);
                normal = V::select(closed, landing, free);
                gap = V::select(closed, zero, reached);
                state = V::select_states(closed, contact.state, detached);
            } else {
                tangential = self.predicted(block, TANGENT, &v, force[TANGENT]);
                (gap, normal, state) = (reached, free, detached);
            }
        }
        let new = [
            self.predicted(block, 0, &v, force[0]),
            self.predicted(block, 1, &v, force[1]),
            tangential,
            normal,
        ];
        // Corrector, eq. (18).
        ([x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], gap], new, state)
    }

    /// Predictor, eq. (13), in velocities.
    #[inline(always)]
    fn predicted(&self, block: &Block<V>, dof: usize, v: &Vector<V>, force: V) -> V {
        v[dof] * self.retained + self.step * (force * block.inverse_mass[dof])
    }

    /// The tangential multiplier, eq. (16), of contacts that are closed and press with `normal` (N).
    #[inline(always)]
    fn contact<L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        force: &Vector<V>,
        normal: V,
        v: &Vector<V>,
        surface: &Surface<V, L>,
        before: V::States,
    ) -> Closed<V> {
        let lag = surface.velocity - v[TANGENT] * self.retained;
        let holding = block.mass[0] * lag * self.per_step - force[TANGENT];
        let sticks = surface.law.holds(holding, normal, before);
        let (slipping, slips) = surface.law.slip(holding, normal);
        let stick = normal.in_state(ContactState::Stick);
        Closed { sticks, slipping, state: V::select_states(sticks, stick, slips) }
    }
}

/// What friction does on contacts that are closed.
struct Closed<V: Lanes> {
    sticks: V::Mask,
    /// T where it does not stick, N.
    slipping: V,
    state: V::States,
}
