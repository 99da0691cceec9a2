//! The modules of each package import only from modules before them; between packages Cargo sees to that.

use std::fs;
use std::path::Path;

/// The sources of each package, and its modules in order.
const PACKAGES: [(&str, &[&str]); 5] = [
    (
        "src",
        &[
            "numerics",
            "decimal",
            "error",
            "contact",
            "model",
            "stability",
            "integrator",
            "scene",
            "assembly",
            "selection",
            "simulation",
            "fmi2",
        ],
    ),
    (
        "crates/analysis/src",
        &[
            "watch",
            "record",
            "journal",
            "output",
            "patterns",
            "statistics",
            "regions",
            "spectral",
            "assign",
            "instant",
            "inputs",
            "effects",
            "stability",
            "doubts",
            "warning",
            "accuracy",
            "sweep",
            "orbit",
            "study",
            "robustness",
            "design",
        ],
    ),
    (
        "crates/structures/src",
        &["random", "dissection", "sparse", "nodes", "shapes", "symmetric", "quadratic", "family"],
    ),
    ("crates/pictures/src", &["picture", "report"]),
    ("crates/export/src", &["superelement", "scene", "feedthrough", "package", "documentation"]),
];

/// Modules that the sources under `path` name with `crate::module`. Tests inside modules may name any.
fn imports(path: &Path, found: &mut Vec<(String, String)>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            imports(&entry.unwrap().path(), found);
        }
        return;
    }
    if path.file_stem().is_some_and(|name| name.to_string_lossy().ends_with("tests")) {
        return;
    }
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    for after in text.split("crate::").skip(1) {
        let module: String =
            after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        found.push((path.display().to_string(), module));
    }
}

#[test]
fn every_module_imports_only_from_modules_before_it() {
    for (sources, modules) in PACKAGES {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(sources);
        for (place, module) in modules.iter().enumerate() {
            let folder = source.join(module);
            let path = if folder.is_dir() { folder } else { source.join(format!("{module}.rs")) };
            let mut found = Vec::new();
            imports(&path, &mut found);
            for (file, import) in found {
                let allowed = import == "Error" || modules[..=place].contains(&&*import);
                assert!(allowed, "{file} imports {import}, which comes after {module}");
            }
        }
        // `lib.rs` declares these modules and no others.
        let lib = fs::read_to_string(source.join("lib.rs")).unwrap();
        let declared = lib.lines().filter(|line| line.contains("mod ") && line.ends_with(';'));
        assert_eq!(declared.count(), modules.len(), "{sources}");
    }
}

#[test]
fn unsafe_stays_in_the_c_interface() {
    fn visit(path: &Path) {
        for entry in fs::read_dir(path).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                visit(&path);
            } else if !path.components().any(|part| part.as_os_str() == "fmi2")
                && !path
                    .parent()
                    .is_some_and(|folder| folder.ends_with("fmu-check/src/run/worker/library"))
            {
                let text = fs::read_to_string(&path).unwrap();
                assert!(!text.contains("unsafe "), "{} calls no C", path.display());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    visit(&root.join("src"));
    for member in fs::read_dir(root.join("crates")).unwrap() {
        visit(&member.unwrap().path().join("src"));
    }
}

/// The digest once listed the modules of `src` by hand and lacked four of them: after a change of one of these, an
/// export put the library of the sources before the change into an FMU.
#[test]
fn the_digest_of_the_library_covers_all_of_its_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let list = fs::read_to_string(root.join("build/sources.rs")).unwrap();
    let covers = |path: &Path| list.contains(&format!("\"{}\"", path.display()));
    for entry in fs::read_dir(root.join("src")).unwrap() {
        let path = Path::new("src").join(entry.unwrap().file_name());
        assert!(path.ancestors().any(covers), "{}", path.display());
    }
}
