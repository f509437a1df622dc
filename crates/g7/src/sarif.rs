//! The common part of logs of SARIF 2.1.0 (OASIS, 2020): `check` and `prove` write them, for tools of
//! code review.

use serde_json::{Value, json};

/// A log with one run.
pub(crate) fn log(run: &Value) -> Value {
    json!({
        "$schema": "https://docs.oasis-open.org/sarif/sarif/v2.1.0/os/schemas/sarif-schema-2.1.0.json",
        "version": "2.1.0",
        "runs": [run],
    })
}

/// A file as a URI reference (RFC 3986), relative as the user named it.
pub(crate) fn artifact(file: &str) -> Value {
    let file = file.strip_prefix("./").unwrap_or(file);
    let mut uri = if file.starts_with('/') { "file://".to_owned() } else { String::new() };
    for byte in file.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(byte as char);
            }
            b'\\' if cfg!(windows) => uri.push('/'),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    json!({ "uri": uri })
}

#[cfg(test)]
mod tests {
    use super::artifact;

    #[test]
    fn files_are_relative_references() {
        assert_eq!(artifact("./my chart é.g7")["uri"], "my%20chart%20%C3%A9.g7");
    }
}
