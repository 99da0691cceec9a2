//! The model description as typed values. Parts that cannot be read are left out; the check against the schema reports
//! them.

use super::xml::Element;
use super::xml::values::{boolean, count, double};
use std::collections::{BTreeSet, HashMap};

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Real,
    Integer,
    Boolean,
    String,
    Enumeration,
}

impl Kind {
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "Real" => Self::Real,
            "Integer" => Self::Integer,
            "Boolean" => Self::Boolean,
            "String" => Self::String,
            "Enumeration" => Self::Enumeration,
            _ => return None,
        })
    }

    /// The type whose functions read and write the variable; a reference identifies a value within that type.
    pub(super) fn base(self) -> Self {
        if self == Self::Enumeration { Self::Integer } else { self }
    }
}

/// A variable with a readable kind, name and reference; others are left out.
pub(super) struct Variable<'a> {
    /// Index of the variable, counted from 1 as in `ModelStructure`.
    pub(super) index: usize,
    pub(super) name: &'a str,
    pub(super) reference: u32,
    pub(super) causality: &'a str,
    pub(super) variability: &'a str,
    pub(super) states_initial: bool,
    /// The stated `initial`, or else the standard's default; `None` for inputs and the independent variable unless
    /// stated.
    pub(super) initial: Option<&'a str>,
    pub(super) kind: Kind,
    /// The child element that states the kind.
    pub(super) element: &'a Element,
    pub(super) declared: Option<&'a Element>,
    pub(super) start: Option<&'a str>,
}

impl<'a> Variable<'a> {
    fn read(index: usize, scalar: &'a Element, types: &HashMap<&str, &'a Element>) -> Option<Self> {
        let (kind, element) =
            scalar.children.iter().find_map(|child| Some((Kind::named(&child.name)?, child)))?;
        let causality = scalar.attribute("causality").unwrap_or("local");
        let variability = scalar.attribute("variability").unwrap_or("continuous");
        let stated = scalar.attribute("initial");
        let usual = match (causality, variability) {
            ("input" | "independent", _) => None,
            ("parameter", _) | (_, "constant") => Some("exact"),
            _ => Some("calculated"),
        };
        let declared = element.attribute("declaredType").and_then(|name| types.get(name)).copied();
        Some(Self {
            index,
            name: scalar.attribute("name")?,
            reference: count(scalar.attribute("valueReference")?)?,
            causality,
            variability,
            states_initial: stated.is_some(),
            initial: stated.or(usual),
            kind,
            element,
            declared,
            start: element.attribute("start"),
        })
    }

    /// Returns an attribute of the variable, or else of its declared type.
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        let inherited = || self.declared?.children.first()?.attribute(name);
        self.element.attribute(name).or_else(inherited)
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        self.attribute(name).and_then(double)
    }

    /// The index of the variable whose derivative this one is.
    pub(super) fn derivative_of(&self) -> Option<usize> {
        self.element.attribute("derivative").and_then(count).map(|index| index as usize)
    }

    /// `true` if importers may set the value at some time.
    pub(super) fn is_settable(&self) -> bool {
        self.variability != "constant"
            && (self.start.is_some() || matches!(self.causality, "input" | "parameter"))
    }
}

/// The parts of a model description on which the rules depend.
pub(super) struct Description<'a> {
    pub(super) root: &'a Element,
    pub(super) variables: Vec<Variable<'a>>,
    /// The `CoSimulation` element; `None` if the FMU has none.
    pub(super) simulation: Option<&'a Element>,
}

impl<'a> Description<'a> {
    pub(super) fn new(root: &'a Element) -> Self {
        let types = root.below("TypeDefinitions");
        let types = types.iter().filter_map(|kind| Some((kind.attribute("name")?, kind))).collect();
        let scalars =
            root.below("ModelVariables").iter().filter(|child| child.name == "ScalarVariable");
        let variables = (1..)
            .zip(scalars)
            .filter_map(|(index, scalar)| Variable::read(index, scalar, &types))
            .collect();
        Self { root, variables, simulation: root.child("CoSimulation") }
    }

    /// Number of variables, including those that cannot be read.
    pub(super) fn count(&self) -> usize {
        self.root.below("ModelVariables").len()
    }

    /// `true` if the list of derivatives has no meaning: that of an FMU for co-simulation alone without directional
    /// derivatives (FMI 2.0, section 2.2.8).
    pub(super) fn ignores_derivatives(&self) -> bool {
        self.root.child("ModelExchange").is_none() && !self.can("providesDirectionalDerivative")
    }

    /// The indices of the continuous-time states: the variables whose derivatives `Derivatives` lists. `None` if they are
    /// not told, which co-simulation allows, or if an entry is wrong.
    pub(super) fn states(&self) -> Option<BTreeSet<usize>> {
        if self.ignores_derivatives() {
            return None;
        }
        let structure = self.root.child("ModelStructure")?;
        if structure.child("Derivatives").is_none() {
            return self.root.child("ModelExchange").map(|_| BTreeSet::new());
        }
        let by_index: HashMap<usize, &Variable<'_>> =
            self.variables.iter().map(|variable| (variable.index, variable)).collect();
        let state = |unknown: &Element| {
            let index = unknown.attribute("index").and_then(count)? as usize;
            let state = by_index.get(&index)?.derivative_of()?;
            (state != index && by_index.contains_key(&state)).then_some(state)
        };
        structure.below("Derivatives").iter().map(state).collect()
    }

    /// `true` if a capability flag of the co-simulation is stated as true.
    pub(super) fn can(&self, flag: &str) -> bool {
        self.simulation.and_then(|simulation| boolean(simulation.attribute(flag)?)).unwrap_or(false)
    }

    /// The name of the library for co-simulation; `None` if it is no C identifier.
    pub(super) fn identifier(&self) -> Option<&'a str> {
        self.simulation?.attribute("modelIdentifier").filter(|name| is_identifier(name))
    }

    /// A number of the default experiment; `None` if it is not stated.
    pub(super) fn experiment(&self, name: &str) -> Option<f64> {
        self.root.child("DefaultExperiment")?.attribute(name).and_then(double)
    }
}

/// `true` if a name is a C identifier.
pub(super) fn is_identifier(name: &str) -> bool {
    let first = |c: char| c.is_ascii_alphabetic() || c == '_';
    name.starts_with(first) && name.chars().all(|c| first(c) || c.is_ascii_digit())
}
