//! Counters of code that a target does not reach are left out by LLVM's linker: after each input
//! all of them are looked at.

fn main() {
    for argument in ["-fuse-ld=lld", "-Wl,-z,start-stop-gc"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    println!("cargo:rerun-if-changed=build.rs");
}
