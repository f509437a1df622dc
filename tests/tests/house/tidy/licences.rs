//! The licences of the packages built in, and if they are allowed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

/// The list `allow` of `deny.toml`.
pub(crate) fn allowed(deny: &str) -> BTreeSet<String> {
    let list = deny.split("allow = [").nth(1).and_then(|rest| rest.split(']').next()).unwrap_or("");
    list.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The packages of the list `exceptions` of `deny.toml`, each with the licence that it may have.
pub(crate) fn exceptions(deny: &str) -> BTreeMap<String, String> {
    let list = deny.split("exceptions = [\n").nth(1).and_then(|rest| rest.split("\n]").next()).unwrap_or("");
    let row = |line: &str| {
        let mut words = line.split('"').skip(1).step_by(2);
        let (licence, package) = (words.next()?, words.next()?);
        Some((package.to_owned(), licence.to_owned()))
    };
    list.lines().filter_map(row).collect()
}

/// Each package that is built into ours, or used to build it, with its licence.
/// Packages that only tests use are left out.
/// `of` says which of the crates of ours count.
pub(crate) fn used(root: &Path, of: impl Fn(&str) -> bool) -> BTreeMap<String, String> {
    let data = metadata(root);
    let text = |v: &Value| v.as_str().unwrap_or("").to_owned();
    let all = |v: &Value| v.as_array().cloned().unwrap_or_default();
    let mut next: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for node in all(&data["resolve"]["nodes"]) {
        let built = all(&node["deps"]).into_iter().filter(|d| {
            // A kind of `null` is a plain dependency.
            all(&d["dep_kinds"]).iter().any(|k| k["kind"] != "dev")
        });
        next.insert(text(&node["id"]), built.map(|d| text(&d["pkg"])).collect());
    }
    let packages: BTreeMap<String, Value> =
        all(&data["packages"]).into_iter().map(|p| (text(&p["id"]), p)).collect();
    let shipped = |id: &String| {
        let path = packages.get(id).map(|p| text(&p["manifest_path"])).unwrap_or_default();
        let name = packages.get(id).map(|p| text(&p["name"])).unwrap_or_default();
        Path::new(&path).iter().any(|part| part == "crates") && of(&name)
    };
    let mut pending: Vec<String> = all(&data["workspace_members"]).iter().map(text).filter(shipped).collect();
    let mut reached = BTreeSet::new();
    while let Some(id) = pending.pop() {
        if reached.insert(id.clone()) {
            pending.extend(next.get(&id).into_iter().flatten().cloned());
        }
    }
    reached
        .iter()
        .filter_map(|id| packages.get(id))
        .map(|p| (format!("{} {}", text(&p["name"]), text(&p["version"])), text(&p["license"])))
        .collect()
}

/// The workspace as cargo knows it, for this machine's platform.
fn metadata(root: &Path) -> Value {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let version = std::process::Command::new(rustc).arg("-vV").output().expect("rustc");
    let version = String::from_utf8_lossy(&version.stdout).into_owned();
    let host = version.lines().find_map(|l| l.strip_prefix("host: ")).expect("the host platform");
    let out = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--filter-platform", host])
        .current_dir(root)
        .output()
        .expect("cargo metadata");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("JSON of cargo metadata")
}

/// True if an SPDX expression can be met by licences that are allowed: one side
/// of each OR, both sides of each AND. No licence at all is none allowed.
pub(crate) fn fits(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut at = 0;
    let fine = either(&words, &mut at, allowed);
    fine && at == words.len()
}

fn either(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut fine = both(words, at, allowed);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        fine |= both(words, at, allowed);
    }
    fine
}

fn both(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut fine = one(words, at, allowed);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        fine &= one(words, at, allowed);
    }
    fine
}

fn one(words: &[&str], at: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let Some(word) = words.get(*at) else { return false };
    *at += 1;
    if *word == "(" {
        let fine = either(words, at, allowed);
        *at += usize::from(words.get(*at) == Some(&")"));
        return fine;
    }
    let mut name = (*word).to_owned();
    if words.get(*at) == Some(&"WITH") {
        name = format!("{name} WITH {}", words.get(*at + 1).unwrap_or(&""));
        *at += 2;
    }
    allowed.contains(&name)
}

#[test]
fn expressions_are_read_as_spdx_has_them() {
    let allowed: BTreeSet<String> =
        ["MIT", "ISC", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned).into();
    for fine in ["MIT", "GPL-3.0 OR MIT", "MIT/GPL-3.0", "MIT AND (ISC OR GPL-3.0)", "(MIT AND ISC)"] {
        assert!(fits(fine, &allowed), "{fine}");
    }
    assert!(fits("Apache-2.0 WITH LLVM-exception", &allowed));
    for bad in ["", "GPL-3.0", "MIT AND GPL-3.0", "(MIT OR ISC) AND GPL-3.0", "Apache-2.0", "MIT )"] {
        assert!(!fits(bad, &allowed), "{bad}");
    }
}
