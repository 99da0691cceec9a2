//! Laws of friction on a closed contact.
//!
//! Each law has a file of its own and a line of `register!`. These places know the laws one by one, and the compiler does
//! not point at all of them:
//!
//! | file | place |
//! | --- | --- |
//! | `tests/support/judge/reduced.rs`, `tests/soak/case.rs` | the law as the judge and the soak know it |
//! | `crates/cli/tests/analyses/answers/` | the law as the matrices of the tests know it |
//! | `scenes/effects/`, with `SHOWN` in `crates/export/tests/export/effects_variables.rs` | a scene of the law |
//! | `docs/scenes/friction.md`, `docs/scenes/options.md`, `scenes/README.md` | the laws, and the tables of effects |
//!
//! A law may use the numbers of [`Friction`]. A number that a new law needs has these places besides:
//!
//! | file | place |
//! | --- | --- |
//! | this one | a field of [`Friction`] |
//! | `src/scene/friction_file.rs`, `mod.rs`, `rule.rs` | the key of `[friction]`, the field of a scene, the values that are possible |
//! | `src/scene/check.rs`, `missing.rs` | the check of the value; what a scene without it is told |
//! | `modelDescription/variables.toml` | the variable, which importers and studies set |
//! | `src/simulation/values.rs`, `catalogue.rs` | where a scene keeps the variable, its rule, `is_present`, `sets_limit` |
//! | `crates/analysis/src/effects.rs` | `set_law`, with a typical value |
//! | `tests/soak/file.rs`, `minimise.rs` | the number in scenes that the soak writes, and without it |

mod fixed_direction;
mod range;

pub use fixed_direction::FixedDirection;
pub use range::FrictionRange;

use super::ContactState;

/// The parameters of a contact's friction. A law ignores the parameters that it does not use.
///
/// ```
/// use amontons::contact::{Friction, Law};
///
/// let friction = Friction::with_static(0.3, 0.5);
/// assert_eq!(Law::StaticKinetic.at_slip(friction, 0.1), 0.3);
/// assert_eq!(Friction::from(0.4).static_, 0.4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Kinetic coefficient µ_k ≥ 0, for a contact that slips.
    pub kinetic: f64,
    /// Static coefficient µ_s ≥ µ_k, for a contact that sticks.
    pub static_: f64,
    /// Stribeck velocity v_s > 0, m/s: the slip velocity over which µ falls from µ_s towards µ_k.
    pub stribeck_velocity: f64,
}

/// Takes one coefficient for both the static and the kinetic one.
impl From<f64> for Friction {
    fn from(coefficient: f64) -> Self {
        Self::with_static(coefficient, coefficient)
    }
}

impl Friction {
    /// Friction with these coefficients µ_k and µ_s.
    #[must_use]
    pub const fn with_static(kinetic: f64, static_: f64) -> Self {
        Self { kinetic, static_, stribeck_velocity: f64::INFINITY }
    }
}

/// Description of a law: its name, its keys and its properties.
#[derive(Clone, Copy, Debug)]
pub struct LawInfo {
    /// Name of the law in a scene.
    pub name: &'static str,
    /// The keys of `[friction]` that the law needs.
    pub keys: &'static [&'static str],
    /// Equation of the law, as text for readers.
    pub equation: &'static str,
    /// The dependence of µ on the slip velocity; `None` if µ does not depend on it. The law is then that of µ and µ_s
    /// of [`Friction`], which event-driven motion and the analyses take from there.
    pub velocity_dependence: Option<VelocityDependence>,
    /// `true` if a contact can stick under the law.
    pub sticks: bool,
}

impl LawInfo {
    /// `true` if the coefficient is the same at all slip velocities. A contact state then has linear motion.
    #[must_use]
    pub const fn is_constant(&self) -> bool {
        self.velocity_dependence.is_none()
    }
}

/// µ as a function of the slip velocity v_r (m/s), for analyses that linearise it or need its bounds.
#[derive(Clone, Copy, Debug)]
pub struct VelocityDependence {
    /// Coefficient µ(v_r).
    pub friction: fn(Friction, f64) -> f64,
    /// Derivatives of µ(v_r). That by the speed is the slope dµ/d|v_r|, s/m.
    pub friction_by: fn(Friction, f64) -> FrictionDerivatives,
    /// Derivatives of the slope dµ/d|v_r|.
    pub slope_by: fn(Friction, f64) -> FrictionDerivatives,
    /// The greatest µ of a contact that slips.
    pub greatest: fn(Friction) -> f64,
}

