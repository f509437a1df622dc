//! Checks the file names that clients send.
//!
//! A name that passes stays below the folder when it is joined to it, on every system: no `..`, no
//! root, no drive, no device, no hidden file. Links are checked in `folder`, on the disk.

use std::path::PathBuf;

use g7_model::{Said, say};

/// Greatest length of a path, in bytes.
const LONGEST: usize = 1024;
/// Greatest depth of a path, in folders.
pub(super) const DEEPEST: usize = 16;

/// Extensions of our own files that are served; those of foreign charts are served too.
const ENDINGS: [&str; 2] = ["g7", "svg"];

/// The path below the folder, or the reason why the name is refused.
pub(super) fn path(name: &str) -> Result<PathBuf, Said> {
    if name.is_empty() || name.len() > LONGEST {
        return Err(say!("a file needs a name of at most 1024 letters"));
    }
    let parts: Vec<&str> = name.split('/').collect();
    if parts.len() > DEEPEST {
        return Err(say!("`{}` lies too deep", shown(name)));
    }
    if let Some(why) = parts.iter().find_map(|p| fault(p)) {
        return Err(say!("`{}` cannot be used here: {why}", shown(name)));
    }
    if !is_served(name) && !is_io(name) {
        return Err(say!(
            "`{}` is neither a chart nor an .svg picture: other files are not served",
            shown(name)
        ));
    }
    Ok(parts.iter().collect())
}

/// True if files with this extension are served.
pub(super) fn is_served(name: &str) -> bool {
    let foreign = g7_exchange::FORMATS.iter().filter(|f| f.is_read()).flat_map(|f| f.endings);
    let mut known = ENDINGS.iter().chain(foreign);
    name.rsplit_once('.')
        .is_some_and(|(stem, end)| !stem.is_empty() && known.any(|known| end.eq_ignore_ascii_case(known)))
}

/// True for the name of an io file, which stands beside its chart and is not listed with the charts.
pub(super) fn is_io(name: &str) -> bool {
    name.strip_suffix(".io.toml").is_some_and(|stem| !stem.is_empty() && !stem.ends_with('/'))
}

/// The fault of the name of a file or folder, if it has one.
pub(super) fn fault(part: &str) -> Option<Said> {
    if part.is_empty() {
        return Some(say!("a part of it is empty"));
    }
    if part == ".." || part == "." {
        return Some(say!("it leads out of the folder"));
    }
    if part.starts_with('.') {
        return Some(say!("hidden files are left alone"));
    }
    if part.len() > 200 {
        return Some(say!("a part of it is too long"));
    }
    if part.chars().any(|c| c.is_control() || "\\:*?\"<>|".contains(c)) {
        return Some(say!("it has a letter that names of files cannot have everywhere"));
    }
    if part.ends_with(['.', ' ']) || part.starts_with(' ') {
        return Some(say!("a part of it begins or ends with a space, or ends with a dot"));
    }
    is_device(part).then(|| say!("it is the name of a device"))
}

/// True for names that Windows treats as devices, whatever the extension.
fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or(part).trim_end().to_ascii_uppercase();
    let numbered = |kind: &str| {
        let rest = stem.strip_prefix(kind);
        rest.is_some_and(|r| {
            let mut letters = r.chars();
            matches!((letters.next(), letters.next()), (Some('0'..='9' | '¹' | '²' | '³'), None))
        })
    };
    matches!(stem.as_str(), "CON" | "PRN" | "AUX" | "NUL" | "CONIN$" | "CONOUT$")
        || numbered("COM")
        || numbered("LPT")
}

/// The name for a message: on one line, and of limited length.
fn shown(name: &str) -> String {
    name.chars().take(80).map(|c| if c.is_control() { '?' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_pass() {
        for name in ["chart.g7", "a/b/Sorter.xml", "tank/view.SVG", "fuellstation süd.g7", "a/chart.io.toml"]
        {
            assert!(path(name).is_ok(), "{name}: {:?}", path(name));
        }
    }

    #[test]
    fn names_that_lead_elsewhere_do_not() {
        let names = [
            "",
            "/etc/x.g7",
            "../x.g7",
            "a/../../x.g7",
            "a/./x.g7",
            "a//x.g7",
            "./x.g7",
            "x.g7/",
            ".g7",
            ".hidden.g7",
            ".git/x.g7",
            "C:x.g7",
            "C:\\x.g7",
            "a\\..\\x.g7",
            "x.g7\0",
            "x\n.g7",
            "x.g7:stream",
            "x.g7 ",
            "x.g7.",
            "CON.g7",
            "a/nul.g7",
            "com1.svg",
            "LPT9.xml",
            "aux .g7",
            "COM¹.g7",
            "CONIN$.g7",
            "\\\\host\\share\\x.g7",
        ];
        for name in names {
            assert!(path(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn other_files_are_not_served() {
        for name in ["notes.txt", "g7", "x.g7.exe", "key.pem", "x", "x.toml", "io.toml"] {
            assert!(path(name).is_err_and(|why| why.contains("not served")), "{name}");
        }
        assert!(path("a/.io.toml").is_err_and(|why| why.contains("hidden")));
        assert!(path(&"a/".repeat(40)).is_err());
        assert!(path(&format!("{}.g7", "x".repeat(2000))).is_err());
    }
}
