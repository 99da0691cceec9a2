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
    /// x + β ẋ, on which K acts for springs and dampers at once; not in use without damping.
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
    pub(super) fn force<E: Effects>(
        &self,
        load: &Vector<V>,
        own: &Vector<V>,
        rests: bool,
        [before, after]: [[V; 2]; 2],
    ) -> Vector<V> {
        let [first, second] = [self.row(0, load, own, rests), self.row(1, load, own, rests)];
        [
            if E::LINKS { first - self.link(0, before, after) } else { first },
            if E::LINKS { second - self.link(1, before, after) } else { second },
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
        E: Effects,
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
        let contacts = &mut moving.contacts[..modules];
        let w = &mut moving.strained[..if E::DAMPING { modules } else { 0 }];
        for _ in 0..count {
            // Neighbours act with what they had before the step; these two are overwritten too early.
            let strained = if E::DAMPING { &*w } else { &*x };
            let first = linked(strained[0].borrow());
            let mut before = linked(strained[modules - 1].borrow());
            for i in 0..modules {
                let strained = if E::DAMPING { &*w } else { &*x };
                let own = *strained[i].borrow();
                let after = if i + 1 < modules { linked(strained[i + 1].borrow()) } else { first };
                let (block, load): (&Block<V>, &Vector<V>) = (blocks[i].borrow(), load[i].borrow());
                let was: V::States = *contacts[i].borrow();
                let old = (*x[i].borrow(), *v[i].borrow(), was);
                let links = [before, after];
                let surface = fixed.surfaces.of(i);
                let (moved, moving_on, state, broken) =
                    self.step_module::<E, _>(block, load, &own, links, &surface, old);
                *x[i].borrow_mut() = moved;
                *v[i].borrow_mut() = moving_on;
                if E::DAMPING {
                    *w[i].borrow_mut() = strain(&moved, &moving_on, self.beta);
                }
                before = linked(&own);
                let changed = V::changed(was, state);
                if V::any(changed) {
                    for (lane, statistics) in moving.statistics.iter_mut().enumerate() {
                        if V::lane(changed, lane) {
                            let landed = V::state(was, lane) == ContactState::Detached;
                            statistics.count_change(V::state(state, lane));
                            statistics.touch_downs += u64::from(landed);
                        }
                    }
                    *contacts[i].borrow_mut() = state;
                }
                if !<S::Law as FrictionLaw<V>>::STICKS || !E::DETACHMENT {
                    broken.count(moving.statistics);
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
    fn step_module<E: Effects, L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        load: &Vector<V>,
        own: &Vector<V>,
        links: [[V; 2]; 2],
        surface: &Surface<V, L>,
        (x, v, before): (Vector<V>, Vector<V>, V::States),
    ) -> (Vector<V>, Vector<V>, V::States, Broken<V>) {
        let h = self.step;
        let zero = h.splat(0.0);
        let surface = &surface.at(&v, before);
        if !E::DETACHMENT {
            return self.step_held::<E, _>(block, load, own, links, surface, (x, v, before));
        }
        let resting = x[NORMAL].is(zero) & v[NORMAL].is(zero);
        let all_rest = V::all(resting);
        // Two copies of one expression, the first of which is shorter.
        let force = if all_rest {
            block.force::<E>(load, own, true, links)
        } else {
            block.force::<E>(load, own, false, links)
        };
        let (tangential, normal);
        let (gap, state, is_closed);
        if all_rest && V::all(force[NORMAL].is_at_most(zero)) {
            // At rest on the slider and pressed on it, which is the rule.
            let contact = self.contact::<E, L>(block, &force, -force[NORMAL], &v, surface, before);
            tangential = self.dragged::<E, L>(block, &force, &v, surface, &contact);
            (gap, normal, state) = (zero, zero, contact.state);
            is_closed = zero.is(zero);
        } else {
            let free = self.predicted::<E>(block, NORMAL, &v, force[NORMAL]);
            let reached = x[NORMAL] + h * free;
            let closed = V::select(resting, force[NORMAL], reached).is_at_most(zero);
            let detached = zero.in_state(ContactState::Detached);
            if V::any(closed) {
                // N as seen from the beginning of the step.
                let (mut pressing, mut landing) = (-force[NORMAL], zero);
                if V::any(closed & !resting) {
                    landing = (zero - x[NORMAL]) * self.per_step;
                    let impact = self.kept::<E>(v[NORMAL]) + x[NORMAL] * self.per_step;
                    let lands = -(force[NORMAL] + block.mass[1] * impact * self.per_step);
                    let lands = V::select(zero.is_below(lands), lands, zero);
                    pressing = V::select(resting, pressing, lands);
                }
                let contact = self.contact::<E, L>(block, &force, pressing, &v, surface, before);
                let dragged = force[TANGENT] + contact.slipping;
                let pull = V::select(closed, dragged, force[TANGENT]);
                let slips = self.predicted::<E>(block, TANGENT, &v, pull);
                tangential = if L::STICKS {
                    V::select(contact.sticks & closed, surface.velocity, slips)
                } else {
                    slips
                };
                normal = V::select(closed, landing, free);
                gap = V::select(closed, zero, reached);
                state = V::select_states(closed, contact.state, detached);
                is_closed = closed;
            } else {
                tangential = self.predicted::<E>(block, TANGENT, &v, force[TANGENT]);
                (gap, normal, state) = (reached, free, detached);
                is_closed = closed;
            }
        }
        let new = [
            self.predicted::<E>(block, 0, &v, force[0]),
            self.predicted::<E>(block, 1, &v, force[1]),
            tangential,
            normal,
        ];
        let broken =
            Broken { slip: surface.reversed(tangential) & is_closed, pull: zero.is_below(zero) };
        // Corrector, eq. (18).
        ([x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], gap], new, state, broken)
    }

    /// The same of a module whose contact holds in both directions, and never moves along its normal.
    #[inline(always)]
    fn step_held<E: Effects, L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        load: &Vector<V>,
        own: &Vector<V>,
        links: [[V; 2]; 2],
        surface: &Surface<V, L>,
        (x, v, before): (Vector<V>, Vector<V>, V::States),
    ) -> (Vector<V>, Vector<V>, V::States, Broken<V>) {
        let h = self.step;
        let zero = h.splat(0.0);
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
            zero,
        ];
        let broken = Broken { slip: surface.reversed(tangential), pull: pressing.is_below(zero) };
        let moved = [x[0] + h * new[0], x[1] + h * new[1], x[2] + h * new[2], zero];
        (moved, new, contact.state, broken)
    }

    /// The tangential velocity under friction.
    #[inline(always)]
    fn dragged<E: Effects, L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        force: &Vector<V>,
        v: &Vector<V>,
        surface: &Surface<V, L>,
        contact: &Closed<V>,
    ) -> V {
        if L::STICKS && V::all(contact.sticks) {
            return surface.velocity;
        }
        let slips = self.predicted::<E>(block, TANGENT, v, force[TANGENT] + contact.slipping);
        if L::STICKS { V::select(contact.sticks, surface.velocity, slips) } else { slips }
    }

    /// What mass-proportional damping leaves of a velocity over a step.
    #[inline(always)]
    fn kept<E: Effects>(&self, v: V) -> V {
        if E::DAMPING { v * self.retained } else { v }
    }

    /// Predictor, eq. (13), in velocities.
    #[inline(always)]
    fn predicted<E: Effects>(&self, block: &Block<V>, dof: usize, v: &Vector<V>, force: V) -> V {
        self.kept::<E>(v[dof]) + self.step * (force * block.inverse_mass[dof])
    }

    /// The tangential multiplier, eq. (16), of contacts that are closed and press with `normal` (N).
    #[inline(always)]
    fn contact<E: Effects, L: FrictionLaw<V>>(
        &self,
        block: &Block<V>,
        force: &Vector<V>,
        normal: V,
        v: &Vector<V>,
        surface: &Surface<V, L>,
        before: V::States,
    ) -> Closed<V> {
        let lag = surface.velocity - self.kept::<E>(v[TANGENT]);
        let holding = block.mass[0] * lag * self.per_step - force[TANGENT];
        let (slipping, slips) = surface.law.slip(holding, normal);
        if !L::STICKS {
            return Closed { sticks: lag.is_below(lag), slipping, state: slips };
        }
        let sticks = surface.law.holds(holding, normal, before);
        let stick = normal.in_state(ContactState::Stick);
        Closed { sticks, slipping, state: V::select_states(sticks, stick, slips) }
    }
}

