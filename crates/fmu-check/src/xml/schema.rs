//! The schema of FMI 2.0 as tables: the attributes of elements, and their children in order.

use super::values::Type::{
    self, Boolean, Count, Counts, Double, Integer, Moment, Text, Word, Words,
};

/// An element of the schema, identified by the last names of its path.
pub(super) struct ElementKind {
    /// `parent/name`, or the name alone if the element is the same everywhere.
    pub(super) name: &'static str,
    /// Attributes: name, type, and `true` if the attribute is required.
    pub(super) attributes: &'static [(&'static str, Type, bool)],
    /// Children in their order; the names of one step may come in any order.
    pub(super) children: &'static [Child],
}

/// A step in the order of an element's children.
pub(super) struct Child {
    pub(super) names: &'static [&'static str],
    /// `true` if at least one element of the step is required.
    pub(super) required: bool,
    /// `true` if a name may occur more than once.
    pub(super) many: bool,
    /// `true` if at most one of the names may occur.
    pub(super) either: bool,
}

const fn one(names: &'static [&'static str]) -> Child {
    Child { names, required: true, many: false, either: false }
}

const fn maybe(names: &'static [&'static str]) -> Child {
    Child { names, required: false, many: false, either: false }
}

const fn some(names: &'static [&'static str]) -> Child {
    Child { names, required: true, many: true, either: false }
}

const fn any(names: &'static [&'static str]) -> Child {
    Child { names, required: false, many: true, either: false }
}

const fn either(names: &'static [&'static str]) -> Child {
    Child { names, required: true, many: false, either: true }
}

const KINDS: &[&str] = &["Real", "Integer", "Boolean", "String", "Enumeration"];

pub(crate) const CAUSALITIES: &[&str] =
    &["parameter", "calculatedParameter", "input", "output", "local", "independent"];
pub(crate) const VARIABILITIES: &[&str] =
    &["constant", "fixed", "tunable", "discrete", "continuous"];

const UNKNOWN: &[(&str, Type, bool)] = &[
    ("index", Count, true),
    ("dependencies", Counts, false),
    ("dependenciesKind", Words(&["dependent", "constant", "fixed", "tunable", "discrete"]), false),
];

