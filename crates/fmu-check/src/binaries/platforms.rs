//! The platforms of FMI 2.0: their folders, the format of their libraries, and the libraries of every such system.

use object::{Architecture, BinaryFormat};

pub(super) struct Platform {
    pub(super) folder: &'static str,
    pub(super) extension: &'static str,
    pub(super) format: BinaryFormat,
    pub(super) processors: &'static [Architecture],
}

pub(super) static PLATFORMS: &[Platform] = &[
    Platform {
        folder: "linux64",
        extension: "so",
        format: BinaryFormat::Elf,
        processors: &[Architecture::X86_64],
    },
    Platform {
        folder: "linux32",
        extension: "so",
        format: BinaryFormat::Elf,
        processors: &[Architecture::I386],
    },
    Platform {
        folder: "win64",
        extension: "dll",
        format: BinaryFormat::Pe,
        processors: &[Architecture::X86_64],
    },
    Platform {
        folder: "win32",
        extension: "dll",
        format: BinaryFormat::Pe,
        processors: &[Architecture::I386],
    },
    // FMI 2.0.4 says that darwin64 is for x86; before, the processor was open, and libraries for both are common.
    Platform {
        folder: "darwin64",
        extension: "dylib",
        format: BinaryFormat::MachO,
        processors: &[Architecture::X86_64, Architecture::Aarch64],
    },
    Platform {
        folder: "darwin32",
        extension: "dylib",
        format: BinaryFormat::MachO,
        processors: &[Architecture::I386],
    },
    Platform {
        folder: "aarch64-darwin",
        extension: "dylib",
        format: BinaryFormat::MachO,
        processors: &[Architecture::Aarch64],
    },
];

/// Libraries that every Linux with glibc and GCC's runtime has; their symbols carry versions.
const LINUX: [&str; 13] = [
    "libc.so.6",
    "libm.so.6",
    "libdl.so.2",
    "libpthread.so.0",
    "librt.so.1",
    "libutil.so.1",
    "libresolv.so.2",
    "libanl.so.1",
    "libmvec.so.1",
    "libgcc_s.so.1",
    "libstdc++.so.6",
    "ld-linux-x86-64.so.2",
    "ld-linux.so.2",
];

/// Libraries of Windows with functions for programs, one a line: those from which the crate `windows-sys` 0.61.2 imports.
/// Microsoft generates that crate from its description of all interfaces of Windows, so no one needs to remember them.
/// This command, run in the folder of the crate's sources, writes the list:
///
/// ```sh
/// grep -rhoE '"[A-Za-z0-9._-]+\.(dll|drv|cpl|ocx)"' src | tr -d '"' | tr A-Z a-z | grep -vE '^(api|ext)-ms-' | LC_ALL=C sort -u
/// ```
const WINDOWS: &str = include_str!("windows_libraries.txt");

/// Libraries of every Windows that `windows-sys` leaves out: runtimes of C, and interfaces of classes, not of functions.
const WINDOWS_MORE: [&str; 6] =
    ["d3d11.dll", "dxgi.dll", "msvcrt.dll", "shcore.dll", "ucrtbase.dll", "wsock32.dll"];

impl Platform {
    pub(super) fn of(folder: &str) -> Option<&'static Self> {
        PLATFORMS.iter().find(|platform| platform.folder == folder)
    }

    /// `true` if every system of this platform has this library.
    pub(super) fn has(&self, library: &str) -> bool {
        match self.format {
            BinaryFormat::Elf => LINUX.contains(&library),
            BinaryFormat::Pe => {
                let library = library.to_ascii_lowercase();
                // The names in front are those of API sets, which Windows resolves to its libraries.
                ["api-ms-", "ext-ms-"].iter().any(|set| library.starts_with(set))
                    || WINDOWS_MORE.contains(&library.as_str())
                    || WINDOWS.lines().any(|known| known == library)
            }
            _ => library.starts_with("/usr/lib/") || library.starts_with("/System/Library/"),
        }
    }
}

/// The folders of the system that this program runs on, the preferred one first; none if FMI 2.0 has none.
pub(crate) const HOST: &[&str] = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    &["linux64"]
} else if cfg!(all(target_os = "linux", target_arch = "x86")) {
    &["linux32"]
} else if cfg!(all(windows, target_arch = "x86_64")) {
    &["win64"]
} else if cfg!(all(windows, target_arch = "x86")) {
    &["win32"]
} else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
    &["aarch64-darwin", "darwin64"]
} else if cfg!(target_os = "macos") {
    &["darwin64"]
} else {
    &[]
};

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of names had once reached into the path of macOS's frameworks.
    #[test]
    fn the_libraries_of_each_system_are_known_and_others_are_not() {
        for (folder, own, other) in [
            ("linux64", "libm.so.6", "libgfortran.so.5"),
            ("win64", "KERNEL32.dll", "libgcc_s_seh-1.dll"),
            ("win64", "IMAGEHLP.DLL", "imagehlp2.dll"),
            ("win32", "dhcpcsvc.DLL", "dhcp.dll"),
            ("win64", "msvcrt.dll", "msvcr120.dll"),
            ("win64", "ext-ms-win-gdi-print-l1-1-0.dll", "python3.dll"),
            ("win64", "api-ms-win-crt-math-l1-1-0.dll", "api.dll"),
            ("darwin64", "/usr/lib/libSystem.B.dylib", "/usr/local/lib/libgcc_s.1.dylib"),
            (
                "darwin64",
                "/System/Library/Frameworks/Accelerate.framework/Versions/A/Accelerate",
                "/Library/Frameworks/R.framework/R",
            ),
        ] {
            let platform = Platform::of(folder).unwrap();
            assert!(platform.has(own) && !platform.has(other), "{folder}: {own}, {other}");
        }
    }
}
