//! Several rings at once, one in each lane of the processor's vectors.

use super::step::{
    Block, Effects, Fixed, Moving, StepConstants, Surface, Surfaces, Vector, With, strain,
};
use super::wide::{Aligned, Wide};
use crate::contact::{ContactLaw, ContactState, Friction, FrictionLaw, Lanes, UnderLaw};
use crate::integrator::{Drive, Motion, Statistics};
use crate::model::ring::MODULE_DOFS;
use crate::model::{Damping, LumpedModel};
use pulp::x86::{V3, V4};
use pulp::{Simd, WithSimd};
use std::array::from_fn;
use std::marker::PhantomData;

/// How wide the processor's vectors are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Four numbers.
    Avx2,
    /// Eight numbers.
    Avx512,
}

impl Width {
    /// Those that this processor has, the widest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let avx512 = V4::try_new().map(|_| Self::Avx512);
        let avx2 = V3::try_new().map(|_| Self::Avx2);
        avx512.into_iter().chain(avx2).collect()
    }

    /// How many rings fit in.
    #[must_use]
    pub fn lanes(self) -> usize {
        match self {
            Self::Avx2 => Wide::<V3>::LANES,
            Self::Avx512 => Wide::<V4>::LANES,
        }
    }
}

/// Rings of equally many modules that move together, each as it would by itself, to the last bit.
///
/// Each is put in a lane, moved with the others, and read back.
pub struct RingBatch(Box<dyn Batch>);

impl RingBatch {
    /// A batch of these models, as many as there are lanes or fewer; none if one has not the pattern of a
    /// ring, or not as many modules or another law of contact than the others, or if the processor has no vectors of that width.
    #[must_use]
    pub fn new<'a>(
        models: impl IntoIterator<Item = &'a LumpedModel>,
        width: Width,
    ) -> Option<Self> {
        let models: Vec<_> = models.into_iter().collect();
        let law = models.first()?.law;
        let rings: Option<Vec<_>> = models.iter().map(|model| super::blocks(model)).collect();
        let rings = rings?;
        let modules = rings.first()?.len();
        let differ = |ring: &Vec<_>| ring.len() != modules;
        if rings.len() > width.lanes()
            || rings.iter().any(differ)
            || models.iter().any(|model| model.law != law)
        {
            return None;
        }
        Some(Self(match width {
            Width::Avx2 => Box::new(Lockstep::new(V3::try_new()?, &rings, law)),
            Width::Avx512 => Box::new(Lockstep::new(V4::try_new()?, &rings, law)),
        }))
    }

    /// Puts a motion in a lane (from 0), with what drives and damps it.
    pub fn load(&mut self, lane: usize, motion: &Motion, drive: &Drive, damping: Damping) {
        self.0.load(lane, motion, drive, damping);
    }

    /// Takes `count` steps of length `step` (s) in all lanes.
    pub fn advance(&mut self, step: f64, count: u64) {
        self.0.advance(step, count);
    }

    /// Reads the motion of a lane (from 0).
    pub fn store(&self, lane: usize, motion: &mut Motion) {
        self.0.store(lane, motion);
    }
}

/// A batch in vectors of some kind.
trait Batch: Send {
    fn load(&mut self, lane: usize, motion: &Motion, drive: &Drive, damping: Damping);
    fn advance(&mut self, step: f64, count: u64);
    fn store(&self, lane: usize, motion: &mut Motion);
}

/// A surface with both coefficients of friction.
type AnySurface<S> = Aligned<Surface<Wide<S>, Friction<Wide<S>>>>;

/// One item a module; what is in no lane is zero, and rests.
struct Lockstep<S: Simd> {
    simd: S,
    law: ContactLaw,
    blocks: Vec<Aligned<Block<Wide<S>>>>,
    forces: Vec<Aligned<Vector<Wide<S>>>>,
    surfaces: Vec<AnySurface<S>>,
    damping: [Wide<S>; 2],
    x: Vec<Aligned<Vector<Wide<S>>>>,
    v: Vec<Aligned<Vector<Wide<S>>>>,
    strained: Vec<Aligned<Vector<Wide<S>>>>,
    contacts: Vec<Aligned<Wide<S>>>,
    statistics: Vec<Statistics>,
}

impl<S: Simd> Lockstep<S> {
    fn new(simd: S, rings: &[Vec<Block<f64>>], law: ContactLaw) -> Self {
        let modules = rings[0].len();
        let zero = Wide::zero(simd);
        let block = |i: usize| {
            let lanes = |pick: &dyn Fn(&Block<f64>) -> f64| {
                let mut values = zero;
                for (lane, ring) in rings.iter().enumerate() {
                    values.set(lane, pick(&ring[i]));
                }
                values
            };
            Aligned(Block {
                mass: from_fn(|r| lanes(&|block| block.mass[r])),
                inverse_mass: from_fn(|r| lanes(&|block| block.inverse_mass[r])),
                own: from_fn(|c| from_fn(|r| lanes(&|block| block.own[c][r]))),
                before: from_fn(|r| lanes(&|block| block.before[r])),
                after: from_fn(|r| lanes(&|block| block.after[r])),
            })
        };
        // The law divides by the last.
        let none = Friction { kinetic: zero, static_: zero, stribeck_velocity: zero.splat(1.0) };
        let at_rest = Surface { velocity: zero, law: none };
        let zeros = vec![Aligned([zero; MODULE_DOFS]); modules];
        Self {
            simd,
            law,
            blocks: (0..modules).map(block).collect(),
            forces: zeros.clone(),
            surfaces: vec![Aligned(at_rest); modules],
            damping: [zero; 2],
            x: zeros.clone(),
            v: zeros.clone(),
            strained: zeros,
            // As an empty lane has them after a step.
            contacts: vec![Aligned(zero.in_state(ContactState::Stick)); modules],
            statistics: vec![Statistics::default(); Wide::<S>::LANES],
        }
    }

