//! The file of hosts: `host:port`, a line for each process.

use crate::Error;

/// The addresses of a file of hosts, in its order. Empty lines and what follows a `#` do not count.
///
/// # Errors
///
/// A line that is no address, or one that stands there twice: `name:line:column` and the reason.
pub fn parse(name: &str, text: &str) -> Result<Vec<String>, Error> {
    let mut found: Vec<String> = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let own = line.split('#').next().unwrap_or_default();
        let address = own.trim();
        if address.is_empty() {
            continue;
        }
        let column = own.chars().take_while(|c| c.is_whitespace()).count() + 1;
        let wrong = |reason: String| Error::Usage(format!("{name}:{}:{column}: {reason}", k + 1));
        if let Some(reason) = fault(address) {
            return Err(wrong(format!("`{address}` is no `host:port`: {reason}")));
        }
        if found.iter().any(|a| a == address) {
            return Err(wrong(format!("`{address}` stands here twice; each process has a port of its own")));
        }
        found.push(address.to_owned());
    }
    if found.is_empty() {
        return Err(Error::Usage(format!(
            "{name}: there is no host; write `host:port`, a line for each process"
        )));
    }
    Ok(found)
}

fn fault(address: &str) -> Option<&'static str> {
    let Some((host, port)) = address.rsplit_once(':') else { return Some("the port is missing") };
    if host.is_empty() {
        return Some("the host is missing");
    }
    if host.contains(char::is_whitespace) {
        return Some("a name of a host has no spaces");
    }
    if host.contains(':') && !(host.starts_with('[') && host.ends_with(']')) {
        return Some("write an address with colons in brackets, as in `[::1]:4000`");
    }
    match port.parse::<u16>() {
        Ok(0) | Err(_) => Some("a port is a number from 1 to 65535"),
        Ok(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn a_file_of_hosts() {
        let text = "# ours\n\n  10.0.0.5:4000 # fast\n[::1]:4001\npc.local:65535\n";
        assert_eq!(parse("h", text).unwrap(), ["10.0.0.5:4000", "[::1]:4001", "pc.local:65535"]);
    }

    #[test]
    fn a_bad_line_is_told_with_its_place() {
        let told = |text: &str| parse("h", text).unwrap_err().to_string();
        assert_eq!(told("a:1\n  b"), "h:2:3: `b` is no `host:port`: the port is missing");
        assert_eq!(told(":80"), "h:1:1: `:80` is no `host:port`: the host is missing");
        assert!(told("a:0").contains("from 1 to 65535"));
        assert!(told("a:65536").contains("from 1 to 65535"));
        assert!(told("a:-1").contains("from 1 to 65535"));
        assert!(told("::1:80").contains("brackets"));
        assert!(told("a b:80").contains("spaces"));
        assert_eq!(told("a:1\na:1"), "h:2:1: `a:1` stands here twice; each process has a port of its own");
        assert!(told(" # nothing\n").contains("no host"));
    }
}
