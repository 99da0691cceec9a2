//! Model descriptions that break one rule.

use super::fmu::{Files, assert_breaks, sound};

const EDITS: &[(&str, &str, &str)] = &[
    ("xml-malformed", "</ModelStructure>", ""),
    ("xml-malformed", "name=\"rate\"", "name=\"rate\" name=\"rate\""),
    ("xml-malformed", "a &lt; b", "a &nonsense; b"),
    ("xml-encoding", "encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\""),
    ("xml-encoding", " encoding=\"UTF-8\"", ""),
    ("xml-encoding", "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", ""),
    ("xml-dtd", "<fmiModelDescription", "<!DOCTYPE a [<!ENTITY b \"c\">]><fmiModelDescription"),
    ("fmi-version", "fmiVersion=\"2.0\"", "fmiVersion=\"2.0.4\""),
    ("fmi-version", "fmiVersion=\"2.0\"", "fmiVersion=\"3.0\""),
    ("xml-element", "<LogCategories>", "<LogCategory/><LogCategories>"),
    ("xml-element", "<Real/>", "<Annotations><Tool name=\"a\"/></Annotations><Real/>"),
    ("xml-element", "<Real/>", "<Real/><Real/>"),
    ("xml-element", "<Real/>", "<Real>1</Real>"),
    ("attribute-unknown", "<Real/>", "<Real colour=\"red\"/>"),
    ("attribute-missing", "modelName=\"decay\" ", ""),
    (
        "attribute-value",
        "canGetAndSetFMUstate=\"true\"",
        "canGetAndSetFMUstate=\"true\" canInterpolateInputs=\"yes\"",
    ),
    ("attribute-value", "factor=\"1000\"", "factor=\"1,000\""),
    ("attribute-value", "causality=\"independent\"", "causality=\"none\""),
    ("not-finite", "max=\"5\"", "max=\"INF\""),
    ("not-finite", "factor=\"1000\"", "factor=\"1e999\""),
    ("guid-empty", "guid=\"{4c1c4b2e-58d6-4c25-8b0e-2f0a3f1f6f11}\"", "guid=\"\""),
    ("generation-date", "23:59:59Z", "23:59:59+01:00"),
    ("generation-date", "23:59:59Z", "23:59:59"),
    ("attribute-value", "2024-12-31T", "2024-13-31T"),
    ("tool-duplicate", "<Tool name=\"a tool\">", "<Tool name=\"a tool\"/><Tool name=\"a tool\">"),
    ("capability-flags", "canGetAndSetFMUstate=\"true\" ", ""),
    ("source-file-missing", "\"decay.c\"", "\"other.c\""),
    ("default-experiment", "stopTime=\"1\"", "stopTime=\"0\""),
    ("default-experiment", "stepSize=\"0.0625\"", "stepSize=\"0\""),
    ("default-experiment", "tolerance=\"1e-6\"", "tolerance=\"-1e-6\""),
    ("category-duplicate", "logStatusError", "logAll"),
    ("unit-duplicate", "<Unit name=\"m/s\">", "<Unit name=\"m\"/><Unit name=\"m/s\">"),
    ("unit-undeclared", "<Real start=\"0.25\"", "<Real unit=\"1/s\" start=\"0.25\""),
    (
        "display-unit-undeclared",
        "<Real unit=\"m\" displayUnit=\"mm\"/>",
        "<Real unit=\"m\" displayUnit=\"cm\"/>",
    ),
    (
        "display-unit-without-unit",
        "<Real start=\"0.25\"",
        "<Real displayUnit=\"mm\" start=\"0.25\"",
    ),
    (
        "type-duplicate",
        "<SimpleType name=\"Mode\">",
        "<SimpleType name=\"Mode\"><Boolean/></SimpleType><SimpleType name=\"Mode\">",
    ),
    ("type-undeclared", "<String start", "<String declaredType=\"Label\" start"),
    ("type-kind", "<String start", "<String declaredType=\"Length\" start"),
    ("type-name", "name=\"position\"", "name=\"Length\""),
    ("enumeration", "name=\"on\" value=\"2\"", "name=\"off\" value=\"2\""),
    ("enumeration", "name=\"off\" value=\"1\"", "name=\"off\" value=\"2\""),
    ("name-duplicate", "name=\"position\"", "name=\"x\""),
    ("name-structured", "name=\"module[1].u\"", "name=\"module 1.u\""),
    (
        "causality-variability",
        "name=\"count\" valueReference=\"0\" causality=\"output\" variability=\"discrete\"",
        "name=\"count\" valueReference=\"0\" causality=\"output\" variability=\"fixed\"",
    ),
    (
        "causality-variability",
        "causality=\"input\" variability=\"continuous\"",
        "causality=\"input\" variability=\"continuous\" initial=\"exact\"",
    ),
    (
        "causality-variability",
        "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
        "causality=\"parameter\" variability=\"discrete\" initial=\"exact\"",
    ),
    (
        "continuous-not-real",
        "name=\"count\" valueReference=\"0\" causality=\"output\" variability=\"discrete\"",
        "name=\"count\" valueReference=\"0\" causality=\"output\"",
    ),
    (
        "independent-variable",
        "name=\"position\" valueReference=\"1\"",
        "name=\"position\" valueReference=\"1\" causality=\"independent\"",
    ),
    ("start-missing", " start=\"1.5\"", ""),
    ("start-missing", "<String start=\"a &lt; b\"/>", "<String/>"),
    (
        "start-forbidden",
        "<Real declaredType=\"Length\"/>",
        "<Real declaredType=\"Length\" start=\"1\"/>",
    ),
    ("start-forbidden", "<Real/>", "<Real start=\"0\"/>"),
    ("start-outside-bounds", "start=\"1.5\"", "start=\"5.5\""),
    ("start-outside-bounds", "start=\"1.5\"", "start=\"-0.1\""),
    (
        "start-outside-bounds",
        "<Enumeration declaredType=\"Mode\" start=\"2\"/>",
        "<Enumeration declaredType=\"Mode\" start=\"3\"/>",
    ),
    (
        "start-outside-bounds",
        "<Real unit=\"m\" min=\"0\" max=\"5\" start=\"1.5\"/>",
        "<Real declaredType=\"Length\" start=\"11\"/>",
    ),
    ("bounds-order", "min=\"0\" max=\"5\"", "min=\"5\" max=\"0\""),
    ("bounds-order", "min=\"-10\" max=\"10\"", "min=\"10\" max=\"-10\""),
    ("nominal-value", "nominal=\"0.5\"", "nominal=\"0\""),
    (
        "alias-settable",
        "name=\"rate\" valueReference=\"4\" causality=\"parameter\" variability=\"tunable\" initial=\"exact\">\n      <Real start",
        "name=\"rate\" valueReference=\"3\" causality=\"parameter\" variability=\"tunable\" initial=\"exact\">\n      <Real unit=\"m\" start",
    ),
    // What can be set, and the independent variable.
    ("alias-settable", "name=\"time\" valueReference=\"0\"", "name=\"time\" valueReference=\"4\""),
    (
        "alias-constant",
        "name=\"position\" valueReference=\"1\">\n      <Real unit=\"m\" displayUnit=\"mm\"/>",
        "name=\"position\" valueReference=\"5\">\n      <Real/>",
    ),
    ("alias-constant", "name=\"rate\" valueReference=\"4\"", "name=\"rate\" valueReference=\"5\""),
    ("alias-unit", "<Real unit=\"m\" displayUnit=\"mm\"/>", "<Real/>"),
    ("alias-unit", "<Real unit=\"m\" displayUnit=\"mm\"/>", "<Real unit=\"m/s\"/>"),
    (
        "alias-start",
        "name=\"g\" valueReference=\"5\" variability=\"constant\" initial=\"exact\">\n      <Real start=\"9.81\"/>",
        "name=\"g\" valueReference=\"5\" variability=\"constant\" initial=\"exact\">\n      <Real start=\"9.8\"/>",
    ),
    (
        "derivative-index",
        "<Real unit=\"m/s\" derivative=\"2\"/>",
        "<Real unit=\"m/s\" derivative=\"99\"/>",
    ),
    (
        "derivative-index",
        "<Real unit=\"m/s\" derivative=\"2\"/>",
        "<Real unit=\"m/s\" derivative=\"3\"/>",
    ),
    (
        "reinit",
        "<Real declaredType=\"Length\"/>",
        "<Real declaredType=\"Length\" reinit=\"true\"/>",
    ),
    (
        "multiple-set",
        "causality=\"input\" variability=\"continuous\"",
        "causality=\"input\" variability=\"continuous\" canHandleMultipleSetPerTimeInstant=\"false\"",
    ),
    (
        "unknown-index",
        "<Unknown index=\"8\" dependencies=\"\"/>",
        "<Unknown index=\"8\"/><Unknown index=\"13\"/>",
    ),
    (
        "unknown-index",
        "<Unknown index=\"8\" dependencies=\"\"/>",
        "<Unknown index=\"8\"/><Unknown index=\"8\"/>",
    ),
    ("outputs-list", "      <Unknown index=\"8\" dependencies=\"\"/>\n", ""),
    (
        "outputs-list",
        "<Unknown index=\"8\" dependencies=\"\"/>",
        "<Unknown index=\"8\"/><Unknown index=\"10\"/>",
    ),
    (
        "initial-unknowns-list",
        "      <Unknown index=\"6\"/>\n      <Unknown index=\"8\"/>\n",
        "      <Unknown index=\"8\"/>\n",
    ),
    (
        "initial-unknowns-list",
        "      <Unknown index=\"3\"/>\n",
        "      <Unknown index=\"3\"/><Unknown index=\"4\"/>\n",
    ),
    (
        "initial-unknowns-order",
        "      <Unknown index=\"2\"/>\n      <Unknown index=\"3\"/>\n",
        "      <Unknown index=\"3\"/>\n      <Unknown index=\"2\"/>\n",
    ),
    ("dependencies-index", "dependencies=\"2\"", "dependencies=\"0\""),
    // An output that cannot be a state.
    ("dependencies-known", "dependencies=\"\"", "dependencies=\"6\""),
    // At the start, a variable that is computed.
    (
        "dependencies-known",
        "      <Unknown index=\"3\"/>\n",
        "      <Unknown index=\"3\" dependencies=\"2\"/>\n",
    ),
    (
        "dependencies-order",
        "dependencies=\"4 5\" dependenciesKind=\"dependent constant\"",
        "dependencies=\"5 4\"",
    ),
    // Only Real unknowns depend in a particular way.
    (
        "dependencies-kind",
        "<Unknown index=\"8\" dependencies=\"\"/>",
        "<Unknown index=\"8\" dependencies=\"4\" dependenciesKind=\"constant\"/>",
    ),
    (
        "dependencies-kind",
        "dependenciesKind=\"dependent constant\"",
        "dependenciesKind=\"dependent\"",
    ),
    ("dependencies-kind", "dependencies=\"2\"", "dependenciesKind=\"constant\""),
    ("library-missing", "modelIdentifier=\"decay\"", "modelIdentifier=\"decline\""),
    ("model-identifier", "modelIdentifier=\"decay\"", "modelIdentifier=\"my-decay\""),
];