    #[inline(always)]
    fn run<E: Effects, L: FrictionLaw<Wide<S>>>(&mut self, step: f64, count: u64) {
        let [alpha, beta] = self.damping;
        let step_lanes = alpha.splat(step);
        let constants = StepConstants {
            step: step_lanes,
            per_step: alpha.splat(1.0 / step),
            retained: alpha.splat(1.0) - step_lanes * alpha,
            beta,
        };
        for ((strained, x), v) in self.strained.iter_mut().zip(&self.x).zip(&self.v) {
            strained.0 = strain(&x.0, &v.0, beta);
        }
        let surfaces = InLanes::<S, L>(&self.surfaces[..self.blocks.len()], PhantomData);
        let fixed = Fixed { blocks: &self.blocks[..], load: &self.forces[..], surfaces };
        let mut moving = Moving {
            x: &mut self.x,
            v: &mut self.v,
            strained: &mut self.strained,
            contacts: &mut self.contacts,
            statistics: &mut self.statistics,
        };
        constants.steps::<E, _, _, _, _>(&fixed, &mut moving, count);
    }
}

/// Surfaces with a law of this kind.
struct InLanes<'a, S: Simd, L>(&'a [AnySurface<S>], PhantomData<L>);

impl<S: Simd, L: FrictionLaw<Wide<S>>> Surfaces<Wide<S>> for InLanes<'_, S, L> {
    type Law = L;

    #[inline(always)]
    fn of(&self, module: usize) -> Surface<Wide<S>, L> {
        let Surface { velocity, law } = self.0[module].0;
        Surface { velocity, law: L::new(law, velocity) }
    }
}

/// Steps, to be compiled for the vectors that they are taken in.
struct Steps<'a, S: Simd> {
    lockstep: &'a mut Lockstep<S>,
    step: f64,
    count: u64,
}

impl<S: Simd> WithSimd for Steps<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) {
        let ContactLaw { friction, sticking, .. } = self.lockstep.law;
        friction.apply(sticking, self);
    }
}

/// Damping and links are in every kernel: where they are zero the doubles are the same.
impl<S: Simd> UnderLaw<Wide<S>> for Steps<'_, S> {
    type Output = ();

    #[inline(always)]
    fn under<L: FrictionLaw<Wide<S>>>(self) {
        let Self { lockstep, step, count } = self;
        if lockstep.law.detachment {
            lockstep.run::<With<true, true, true>, L>(step, count);
        } else {
            lockstep.run::<With<false, true, true>, L>(step, count);
        }
    }
}

/// Puts one number a degree of freedom in a lane.
fn scatter<S: Simd>(vectors: &mut [Aligned<Vector<Wide<S>>>], lane: usize, values: &[f64]) {
    for (wide, value) in vectors.iter_mut().flat_map(|vector| &mut vector.0).zip(values) {
        wide.set(lane, *value);
    }
}

/// Reads one number a degree of freedom from a lane.
fn gather<S: Simd>(vectors: &[Aligned<Vector<Wide<S>>>], lane: usize, values: &mut [f64]) {
    for (wide, value) in vectors.iter().flat_map(|vector| &vector.0).zip(values) {
        *value = wide.get(lane);
    }
}

impl<S: Simd> Batch for Lockstep<S> {
    fn load(&mut self, lane: usize, motion: &Motion, drive: &Drive, damping: Damping) {
        scatter(&mut self.x, lane, &motion.displacement);
        scatter(&mut self.v, lane, &motion.velocity);
        scatter(&mut self.forces, lane, &drive.force);
        for (wide, state) in self.contacts.iter_mut().zip(&motion.contacts) {
            wide.0.set(lane, f64::from(*state as u8));
        }
        self.statistics[lane] = motion.statistics;
        self.damping[0].set(lane, damping.alpha);
        self.damping[1].set(lane, damping.beta);
        let drives = drive.slider_velocity.iter().zip(&drive.friction);
        for (Aligned(Surface { velocity, law }), (v, mu)) in self.surfaces.iter_mut().zip(drives) {
            velocity.set(lane, *v);
            law.kinetic.set(lane, mu.kinetic);
            law.static_.set(lane, mu.static_);
            law.stribeck_velocity.set(lane, mu.stribeck_velocity);
        }
    }

    fn advance(&mut self, step: f64, count: u64) {
        self.simd.vectorize(Steps { lockstep: self, step, count });
    }

    fn store(&self, lane: usize, motion: &mut Motion) {
        gather(&self.x, lane, &mut motion.displacement);
        gather(&self.v, lane, &mut motion.velocity);
        for (wide, state) in self.contacts.iter().zip(&mut motion.contacts) {
            *state = Wide::state(wide.0, lane);
        }
        motion.statistics = self.statistics[lane];
    }
}
