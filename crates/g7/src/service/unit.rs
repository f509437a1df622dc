//! The text of a unit of systemd (systemd.service(5), systemd.exec(5)).
//!
//! The service may do what a controller needs and no more: it reads the file system, writes the folder
//! of its retained values and its history alone, and gets no new rights.

use std::path::Path;

use g7_model::{Said, say};

/// The first line of our units, by which they are known.
const OURS: &str = "# Written by `g7 service install`.";

/// The command of the service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Runs {
    /// `g7 run --online`
    Run,
    /// `g7 serve --online`
    Serve,
}

/// All that a unit says. Paths are absolute.
#[derive(Clone, Debug)]
pub(super) struct Unit<'a> {
    pub(super) binary: &'a Path,
    pub(super) chart: &'a Path,
    pub(super) io: &'a Path,
    pub(super) name: &'a str,
    pub(super) runs: Runs,
    pub(super) of_user: bool,
    /// The user whose rights it has.
    pub(super) run_as: Option<String>,
    pub(super) restart: bool,
    /// It writes retained values or a history beside the io file.
    pub(super) keeps: bool,
    /// It has a serial line.
    pub(super) serial: bool,
    /// It listens at a port below 1024.
    pub(super) low_port: bool,
    /// Its scan has a priority.
    pub(super) realtime: bool,
}

impl Unit<'_> {
    /// The file of the unit.
    ///
    /// # Errors
    ///
    /// A sentence, where a path cannot stand in a unit.
    pub(super) fn text(&self) -> Result<String, Said> {
        let command = match self.runs {
            Runs::Run => "run --online",
            Runs::Serve => "serve --online --no-open",
        };
        let [binary, chart, io] = [self.binary, self.chart, self.io].map(quoted);
        let (binary, chart, io) = (binary?, chart?, io?);
        let mut lines = vec![
            OURS.to_owned(),
            "[Unit]".to_owned(),
            format!("Description=G7 controller {}", self.name),
            "Documentation=man:g7(1)".to_owned(),
        ];
        if !self.of_user {
            lines.push("Wants=network-online.target\nAfter=network-online.target".to_owned());
        }
        lines.push("\n[Service]\nType=notify".to_owned());
        lines.push(format!("ExecStart={binary} {command} {chart} --io {io}"));
        // A controller that hangs as a whole is ended; its devices then notice its silence.
        lines.push("WatchdogSec=10\nTimeoutStopSec=20".to_owned());
        lines.push(if self.restart { "Restart=on-failure\nRestartSec=2" } else { "Restart=no" }.to_owned());
        if let Some(user) = &self.run_as {
            lines.push(format!("User={user}"));
        }
        if self.realtime {
            lines.push("LimitRTPRIO=99\nLimitMEMLOCK=infinity".to_owned());
        }
        if !self.of_user {
            lines.push(self.bounds()?);
        }
        let target = if self.of_user { "default.target" } else { "multi-user.target" };
        lines.push(format!("\n[Install]\nWantedBy={target}\n"));
        Ok(lines.join("\n"))
    }

    /// The lines that bound the rights of the service.
    fn bounds(&self) -> Result<String, Said> {
        let mut lines = vec![
            "NoNewPrivileges=yes",
            "ProtectSystem=strict",
            "PrivateTmp=yes",
            "ProtectKernelTunables=yes",
            "ProtectKernelModules=yes",
            "ProtectControlGroups=yes",
            "RestrictSUIDSGID=yes",
            "RestrictNamespaces=yes",
            "LockPersonality=yes",
            "MemoryDenyWriteExecute=yes",
            "RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6",
        ];
        lines.push(if self.low_port {
            "AmbientCapabilities=CAP_NET_BIND_SERVICE\nCapabilityBoundingSet=CAP_NET_BIND_SERVICE"
        } else {
            "CapabilityBoundingSet="
        });
        if self.serial {
            lines.push("SupplementaryGroups=dialout");
        }
        let mut text = lines.join("\n");
        if self.keeps
            && let Some(folder) = self.io.parent()
        {
            text.push_str("\nReadWritePaths=");
            text.push_str(&quoted(folder)?);
        }
        Ok(text)
    }
}

/// True for the text of a unit of ours.
pub(super) fn is_ours(text: &[u8]) -> bool {
    text.starts_with(OURS.as_bytes())
}

/// Refuses what is no name of a unit (systemd.unit(5)) or would be an instance or a path.
pub(super) fn check_name(name: &str) -> Result<(), Said> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.len() > 200 || !name.chars().all(fits) || name.starts_with(['-', '.']) {
        return Err(say!(
            "`{name}` is no name of a service: letters without accents, digits, `-`, `_` and `.` \
             (--name gives another one)"
        ));
    }
    Ok(())
}

/// A path as an argument (systemd.service(5), "Command lines"; systemd.unit(5), "Specifiers").
fn quoted(path: &Path) -> Result<String, Said> {
    let Some(text) = path.to_str().filter(|text| !text.contains(['\n', '\r'])) else {
        return Err(say!("`{}` cannot stand in a unit: rename it", path.display()));
    };
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '%' | '$' => out.extend([c, c]),
            _ => out.push(c),
        }
    }
    out.push('"');
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_units() {
        for name in ["g7-sorter", "a", "x_1.y"] {
            assert_eq!(check_name(name), Ok(()));
        }
        let long = "a".repeat(201);
        for name in ["", "-x", ".x", "a b", "a/b", "a@b", "é", "a\nb", &long] {
            assert!(check_name(name).is_err(), "{name}");
        }
    }

    #[test]
    fn paths_are_one_argument_without_specifiers() {
        assert_eq!(quoted(Path::new("/a b/100%/$x\"\\")).as_deref(), Ok("\"/a b/100%%/$$x\\\"\\\\\""));
        assert!(quoted(Path::new("/a\nb")).is_err());
    }
}