#[test]
fn each_fault_of_a_model_description_is_found_by_its_rule_alone() {
    for (rule, from, to) in EDITS {
        assert_breaks(rule, &sound().edit(from, to).pack(), &["--no-run"]);
    }
}

#[test]
fn elements_of_arrays_follow_each_other_in_order() {
    let named = |names: [&str; 3]| {
        let mut files = sound();
        for (old, new) in ["position", "gravity", "g"].iter().zip(names) {
            files = files.edit(&format!("name=\"{old}\""), &format!("name=\"{new}\""));
        }
        files
    };
    for names in [["a[1]", "b", "a[2]"], ["a[2]", "a[1]", "b"], ["a[1,2]", "a[1,10]", "a[1,3]"]] {
        assert_breaks("array-order", &named(names).pack(), &["--no-run"]);
    }
    for names in [["a[0]", "a[1]", "a[10]"], ["a[1].x", "b", "a[2].x"], ["a[1,2]", "a[2,1]", "b"]] {
        assert_eq!(super::fmu::check(&named(names).pack(), &["--no-run"]).1, "");
    }
}

#[test]
fn an_fmu_for_model_exchange_may_tell_what_only_that_knows() {
    let both = sound()
        .edit("  <CoSimulation", "  <ModelExchange modelIdentifier=\"decay\"/>\n  <CoSimulation");
    let (state, input) =
        ("<Real declaredType=\"Length\"/>", "causality=\"input\" variability=\"continuous\"");
    let sound = both
        .clone()
        .edit(state, "<Real declaredType=\"Length\" reinit=\"true\"/>")
        .edit(input, &format!("{input} canHandleMultipleSetPerTimeInstant=\"false\""));
    assert_eq!(super::fmu::check(&sound.pack(), &["--no-run"]).1, "");
    let position = "<Real unit=\"m\" displayUnit=\"mm\"/>";
    let local = both.clone().edit(position, &position.replace("/>", " reinit=\"false\"/>"));
    assert_breaks("reinit", &local.pack(), &["--no-run"]);
    let parameter = "causality=\"parameter\" variability=\"tunable\"";
    let other = both
        .clone()
        .edit(parameter, &format!("{parameter} canHandleMultipleSetPerTimeInstant=\"true\""));
    assert_breaks("multiple-set", &other.pack(), &["--no-run"]);
    // With model exchange, its states and derivatives are unknowns at the start.
    let lacking = both.edit("      <Unknown index=\"3\"/>\n", "");
    assert_breaks("initial-unknowns-list", &lacking.pack(), &["--no-run"]);
}

