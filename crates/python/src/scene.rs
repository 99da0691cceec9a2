//! Scenes as Python has them: a file's text, values that were changed, and a choice of method and step.

use crate::errors::raised;
use amontons::scene::{BUILTIN, IntegratorChoice, Method, Preset, Source, named};
use amontons::selection::resolve;
use amontons::simulation::catalogue::{Causality, Kind};
use amontons::simulation::variables;
use amontons_analysis::assign::{assign, value_of};
use amontons_analysis::doubts::doubts_of;
use amontons_analysis::stability::Linearised;
use amontons_export::scene as files;
use amontons_pictures::picture::Structure;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use std::path::PathBuf;
use std::sync::OnceLock;

/// The internal step among the variables; here it is a part of the choice of method and step.
const STEP: &str = "integrator.step";

/// A scene, which never changes.
#[pyclass(frozen, module = "amontons._core")]
pub struct Scene {
    /// The scene with all values.
    pub scene: amontons::scene::Scene,
    /// Its files, in which no values are changed.
    pub source: Source,
    /// Values that were changed, each once, in the order in which they were changed last.
    pub values: Vec<(String, f64)>,
    /// Method, step and preset that were chosen in place of those of the file.
    pub integrator: IntegratorChoice,
    linearised: OnceLock<Linearised>,
}

impl Scene {
    fn new((scene, source): (amontons::scene::Scene, Source)) -> Self {
        Self {
            scene,
            source,
            values: Vec::new(),
            integrator: IntegratorChoice::default(),
            linearised: OnceLock::new(),
        }
    }

    /// The scene with the method and step that its tolerance chooses, if it has one.
    pub fn resolved(&self) -> amontons::scene::Scene {
        let mut scene = self.scene.clone();
        resolve(&mut scene);
        scene
    }

    /// The scene as eigenvalues need it.
    pub fn linearised(&self) -> &Linearised {
        self.linearised.get_or_init(|| Linearised::of(&self.scene))
    }
}

#[pymethods]
impl Scene {
    #[staticmethod]
    fn builtin(name: &str) -> PyResult<Self> {
        let builtin = named(name).map_err(raised)?;
        Ok(Self::new((builtin.scene(), builtin.text.into())))
    }

    #[staticmethod]
    #[allow(clippy::needless_pass_by_value)]
    fn read(path: PathBuf) -> PyResult<Self> {
        files::read(&path).map(Self::new).map_err(raised)
    }

    #[staticmethod]
    fn from_toml(name: &str, text: &str) -> PyResult<Self> {
        let scene = files::parse(name, text).map_err(raised)?;
        Ok(Self::new((scene, text.into())))
    }

    /// The scene with other values of parameters, inputs and signals, given in their order.
    fn with_values(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut scene = self.scene.clone();
        let (mut known, mut integrator) = (self.values.clone(), self.integrator.clone());
        for (name, value) in values {
            assign(&mut scene, &name, value).map_err(raised)?;
            if name == STEP {
                integrator.step = Some(value);
                continue;
            }
            known.retain(|(other, _)| *other != name);
            known.push((name, value));
        }
        scene.check().map_err(raised)?;
        Ok(Self { values: known, integrator, ..Self::new((scene, self.source.clone())) })
    }

    /// The scene with another method, step or preset: names as in scene files.
    #[pyo3(signature = (method=None, step=None, preset=None))]
    fn with_integrator(
        &self,
        method: Option<&str>,
        step: Option<f64>,
        preset: Option<&str>,
    ) -> PyResult<Self> {
        let choice = choice(method, step, preset)?;
        let mut scene = self.scene.clone();
        choice.apply(&mut scene).and_then(|()| scene.check()).map_err(raised)?;
        let values = self.values.clone();
        let before = &self.integrator;
        let integrator = if choice.preset.is_some() || before.preset.is_some() {
            choice
        } else {
            let (method, step) = (choice.method.or(before.method), choice.step.or(before.step));
            IntegratorChoice { method, step, preset: None }
        };
        Ok(Self { values, integrator, ..Self::new((scene, self.source.clone())) })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.scene.name
    }

    #[getter]
    fn description(&self) -> &str {
        &self.scene.description
    }

    #[getter]
    fn text(&self) -> &str {
        &self.source.text
    }

    #[getter]
    fn tables(&self) -> Vec<(String, String)> {
        self.source.tables.clone()
    }