pub(super) static ELEMENTS: &[ElementKind] = &[
    ElementKind {
        name: "fmiModelDescription",
        attributes: &[
            ("fmiVersion", Text, true),
            ("modelName", Text, true),
            ("guid", Text, true),
            ("description", Text, false),
            ("author", Text, false),
            ("version", Text, false),
            ("copyright", Text, false),
            ("license", Text, false),
            ("generationTool", Text, false),
            ("generationDateAndTime", Moment, false),
            ("variableNamingConvention", Word(&["flat", "structured"]), false),
            ("numberOfEventIndicators", Count, false),
        ],
        children: &[
            one(&["ModelExchange", "CoSimulation"]),
            maybe(&["UnitDefinitions"]),
            maybe(&["TypeDefinitions"]),
            maybe(&["LogCategories"]),
            maybe(&["DefaultExperiment"]),
            maybe(&["VendorAnnotations"]),
            one(&["ModelVariables"]),
            one(&["ModelStructure"]),
        ],
    },
    ElementKind {
        name: "ModelExchange",
        attributes: &[
            ("modelIdentifier", Text, true),
            ("needsExecutionTool", Boolean, false),
            ("completedIntegratorStepNotNeeded", Boolean, false),
            ("canBeInstantiatedOnlyOncePerProcess", Boolean, false),
            ("canNotUseMemoryManagementFunctions", Boolean, false),
            ("canGetAndSetFMUstate", Boolean, false),
            ("canSerializeFMUstate", Boolean, false),
            ("providesDirectionalDerivative", Boolean, false),
        ],
        children: &[maybe(&["SourceFiles"])],
    },
    ElementKind {
        name: "CoSimulation",
        attributes: &[
            ("modelIdentifier", Text, true),
            ("needsExecutionTool", Boolean, false),
            ("canHandleVariableCommunicationStepSize", Boolean, false),
            ("canInterpolateInputs", Boolean, false),
            ("maxOutputDerivativeOrder", Count, false),
            ("canRunAsynchronuously", Boolean, false),
            ("canBeInstantiatedOnlyOncePerProcess", Boolean, false),
            ("canNotUseMemoryManagementFunctions", Boolean, false),
            ("canGetAndSetFMUstate", Boolean, false),
            ("canSerializeFMUstate", Boolean, false),
            ("providesDirectionalDerivative", Boolean, false),
        ],
        children: &[maybe(&["SourceFiles"])],
    },
    ElementKind { name: "SourceFiles", attributes: &[], children: &[some(&["File"])] },
    ElementKind { name: "File", attributes: &[("name", Text, true)], children: &[] },
    ElementKind { name: "UnitDefinitions", attributes: &[], children: &[some(&["Unit"])] },
    ElementKind {
        name: "Unit",
        attributes: &[("name", Text, true)],
        children: &[maybe(&["BaseUnit"]), any(&["DisplayUnit"])],
    },
    ElementKind {
        name: "BaseUnit",
        attributes: &[
            ("kg", Integer, false),
            ("m", Integer, false),
            ("s", Integer, false),
            ("A", Integer, false),
            ("K", Integer, false),
            ("mol", Integer, false),
            ("cd", Integer, false),
            ("rad", Integer, false),
            ("factor", Double, false),
            ("offset", Double, false),
        ],
        children: &[],
    },
    ElementKind {
        name: "DisplayUnit",
        attributes: &[("name", Text, true), ("factor", Double, false), ("offset", Double, false)],
        children: &[],
    },
    ElementKind { name: "TypeDefinitions", attributes: &[], children: &[some(&["SimpleType"])] },
    ElementKind {
        name: "SimpleType",
        attributes: &[("name", Text, true), ("description", Text, false)],
        children: &[either(KINDS)],
    },
    ElementKind {
        name: "SimpleType/Real",
        attributes: &[
            ("quantity", Text, false),
            ("unit", Text, false),
            ("displayUnit", Text, false),
            ("relativeQuantity", Boolean, false),
            ("min", Double, false),
            ("max", Double, false),
            ("nominal", Double, false),
            ("unbounded", Boolean, false),
        ],
        children: &[],
    },
    ElementKind {
        name: "SimpleType/Integer",
        attributes: &[("quantity", Text, false), ("min", Integer, false), ("max", Integer, false)],
        children: &[],
    },
    ElementKind {
        name: "SimpleType/Enumeration",
        attributes: &[("quantity", Text, false)],
        children: &[some(&["Item"])],
    },
    ElementKind {
        name: "Item",
        attributes: &[("name", Text, true), ("value", Integer, true), ("description", Text, false)],
        children: &[],
    },
    ElementKind { name: "LogCategories", attributes: &[], children: &[some(&["Category"])] },
    ElementKind {
        name: "Category",
        attributes: &[("name", Text, true), ("description", Text, false)],
        children: &[],
    },
    ElementKind {
        name: "DefaultExperiment",
        attributes: &[
            ("startTime", Double, false),
            ("stopTime", Double, false),
            ("tolerance", Double, false),
            ("stepSize", Double, false),
        ],
        children: &[],
    },
    ElementKind { name: "VendorAnnotations", attributes: &[], children: &[some(&["Tool"])] },
    ElementKind { name: "Annotations", attributes: &[], children: &[some(&["Tool"])] },
    ElementKind { name: "Tool", attributes: &[("name", Text, true)], children: &[] },
    ElementKind { name: "ModelVariables", attributes: &[], children: &[some(&["ScalarVariable"])] },
    ElementKind {
        name: "ScalarVariable",
        attributes: &[
            ("name", Text, true),
            ("valueReference", Count, true),
            ("description", Text, false),
            ("causality", Word(CAUSALITIES), false),
            ("variability", Word(VARIABILITIES), false),
            ("initial", Word(&["exact", "approx", "calculated"]), false),
            ("canHandleMultipleSetPerTimeInstant", Boolean, false),
        ],
        children: &[either(KINDS), maybe(&["Annotations"])],
    },
    ElementKind {
        name: "ScalarVariable/Real",
        attributes: &[
            ("declaredType", Text, false),
            ("quantity", Text, false),
            ("unit", Text, false),
            ("displayUnit", Text, false),
            ("relativeQuantity", Boolean, false),
            ("min", Double, false),
            ("max", Double, false),
            ("nominal", Double, false),
            ("unbounded", Boolean, false),
            ("start", Double, false),
            ("derivative", Count, false),
            ("reinit", Boolean, false),
        ],
        children: &[],
    },
    ElementKind {
        name: "ScalarVariable/Integer",
        attributes: &[
            ("declaredType", Text, false),
            ("quantity", Text, false),
            ("min", Integer, false),
            ("max", Integer, false),
            ("start", Integer, false),
        ],
        children: &[],
    },
    ElementKind {
        name: "ScalarVariable/Boolean",
        attributes: &[("declaredType", Text, false), ("start", Boolean, false)],
        children: &[],
    },
    ElementKind {
        name: "ScalarVariable/String",
        attributes: &[("declaredType", Text, false), ("start", Text, false)],
        children: &[],
    },
    ElementKind {
        name: "ScalarVariable/Enumeration",
        attributes: &[
            ("declaredType", Text, true),
            ("quantity", Text, false),
            ("min", Integer, false),
            ("max", Integer, false),
            ("start", Integer, false),
        ],
        children: &[],
    },
    ElementKind {
        name: "ModelStructure",
        attributes: &[],
        children: &[maybe(&["Outputs"]), maybe(&["Derivatives"]), maybe(&["InitialUnknowns"])],
    },
    ElementKind { name: "Outputs", attributes: &[], children: &[some(&["Unknown"])] },
    ElementKind { name: "Derivatives", attributes: &[], children: &[some(&["Unknown"])] },
    ElementKind { name: "InitialUnknowns", attributes: &[], children: &[some(&["Unknown"])] },
    ElementKind { name: "Unknown", attributes: UNKNOWN, children: &[] },
];