#[test]
fn derivatives_that_co_simulation_ignores_need_not_be_initial_unknowns() {
    let derivative = "      <Unknown index=\"3\"/>\n";
    assert_eq!(super::fmu::check(&sound().edit(derivative, "").pack(), &["--no-run"]).1, "");
    let used = with_derivatives().edit(derivative, "");
    assert_breaks("initial-unknowns-list", &used.pack(), &["--no-run"]);
}

#[test]
fn where_the_text_and_the_schema_differ_there_is_a_hint() {
    let unknown = "      <Unknown index=\"3\"/>\n";
    let fixed = unknown.replace("/>", " dependencies=\"4\" dependenciesKind=\"fixed\"/>");
    let (code, printed) = super::fmu::check(&sound().edit(unknown, &fixed).pack(), &["--no-run"]);
    assert!(code == 0 && printed.starts_with("hint: dependencies-kind "), "{printed}");
}

#[test]
fn states_that_are_not_told_may_be_depended_on() {
    let derivatives =
        "    <Derivatives>\n      <Unknown index=\"3\" dependencies=\"2\"/>\n    </Derivatives>\n";
    let untold = sound()
        .edit(derivatives, "")
        .edit("      <Unknown index=\"3\"/>\n", "")
        .edit("dependencies=\"\"", "dependencies=\"10\"");
    assert_eq!(super::fmu::check(&untold.pack(), &["--no-run"]).1, "");
}