/// The derivatives of µ, or of its slope dµ/d|v_r| (s/m), by each quantity that they depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionDerivatives {
    /// By the kinetic coefficient µ_k.
    pub kinetic: f64,
    /// By the static coefficient µ_s.
    pub static_: f64,
    /// By the Stribeck velocity v_s, m/s.
    pub stribeck_velocity: f64,
    /// By the size |v_r| of the slip velocity, m/s.
    pub speed: f64,
}

/// A law that gives the friction on a closed contact.
pub trait FrictionLaw: Copy {
    /// `true` if friction can hold a contact. Otherwise [`holds`](Self::holds) is not evaluated.
    const STICKS: bool = true;

    /// `true` if friction has a direction, which a slip may oppose.
    const HAS_DIRECTION: bool = true;

    /// This law with its direction held fixed.
    type FixedDirection: FrictionLaw;

    /// The law with these numbers, on a surface that moves with velocity `surface` (m/s) along the tangent.
    fn new(friction: Friction, surface: f64) -> Self;

    /// The law over a step that begins with this slip velocity, m/s, in this state.
    #[inline(always)]
    #[must_use]
    fn at(self, _slip: f64, _before: ContactState) -> Self {
        self
    }

    /// `true` if friction can be `holding` (N) on a contact that was in state `before` and presses with `normal` (N).
    #[inline(always)]
    fn holds(self, holding: f64, normal: f64, _before: ContactState) -> bool {
        holding.abs() <= self.limit(normal)
    }

    /// Magnitude of T on a contact that slips and presses with `normal` (N), N.
    #[must_use]
    fn limit(self, normal: f64) -> f64;

    /// Returns T on a contact that friction does not hold, N, and its state.
    #[inline(always)]
    #[must_use]
    fn slip(self, holding: f64, normal: f64) -> (f64, ContactState) {
        let limit = self.limit(normal);
        if holding > 0.0 {
            (limit, ContactState::Slide)
        } else {
            (-limit, ContactState::ReverseSlide)
        }
    }

    /// The range of T/N on a contact that was in state `before`.
    #[inline(always)]
    #[must_use]
    fn range(self, _before: ContactState) -> FrictionRange {
        FrictionRange::of(self.limit(1.0))
    }
}

/// A computation that is compiled for each law of friction.
pub trait LawVisitor {
    /// Result of the computation.
    type Output;

    /// Runs the computation under the law `L`.
    fn under<L: FrictionLaw>(self) -> Self::Output;
}

macro_rules! register {
    ($($(#[$doc:meta])+ $law:ident in $file:ident,)+) => {
        $(mod $file;)+
        $(pub use $file::$law;)+

        /// The available laws of friction.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Law {
            $($(#[$doc])+ $law,)+
        }

        impl Law {
            /// All laws.
            pub const ALL: &'static [Self] = &[$(Self::$law),+];

            /// Description of the law.
            #[must_use]
            pub const fn info(self) -> LawInfo {
                match self {
                    $(Self::$law => $file::INFO,)+
                }
            }

            /// Runs a computation under this law, or under its form with a fixed direction if `sticking` is `false`.
            #[inline(always)]
            pub fn apply<W: LawVisitor>(self, sticking: bool, work: W) -> W::Output {
                match (self, sticking) {
                    $(
                        (Self::$law, true) => work.under::<$law>(),
                        (Self::$law, false) => work.under::<<$law as FrictionLaw>::FixedDirection>(),
                    )+
                }
            }
        }
    };
}

register! {
    /// No friction at all.
    Frictionless in frictionless,
    /// Coulomb's law with one coefficient.
    Coulomb in coulomb,
    /// Static and kinetic friction, with a static coefficient above the kinetic one.
    StaticKinetic in static_kinetic,
    /// Stribeck friction, with a coefficient that falls with the slip velocity.
    Stribeck in stribeck,
}

impl Law {
    /// µ at a slip velocity, m/s.
    #[must_use]
    pub fn at_slip(self, friction: Friction, slip: f64) -> f64 {
        self.info()
            .velocity_dependence
            .map_or(friction.kinetic, |law| (law.friction)(friction, slip))
    }

    /// dµ/d|v_r| at a slip velocity v_r, s/m; v_r in m/s.
    #[must_use]
    pub fn slope_at(self, friction: Friction, slip: f64) -> f64 {
        self.info().velocity_dependence.map_or(0.0, |law| (law.friction_by)(friction, slip).speed)
    }

    /// The greatest µ that a contact can have in slip.
    #[must_use]
    pub fn greatest_in_slip(self, friction: Friction) -> f64 {
        self.info().velocity_dependence.map_or(friction.kinetic, |law| (law.greatest)(friction))
    }

    /// The law with this name in a scene; `None` if there is none.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|law| law.info().name == name)
    }
}
