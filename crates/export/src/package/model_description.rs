//! `modelDescription.xml` (FMI 2.0.4, section 2.2), elements in the order of the schema.

use crate::feedthrough::feedthrough;
use amontons::fmi2::{CATEGORIES, STRICT};
use amontons::scene::{Scene, Selection, Source};
use amontons::simulation::catalogue::{
    Causality, ENUMERATIONS, Kind, Template, UNITS, Variability, Variable, fmu_variables,
};
use amontons::simulation::{Parameters, fingerprint};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};

/// License of the contents of the FMU; the scene is its author's.
const LICENSE: &str =
    "MIT OR Apache-2.0; licence texts, also of linked libraries, in documentation/licenses";

/// The name of the model as a C identifier, which the library's file must have too.
#[must_use]
pub fn identifier(name: &str) -> String {
    let mut identifier: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !identifier.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        identifier.insert(0, '_');
    }
    identifier
}

/// The model description of a scene; `source` is what it was read from, word for word;
/// `date` is when it is made, as XML Schema writes a time in UTC.
#[must_use]
pub fn model_description(scene: &Scene, source: &Source, date: Option<&str>) -> String {
    let mut xml = Xml(Writer::new_with_indent(Vec::new(), b' ', 2));
    let variables = fmu_variables(scene);
    let mut root = vec![
        ("fmiVersion", "2.0".to_owned()),
        ("modelName", scene.name.clone()),
        ("guid", fingerprint(source)),
        ("description", scene.description.clone()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("license", LICENSE.to_owned()),
        ("generationTool", concat!("Amontons ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("variableNamingConvention", "structured".to_owned()),
        ("numberOfEventIndicators", "0".to_owned()),
    ];
    if let Some(date) = date {
        root.insert(7, ("generationDateAndTime", date.to_owned()));
    }
    xml.declaration();
    xml.nest("fmiModelDescription", &root, |xml| {
        xml.empty(
            "CoSimulation",
            &[
                ("modelIdentifier", identifier(&scene.name)),
                ("canHandleVariableCommunicationStepSize", "true".to_owned()),
                ("canInterpolateInputs", "true".to_owned()),
                ("maxOutputDerivativeOrder", "1".to_owned()),
                ("canNotUseMemoryManagementFunctions", "true".to_owned()),
                ("canGetAndSetFMUstate", "true".to_owned()),
                ("canSerializeFMUstate", "true".to_owned()),
                ("providesDirectionalDerivative", "true".to_owned()),
            ],
        );
        units(xml);
        types(xml);
        xml.nest("LogCategories", &[], |xml| {
            for (name, description) in CATEGORIES {
                let attributes =
                    [("name", name.to_owned()), ("description", description.to_owned())];
                xml.empty("Category", &attributes);
            }
        });
        let mut experiment = vec![
            ("startTime", "0".to_owned()),
            ("stopTime", number(scene.experiment.stop_time)),
            ("stepSize", number(scene.experiment.output_interval)),
        ];
        // Some importers pass it on by themselves: only where it would change something.
        if let Selection::Auto { tolerance } = scene.selection {
            experiment.insert(2, ("tolerance", number(tolerance)));
        }
        xml.empty("DefaultExperiment", &experiment);
        let parameters = Parameters::of(scene.clone());
        xml.nest("ModelVariables", &[], |xml| {
            for (reference, variable) in variables.iter().enumerate() {
                scalar_variable(xml, parameters.get(variable), reference, variable);
            }
        });
        structure(xml, scene, &variables);
    });
    xml.finish()
}

fn units(xml: &mut Xml) {
    xml.nest("UnitDefinitions", &[], |xml| {
        for unit in UNITS {
            xml.nest("Unit", &[("name", unit.name.to_owned())], |xml| {
                let exponents: Vec<_> =
                    unit.exponents.iter().map(|&(base, power)| (base, power.to_string())).collect();
                xml.empty("BaseUnit", &exponents);
            });
        }
    });
}

fn types(xml: &mut Xml) {
    xml.nest("TypeDefinitions", &[], |xml| {
        for enumeration in ENUMERATIONS {
            let attributes = [
                ("name", enumeration.name.to_owned()),
                ("description", enumeration.description.to_owned()),
            ];
            xml.nest("SimpleType", &attributes, |xml| {
                xml.nest("Enumeration", &[], |xml| {
                    for (value, (name, description)) in (1..).zip(enumeration.items) {
                        let attributes = [
                            ("name", (*name).to_owned()),
                            ("value", i32::to_string(&value)),
                            ("description", (*description).to_owned()),
                        ];
                        xml.empty("Item", &attributes);
                    }
                });
            });
        }
    });
}

fn scalar_variable(xml: &mut Xml, start: Option<f64>, reference: usize, variable: &Variable) {
    let Template { kind, description, .. } = *variable.template;
    let (causality, initial) = match variable.causality {
        Causality::Input => ("input", None),
        Causality::Output => ("output", Some("calculated")),
        Causality::Parameter => ("parameter", Some("exact")),
    };
    let variability = match variable.variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    };
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", description.to_owned()),
        ("causality", causality.to_owned()),
        ("variability", variability.to_owned()),
    ];
    attributes.extend(initial.map(|initial| ("initial", initial.to_owned())));
    xml.nest("ScalarVariable", &attributes, |xml| {
        let mut attributes = Vec::new();
        let element = match kind {
            Kind::Real { unit, min } => {
                attributes.push(("unit", unit.to_owned()));
                attributes.extend(min.map(|min| ("min", number(min))));
                "Real"
            }
            Kind::Integer => "Integer",
            Kind::Boolean => {
                // The only variable of this kind, which no scene has.
                attributes.push(("start", STRICT.to_string()));
                "Boolean"
            }
            Kind::Enumeration { name } => {
                attributes.push(("declaredType", name.to_owned()));
                "Enumeration"
            }
        };
        attributes.extend(start.map(|start| ("start", number(start))));
        xml.empty(element, &attributes);
    });
}

/// Every output with the inputs that act on it at once, and every one an unknown of the initialization that depends
/// on anything.
fn structure(xml: &mut Xml, scene: &Scene, variables: &[Variable]) {
    let is_output = |(_, variable): &(_, &Variable)| variable.causality == Causality::Output;
    let outputs: Vec<(usize, &Variable)> = (1..).zip(variables).filter(is_output).collect();
    let index = |place: usize| ("index", place.to_string());
    xml.nest("ModelStructure", &[], |xml| {
        xml.nest("Outputs", &[], |xml| {
            for &(place, output) in &outputs {
                let mut attributes = vec![index(place)];
                if let Some(inputs) = feedthrough(scene, variables, output) {
                    let inputs: Vec<String> = inputs.iter().map(|i| (i + 1).to_string()).collect();
                    attributes.push(("dependencies", inputs.join(" ")));
                }
                xml.empty("Unknown", &attributes);
            }
        });
        xml.nest("InitialUnknowns", &[], |xml| {
            for &(place, _) in &outputs {
                xml.empty("Unknown", &[index(place)]);
            }
        });
    });
}

/// The shortest decimal that reads back as the same double.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// An XML writer into memory, which cannot fail.
struct Xml(Writer<Vec<u8>>);

impl Xml {
    fn declaration(&mut self) {
        self.write(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
    }

    fn empty(&mut self, name: &str, attributes: &[(&str, String)]) {
        self.write(Event::Empty(start(name, attributes)));
    }

    fn nest(&mut self, name: &str, attributes: &[(&str, String)], content: impl FnOnce(&mut Self)) {
        self.write(Event::Start(start(name, attributes)));
        content(self);
        self.write(Event::End(BytesEnd::new(name)));
    }

    fn write(&mut self, event: Event<'_>) {
        self.0.write_event(event).expect("a vector takes all bytes");
    }

    fn finish(self) -> String {
        let mut text = String::from_utf8(self.0.into_inner()).expect("only text was written");
        text.push('\n');
        text
    }
}

/// A start tag; characters that XML 1.0 cannot hold at all are left out of the values.
fn start<'a>(name: &'a str, attributes: &[(&str, String)]) -> BytesStart<'a> {
    let possible = |c: &char| {
        matches!(c, '\t' | '\n' | '\r') || !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'))
    };
    let mut start = BytesStart::new(name);
    for (key, value) in attributes {
        let value: String = value.chars().filter(possible).collect();
        start.push_attribute((*key, value.as_str()));
    }
    start
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_becomes_a_c_identifier() {
        assert_eq!(identifier("set1"), "set1");
        assert_eq!(identifier("my brake-2"), "my_brake_2");
        assert_eq!(identifier("12 rings"), "_12_rings");
        assert_eq!(identifier("é"), "_");
    }

    #[test]
    fn doubles_read_back_the_same() {
        for value in [0.1, 1e-300, 53.617e3, f64::MAX, 5e-324, -0.0] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }
}
