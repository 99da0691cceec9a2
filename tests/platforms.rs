//! On which platforms an FMU runs, and that a release runs where it says: the release itself is made, installed and
//! used, its Windows library through wine.
#![cfg(feature = "tools")]

mod program;
mod python;

use amontons::package::Library;
use program::{assert_refused, folder, run, text};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

const AMONTONS: &str = env!("CARGO_BIN_EXE_amontons");
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The platforms of an FMU, from the names of its files.
fn platforms(fmu: &Path) -> Vec<String> {
    let archive = zip::ZipArchive::new(File::open(fmu).unwrap()).unwrap();
    let mut names: Vec<String> = archive
        .file_names()
        .filter_map(|name| {
            Some(name.unwrap().strip_prefix("binaries/")?.split_once('/')?.0.to_owned())
        })
        .collect();
    names.sort();
    names
}

#[test]
fn a_platform_whose_library_is_not_carried_is_refused_with_a_way_to_get_it() {
    let folder = folder();
    let is_carried = |name: &str| Library::carried().iter().any(|one| one.platform == name);
    for platform in
        ["linux64", "win64", "darwin64", ""].into_iter().filter(|name| !is_carried(name))
    {
        for list in [platform.to_owned(), format!("{},{platform}", Library::carried()[0].platform)]
        {
            let output = run(AMONTONS, folder.path(), &["export", "set1", "--platform", &list]);
            let carried = Library::carried()[0].platform;
            assert_refused(&output, 2, &["--platform", "carries", carried, "release"]);
        }
    }
    assert!(!folder.path().join("set1.fmu").exists());
}

