//! The versions of FMI: how each names a library and its place in the archive.

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    V2,
    /// FMI 3.0.
    V3,
}

impl Version {
    /// The folder of the library for a machine, below `binaries`; `None` where the standard has no name.
    pub fn folder(self, system: &str, machine: &str) -> Option<String> {
        match self {
            Version::V2 => {
                let system = match system {
                    "linux" => "linux",
                    "macos" => "darwin",
                    "windows" => "win",
                    _ => return None,
                };
                let bits = match (system, machine) {
                    (_, "x86_64") | ("darwin", "aarch64") => "64",
                    ("linux" | "win", "x86") => "32",
                    // The tuple of FMI 3.0: version 2.0 has no name for the machine.
                    ("linux", "aarch64") => return Some("aarch64-linux".to_owned()),
                    _ => return None,
                };
                Some(format!("{system}{bits}"))
            }
            Version::V3 => {
                let system = match system {
                    "linux" => "linux",
                    "macos" => "darwin",
                    "windows" => "windows",
                    _ => return None,
                };
                let known = matches!(machine, "x86" | "x86_64" | "aarch64" | "arm" | "riscv64");
                known.then(|| format!("{}-{system}", if machine == "arm" { "aarch32" } else { machine }))
            }
        }
    }
}