    /// Names and contents of the packed superelements.
    #[getter]
    fn binaries<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyBytes>)> {
        let packed = self.source.binaries.iter();
        packed.map(|(name, bytes)| (name.clone(), PyBytes::new(py, bytes))).collect()
    }

    #[getter]
    fn values(&self) -> Vec<(String, f64)> {
        self.values.clone()
    }

    /// Method, step and preset that were chosen in place of the file's.
    #[getter]
    fn integrator(&self) -> (Option<&'static str>, Option<f64>, Option<&'static str>) {
        let IntegratorChoice { method, step, preset } = self.integrator;
        (method.map(Method::name), step, preset.map(Preset::name))
    }

    /// Method and step (s) of runs; those that a tolerance chooses, where one does.
    fn pace(&self, py: Python<'_>) -> (&'static str, f64) {
        let scene = py.detach(|| self.resolved());
        (scene.method.name(), scene.step)
    }

    #[getter]
    fn contact_count(&self) -> usize {
        self.scene.contact_count()
    }

    #[getter]
    fn dof_names(&self) -> Vec<String> {
        self.scene.dof_names()
    }

    #[getter]
    fn contact_names(&self) -> Vec<String> {
        (0..self.scene.contact_count()).map(|contact| self.scene.contact_name(contact)).collect()
    }

    /// Values that are possible, but hardly meant, each as a sentence.
    #[getter]
    fn doubts(&self) -> Vec<String> {
        doubts_of(&self.scene)
    }

    /// The value of a parameter, an input or a signal.
    fn value(&self, name: &str) -> PyResult<f64> {
        value_of(&self.scene, name).map_err(raised)
    }

    /// All variables: name, causality, type, unit, description, and the value of those that can be set.
    fn variables<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyTuple>>> {
        let parameters = amontons::simulation::Parameters::of(self.scene.clone());
        variables(&self.scene)
            .into_iter()
            .map(|variable| {
                let value = parameters.get(&variable);
                let causality = match variable.causality {
                    Causality::Input => "input",
                    Causality::Output => "output",
                    Causality::Parameter => "parameter",
                };
                let (kind, unit) = match variable.template.kind {
                    Kind::Real { unit, .. } => ("Real", unit),
                    Kind::Integer => ("Integer", "1"),
                    Kind::Boolean => ("Boolean", "1"),
                    Kind::Enumeration { .. } => ("Enumeration", "1"),
                };
                let description = variable.template.description;
                (variable.name, causality, kind, unit, description, value).into_pyobject(py)
            })
            .collect()
    }

    /// The drawing of the scene as the text of an SVG.
    fn svg(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| Structure::from(&self.scene).svg()).map_err(raised)
    }

    /// Writes the drawing of the scene; the path's ending, .svg or .png, chooses the format.
    #[allow(clippy::needless_pass_by_value)]
    fn draw(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| Structure::from(&self.scene).write(&path)).map_err(raised)
    }
}

/// The choice of method, step and preset by their names.
fn choice(
    method: Option<&str>,
    step: Option<f64>,
    preset: Option<&str>,
) -> PyResult<IntegratorChoice> {
    let wrong = |what: &str, name: &str, names: &[&str]| {
        raised(amontons::Error::argument(format!(
            "there is no {what} {name}; there are {}",
            names.join(", ")
        )))
    };
    let method = method
        .map(|name| {
            Method::ALL
                .into_iter()
                .find(|method| method.name() == name)
                .ok_or_else(|| wrong("integrator", name, &Method::ALL.map(Method::name)))
        })
        .transpose()?;
    let preset = preset
        .map(|name| {
            Preset::ALL
                .into_iter()
                .find(|preset| preset.name() == name)
                .ok_or_else(|| wrong("preset", name, &Preset::ALL.map(Preset::name)))
        })
        .transpose()?;
    if let Some(step) = step.filter(|step| !(step.is_finite() && *step > 0.0)) {
        let error = format!("a step of {step:?} s is impossible; give a number above zero");
        return Err(raised(amontons::Error::argument(error)));
    }
    if preset.is_some() && (method.is_some() || step.is_some()) {
        let error = "a preset chooses both integrator and step; give either a preset or these";
        return Err(raised(amontons::Error::argument(error)));
    }
    Ok(IntegratorChoice { method, step, preset })
}

/// Names of the built-in scenes.
#[pyfunction]
pub fn builtin_names() -> Vec<&'static str> {
    BUILTIN.iter().map(|builtin| builtin.name).collect()
}
