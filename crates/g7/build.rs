//! Has `g7` built again when the page that it carries was.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // A development build reads the page from the disk.
    if std::env::var("PROFILE").is_ok_and(|p| p == "release") {
        println!("cargo:rerun-if-changed=../../web/dist/index.html");
    }
}
