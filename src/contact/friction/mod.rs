//! Laws of friction: what friction may be on a closed contact.
//!
//! Each law is a file of its own, and a line of `register!`. A law may use the numbers of [`Friction`]; one
//! that needs another number adds it there, to `[friction]` of a scene and to the catalogue of variables.

mod frozen;
mod range;

pub use frozen::Frozen;
pub use range::FrictionRange;

use super::ContactState;

/// The numbers that a contact's friction is made of. Laws that do not know one of them have no use for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// µ_k ≥ 0, of a contact that slips.
    pub kinetic: f64,
    /// µ_s ≥ µ_k, of one that does not.
    pub static_: f64,
    /// v_s > 0, m/s: the slip velocity over which µ falls from µ_s towards µ_k.
    pub stribeck_velocity: f64,
}

/// One coefficient for all that a contact does.
impl From<f64> for Friction {
    fn from(coefficient: f64) -> Self {
        Self::with_static(coefficient, coefficient)
    }
}

impl Friction {
    /// µ_k and µ_s.
    #[must_use]
    pub fn with_static(kinetic: f64, static_: f64) -> Self {
        Self { kinetic, static_, stribeck_velocity: f64::INFINITY }
    }
}

/// What there is to know about a law before it is used.
#[derive(Clone, Copy, Debug)]
pub struct LawInfo {
    /// Its name in a scene.
    pub name: &'static str,
    /// The keys of `[friction]` that it needs.
    pub keys: &'static [&'static str],
    /// Its equation, for people.
    pub equation: &'static str,
    /// How µ depends on the slip velocity, where it does. Where it does not, the law is that of µ and µ_s of
    /// [`Friction`], which exact motion and the analyses take from there.
    pub velocity_dependence: Option<VelocityDependence>,
    /// Can a contact stick?
    pub sticks: bool,
}

impl LawInfo {
    /// Is the coefficient the same at all slip velocities? Then a contact state has linear motion.
    #[must_use]
    pub const fn is_constant(&self) -> bool {
        self.velocity_dependence.is_none()
    }
}

/// µ as a function of the slip velocity v_r (m/s), for whoever linearises it or asks what may happen.
#[derive(Clone, Copy, Debug)]
pub struct VelocityDependence {
    /// µ(v_r).
    pub friction: fn(Friction, f64) -> f64,
    /// dµ/d|v_r|, s/m.
    pub slope: fn(Friction, f64) -> f64,
    /// ∂µ/∂µ_k and ∂µ/∂µ_s.
    pub by_coefficients: fn(Friction, f64) -> [f64; 2],
    /// The greatest µ in slip.
    pub greatest: fn(Friction) -> f64,
}

/// A law that says what friction is on a closed contact.
pub trait FrictionLaw: Copy {
    /// Can friction hold a contact? Where not, nothing is asked of [`holds`](Self::holds).
    const STICKS: bool = true;

    /// Has friction a direction, which a slip may be against?
    const HAS_DIRECTION: bool = true;

    /// This law with its direction held fixed.
    type Frozen: FrictionLaw;

    /// The law with these numbers, on a surface that moves with velocity `surface` (m/s) along the tangent.
    fn new(friction: Friction, surface: f64) -> Self;

    /// The law over a step that begins with this slip velocity, m/s, in this state.
    #[inline(always)]
    #[must_use]
    fn at(self, _slip: f64, _before: ContactState) -> Self {
        self
    }

    /// Can friction be `holding` (N) on a contact that was in state `before` and presses with `normal` (N)?
    #[inline(always)]
    fn holds(self, holding: f64, normal: f64, _before: ContactState) -> bool {
        holding.abs() <= self.limit(normal)
    }

    /// The size of T on a contact that slips and presses with `normal`, N.
    #[must_use]
    fn limit(self, normal: f64) -> f64;

    /// T on a contact that friction does not hold, N, and its state.
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

    /// How far T may go on a contact that was in state `before`, over N.
    #[inline(always)]
    #[must_use]
    fn range(self, _before: ContactState) -> FrictionRange {
        FrictionRange::of(self.limit(1.0))
    }
}

/// Something that is done under a law that is known when it is compiled.
pub trait UnderLaw {
    /// What comes of it.
    type Output;

    /// Does it.
    fn under<L: FrictionLaw>(self) -> Self::Output;
}

macro_rules! register {
    ($($(#[$doc:meta])+ $law:ident in $file:ident,)+) => {
        $(mod $file;)+
        $(pub use $file::$law;)+

        /// The laws of friction that there are.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Law {
            $($(#[$doc])+ $law,)+
        }

        impl Law {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$law),+];

            /// What there is to know about it.
            #[must_use]
            pub const fn info(self) -> LawInfo {
                match self {
                    $(Self::$law => $file::INFO,)+
                }
            }

            /// Does something under this law, or under the same with its direction frozen.
            #[inline(always)]
            pub fn apply<W: UnderLaw>(self, sticking: bool, work: W) -> W::Output {
                match (self, sticking) {
                    $(
                        (Self::$law, true) => work.under::<$law>(),
                        (Self::$law, false) => work.under::<<$law as FrictionLaw>::Frozen>(),
                    )+
                }
            }
        }
    };
}

register! {
    /// No friction at all.
    Frictionless in frictionless,
    /// One coefficient.
    Coulomb in coulomb,
    /// A static coefficient above the kinetic one.
    StaticKinetic in static_kinetic,
    /// A coefficient that falls with the slip velocity.
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
        self.info().velocity_dependence.map_or(0.0, |law| (law.slope)(friction, slip))
    }

    /// The greatest µ that a contact can have in slip.
    #[must_use]
    pub fn greatest_in_slip(self, friction: Friction) -> f64 {
        self.info().velocity_dependence.map_or(friction.kinetic, |law| (law.greatest)(friction))
    }

    /// The law of this name in a scene.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|law| law.info().name == name)
    }
}
