//! The Python module in a Python interpreter: runs the tests in `tests/test_*.py`, one test here for each file there; and
//! the wheel of a release.

#[path = "../../../tests/support/python/mod.rs"]
mod python;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The folder in which Cargo puts programs and libraries of this build.
fn build() -> PathBuf {
    let test = std::env::current_exe().expect("a test has a path");
    test.ancestors().nth(2).expect("it is in a folder of that").to_owned()
}

/// The path of a program of this build, which is built where it is missing: only tests of the whole workspace build it.
fn program(name: &str) -> PathBuf {
    let path = build().join(name);
    if !path.exists() {
        let cargo = ["build", "--release", "--package", "amontons-cli", "--bins"];
        succeed(Command::new(env!("CARGO")).args(cargo).current_dir(ROOT));
    }
    path
}

/// The compiled part of the module.
fn compiled() -> PathBuf {
    build().join("deps").join("lib_core.so")
}

/// A folder with the package as pip would install it: the Python sources and the compiled part.
fn package() -> &'static Path {
    static PACKAGE: OnceLock<PathBuf> = OnceLock::new();
    PACKAGE.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("python-module");
        let package = folder.join("amontons");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&package).unwrap();
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/amontons");
        for file in std::fs::read_dir(sources).unwrap().map(|file| file.unwrap().path()) {
            // A compiled part among the sources is of another build.
            if file.is_file() && file.extension().is_some_and(|end| end != "so") {
                std::fs::copy(&file, package.join(file.file_name().unwrap())).unwrap();
            }
        }
        std::fs::copy(compiled(), package.join("_core.abi3.so")).unwrap();
        folder
    })
}

/// Runs the tests of one Python file; pytest's report is the message of a failure.
fn pytest(file: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let scratch = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder can be made there");
    let mut pytest = Command::new(python::interpreter());
    pytest
        // No bytecode and no cache: the tests leave nothing among the sources.
        .args(["-B", "-m", "pytest", "-p", "no:cacheprovider", "--strict-markers", "--tb=short"])
        .arg("--rootdir")
        .arg(&folder)
        .arg("--basetemp")
        .arg(scratch.path().join("pytest"))
        .arg(folder.join(file))
        .env("PYTHONPATH", package())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("AMONTONS_PROGRAMS", program("amontons").parent().expect("it is in a folder"))
        // Packages may bring plugins of their own.
        .env("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
        .env_remove("PYTEST_ADDOPTS");
    succeed(&mut pytest);
}

/// Runs a command to its end; what it prints is the message of a failure.
fn succeed(command: &mut Command) {
    let Output { status, stdout, stderr } = command.output().expect("the command can be run");
    let [stdout, stderr] = [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(status.success(), "{command:?}: {status}\n{stdout}{stderr}");
}

macro_rules! files {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                pytest(concat!(stringify!($name), ".py"));
            }
        )*

        /// A Python file that is not named above would never run.
        #[test]
        fn every_python_file_is_run() {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
            let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name());
            let named = files.filter_map(|name| {
                let name = name.into_string().unwrap();
                name.strip_suffix(".py").filter(|name| name.starts_with("test_")).map(str::to_owned)
            });
            let mut found: Vec<String> = named.collect();
            found.sort();
            let named: &[&str] = &[$(stringify!($name)),*];
            assert_eq!(found, named);
        }
    };
}

files! {
    test_book
    test_clusters
    test_design
    test_executors
    test_interrupts
    test_misuse
    test_package
    test_robustness
    test_runs
    test_scenes
    test_stability
}

#[test]
#[ignore = "makes a Python environment"]
fn a_wheel_has_the_module_and_the_programs_and_the_same_bytes_whenever_it_is_packed() {
    let folder = TempDir::new_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder can be made there");
    let programs = ["amontons", "amontons-stability"].map(program);
    // By the release's own code, of the programs and the module that are there.
    let pack = |target: &str| {
        let [amontons, stability] = &programs;
        let module = compiled();
        let code = format!(
            "import archives, pathlib\narchives.wheel([pathlib.Path(p) for p in ({amontons:?}, {stability:?})], \
             pathlib.Path({module:?}), 'manylinux_2_17_x86_64', 'licences of others')"
        );
        let target = folder.path().join(target);
        succeed(
            Command::new("python3")
                .args(["-B", "-c", &code])
                .current_dir(format!("{ROOT}/release"))
                .env("CARGO_TARGET_DIR", &target)
                .env("SOURCE_DATE_EPOCH", "1700000000"),
        );
        let version = env!("CARGO_PKG_VERSION");
        let name = format!("amontons-{version}-cp310-abi3-manylinux_2_17_x86_64.whl");
        target.join("release-packages").join(name)
    };
    let wheel = pack("one");
    assert!(std::fs::read(&wheel).unwrap() == std::fs::read(pack("other")).unwrap());

    let environment = folder.path().join("environment");
    succeed(Command::new("python3").args(["-m", "venv"]).arg(&environment));
    let bin = environment.join("bin");
    // NumPy, which the wheel asks for, is not on every machine; without it no array can be made.
    let pip = ["-m", "pip", "install", "--quiet", "--no-index", "--no-deps"];
    succeed(Command::new(bin.join("python")).args(pip).arg(wheel));
    let fmu = |name: &str| folder.path().join(name);
    let code =
        format!("import amontons; amontons.Scene.builtin('set1').export({:?})", fmu("module.fmu"));
    succeed(Command::new(bin.join("python")).args(["-I", "-c", &code]));
    let export = ["export", "set1", "-o"];
    succeed(Command::new(bin.join("amontons")).args(export).arg(fmu("installed.fmu")));
    succeed(Command::new(&programs[0]).args(export).arg(fmu("here.fmu")));
    let here = std::fs::read(fmu("here.fmu")).unwrap();
    for name in ["module.fmu", "installed.fmu"] {
        assert!(std::fs::read(fmu(name)).unwrap() == here, "{name}");
    }
    succeed(Command::new(bin.join("amontons-stability")).arg("--version"));
}