/// The sound FMU, whose list of derivatives has a meaning.
fn with_derivatives() -> Files {
    let flag = "canHandleVariableCommunicationStepSize=\"true\"";
    sound().edit(flag, &format!("{flag} providesDirectionalDerivative=\"true\""))
}

#[test]
fn states_are_what_the_list_of_derivatives_says() {
    let parameter = with_derivatives().edit("derivative=\"2\"", "derivative=\"5\"").edit(
        "<Unknown index=\"3\" dependencies=\"2\"/>",
        "<Unknown index=\"3\" dependencies=\"5\"/>",
    );
    assert_breaks("state-causality", &parameter.pack(), &["--no-run"]);
    let local = with_derivatives().edit("dependencies=\"\"", "dependencies=\"10\"");
    assert_breaks("dependencies-known", &local.pack(), &["--no-run"]);
    // Where the list is ignored, the local variable may be a state.
    let local = sound().edit("dependencies=\"\"", "dependencies=\"10\"");
    assert_eq!(super::fmu::check(&local.pack(), &["--no-run"]).1, "");
}

#[test]
fn a_finding_says_the_line() {
    let printed = assert_breaks(
        "start-outside-bounds",
        &sound().edit("start=\"1.5\"", "start=\"9\"").pack(),
        &["--no-run"],
    );
    assert!(
        printed.starts_with("violation: start-outside-bounds modelDescription.xml:49: "),
        "{printed}"
    );
}