#[test]
fn an_fmu_has_the_platforms_asked_for_or_all_and_says_which() {
    let folder = folder();
    let all: Vec<&str> = Library::carried().iter().map(|library| library.platform).collect();
    let export = |more: &[&str]| {
        let output = run(AMONTONS, folder.path(), &[&["export", "set1"], more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let fmu = folder.path().join("set1.fmu");
        (text(&output.stdout), platforms(&fmu), fs::read(fmu).unwrap())
    };
    let (printed, found, bytes) = export(&[]);
    assert!(printed.contains(&format!("platform       {}\n", all.join(", "))), "{printed}");
    assert_eq!(found, all);
    // Neither order nor repetition is in the file.
    let backwards: Vec<&str> = all.iter().rev().chain(&all).copied().collect();
    assert_eq!(export(&["--platform", &backwards.join(",")]).2, bytes);
    assert_eq!(export(&["--platform", all[0]]).1, all[..1]);
    let help = text(&run(AMONTONS, folder.path(), &["export", "--help"]).stdout);
    assert!(help.contains(&all.join(", ")), "{help}");
}

/// Runs a command to its end; what it prints.
fn succeed(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{command:?}\n{printed}{}", text(&output.stderr));
    printed
}

/// The latest glibc that a file wants a symbol of.
fn glibc_floor(file: &Path) -> (u32, u32) {
    let listed = succeed(Command::new("readelf").args(["--version-info", "--wide"]).arg(file));
    let versions = listed.split("GLIBC_2.").skip(1).map(|rest| {
        let minor: String = rest.chars().take_while(char::is_ascii_digit).collect();
        (2, minor.parse().unwrap())
    });
    versions.max().expect("it wants something of glibc")
}

/// Makes the release for Linux with the libraries of both platforms; the folder of its target.
fn release() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().to_owned();
    succeed(
        Command::new(format!("{ROOT}/release/make")).arg("linux").env("CARGO_TARGET_DIR", &target),
    );
    target
}

fn package(target: &Path, end: &str) -> PathBuf {
    let name = format!("amontons-{}-{end}", env!("CARGO_PKG_VERSION"));
    target.join("release-packages").join(name)
}

#[test]
#[ignore = "makes a release: minutes"]
fn a_release_installs_runs_on_old_systems_and_gives_the_same_doubles_on_both_platforms() {
    let target = release();
    let folder = folder();

    // From the wheel, in an environment of its own.
    let environment = folder.path().join("environment");
    succeed(Command::new("python3").args(["-m", "venv"]).arg(&environment));
    let wheel = package(&target, "py3-none-manylinux_2_17_x86_64.whl");
    let pip = ["-m", "pip", "install", "--quiet", "--no-index", "--disable-pip-version-check"];
    succeed(Command::new(environment.join("bin/python")).args(pip).arg(wheel));
    let installed = environment.join("bin/amontons");
    succeed(Command::new(&installed).args(["export", "set1"]).current_dir(folder.path()));
    succeed(Command::new(environment.join("bin/amontons-stability")).arg("--version"));
    let fmu = folder.path().join("set1.fmu");
    assert_eq!(platforms(&fmu), ["linux64", "win64"]);

    // From the archive: the same program, so the same FMU.
    let archive = package(&target, "linux64.tar.gz");
    succeed(Command::new("tar").arg("-xzf").arg(archive).current_dir(folder.path()));
    let unpacked = folder.path().join(format!("amontons-{}-linux64", env!("CARGO_PKG_VERSION")));
    for name in ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "scenes/belt.toml"] {
        assert!(unpacked.join(name).is_file(), "{name}");
    }
    let program = unpacked.join("amontons");
    let other = folder.path().join("other.fmu");
    let export = ["export", "set1", "-o"];
    succeed(Command::new(&program).args(export).arg(&other));
    assert_eq!(fs::read(&fmu).unwrap(), fs::read(&other).unwrap());

    // What is in it is what was checked.
    let mut carried = zip::ZipArchive::new(File::open(&fmu).unwrap()).unwrap();
    carried.extract(folder.path().join("set1")).unwrap();
    let library = folder.path().join("set1/binaries/linux64/set1.so");
    for file in [&library, &installed, &unpacked.join("amontons-stability")] {
        assert!(glibc_floor(file) <= (2, 17), "{file:?}: {:?}", glibc_floor(file));
    }
    // The library of this test's own program is built for this system alone: the measure sees a difference.
    println!(
        "glibc {:?}, this system's {:?}",
        glibc_floor(&library),
        glibc_floor(AMONTONS.as_ref())
    );

    doubles(&program, folder.path());
}

/// The Python tests in `tests/platforms/`, with a wine of their own.
fn doubles(program: &Path, folder: &Path) {
    let stub = folder.join("stub");
    fs::create_dir(&stub).unwrap();
    succeed(
        Command::new("x86_64-w64-mingw32-gcc")
            .args(["-shared", "-O1", "-o"])
            .arg(stub.join("bcryptprimitives.dll"))
            .arg(format!("{ROOT}/tests/platforms/bcryptprimitives.c")),
    );
    // Debian has wine64 beside the path.
    let path = format!("{}:/usr/lib/wine", std::env::var("PATH").unwrap());
    succeed(
        Command::new(python::interpreter())
            .args(["-B", "-m", "pytest", "-p", "no:cacheprovider", "--tb=short", "--rootdir"])
            .args([OsStr::new(ROOT), OsStr::new("--basetemp"), folder.join("pytest").as_os_str()])
            .arg(format!("{ROOT}/tests/platforms/test_doubles.py"))
            .current_dir(ROOT)
            .env("AMONTONS", program)
            .env("AMONTONS_FOLDER", folder)
            .env("PATH", path)
            .env("WINEPATH", stub)
            .env("WINEPREFIX", folder.join("wine"))
            .env("WINEDEBUG", "-all")
            // Neither a browser nor .NET is wanted: wine would offer to install them.
            .env("WINEDLLOVERRIDES", "mscoree=;mshtml=")
            .env("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
            .env_remove("PYTEST_ADDOPTS")
            .env_remove("SOURCE_DATE_EPOCH"),
    );
}
