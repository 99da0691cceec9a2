//! All rules in one table: the name of each, which later versions keep, its requirement, its class, and the section of
//! FMI 2.0.5 that states it.

use serde::Serialize;
use std::fmt;

/// The class of a rule: how grave it is that an FMU breaks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// The FMU contradicts a sentence of the standard.
    Violation,
    /// The FMU fails: in a run, or because it cannot be read or loaded, although no sentence of the standard forbids it.
    Defect,
    /// A recommendation is not followed, or something is wrong on some hosts only.
    Hint,
}

impl Class {
    /// All classes, the gravest first.
    pub const ALL: [Self; 3] = [Self::Violation, Self::Defect, Self::Hint];

    /// The class as one word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Violation => "violation",
            Self::Defect => "defect",
            Self::Hint => "hint",
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

/// The part of an examination that judges a rule, in the order of the parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// The archive's headers, names and contents.
    #[default]
    Archive,
    /// `modelDescription.xml`.
    Description,
    /// The libraries of all platforms, as files.
    Libraries,
    /// A run of the library for this host.
    Run,
}

/// Returns the value that is given, or `None`.
macro_rules! optional {
    () => {
        None
    };
    ($value:literal) => {
        Some($value)
    };
}

/// Defines the enumeration of the rules. Each has its name, its requirement, its class and, where a sentence of the
/// standard stands behind it, the section of FMI 2.0.5 and the version since which it holds.
macro_rules! rules {
    ($($part:ident {
        $($rule:ident $id:literal $line:literal $class:ident $($section:literal $since:literal)?;)*
    })*) => {
        /// A rule that an FMU must follow.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(missing_docs)]
        pub enum Rule { $($($rule),*),* }

        impl Rule {
            /// All rules, in the order in which they are listed.
            pub const ALL: &[Self] = &[$($(Self::$rule),*),*];

            /// The name of the rule, which later versions keep.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $($(Self::$rule => $id),*),* }
            }

            /// The requirement of the rule, in one line.
            #[must_use]
            pub const fn line(self) -> &'static str {
                match self { $($(Self::$rule => $line),*),* }
            }

            /// The class of the rule. A finding may have another one: see
            /// [`Finding::class`](crate::Finding::class).
            #[must_use]
            pub const fn class(self) -> Class {
                match self { $($(Self::$rule => Class::$class),*),* }
            }

            /// The section of FMI 2.0.5 that states the requirement; `None` if no sentence does.
            #[must_use]
            pub const fn section(self) -> Option<&'static str> {
                match self { $($(Self::$rule => optional!($($section)?)),*),* }
            }

            /// The version of FMI 2.0 since which the requirement holds, for rules with a section. The text of 2.0.1 is
            /// the first that was compared.
            #[must_use]
            pub const fn since(self) -> Option<&'static str> {
                match self { $($(Self::$rule => optional!($($since)?)),*),* }
            }

            /// The part of the examination that judges the rule.
            #[must_use]
            pub const fn part(self) -> Part {
                match self { $($(Self::$rule => Part::$part),*),* }
            }
        }
    };
}