#[test]
fn names_without_a_convention_may_be_anything_but_lines() {
    let flat = sound()
        .edit("variableNamingConvention=\"structured\"", "variableNamingConvention=\"flat\"");
    let odd = flat.clone().edit("\"module[1].u\"", "\"module 1: u\"");
    assert_eq!(super::fmu::check(&odd.pack(), &["--no-run"]).1, "");
    assert_breaks("name-flat", &flat.edit("\"module[1].u\"", "\"u&#10;v\"").pack(), &["--no-run"]);
}

#[test]
fn xml_without_an_end_in_sight_is_not_read_further() {
    let deep = format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000));
    assert_breaks("xml-limits", &sound().edit("<Real/>", &deep).pack(), &["--no-run"]);
}

#[test]
fn an_element_has_no_endless_attributes() {
    let many: String = (0..300).map(|number| format!(" a{number}=\"\"")).collect();
    assert_breaks(
        "xml-limits",
        &sound().edit("<Real/>", &format!("<Real{many}/>")).pack(),
        &["--no-run"],
    );
}

#[test]
fn one_value_may_be_written_in_two_ways() {
    let written = "<Real start=\"9.81\"/>\n    </ScalarVariable>\n  </ModelVariables>";
    let fmu = sound().edit(written, &written.replace("9.81", "+9.810"));
    assert_eq!(super::fmu::check(&fmu.pack(), &["--no-run"]).1, "");
}

#[test]
fn bytes_that_are_no_text_are_told() {
    let mut files = sound();
    let xml = &mut files.0[0].1;
    let at = xml.windows(5).position(|bytes| bytes == b"decay").unwrap();
    xml[at] = 0xff;
    assert_breaks("xml-encoding", &files.pack(), &["--no-run"]);
}

#[test]
fn a_model_for_model_exchange_alone_is_no_fault() {
    let exchange = sound()
        .edit("<CoSimulation", "<ModelExchange")
        .edit("</CoSimulation>", "</ModelExchange>")
        .edit("canHandleVariableCommunicationStepSize=\"true\" ", "");
    let (code, printed) = super::fmu::check(&exchange.pack(), &[]);
    assert_eq!(
        (code, printed.as_str()),
        (0, "note: modelDescription.xml has no CoSimulation element: libraries are not examined\n")
    );
}

#[test]
fn derivatives_are_derivatives_where_the_list_of_them_counts() {
    let listed = "<Unknown index=\"3\" dependencies=\"2\"/>";
    let wrong = sound().edit(listed, "<Unknown index=\"3\"/><Unknown index=\"4\"/>");
    // FMI 2.0, section 2.2.8, has the list ignored unless directional derivatives are provided.
    assert_eq!(super::fmu::check(&wrong.pack(), &["--no-run"]), (0, String::new()));
    let flag = "<CoSimulation providesDirectionalDerivative=\"true\" ";
    let counts = wrong.edit("<CoSimulation ", flag);
    assert_breaks("derivatives-list", &counts.pack(), &["--no-run"]);
}

#[test]
fn a_dependency_on_a_fixed_parameter_is_a_hint() {
    let fmu = sound().edit("dependencies=\"4 5\"", "dependencies=\"4 7\"").pack();
    let (code, printed) = super::fmu::check(&fmu, &["--no-run"]);
    assert_eq!(code, 0, "{printed}");
    assert!(printed.starts_with("hint: dependencies-known "), "{printed}");
}
