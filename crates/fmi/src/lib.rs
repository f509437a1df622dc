//! FMUs of others as plants: an archive is unpacked, its description read, its library loaded and stepped.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> archive -> files -> (written by the caller) -> library: an instance, set, stepped, read
//!             +-> modelDescription.xml -> description: variables, identifier, token
//! ```
//!
//! # Invariants
//!
//! - A broken archive or description is an error in words. The library itself is a program of others, which can
//!   do anything that this process can: whoever loads it has to trust it.
//! - Foreign functions are called in [`library`] alone, the only file of the crates with unsafe code.
#![deny(unsafe_code)]

pub mod archive;
pub mod description;
pub mod library;