rules! {
    Archive {
        ZipVersion "zip-version" "every entry can be extracted by a reader of zip 2.0; zip64 is not allowed" Violation "2.3" "2.0.3";
        ZipMethod "zip-method" "entries are stored or deflated, and not encrypted" Violation "2.3" "2.0.3";
        ZipDataDescriptor "zip-data-descriptor" "a data descriptor follows the content of deflated entries only" Violation "2.3" "2.0.3";
        ZipLink "zip-link" "every entry is a file or a folder, not a link, device or pipe" Violation "2.3" "2.0.4";
        ZipPath "zip-path" "names are relative UTF-8 paths with forward slashes that stay inside the archive" Violation "2.3" "2.0.1";
        ZipDuplicate "zip-duplicate" "no two entries have the same name, even if case is ignored" Hint;
        ZipDamaged "zip-damaged" "every entry unpacks to the size and checksum that it states" Violation "2.3" "2.0.1";
        ZipBomb "zip-bomb" "the unpacked size is within limits, and entries do not overlap" Defect;
        ZipUnknownEntry "zip-unknown-entry" "the top level holds only files and folders that FMI 2.0 defines" Hint "2.3" "2.0.2";
        ModelDescriptionMissing "model-description-missing" "modelDescription.xml is at the top level of the archive" Violation "2.3" "2.0.1";
        SourceFileMissing "source-file-missing" "every source file that the model description lists is in sources/" Violation "2.3" "2.0.1";
    }
    Description {
        // The model description as XML.
        XmlMalformed "xml-malformed" "modelDescription.xml is well-formed XML" Violation "2.2" "2.0.1";
        XmlEncoding "xml-encoding" "modelDescription.xml is in UTF-8 and declares this encoding" Violation "2.2" "2.0.1";
        XmlDtd "xml-dtd" "modelDescription.xml has no document type declaration (DTD)" Defect;
        XmlLimits "xml-limits" "size, nesting, and numbers of elements and attributes are within limits" Defect;
        FmiVersion "fmi-version" "the root element is fmiModelDescription, and its fmiVersion is 2.0" Violation "2.2.1" "2.0.1";
        XmlElement "xml-element" "elements are defined by the schema, complete, and in its order" Violation "2.2" "2.0.1";
        AttributeUnknown "attribute-unknown" "elements have only attributes that the schema defines" Violation "2.2" "2.0.1";
        AttributeMissing "attribute-missing" "every required attribute is present" Violation "2.2" "2.0.1";
        AttributeValue "attribute-value" "every attribute value has the type that the schema defines" Violation "2.2" "2.0.1";
        NotFinite "not-finite" "no number is NaN or infinite" Violation "2.2" "2.0.1";
        // The model description's contents.
        ModelIdentifier "model-identifier" "modelIdentifier is a C identifier" Violation "4.3.1" "2.0.1";
        GuidEmpty "guid-empty" "the guid is not empty" Hint "2.2.1" "2.0.1";
        GenerationDate "generation-date" "generationDateAndTime is in UTC, with whole seconds, and ends in Z" Hint "2.2.1" "2.0.1";
        CapabilityFlags "capability-flags" "an FMU with canSerializeFMUstate also has canGetAndSetFMUstate" Violation "4.3.1" "2.0.1";
        DefaultExperiment "default-experiment" "startTime < stopTime, stepSize > 0 and tolerance > 0" Hint;
        CategoryDuplicate "category-duplicate" "names of log categories are unique" Violation "2.2.4" "2.0.1";
        ToolDuplicate "tool-duplicate" "names of tools in VendorAnnotations are unique" Violation "2.2.6" "2.0.1";
        UnitDuplicate "unit-duplicate" "names of units, and of the display units of a unit, are unique" Violation "2.2.2" "2.0.1";
        UnitUndeclared "unit-undeclared" "every unit that is used is declared in UnitDefinitions" Violation "2.2.3" "2.0.1";
        DisplayUnitWithoutUnit "display-unit-without-unit" "what has a display unit has a unit" Violation "2.2.3" "2.0.1";
        DisplayUnitUndeclared "display-unit-undeclared" "every display unit that is used is declared below its unit; others are ignored" Hint "2.2.3" "2.0.1";
        TypeDuplicate "type-duplicate" "type names are unique" Violation "2.2.3" "2.0.1";
        TypeUndeclared "type-undeclared" "every declaredType is defined in TypeDefinitions" Violation "2.2.7" "2.0.1";
        TypeKind "type-kind" "a variable and its declaredType are of the same kind, such as Real" Violation "2.2.7" "2.0.1";
        TypeName "type-name" "no type has the name of a variable" Violation "2.2.3" "2.0.1";
        Enumeration "enumeration" "names and values of the items of an enumeration are unique" Violation "2.2.3" "2.0.1";
        // Variables.
        NameDuplicate "name-duplicate" "variable names are unique" Violation "2.2.7" "2.0.1";
        NameStructured "name-structured" "names follow the grammar of structured names if that is the naming convention" Violation "2.2.9" "2.0.1";
        NameFlat "name-flat" "variable names are not empty and contain no tabs or line ends" Violation "2.2.9" "2.0.1";
        ArrayOrder "array-order" "elements of an array follow each other in the order of their indices if names are structured" Hint "2.2.9" "2.0.1";
        CausalityVariability "causality-variability" "causality, variability and initial form a combination that FMI allows" Violation "2.2.7" "2.0.1";
        ContinuousNotReal "continuous-not-real" "only Real variables are continuous; continuous is the default variability" Violation "2.2.7" "2.0.1";
        IndependentVariable "independent-variable" "there is at most one independent variable, and it is a Real" Violation "2.2.7" "2.0.1";
        StartMissing "start-missing" "inputs, and variables with initial exact or approx, have a start value" Violation "2.2.7" "2.0.1";
        StartForbidden "start-forbidden" "the independent variable and variables with initial calculated have no start value" Violation "2.2.7" "2.0.1";
        StartOutsideBounds "start-outside-bounds" "start values lie within min and max, and are items of their enumeration" Violation "2.2.7" "2.0.1";
        BoundsOrder "bounds-order" "min is not above max" Violation "2.2.3" "2.0.1";
        NominalValue "nominal-value" "nominal values are above zero" Violation "2.2.3" "2.0.1";
        AliasSettable "alias-settable" "of variables that share a value reference at most one is set: it can be set, or is the independent variable" Violation "2.2.7" "2.0.1";
        AliasConstant "alias-constant" "a constant shares its value reference with constants only" Violation "2.2.7" "2.0.1";
        AliasUnit "alias-unit" "variables that share a value reference have the same unit, or none" Violation "2.2.7" "2.0.1";
        AliasStart "alias-start" "constants that share a value reference have the same value" Violation "2.2.7" "2.0.1";
        DerivativeIndex "derivative-index" "the attribute derivative is the index of another Real variable" Violation "2.2.7" "2.0.1";
        StateCausality "state-causality" "continuous-time states are local variables or outputs" Violation "2.2.7" "2.0.1";
        Reinit "reinit" "only continuous-time states of an FMU for model exchange have the attribute reinit" Violation "2.2.7" "2.0.1";
        MultipleSet "multiple-set" "only inputs of an FMU for model exchange have canHandleMultipleSetPerTimeInstant" Violation "2.2.7" "2.0.1";
        // The structure.
        UnknownIndex "unknown-index" "every Unknown is the index of a variable, and occurs once in its list" Violation "2.2.8" "2.0.1";
        OutputsList "outputs-list" "Outputs lists all outputs and nothing else" Violation "2.2.8" "2.0.1";
        DerivativesList "derivatives-list" "Derivatives lists only variables with the attribute derivative" Violation "2.2.8" "2.0.1";
        InitialUnknownsList "initial-unknowns-list" "InitialUnknowns lists exactly the variables that initialization computes" Violation "2.2.8" "2.0.1";
        InitialUnknownsOrder "initial-unknowns-order" "InitialUnknowns is in ascending order of the indices" Violation "2.2.8" "2.0.1";
        DependenciesIndex "dependencies-index" "dependencies are indices of variables" Violation "2.2.8" "2.0.1";
        DependenciesKnown "dependencies-known" "unknowns depend only on what is known: inputs, the independent variable, states, at the start initial exact" Violation "2.2.8" "2.0.1";
        DependenciesOrder "dependencies-order" "dependencies are in ascending order" Violation "2.2.8" "2.0.1";
        DependenciesKind "dependencies-kind" "dependenciesKind has one entry for each dependency, for unknowns that are not Real always dependent" Violation "2.2.8" "2.0.1";
    }
    Libraries {
        PlatformFolder "platform-folder" "every folder in binaries/ is named as a platform of FMI 2.0" Hint "2.3" "2.0.1";
        LibraryMissing "library-missing" "there are sources or a library, and libraries are named after modelIdentifier" Violation "2.3" "2.0.1";
        LibraryFormat "library-format" "the library is made for the system and processor of its folder" Violation "2.3" "2.0.4";
        FunctionMissing "function-missing" "the library exports every function of FMI 2.0 for co-simulation" Violation "2.3" "2.0.1";
        SymbolUndefined "symbol-undefined" "every undefined symbol of the library is provided by a library that it links to" Hint;
        NeededLibrary "needed-library" "the library needs only system libraries and libraries that are packed with it" Hint "2.3" "2.0.1";
        GlibcFloor "glibc-floor" "the library needs no newer glibc than the hosts have; a defect with --glibc" Hint;
        RunPath "run-path" "search paths of the library begin with $ORIGIN, its own folder" Hint "2.3" "2.0.1";
        ExecutableStack "executable-stack" "the library does not require an executable stack" Hint;
    }
    Run {
        Load "load" "the library can be loaded" Defect;
        TypesPlatform "types-platform" "fmi2GetTypesPlatform returns \"default\"" Defect;
        Version "version" "fmi2GetVersion returns \"2.0\"" Defect;
        Instantiate "instantiate" "fmi2Instantiate accepts the guid of the model description" Defect;
        FreeNull "free-null" "fmi2FreeInstance ignores NULL" Defect;
        WrongGuid "wrong-guid" "fmi2Instantiate refuses any other guid" Defect;
        NullCallbacks "null-callbacks" "an FMU with canNotUseMemoryManagementFunctions accepts NULL memory callbacks" Defect;
        ResourceLocation "resource-location" "fmi2Instantiate accepts every valid form of the URI of the resources" Defect;
        CallFailed "call-failed" "the calls succeed that every host makes, and those that the model description promises" Defect;
        StartDiffers "start-differs" "inputs, parameters and constants have their start values after initialization" Defect;
        OutputNotFinite "output-not-finite" "Real outputs are finite" Defect;
        ValueLost "value-lost" "inputs and parameters keep a value that was accepted" Defect;
        RefusalSilent "refusal-silent" "a library that refuses a value tells the logger why" Hint;
        ResetDiffers "reset-differs" "a run after fmi2Reset gives the same outputs" Defect;
        StateDiffers "state-differs" "a run from a saved state gives the same outputs" Defect;
        FreeState "free-state" "fmi2FreeFMUstate ignores NULL, and sets the pointer of a freed state to NULL" Defect;
        SerializedStateDiffers "serialized-state-differs" "a run from a serialized state gives the same outputs" Defect;
        InstancesDiffer "instances-differ" "instances of one process do not affect each other" Defect;
        LoggingDiffers "logging-differs" "a run with logging on gives the same outputs" Defect;
        DirectionalDerivative "directional-derivative" "derivatives of outputs by inputs are those of the outputs" Defect;
        OutputDerivative "output-derivative" "derivatives of outputs by time are finite, and not far below those of the outputs" Defect;
        InputDerivative "input-derivative" "derivatives of inputs that are zero change nothing" Defect;
        ArrayBounds "array-bounds" "calls stay within the host's arrays, and do not write to those that they are to read" Defect;
        MemoryErrors "memory-errors" "valgrind finds no wrong access to memory, and no use of values that were never set" Defect;
        FloatingPointMode "floating-point-mode" "rounding, denormal numbers and traps of floating point stay as the host has set them" Defect;
        ProcessSettings "process-settings" "working folder, locale and blocked signals stay as the host has set them" Defect;
        SignalHandlers "signal-handlers" "handlers of signals stay as the host has set them" Hint;
        WritesFiles "writes-files" "nothing is written into the working folder of the host" Hint;
        MemoryGrowth "memory-growth" "memory and open files do not grow as instances are made and freed" Defect;
        Prints "prints" "messages go to the logger, not to standard output or standard error" Defect;
        Crash "crash" "the library does not crash" Defect;
        Exit "exit" "the library does not end the process" Defect;
        TimeLimit "time-limit" "the run finishes within the time limit" Defect;
        MemoryLimit "memory-limit" "the run stays within the memory limit" Defect;
        LeavesProcesses "leaves-processes" "the library leaves no processes behind" Defect;
    }
}

impl Rule {
    /// Returns the rule of this name.
    #[must_use]
    pub fn named(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|rule| rule.id() == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_in_kebab_case() {
        let ids: BTreeSet<_> = Rule::ALL.iter().map(|rule| rule.id()).collect();
        assert_eq!(ids.len(), Rule::ALL.len());
        for id in ids {
            assert!(id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
        }
    }

    #[test]
    fn every_violation_names_its_section() {
        for rule in Rule::ALL {
            let has_section = rule.section().is_some();
            assert!(has_section || rule.class() != Class::Violation, "{}", rule.id());
            assert_eq!(has_section, rule.since().is_some(), "{}", rule.id());
        }
    }
}
