//! The rooms of the crate import only from rooms before them.

use std::fs;
use std::path::Path;

/// The way through, in its one direction.
const ROOMS: [&str; 18] = [
    "error",
    "output",
    "progress",
    "spectral",
    "contact",
    "scene",
    "model",
    "stability",
    "integrator",
    "simulation",
    "accuracy",
    "sweep",
    "study",
    "fmi2",
    "package",
    "picture",
    "report",
    "documentation",
];

/// Rooms that the sources under `path` name with `crate::room`.
fn imports(path: &Path, found: &mut Vec<(String, String)>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            imports(&entry.unwrap().path(), found);
        }
        return;
    }
    let text = fs::read_to_string(path).unwrap();
    for after in text.split("crate::").skip(1) {
        let room: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        found.push((path.display().to_string(), room));
    }
}

#[test]
fn every_room_imports_only_from_rooms_before_it() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for (place, room) in ROOMS.iter().enumerate() {
        let folder = source.join(room);
        let path = if folder.is_dir() { folder } else { source.join(format!("{room}.rs")) };
        let mut found = Vec::new();
        imports(&path, &mut found);
        for (file, import) in found {
            let allowed = import == "Error" || ROOMS[..=place].contains(&&*import);
            assert!(allowed, "{file} imports {import}, which comes after {room}");
        }
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
                    .is_some_and(|room| room.ends_with("fmu-check/src/run/worker/library"))
            {
                let text = fs::read_to_string(&path).unwrap();
                assert!(!text.contains("unsafe "), "{} calls no C", path.display());
            }
        }
    }
    for sources in ["src", "crates/fmu-check/src"] {
        visit(&Path::new(env!("CARGO_MANIFEST_DIR")).join(sources));
    }
}
