// SPDX-License-Identifier: 0BSD
// Compiles the C sources beside this crate; needs a C compiler ($CC or cc) and ar ($AR or ar), no crate.
use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn run(command: &mut Command) {
    let status = command.status().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    assert!(status.success(), "{command:?} failed");
}

/// The tool that a variable names for this target, or at all; of several words, as `zig cc` is.
fn tool(variable: &str, usual: &str) -> Command {
    let target = env::var("TARGET").unwrap().replace('-', "_");
    let named = [format!("{variable}_{target}"), variable.to_string()].into_iter().find_map(|name| {
        println!("cargo:rerun-if-env-changed={name}");
        env::var(name).ok()
    });
    let words = named.unwrap_or_else(|| usual.to_string());
    let mut words = words.split_whitespace();
    let mut command = Command::new(words.next().unwrap_or(usual));
    command.args(words);
    command
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = fs::read_dir(folder)
        .expect("sources")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension() == Some("c".as_ref()))
        .collect();
    found.sort();
    found
}

fn main() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf();
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap());
    let float = env::var_os("CARGO_FEATURE_FLOAT").is_some();
    let mut include = OsString::from("-I");
    include.push(package.join("include"));
    let mut objects = Vec::new();
    for source in sources(&package.join("src")) {
        let object = out.join(source.with_extension("o").file_name().unwrap());
        let number = if float { "-DPANDA_USE_FLOAT=1" } else { "-DPANDA_USE_DOUBLE=1" };
        let mut command = tool("CC", "cc");
        command.args(["-std=c99", "-O2", "-fPIC", number]).arg(&include);
        run(command.arg("-c").arg(&source).arg("-o").arg(&object));
        println!("cargo:rerun-if-changed={}", source.display());
        objects.push(object);
    }
    println!("cargo:rerun-if-changed={}", package.join("include").display());
    let library = out.join("libpanda.a");
    let _ = fs::remove_file(&library);
    run(tool("AR", "ar").arg("crs").arg(&library).args(&objects));
    println!("cargo:rustc-link-search=native={}", out.display());
    println!("cargo:rustc-link-lib=static=panda");
    if env::var("CARGO_CFG_TARGET_FAMILY").as_deref() == Ok("unix") {
        println!("cargo:rustc-link-lib=m");
    }
}
