//! All rules in one table: the name of each, which later versions keep, and its requirement.

/// Defines the enumeration of the rules, with the name and the requirement of each.
macro_rules! rules {
    ($($rule:ident $id:literal $line:literal;)*) => {
        /// A rule that an FMU must follow.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(missing_docs)]
        pub enum Rule { $($rule),* }

        impl Rule {
            /// All rules, in the order in which they are listed.
            pub const ALL: &[Self] = &[$(Self::$rule),*];

            /// The name of the rule, which later versions keep.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$rule => $id),* }
            }

            /// The requirement of the rule, in one line.
            #[must_use]
            pub const fn line(self) -> &'static str {
                match self { $(Self::$rule => $line),* }
            }
        }
    };
}

rules! {
    // The archive.
    ZipVersion "zip-version" "every entry can be extracted by a reader of zip 2.0; zip64 is not allowed";
    ZipMethod "zip-method" "entries are stored or deflated, and not encrypted";
    ZipDataDescriptor "zip-data-descriptor" "the local header states the sizes; no data descriptor follows the content";
    ZipLink "zip-link" "every entry is a file or a folder, not a link, device or pipe";
    ZipPath "zip-path" "names are relative UTF-8 paths with forward slashes that stay inside the archive";
    ZipDuplicate "zip-duplicate" "no two entries have the same name, even if case is ignored";
    ZipDamaged "zip-damaged" "every entry unpacks to the size and checksum that it states";
    ZipBomb "zip-bomb" "the unpacked size is within limits, and entries do not overlap";
    ZipUnknownEntry "zip-unknown-entry" "the top level holds only files and folders that FMI 2.0 defines";
    ModelDescriptionMissing "model-description-missing" "modelDescription.xml is at the top level of the archive";
    SourceFileMissing "source-file-missing" "every source file that the model description lists is in sources/";
    // The model description as XML.
    XmlMalformed "xml-malformed" "modelDescription.xml is well-formed XML";
    XmlEncoding "xml-encoding" "modelDescription.xml is in UTF-8 and declares no other encoding";
    XmlDtd "xml-dtd" "modelDescription.xml has no document type declaration (DTD)";
    XmlLimits "xml-limits" "size, nesting, and numbers of elements and attributes are within limits";
    FmiVersion "fmi-version" "the root element is fmiModelDescription, and its fmiVersion is 2.0";
    XmlElement "xml-element" "elements are defined by the schema, complete, and in its order";
    AttributeUnknown "attribute-unknown" "elements have only attributes that the schema defines";
    AttributeMissing "attribute-missing" "every required attribute is present";
    AttributeValue "attribute-value" "every attribute value has the type that the schema defines";
    NotFinite "not-finite" "no number is NaN or infinite";
    // The model description's contents.
    ModelIdentifier "model-identifier" "modelIdentifier is a C identifier";
    GuidEmpty "guid-empty" "the guid is not empty";
    GenerationDate "generation-date" "generationDateAndTime is a date and time in UTC that ends in Z";
    CapabilityFlags "capability-flags" "an FMU with canSerializeFMUstate also has canGetAndSetFMUstate";
    DefaultExperiment "default-experiment" "startTime < stopTime, stepSize > 0 and tolerance > 0";
    CategoryDuplicate "category-duplicate" "names of log categories are unique";
    UnitDuplicate "unit-duplicate" "names of units, and of the display units of a unit, are unique";
    UnitUndeclared "unit-undeclared" "every unit that is used is declared in UnitDefinitions";
    DisplayUnitUndeclared "display-unit-undeclared" "every display unit that is used is declared below its unit";
    TypeDuplicate "type-duplicate" "type names are unique";
    TypeUndeclared "type-undeclared" "every declaredType is defined in TypeDefinitions";
    TypeKind "type-kind" "a variable and its declaredType are of the same kind, such as Real";
    TypeName "type-name" "no type has the name of a variable";
    Enumeration "enumeration" "names and values of the items of an enumeration are unique";
    // Variables.
    NameDuplicate "name-duplicate" "variable names are unique";
    NameStructured "name-structured" "names follow the grammar of structured names if that is the naming convention";
    NameFlat "name-flat" "variable names are not empty and contain no tabs or line ends";
    CausalityVariability "causality-variability" "causality, variability and initial form a combination that FMI allows";
    ContinuousNotReal "continuous-not-real" "only Real variables are continuous; continuous is the default variability";
    IndependentVariable "independent-variable" "there is at most one independent variable, and it is a Real";
    StartMissing "start-missing" "inputs, and variables with initial exact or approx, have a start value";
    StartForbidden "start-forbidden" "the independent variable and variables with initial calculated have no start value";
    StartOutsideBounds "start-outside-bounds" "start values lie within min and max, and are items of their enumeration";
    BoundsOrder "bounds-order" "min is not above max";
    NominalValue "nominal-value" "nominal values are above zero";
    AliasSettable "alias-settable" "at most one of the variables that share a value reference can be set";
    AliasUnit "alias-unit" "variables that share a value reference have the same unit";
    AliasStart "alias-start" "constants that share a value reference have the same value";
    DerivativeIndex "derivative-index" "the attribute derivative is the index of another Real variable";
    // The structure.
    UnknownIndex "unknown-index" "every Unknown is the index of a variable, and occurs once in its list";
    OutputsList "outputs-list" "Outputs lists all outputs and nothing else";
    DerivativesList "derivatives-list" "Derivatives lists only variables with the attribute derivative";
    InitialUnknownsList "initial-unknowns-list" "InitialUnknowns lists exactly the variables that initialization computes";
    InitialUnknownsOrder "initial-unknowns-order" "InitialUnknowns is in ascending order of the indices";
    DependenciesIndex "dependencies-index" "dependencies are indices of variables";
    DependenciesKind "dependencies-kind" "dependenciesKind has one entry for each entry of dependencies";
    // Binaries.
    PlatformFolder "platform-folder" "every folder in binaries/ is named as a platform of FMI 2.0";
    LibraryMissing "library-missing" "every platform folder holds a library that is named after modelIdentifier";
    LibraryFormat "library-format" "the library is made for the system and processor of its folder";
    FunctionMissing "function-missing" "the library exports every function of FMI 2.0 for co-simulation";
    SymbolUndefined "symbol-undefined" "every undefined symbol of the library is provided by a library that it links to";
    NeededLibrary "needed-library" "the library needs only system libraries and libraries that are packed with it";
    GlibcFloor "glibc-floor" "the library needs no newer glibc than the hosts have; a hint without --glibc";
    RunPath "run-path" "search paths of the library begin with $ORIGIN, its own folder";
    ExecutableStack "executable-stack" "the library does not require an executable stack";
    // The run.
    Load "load" "the library can be loaded";
    TypesPlatform "types-platform" "fmi2GetTypesPlatform returns \"default\"";
    Version "version" "fmi2GetVersion returns \"2.0\"";
    Instantiate "instantiate" "fmi2Instantiate accepts the guid of the model description";
    WrongGuid "wrong-guid" "fmi2Instantiate refuses any other guid";
    NullCallbacks "null-callbacks" "an FMU with canNotUseMemoryManagementFunctions accepts NULL memory callbacks";
    ResourceLocation "resource-location" "fmi2Instantiate accepts every valid form of the URI of the resources";
    CallFailed "call-failed" "all calls of a plain run succeed";
    StartDiffers "start-differs" "inputs, parameters and constants have their start values after initialization";
    OutputNotFinite "output-not-finite" "Real outputs are finite";
    ResetDiffers "reset-differs" "a run after fmi2Reset gives the same outputs";
    StateDiffers "state-differs" "a run from a saved state gives the same outputs";
    SerializedStateDiffers "serialized-state-differs" "a run from a serialized state gives the same outputs";
    MemoryGrowth "memory-growth" "memory does not grow as instances are made and freed";
    Prints "prints" "messages go to the logger, not to standard output or standard error";
    Crash "crash" "the library does not crash";
    Exit "exit" "the library does not end the process";
    TimeLimit "time-limit" "the run finishes within the time limit";
    MemoryLimit "memory-limit" "the run stays within the memory limit";
    LeavesProcesses "leaves-processes" "the library leaves no processes behind";
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
}
