//! Rebuilds `g7` when the web page that it contains has changed.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // A development build reads the page from the disk.
    if std::env::var("PROFILE").is_ok_and(|p| p == "release") {
        println!("cargo:rerun-if-changed=../../web/packed/index.html.gz");
    }
}
