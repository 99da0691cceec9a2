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
    ZipVersion "zip-version" "every entry can be extracted by version 2.0 of zip: no zip64";
    ZipMethod "zip-method" "entries are stored or deflated, and not encrypted";
    ZipDataDescriptor "zip-data-descriptor" "sizes stand before the content, not in a data descriptor after it";
    ZipLink "zip-link" "entries are files and folders: no links, devices or pipes";
    ZipPath "zip-path" "names are relative UTF-8 paths with forward slashes that stay inside the archive";
    ZipDuplicate "zip-duplicate" "no two entries have one name, also where case does not count";
    ZipDamaged "zip-damaged" "every entry unpacks to the size and checksum that it states";
    ZipBomb "zip-bomb" "the archive unpacks to a size that is no attack";
    ZipUnknownEntry "zip-unknown-entry" "the top level holds only what FMI names";
    ModelDescriptionMissing "model-description-missing" "modelDescription.xml stands at the top level";
    SourceFileMissing "source-file-missing" "every listed source file is in sources/";
    // The model description as XML.
    XmlMalformed "xml-malformed" "modelDescription.xml is well-formed";
    XmlEncoding "xml-encoding" "modelDescription.xml is in UTF-8 and says so";
    XmlDtd "xml-dtd" "there is no document type declaration";
    XmlLimits "xml-limits" "size, nesting and number of elements are those of a model description";
    FmiVersion "fmi-version" "the root is fmiModelDescription and its fmiVersion is 2.0";
    XmlElement "xml-element" "elements are known, complete and in the order of the schema";
    AttributeUnknown "attribute-unknown" "elements have no attributes but those of the schema";
    AttributeMissing "attribute-missing" "required attributes are there";
    AttributeValue "attribute-value" "values are of their attribute's type";
    NotFinite "not-finite" "no number is NaN or infinite";
    // The model description's contents.
    ModelIdentifier "model-identifier" "modelIdentifier is a C identifier";
    GuidEmpty "guid-empty" "the guid is not empty";
    GenerationDate "generation-date" "generationDateAndTime is a date and time that ends in Z";
    CapabilityFlags "capability-flags" "who can serialize states can get and set them";
    DefaultExperiment "default-experiment" "start < stop, step > 0 and tolerance > 0";
    CategoryDuplicate "category-duplicate" "log categories are unique";
    UnitDuplicate "unit-duplicate" "units, and display units of a unit, are unique";
    UnitUndeclared "unit-undeclared" "every unit is declared";
    DisplayUnitUndeclared "display-unit-undeclared" "every display unit is declared below its unit";
    TypeDuplicate "type-duplicate" "type names are unique";
    TypeUndeclared "type-undeclared" "every declared type is there";
    TypeKind "type-kind" "a declared type is of the variable's kind";
    TypeName "type-name" "no type has a variable's name";
    Enumeration "enumeration" "names and values of an enumeration's items are unique";
    // Variables.
    NameDuplicate "name-duplicate" "variable names are unique";
    NameStructured "name-structured" "names parse where the convention is structured";
    NameFlat "name-flat" "names have no tabs and line ends, and are not empty";
    CausalityVariability "causality-variability" "causality, variability and initial go together";
    ContinuousNotReal "continuous-not-real" "only Real variables are continuous, which is the default";
    IndependentVariable "independent-variable" "there is at most one independent variable, a Real";
    StartMissing "start-missing" "inputs, parameters, exact and approx variables have a start value";
    StartForbidden "start-forbidden" "calculated and independent variables have no start value";
    StartOutsideBounds "start-outside-bounds" "start values lie within min and max, or are items of the enumeration";
    BoundsOrder "bounds-order" "min is not above max";
    NominalValue "nominal-value" "nominal values are above zero";
    AliasSettable "alias-settable" "of variables with one reference at most one can be set";
    AliasUnit "alias-unit" "variables with one reference have one unit";
    AliasStart "alias-start" "constants with one reference have one value";
    DerivativeIndex "derivative-index" "derivative names another Real variable";
    // The structure.
    UnknownIndex "unknown-index" "unknowns are variables, each once in a list";
    OutputsList "outputs-list" "Outputs lists exactly the outputs";
    DerivativesList "derivatives-list" "Derivatives lists variables that are derivatives";
    InitialUnknownsList "initial-unknowns-list" "InitialUnknowns lists exactly what is computed at the start";
    InitialUnknownsOrder "initial-unknowns-order" "InitialUnknowns is in the order of the variables";
    DependenciesIndex "dependencies-index" "dependencies are variables";
    DependenciesKind "dependencies-kind" "there are as many dependenciesKind as dependencies";
    // Binaries.
    PlatformFolder "platform-folder" "the folders in binaries/ are those that FMI names";
    LibraryMissing "library-missing" "a platform's folder holds the library, named as the modelIdentifier";
    LibraryFormat "library-format" "the library is of its folder's system and processor";
    FunctionMissing "function-missing" "the library exports every function that importers ask for";
    SymbolUndefined "symbol-undefined" "something that the library needs provides each of its symbols";
    NeededLibrary "needed-library" "the library needs no others but those of the system, and what lies beside it";
    GlibcFloor "glibc-floor" "the library needs no newer glibc than hosts have; a hint unless --glibc says which";
    RunPath "run-path" "the library looks for others beside itself, not in a folder of the machine it was built on";
    ExecutableStack "executable-stack" "the library asks for no executable stack";
    // The run.
    Load "load" "the library can be loaded";
    TypesPlatform "types-platform" "fmi2GetTypesPlatform answers \"default\"";
    Version "version" "fmi2GetVersion answers \"2.0\"";
    Instantiate "instantiate" "an instance with the model description's guid is made";
    WrongGuid "wrong-guid" "an instance with another guid is refused";
    NullCallbacks "null-callbacks" "an FMU that does without memory callbacks takes NULL for them";
    ResourceLocation "resource-location" "every way to write the resources' URI is understood";
    CallFailed "call-failed" "the functions of a plain run succeed";
    StartDiffers "start-differs" "exact variables begin with the start value of the model description";
    OutputNotFinite "output-not-finite" "outputs are finite";
    ResetDiffers "reset-differs" "a run after fmi2Reset gives the same values";
    StateDiffers "state-differs" "a run from a saved state gives the same values";
    SerializedStateDiffers "serialized-state-differs" "a run from a serialized state gives the same values";
    MemoryGrowth "memory-growth" "memory does not grow from one instance to the next";
    Prints "prints" "messages go to the logger, not to standard output or error";
    Crash "crash" "the library does not crash";
    Exit "exit" "the library does not end the process";
    TimeLimit "time-limit" "the run ends in time";
    MemoryLimit "memory-limit" "the run does with the memory that it is given";
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
