//! On which platforms an FMU runs, and that a release's libraries run where it says, those for
//! Windows through wine.

use crate::program::{assert_refused, folder, run, text};
use crate::python;
use amontons_export::package::Library;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

const AMONTONS: &str = env!("CARGO_BIN_EXE_amontons");
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The platforms of an FMU, from the names of its files.
fn platforms(fmu: &Path) -> Vec<String> {
    let archive = zip::ZipArchive::new(File::open(fmu).unwrap()).unwrap();
    let platform = |name: &str| {
        let (platform, _) = name.strip_prefix("binaries/")?.split_once('/')?;
        Some(platform.to_owned())
    };
    let mut names: Vec<String> =
        archive.file_names().filter_map(|name| platform(&name.unwrap())).collect();
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
            let way = if platform == "win64" {
                "release"
            } else {
                "FMUs can be made for linux64 and win64"
            };
            assert_refused(&output, 2, &["--platform", "contains", carried, way]);
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

fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().to_owned()
}

/// A program that carries the libraries of a release: this test's own where it was built with them
/// (`AMONTONS_FMU_LIBRARIES`), or one that is made here, which takes many minutes.
fn program(folder: &Path) -> PathBuf {
    if Library::carried().len() == 2 {
        return AMONTONS.into();
    }
    let make = format!("{ROOT}/release/make");
    succeed(Command::new(make).arg("linux").env("CARGO_TARGET_DIR", target()));
    let stem = format!("amontons-{}-linux64", env!("CARGO_PKG_VERSION"));
    let archive = target().join("release-packages").join(format!("{stem}.tar.gz"));
    succeed(Command::new("tar").arg("-xzf").arg(archive).current_dir(folder));
    folder.join(stem).join("amontons")
}

#[test]
#[ignore = "wants the libraries of a release, and wine"]
fn the_libraries_of_a_release_run_on_old_systems_and_give_the_same_doubles_on_both_platforms() {
    let folder = folder();
    let program = program(folder.path());
    let fmu = folder.path().join("both.fmu");
    succeed(Command::new(&program).args(["export", "set1", "-o"]).arg(&fmu));
    assert_eq!(platforms(&fmu), ["linux64", "win64"]);
    let mut archive = zip::ZipArchive::new(File::open(&fmu).unwrap()).unwrap();
    archive.extract(folder.path().join("both")).unwrap();
    let floor = glibc_floor(&folder.path().join("both/binaries/linux64/set1.so"));
    assert!(floor <= (2, 17), "{floor:?}");
    doubles(&program, folder.path());
}

/// The Python tests in `tests/platforms/`, with a wine of their own.
fn doubles(program: &Path, folder: &Path) {
    let mingw = |more: &[&str], source: &str, made: &Path| {
        let headers = "import fmpy, pathlib; print(pathlib.Path(fmpy.__file__).parent / 'c-code')";
        let headers = succeed(Command::new(python::interpreter()).args(["-c", headers]));
        succeed(
            Command::new("x86_64-w64-mingw32-gcc")
                .args(["-O1", "-Wall", "-Wextra", "-Werror", "-I", headers.trim(), "-o"])
                .arg(made)
                .arg(format!("{ROOT}/crates/cli/tests/platforms/{source}"))
                .args(more),
        );
    };
    // Debian has wine64 beside the path, where FMPy looks for it.
    let path = format!("{}:/usr/lib/wine", std::env::var("PATH").unwrap());
    let wine = folder.join("wine");
    let with_wine = |command: &mut Command| {
        command
            .env("PATH", &path)
            .env("WINEPREFIX", &wine)
            .env("WINEDEBUG", "-all")
            // Neither a browser nor .NET is wanted: wine would offer to install them.
            .env("WINEDLLOVERRIDES", "mscoree=;mshtml=");
    };
    let mut boot = Command::new("timeout");
    boot.args(["300", "/usr/lib/wine/wine64", "wineboot", "--init"]);
    with_wine(&mut boot);
    succeed(&mut boot);
    mingw(
        &["-shared"],
        "bcryptprimitives.c",
        &wine.join("drive_c/windows/system32/bcryptprimitives.dll"),
    );
    let host = folder.join("host.exe");
    mingw(&[], "host.c", &host);

    let mut pytest = Command::new("timeout");
    pytest
        .arg("600")
        .arg(python::interpreter())
        .args(["-B", "-m", "pytest", "-p", "no:cacheprovider", "--tb=short", "--rootdir", ROOT])
        .args([OsStr::new("--basetemp"), folder.join("pytest").as_os_str()])
        .arg(format!("{ROOT}/crates/cli/tests/platforms/test_doubles.py"))
        .current_dir(ROOT)
        .env("AMONTONS", program)
        .env("AMONTONS_FOLDER", folder)
        .env("AMONTONS_HOST", host)
        .env("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
        .env_remove("PYTEST_ADDOPTS")
        .env_remove("SOURCE_DATE_EPOCH");
    with_wine(&mut pytest);
    succeed(&mut pytest);
}