impl<V: Lanes, L: FrictionLaw<V>> Surface<V, L> {
    /// The surface as a module meets it that moves with these velocities.
    #[inline(always)]
    fn at(&self, v: &Vector<V>, before: V::States) -> Self {
        Self { law: self.law.at(self.velocity - v[TANGENT], before), ..*self }
    }

    /// Does a mass with this tangential velocity slip against a direction that is frozen?
    #[inline(always)]
    fn reversed(&self, tangential: V) -> V::Mask {
        let zero = tangential.splat(0.0);
        if L::STICKS || !L::HAS_DIRECTION {
            return zero.is_below(zero);
        }
        let slip = self.velocity - tangential;
        (slip * self.velocity).is_below(zero)
    }
}

/// Where what a scene leaves out would have been needed.
#[derive(Clone, Copy)]
struct Broken<V: Lanes> {
    /// Slip against the frozen direction.
    slip: V::Mask,
    /// A normal force that pulls.
    pull: V::Mask,
}

impl<V: Lanes> Broken<V> {
    #[inline(always)]
    fn count(self, statistics: &mut [Statistics]) {
        if V::any(self.slip | self.pull) {
            for (lane, statistics) in statistics.iter_mut().enumerate() {
                statistics.reversed_slips += u64::from(V::lane(self.slip, lane));
                statistics.pulled_contacts += u64::from(V::lane(self.pull, lane));
            }
        }
    }
}

/// What friction does on contacts that are closed.
struct Closed<V: Lanes> {
    sticks: V::Mask,
    /// T where it does not stick, N.
    slipping: V,
    state: V::States,
}
